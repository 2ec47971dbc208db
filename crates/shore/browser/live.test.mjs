// A running game: what the page shows, and what its buttons do.

import assert from 'node:assert/strict';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { Program, Sight, folder, gameFile, openBrowser, readJson, scenario } from './harness.mjs';

let browser;
before(async () => { browser = await openBrowser(); });
after(() => browser.close());

/** A boat slower than this stands still, m/s. */
const STANDS_M_S = 0.15;
/** A boat faster than this is moving, m/s. */
const GOES_M_S = 0.5;

/** Whether the game runs at a speed. A busy machine may not reach it, but none exceeds it. */
const SPEED = (want) => squall.state.speed === want && squall.state.rate > want / 2 && squall.state.rate < want * 1.2 && squall.state.rate;

const pav01 = scenario('games/pav01_vs_pav01.toml');

test('a game is shown as it is played, up to its result', async (t) => {
  const result = join(folder(t), 'result.json');
  const game = gameFile(t, 'short', 'pav01_vs_pav01.toml', 'duration_s = 240');
  const run = new Program(t, 'run', game, '--view', '--speed', '20x', '--no-record', '--json', result, '--listen', '127.0.0.1:0');
  const sight = await Sight.open(t, browser, await run.url());
  const names = ['blue_one', 'blue_two', 'red_one', 'red_two'];
  assert.deepEqual(await sight.get(() => squall.frame.boats.map((boat) => boat.name)), names);
  assert.deepEqual(await sight.page.$$eval('[data-vehicle]', (rows) => rows.map((row) => row.dataset.vehicle)), names);
  // The title shows who plays and the score; the game's id is in the tab `Game`.
  assert.match(await sight.page.title(), /^pav01 \d+ : \d+ pav01 – Squall$/);
  assert.deepEqual(await sight.page.$$eval('#score .name', (names) => names.map((each) => each.textContent)), ['pav01', 'pav01']);
  await sight.press('#tab-game');
  const id = (await run.hears(/game (\S+) at/))[1].replaceAll('_', ' ');
  await sight.until('the game is named', (id) => document.querySelector('#pane-game dd').textContent === id, id);
  await sight.goesOn();
  const clock = await sight.text('#clock');
  await sight.until('the clock on the page runs', (before) => document.getElementById('clock').textContent !== before, clock);
  const rate = await sight.until('the game runs at the requested speed', SPEED, 20);
  await sight.until('the game is over', () => squall.frame.over);
  const shown = await sight.get(() => ({ score: squall.score, t_s: squall.t_s, events: squall.events.map(({ text, ...event }) => event) }));
  await run.end();
  const told = readJson(result);
  assert.deepEqual(shown.score, [told.score.teams.blue, told.score.teams.red]);
  assert(shown.score[0] > 0, 'the game must have points');
  assert.deepEqual(await Promise.all([sight.text('#score-blue'), sight.text('#score-red')]), shown.score.map(String));
  assert(Math.abs(shown.t_s - told.duration_s) < 1e-6, `${shown.t_s} s, told: ${told.duration_s} s`);
  assert.deepEqual(shown.events, told.events);
  t.diagnostic(`${rate.toFixed(1)}x, score ${shown.score.join(':')}, ${shown.events.length} events`);
});

test('pause, one decision, speed and resuming', async (t) => {
  const run = new Program(t, 'run', pav01, '--view', '--speed', '5x', '--no-record', '--listen', '127.0.0.1:0');
  const sight = await Sight.open(t, browser, await run.url());
  await sight.goesOn();
  await sight.press('#pause');
  await sight.phase('paused');
  const before = await sight.until('the game is paused', () => Math.abs(squall.state.now_s - squall.t_s) < 1e-6 && { t_s: squall.t_s, tick: squall.frame.tick });
  await sight.press('#step');
  const after = await sight.until('a decision is made', (then) => squall.t_s > then.t_s && { t_s: squall.t_s, tick: squall.frame.tick }, before);
  const decision_s = await sight.get(() => squall.hello.chart.decision_s);
  assert(Math.abs(after.t_s - before.t_s - decision_s) < 1e-6, `from ${before.t_s} to ${after.t_s}, by ${decision_s}`);
  await sight.page.focus('#sheet');
  await sight.keys('s', 's', 's');
  await sight.until('three more decisions are made', (want) => squall.t_s > want - 1e-6, before.t_s + 4 * decision_s);
  assert(Math.abs((await sight.get(() => squall.t_s)) - before.t_s - 4 * decision_s) < 1e-6, 'exactly three more decisions');
  await sight.phase('paused');
  await sight.keys(' ');
  await sight.phase('playing');
  await sight.goesOn();
  await sight.keys('s');
  await sight.phase('paused');
  await sight.until('the game is paused after the step', () => Math.abs(squall.state.now_s - squall.t_s) < 1e-6);
  await sight.keys(' ');
  await sight.phase('playing');
  await sight.goesOn();
  await sight.page.selectOption('#speed', '1');
  await sight.until('real time', () => squall.state.speed === 1 && Math.abs(squall.state.rate - 1) < 0.3);
  await sight.page.selectOption('#speed', '10');
  await sight.until('ten times real time', SPEED, 10);
  await sight.page.selectOption('#speed', 'max');
  await sight.until('unlimited speed', () => squall.state.speed === null && squall.state.rate > 12);
});

