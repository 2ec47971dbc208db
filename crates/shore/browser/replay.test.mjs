// Recordings on the page: what is shown at each moment, compared with the result written by the program.

import assert from 'node:assert/strict';
import { readdirSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { Program, Sight, folder, gameFile, openBrowser, readJson, scenario, squall } from './harness.mjs';

let browser;
before(async () => { browser = await openBrowser(); });
after(() => browser.close());

/** A time after an event, and before the next one, s. */
const JUST_AFTER_S = 0.3;
/** Tolerance of a time chosen on the timeline, s: the time that one pixel covers. */
const PIXEL_S = 0.6;

const pav01 = scenario('games/pav01_vs_pav01.toml');

/** Plays and records a game. Returns the recording and the result. */
async function record(t, game = pav01, ...more) {
  const place = folder(t);
  await squall(t, 'run', game, '--in-process', '--record', place, '--json', join(place, 'result.json'), ...more);
  const file = readdirSync(place).find((name) => name.endsWith('.mcap'));
  return { file: join(place, file), result: readJson(join(place, 'result.json')) };
}

/** Which team's flag each boat carries at a time, and the score by then, according to the events. */
function standing(result, rules, t_s) {
  const carrier = { blue: null, red: null };
  const score = { blue: 0, red: 0 };
  for (const { event, vehicle, team } of result.events.filter(({ at_s }) => at_s <= t_s + 1e-6)) {
    if (event === 'grabbed') carrier[team] = vehicle;
    if (event === 'captured' || event === 'flag_returned') carrier[team] = null;
    if (event === 'grabbed') score[result.boats[vehicle]] += rules.grab;
    if (event === 'captured') score[result.boats[vehicle]] += rules.capture;
  }
  return { carrier, score };
}

/** Presses the timeline at a time. */
async function scrub(sight, t_s) {
  const box = await sight.page.locator('#timeline').boundingBox();
  const { from_s, to_s } = await sight.get(() => squall.player);
  const [left, right] = [34, 14];
  await sight.page.mouse.click(box.x + left + ((t_s - from_s) / (to_s - from_s)) * (box.width - left - right), box.y + box.height - 20);
  return sight.until(`the replay is at ${t_s} s`, ([want, off]) => Math.abs(squall.t_s - want) < off && squall.t_s, [t_s, PIXEL_S]);
}

test('a recording agrees with its events at every moment', async (t) => {
  const { file, result } = await record(t, 'strategy_4_vs_3');
  const replay = new Program(t, 'replay', file, '--listen', '127.0.0.1:0');
  const sight = await Sight.open(t, browser, `${await replay.url()}#t=0`);
  assert.equal(await sight.get(() => squall.mode), 'replay');
  const { points, teams, field } = await sight.get(() => squall.hello.chart);
  assert.deepEqual(await sight.get(() => squall.events.filter((each) => each.event !== 'failsafe').map(({ text, ...event }) => event)), result.events);
  const names = teams.map((team) => team.name);
  const check = async (why) => {
    const shown = await sight.get(() => ({ t_s: squall.t_s, score: squall.score, flags: squall.flags, boats: squall.frame.boats }));
    const want = standing(result, points, shown.t_s);
    assert.deepEqual(shown.score, names.map((name) => want.score[name]), `score ${why} at ${shown.t_s} s`);
    shown.flags.forEach((flag, at) => {
      const carrier = want.carrier[names[flag.team]];
      assert.equal(flag.carrier, carrier, `the ${names[flag.team]} flag ${why} at ${shown.t_s} s`);
      const place = carrier === null ? field.flags[at] : shown.boats.find((boat) => boat.name === carrier);
      assert(Math.hypot(flag.x - place.x, flag.y - place.y) < 1e-6);
      if (carrier !== null) assert.equal(place.carrying, at, `${carrier} knows what it carries`);
    });
  };
  const kinds = new Set();
  const few = ['grabbed', 'captured', 'flag_returned'].flatMap((kind) => result.events.filter(({ event }) => event === kind).slice(0, 3));
  for (const event of few) {
    await scrub(sight, event.at_s + JUST_AFTER_S);
    await check('at the pressed position');
    kinds.add(event.event);
  }
  assert(kinds.size === 3, `the game has grabs, captures and lost flags, but only ${[...kinds]} were checked`);
  await scrub(sight, result.duration_s);
  await check('at the end');
  assert.deepEqual(await sight.get(() => squall.score), names.map((name) => result.score.teams[name]));
});

test('the chance of winning is on the timeline once it is known', async (t) => {
  const { file } = await record(t, 'strategy_4_vs_3', '--set', 'game.duration_s=60');
  await squall(t, 'log', file, '--turning-points', '--futures', '50');
  const { curve, teams } = readJson(file.replace('.mcap', '.turning-points.json'));
  const replay = new Program(t, 'replay', file, '--listen', '127.0.0.1:0');
  const sight = await Sight.open(t, browser, await replay.url());
  assert.deepEqual(await sight.get(() => squall.hello.chart.chances.chance), curve.map(({ chance }) => chance.mean));
  const line = await sight.page.locator('#timeline').boundingBox();
  const { at_s, chance } = curve[4];
  await sight.page.mouse.move(line.x + 34 + ((at_s + 1) / 60) * (line.width - 48), line.y + 30);
  const percent = (part) => Math.round(100 * part);
  const words = `${teams[0]} wins: ${percent(chance.mean)} % (${percent(chance.low)} to ${percent(chance.high)})`;
  await sight.until('the tip shows it', (words) => document.getElementById('timeline-tip').innerText.includes(words), words);
});

test('the buttons of a replay: forward, back, to events, faster', async (t) => {
  const { file, result } = await record(t);
  const replay = new Program(t, 'replay', file, '--listen', '127.0.0.1:0');
  const sight = await Sight.open(t, browser, `${await replay.url()}#t=0`);
  // A paused replay sends nothing, and must not count as dead.
  const hello = await sight.page.evaluateHandle(() => squall.hello);
  await sight.page.waitForTimeout(7000);
  assert(await sight.get((hello) => squall.connected && squall.hello === hello, hello));
  // The first picture after an event shows it.
  const at = (t_s) => sight.until(`it is ${t_s} s`, (want) => squall.t_s > want - 1e-6 && squall.t_s < want + 0.1 && squall.t_s, t_s);
  const times = (kind) => [...new Set(result.events.filter(({ event }) => event === kind).map(({ at_s }) => at_s))];
  const [first, second] = times('captured');
  await sight.page.selectOption('#event-kind', { label: 'captures' });
  await sight.press('#event-next');
  await at(first);
  await sight.until('the capture is scored', () => squall.score.some((points) => points > 0));
  await sight.press('#event-next');
  await at(second);
  await sight.press('#event-back');
  await at(first);
  await sight.page.focus('#sheet');
  await sight.keys('g');
  await at(times('grabbed').find((at_s) => at_s > first + 0.1));
  await sight.keys('Shift+G');
  await at(times('grabbed').findLast((at_s) => at_s < first));
  await sight.until('the boat carries the flag', () => squall.flags.some((flag) => flag.carrier !== null));

  const before = await sight.get(() => ({ t_s: squall.t_s, decision_s: squall.hello.chart.decision_s }));
  await sight.press('#step');
  await at(before.t_s + before.decision_s);
  await sight.press('#step-back');
  await at(before.t_s);
  await sight.press('#step-back');
  await at(before.t_s - before.decision_s);

  await sight.press('#pause');
  await sight.until('the replay plays', (from_s) => squall.player.playing && squall.t_s > from_s + 0.5, before.t_s);
  await sight.page.selectOption('#speed', '50');
  await sight.until('the replay plays faster', (from_s) => squall.player.speed === 50 && squall.t_s > from_s + 60, before.t_s);
  await sight.press('#pause');
  await sight.until('the game is paused', () => !squall.player.playing && squall.t_s === Math.max(squall.t_s, squall.player.t_s - 0.2));
  // The first event is last in the list.
  const [event] = result.events;
  await sight.press('#events li:last-child button');
  await at(event.at_s);
  assert.equal(await sight.get(() => squall.selected), event.vehicle);
  assert.equal(await sight.get(() => squall.following), true);
});

test('a recomputed helm agrees with the recording', async (t) => {
  const { file } = await record(t);
  const replay = new Program(t, 'replay', file, '--listen', '127.0.0.1:0');
  const sight = await Sight.open(t, browser, `${await replay.url()}#t=0`);
  const modes = new Set();
  for (const [name, t_s] of [['blue_one', 40], ['blue_two', 200], ['red_two', 120], ['red_one', 500]]) {
    await scrub(sight, t_s);
    await sight.page.press('body', '1');
    await sight.press(`[data-vehicle=${name}]`);
    const report = await sight.until(`the helm of ${name} is known at ${t_s} s`, ([name]) => squall.helm?.vehicle === name
      && squall.helm.computed && Math.abs(squall.helm.report?.at_s - squall.t_s) < 0.15 && squall.helm.report.collective && squall.helm, [name]);
    assert.equal(report.agrees, true, `${name} at ${t_s} s`);
    const { courses, speeds, collective, mode, functions } = report.report;
    assert.equal(collective.length, courses * speeds);
    assert(functions.length > 0 && functions.every((each) => each.utilities.length === collective.length));
    modes.add(mode);
    await sight.until('the page says so', () => /matches the recorded one/.test(document.getElementById('helm-reason').textContent));
    const facts = await sight.text('#boat-summary');
    assert(facts.includes(mode.replaceAll('_', ' ').replaceAll(':', ' › ')) && /m\/s · \d{3}°$/.test(facts), facts);
    // The chosen decision has a high utility, and the rose is not empty.
    const painted = await sight.get(() => {
      const { width, height } = document.getElementById('rose');
      const copy = Object.assign(document.createElement('canvas'), { width, height }).getContext('2d', { willReadFrequently: true });
      copy.drawImage(document.getElementById('rose'), 0, 0);
      const { data } = copy.getImageData(0, 0, width, height);
      return new Set(new Uint32Array(data.buffer)).size;
    });
    assert(painted > 20, `the rose has only ${painted} colours`);
  }
  assert(modes.size > 1, `only ${[...modes]}`);
});

test('a finished game becomes its replay', async (t) => {
  const place = folder(t);
  const game = gameFile(t, 'short', 'pav01_vs_pav01.toml', 'duration_s = 200');
  const words = ['--record', place, '--json', join(place, 'result.json'), '--listen', '127.0.0.1:0'];
  const run = new Program(t, 'run', game, '--view', '--speed', '10x', ...words);
  const sight = await Sight.open(t, browser, await run.url());
  assert.equal(await sight.get(() => squall.mode), 'live');
  await sight.until('the page shows the recording', () => squall.mode === 'replay' && squall.frame !== null && squall.events.length > 0);
  assert(await sight.page.isVisible('#timeline'));
  assert(!(await sight.page.isVisible('#estop')), 'a recording cannot be stopped');
  assert(Math.abs((await sight.get(() => squall.player.to_s)) - 200) < 1e-6);
  await sight.until('its end is shown', () => squall.t_s >= 200 - 1e-6);
  const score = await sight.get(() => squall.score);
  const won = score[0] === score[1] ? 'A draw.' : score[0] > score[1] ? 'Blue wins.' : 'Red wins.';
  await sight.until('the result is shown', (text) => document.getElementById('over').textContent === text,
    `pav01 ${score[0]} : ${score[1]} pav01. ${won}`);
  await sight.press('#watch');
  await sight.until('it plays from the start', () => squall.player.playing && squall.t_s < 60 && document.getElementById('over').hidden);
  await sight.press('#pause');
  const grab = await sight.get(() => squall.events.find((each) => each.event === 'grabbed').at_s);
  await scrub(sight, grab + JUST_AFTER_S);
  assert(await sight.get(() => squall.flags.some((flag) => flag.carrier !== null)));
  await sight.page.reload();
  await sight.until('a later page sees it too', () => squall.mode === 'replay' && squall.frame !== null);
  await sight.close();
  await run.end();
  const { teams } = readJson(join(place, 'result.json')).score;
  assert.deepEqual(score, [teams.blue, teams.red]);
});
