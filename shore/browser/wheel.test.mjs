// A boat that people steer: two pages look at one game, and one of them has the wheel.

import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { Program, Sight, openAnother, openBrowser, scenario } from './harness.mjs';

let browser;
before(async () => { browser = await openBrowser(); });
after(() => browser.close());

/** How far a boat may be off the course and the speed it is ordered, in calm water. */
const OFF_DEG = 8;
const OFF_M_S = 0.25;

const BOAT = 'blue_one';

/** Waits until the boat goes as ordered. */
const goes = (sight, course_deg, speed_m_s) => sight.until(`${BOAT} goes ${course_deg}° at ${speed_m_s} m/s`,
  ([name, course_deg, speed_m_s, off_deg, off_m_s]) => {
    const boat = squall.frame.boats.find((each) => each.name === name);
    const off = Math.abs(((boat.course_deg - course_deg + 540) % 360) - 180);
    return off < off_deg && Math.abs(boat.speed_m_s - speed_m_s) < off_m_s && { course_deg: boat.course_deg, speed_m_s: boat.speed_m_s };
  }, [BOAT, course_deg, speed_m_s, OFF_DEG, OFF_M_S]);

/** Takes the wheel of the boat. */
async function take(sight) {
  await sight.press(`[data-vehicle=${BOAT}]`);
  await sight.press('#drive');
}

test('two pages see one game; a boat goes as one of them says, and the other is told who steers', async (t) => {
  const run = new Program(t, 'run', scenario('games/person_2v2.toml'), '--view', '--pace', 'realtime', '--no-record', '--listen', '127.0.0.1:0');
  const url = await run.url();
  // Two browsers, as two people have: a page that is not in front is shown nothing.
  const other = await openAnother(t);
  const [mine, theirs] = [await Sight.open(t, browser, url), await Sight.open(t, other, url)];
  const look = (sight) => sight.get(() => ({ t_s: squall.t_s, places: squall.frame.boats.map(({ name, x, y }) => [name, x, y]) }));
  await Promise.all([mine.goesOn(), theirs.goesOn()]);
  const [here, there] = await Promise.all([look(mine), look(theirs)]);
  assert(Math.abs(here.t_s - there.t_s) < 1, `${here.t_s} s here, ${there.t_s} s there`);
  here.places.forEach(([name, x, y], at) => {
    const [named, otherX, otherY] = there.places[at];
    assert.equal(name, named);
    assert(Math.hypot(x - otherX, y - otherY) < 4, `${name} at ${x}, ${y} here and ${otherX}, ${otherY} there`);
  });
  await theirs.press(`[data-vehicle=${BOAT}]`);
  await take(mine);
  await mine.until('the wheel is ours', () => /You have the wheel/.test(document.getElementById('pane-boat').textContent));
  await theirs.until('they are told', () => /Somebody else has the wheel/.test(document.getElementById('pane-boat').textContent));
  const start = await mine.get((name) => squall.frame.boats.find((boat) => boat.name === name), BOAT);
  const course_deg = 90;
  const begun_deg = await mine.get(() => Number(document.getElementById('wheel-text').textContent.match(/\d+/)[0]));
  const turn = Math.round((((course_deg - begun_deg + 540) % 360) - 180) / 5);
  await mine.keys(...Array(Math.abs(turn)).fill(turn < 0 ? 'a' : 'd'), 'w', 'w', 'w', 'w', 'w', 'w');
  const ordered = await mine.text('#wheel-text');
  const [, ordered_deg, ordered_m_s] = ordered.match(/(\d+)°\s+([\d.]+)/).map(Number);
  assert(Math.abs(ordered_deg - course_deg) <= 3 && ordered_m_s === 1.5, ordered);
  const went = await goes(mine, ordered_deg, ordered_m_s);
  const { x, y } = await mine.get((name) => squall.frame.boats.find((boat) => boat.name === name), BOAT);
  await mine.until('it gets on eastward', ([name, x]) => squall.frame.boats.find((boat) => boat.name === name).x > x + 3, [BOAT, x]);
  t.diagnostic(`from ${start.x.toFixed(1)}, ${start.y.toFixed(1)} to ${x.toFixed(1)}, ${y.toFixed(1)}; ordered ${ordered}, went ${JSON.stringify(went)}`);
  await theirs.press('#drive');
  await theirs.until('they are refused the wheel', () => squall.driving === null
    && /Somebody else/.test(document.getElementById('notices').textContent));
  assert.equal(await mine.get(() => squall.driving), BOAT, 'and it stays ours');
  await mine.page.focus('#wheel');
  await mine.keys(...Array(6).fill('ArrowDown'));
  await mine.until('it stops', (name) => squall.frame.boats.find((boat) => boat.name === name).speed_m_s < 0.2, BOAT);
  await mine.keys('Escape');
  assert.equal(await mine.get(() => squall.driving), null);
  await theirs.until('the wheel is free', () => !/Somebody else has the wheel/.test(document.querySelector('.note:not([hidden])')?.textContent ?? ''));
  await theirs.press('#drive');
  await theirs.until('it is theirs', () => /You have the wheel/.test(document.getElementById('pane-boat').textContent));
  await mine.until('and we are told', () => /Somebody else has the wheel/.test(document.getElementById('pane-boat').textContent));
});
