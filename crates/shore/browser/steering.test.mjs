// A boat driven by a person: two pages show one game, and one of them drives.

import assert from 'node:assert/strict';
import { mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { Program, Sight, openAnother, openBrowser, scenario } from './harness.mjs';

let browser;
before(async () => { browser = await openBrowser(); });
after(() => browser.close());

/** Tolerances of the ordered course and speed in calm water. */
const OFF_DEG = 8;
const OFF_M_S = 0.25;

const BOAT = 'blue_one';

/** Waits until the boat moves as ordered. */
const goes = (sight, course_deg, speed_m_s) => sight.until(`${BOAT} goes ${course_deg}° at ${speed_m_s} m/s`,
  ([name, course_deg, speed_m_s, off_deg, off_m_s]) => {
    const boat = squall.frame.boats.find((each) => each.name === name);
    const off = Math.abs(((boat.course_deg - course_deg + 540) % 360) - 180);
    return off < off_deg && Math.abs(boat.speed_m_s - speed_m_s) < off_m_s && { course_deg: boat.course_deg, speed_m_s: boat.speed_m_s };
  }, [BOAT, course_deg, speed_m_s, OFF_DEG, OFF_M_S]);

/** The ordered course and speed, as shown on the page. */
const ordered = async (sight) => (await sight.text('#steering-text')).match(/(\d+)°\s+([\d.]+)/).slice(1).map(Number);

/** Waits until this course and speed are ordered. */
const orders = (sight, course_deg, speed_m_s) => sight.until(`${course_deg}° at ${speed_m_s} m/s are ordered`, ([course_deg, speed_m_s]) => {
  const [, deg, m_s] = document.getElementById('steering-text').textContent.match(/(\d+)°\s+([\d.]+)/).map(Number);
  return deg === course_deg && m_s === speed_m_s;
}, [course_deg, speed_m_s]);

/** Waits until the boat stands still. */
const stands = (sight) => sight.until(`${BOAT} stands`, (name) => squall.frame.boats.find((boat) => boat.name === name).speed_m_s < 0.2, BOAT);

/** Waits until no page drives the boat, according to the server. */
const isFree = (sight) => sight.until('no page drives the boat', () => squall.driving === null
  && document.querySelector('#pane-boat .note').hidden);

/** Starts to drive the boat. */
async function take(sight) {
  await sight.press(`[data-vehicle=${BOAT}]`);
  await sight.press('#drive');
}

/** A game in which only the driven boat moves. */
function alone(t) {
  const folder = mkdtempSync(join(tmpdir(), 'squall-'));
  t.after(() => rmSync(folder, { recursive: true, force: true }));
  const vehicle = (name, strategy) => `[[vehicle]]\nname = "${name}"\nteam = "${name.split('_')[0]}"\nstrategy = "${scenario(`strategies/${strategy}.toml`)}"\n`;
  const others = ['blue_two', 'red_one', 'red_two'].map((name) => vehicle(name, 'idle'));
  const file = join(folder, 'alone.toml');
  writeFileSync(file, [`base = "${scenario('games/person_2v2.toml')}"\n`, vehicle(BOAT, 'teleop'), ...others].join('\n'));
  return file;
}

test('two pages see one game; one steers a boat, and the other sees who steers', async (t) => {
  // The other boats stay still: safety behaviours would move this boat if they came near, and a slow machine needs time.
  const run = new Program(t, 'run', alone(t), '--view', '--pace', 'realtime', '--no-record', '--listen', '127.0.0.1:0');
  const url = await run.url();
  // Two browsers, as for two people: a page in the background draws nothing.
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
  await mine.until('this page drives the boat', () => /You are driving this boat/.test(document.getElementById('pane-boat').textContent));
  await theirs.until('the other page is informed', () => /Another page is driving/.test(document.getElementById('pane-boat').textContent));
  const start = await mine.get((name) => squall.frame.boats.find((boat) => boat.name === name), BOAT);
  const course_deg = 90;
  const begun_deg = await mine.get(() => Number(document.getElementById('steering-text').textContent.match(/\d+/)[0]));
  const turn = Math.round((((course_deg - begun_deg + 540) % 360) - 180) / 5);
  await mine.keys(...Array(Math.abs(turn)).fill(turn < 0 ? 'a' : 'd'), 'w', 'w', 'w', 'w');
  const [ordered_deg, ordered_m_s] = await ordered(mine);
  assert(Math.abs(ordered_deg - course_deg) <= 3 && ordered_m_s === 1, `${ordered_deg}° at ${ordered_m_s} m/s`);
  const went = await goes(mine, ordered_deg, ordered_m_s);
  const { x, y } = await mine.get((name) => squall.frame.boats.find((boat) => boat.name === name), BOAT);
  await mine.until('the boat moves eastward', ([name, x]) => squall.frame.boats.find((boat) => boat.name === name).x > x + 3, [BOAT, x]);
  t.diagnostic(`from ${start.x.toFixed(1)}, ${start.y.toFixed(1)} to ${x.toFixed(1)}, ${y.toFixed(1)}; ordered ${ordered_deg}° at ${ordered_m_s} m/s, went ${JSON.stringify(went)}`);
  await theirs.press('#drive');
  await theirs.until('the other page is refused', () => squall.driving === null
    && /Another page/.test(document.getElementById('notices').textContent));
  assert.equal(await mine.get(() => squall.driving), BOAT, 'this page still drives the boat');
  await mine.page.focus('#steering');
  await mine.keys(...Array(6).fill('ArrowDown'));
  await stands(mine);
  await mine.keys('Escape');
  assert.equal(await mine.get(() => squall.driving), null);
  await theirs.until('no page drives the boat', () => !/Another page is driving/.test(document.querySelector('.note:not([hidden])')?.textContent ?? ''));
  await theirs.press('#drive');
  await theirs.until('the other page drives the boat', () => /You are driving this boat/.test(document.getElementById('pane-boat').textContent));
  await mine.until('this page is informed', () => /Another page is driving/.test(document.getElementById('pane-boat').textContent));
});

const person = (t, ...words) => new Program(t, 'run', scenario('games/person_2v2.toml'), '--view', '--no-record', '--listen', '127.0.0.1:0', ...words);

/** Fake gamepads: those in `pads` are connected. */
const PADS = () => {
  window.pads = [];
  navigator.getGamepads = () => window.pads;
};

/** Waits until the page has read the gamepads several times. */
const read = (sight) => sight.get(() => new Promise((done) => {
  let left = 5;
  navigator.getGamepads = () => {
    left -= 1;
    if (left === 0) done();
    return window.pads;
  };
}));

test('a gamepad steers once its stick has been at rest; the boat stops when the gamepad is gone', async (t) => {
  const sight = await Sight.open(t, browser, await person(t, '--pace', 'realtime').url(), { before: PADS });
  const plug = (...pads) => sight.get((pads) => {
    window.pads = pads.map(([axes, mapping], index) => ({ index, id: `pad ${index}`, mapping, connected: true,
      axes: axes.map((axis) => axis ?? NaN), buttons: [] }));
  }, pads);
  const leans = [[0, -1], ''];
  const out = [[1, 0, 0, 0], 'standard'];
  const rests = [[0.02, null, 0, 0], 'standard'];
  await plug(leans, out);
  await take(sight);
  const [start_deg] = await ordered(sight);
  await read(sight);
  assert.deepEqual(await ordered(sight), [start_deg, 0], 'a stick deflected from the start has no effect');
  await plug(leans, rests);
  await read(sight);
  assert.deepEqual(await ordered(sight), [start_deg, 0], 'neither a stick at rest nor another device has an effect');
  await plug(leans, out);
  await orders(sight, 90, 3);
  await goes(sight, 90, 3);
  await plug(leans);
  await orders(sight, 90, 0);
  assert.match(await sight.text('#notices'), /gamepad is disconnected/);
  await stands(sight);
  await plug(out);
  await read(sight);
  assert.deepEqual(await ordered(sight), [90, 0], 'a reconnected stick must be at rest first');
  await plug(rests);
  await read(sight);
  await plug([[0, 0.5, 0, 0], 'standard']);
  await orders(sight, 180, 1.5);
  await plug(rests);
  await orders(sight, 180, 0);
});

test('a driver who leaves the window releases the boat, and it stops', async (t) => {
  const sight = await Sight.open(t, browser, await person(t, '--pace', 'realtime').url());
  const away = {
    'another window is in front': () => dispatchEvent(new Event('blur')),
    'the page is hidden': () => {
      Object.defineProperty(document, 'hidden', { configurable: true, value: true });
      document.dispatchEvent(new Event('visibilitychange'));
      delete document.hidden;
    },
  };
  for (const [why, go] of Object.entries(away)) {
    await take(sight);
    await sight.until('the page drives the boat', () => /You are driving this boat/.test(document.getElementById('pane-boat').textContent));
    await sight.keys(...Array(8).fill('w'));
    await sight.until('the boat moves', (name) => squall.frame.boats.find((boat) => boat.name === name).speed_m_s > 0.8, BOAT);
    await sight.get(go);
    assert.equal(await sight.get(() => squall.driving), null, why);
    await isFree(sight);
    await stands(sight);
    await sight.press('#tab-boats');
  }
});

/** How long a helm uses a set-point, simulated s. */
const HEEDED_S = 1.5;

/** Runs in the page before its own scripts: records the simulated times at which it sends set-points. */
const NOTED = () => {
  window.driveSent_s = [];
  const { send } = WebSocket.prototype;
  WebSocket.prototype.send = function noted(text) {
    if (JSON.parse(text).do === 'drive') driveSent_s.push(squall.t_s);
    send.call(this, text);
  };
};

test('a fast game is steered without gaps, and one at maximum speed is reported as too fast', async (t) => {
  const sight = await Sight.open(t, browser, await person(t, '--speed', '10x').url(), { before: NOTED });
  await take(sight);
  // Keys steer whatever has the focus: a list would take the arrow keys.
  await sight.page.focus('#speed');
  await sight.keys(...Array(4).fill('ArrowUp'));
  const [course_deg, speed_m_s] = await ordered(sight);
  assert.equal(speed_m_s, 1);
  assert.equal(await sight.get(() => squall.state.speed), 10);
  await goes(sight, course_deg, speed_m_s);
  // A machine may stall for a while, and then the boat stops, as it should: it must be driven in at least one period in ten.
  const stretch = () => sight.get((name) => new Promise((done) => {
    const middle = (values) => values.sort((one, other) => one - other)[Math.floor(values.length / 2)];
    const from_s = squall.t_s;
    const speeds = [];
    const look = setInterval(() => {
      speeds.push(squall.frame.boats.find((each) => each.name === name).speed_m_s);
      if (squall.t_s < from_s + 20) return;
      clearInterval(look);
      const sent = driveSent_s.filter((t_s) => t_s >= from_s);
      done({ gap_s: middle(sent.slice(1).map((t_s, at) => t_s - sent[at])), went_m_s: middle(speeds) });
    }, 20);
  }), BOAT);
  const seen = [];
  const isSteered = ({ gap_s, went_m_s }) => gap_s < HEEDED_S && Math.abs(went_m_s - speed_m_s) < OFF_M_S / 2;
  while (seen.length < 10 && !seen.some(isSteered)) seen.push(await stretch());
  assert(seen.some(isSteered), `intervals between set-points, s, and the boat's motion: ${JSON.stringify(seen)}`);
  assert(!(await sight.page.isVisible('#steering-note')));
  await sight.page.selectOption('#speed', 'max');
  await sight.until('the page says that the game is too fast', () => /Too fast/.test(document.getElementById('steering-note').textContent)
    && !document.getElementById('steering-note').hidden);
});