test('a helm not viewed before the pause says so, and shows its rose after a step', async (t) => {
  const run = new Program(t, 'run', pav01, '--view', '--speed', '5x', '--no-record', '--listen', '127.0.0.1:0');
  const sight = await Sight.open(t, browser, await run.url());
  // A helm without a position fix has no utilities yet.
  await sight.until('every boat moves', (least) => squall.frame?.boats.every((boat) => boat.speed_m_s > least), GOES_M_S);
  await sight.press('#pause');
  await sight.phase('paused');
  await sight.press('[data-vehicle=blue_two]');
  await sight.until('the page says so', () => /No utilities yet/.test(document.getElementById('helm-reason').textContent));
  assert(!(await sight.page.isVisible('#rose')));
  assert(await sight.page.isVisible('#behaviours'));
  await sight.press('#step');
  await sight.until('the rose is shown', () => squall.helm?.report?.collective && document.getElementById('helm-reason').hidden);
  assert(await sight.page.isVisible('#rose'));
});

test('an E-stop takes one press and holds every boat until it is released, which needs confirmation; likewise a halt', async (t) => {
  const game = gameFile(t, 'long', 'pav01_vs_pav01.toml', 'duration_s = 3600');
  const run = new Program(t, 'run', game, '--view', '--speed', '5x', '--no-record', '--listen', '127.0.0.1:0');
  const sight = await Sight.open(t, browser, await run.url());
  const stand = () => sight.until('every boat stands still', (most) => squall.frame.boats.every((boat) => boat.speed_m_s < most), STANDS_M_S);
  const go = () => sight.until('a boat moves', (least) => squall.frame.boats.some((boat) => boat.speed_m_s > least), GOES_M_S);
  const stay = async () => {
    const from_s = await sight.get(() => squall.t_s);
    const fastest = await sight.get(([from_s, most]) => new Promise((done) => {
      let fastest = 0;
      const look = setInterval(() => {
        fastest = Math.max(fastest, ...squall.frame.boats.map((boat) => boat.speed_m_s));
        if (fastest <= most && squall.t_s < from_s + 10) return;
        clearInterval(look);
        done(fastest);
      }, 20);
    }), [from_s, STANDS_M_S]);
    assert(fastest <= STANDS_M_S, `a boat moves again at ${fastest} m/s`);
  };
  await go();
  await sight.page.focus('#sheet');
  await sight.keys('e');
  await sight.goesOn();
  assert.equal(await sight.get(() => squall.events.some((each) => each.event === 'e_stopped')), false, 'a single letter does not stop a simulation');
  await sight.keys('E');
  await sight.phase('E-STOPPED');
  await sight.press('#estop');
  await sight.press('#estop-confirm');
  await sight.phase('playing');
  await sight.press('#estop');
  assert(!(await sight.page.isVisible('#estop-confirm')), 'one press stops without a question');
  await sight.phase('E-STOPPED');
  await sight.until('the event is listed', () => squall.events.some((each) => each.event === 'e_stopped')
    && /stop/i.test(document.querySelector('#events li')?.textContent));
  await sight.page.focus('#sheet');
  await sight.keys('h');
  assert(!(await sight.page.isVisible('#halt-ask')), 'a key has no effect while its button is disabled');
  await stand();
  await stay();
  await sight.press('#estop');
  assert(await sight.page.isVisible('#estop-confirm'));
  assert.equal(await sight.get(() => squall.frame.stopped), true, 'the question by itself releases no boat');
  await sight.press('#estop-cancel');
  assert(!(await sight.page.isVisible('#estop-confirm')));
  await sight.press('#estop');
  await sight.press('#estop-confirm');
  await sight.until('released', () => squall.events.some((each) => each.event === 'released') && !squall.frame.stopped);
  await sight.phase('playing');
  await go();
  await sight.press('#halt');
  await sight.press('#halt-confirm');
  await sight.phase('halted');
  await stand();
  await stay();
  await sight.press('#halt');
  await sight.press('#halt-confirm');
  await sight.phase('playing');
  await go();
});
