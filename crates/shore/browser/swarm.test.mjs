// Two hundred boats: the page keeps up.

import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { Program, Sight, gameFile, openBrowser, scenario } from './harness.mjs';

let browser;
before(async () => { browser = await openBrowser(); });
after(() => browser.close());

/** Maximum time per picture, ms: a screen shows sixty per second. */
const PICTURE_MS = 16;
/** Number of pictures measured. */
const PICTURES = 120;

const FLEETS = ['blue', 'red'].map((team) => `
[[fleet]]
team = "${team}"
count = 100
spawn = { along_m = [10, 350], across_m = [10, 390], gap_m = 10 }
`).join('');

/** Measures each drawing callback. */
const MEASURE = () => {
  const ask = window.requestAnimationFrame.bind(window);
  window.pictures_ms = [];
  window.requestAnimationFrame = (draw) => ask((now) => {
    const began = performance.now();
    draw(now);
    window.pictures_ms.push(performance.now() - began);
  });
};

/** The times of pictures in ascending order, ms. */
async function pictures(sight) {
  await sight.get(() => { window.pictures_ms.length = 0; });
  const times = await sight.until('pictures are made', (count) => window.pictures_ms.length >= count && window.pictures_ms, PICTURES);
  return times.sort((a, b) => a - b);
}

const median = async (sight) => (await pictures(sight))[PICTURES >> 1];

test('two hundred boats are drawn in time', async (t) => {
  const game = gameFile(t, 'swarm_100v100', 'swarm_20v20.toml', `field = "${scenario('fields/open_800x400.toml')}"\nduration_s = 3600\n${FLEETS}`);
  const run = new Program(t, 'run', game, '--view', '--pace', 'realtime', '--agents-per-process', '200', '--no-record', '--listen', '127.0.0.1:0');
  const sight = await Sight.open(t, browser, await run.url(), { before: MEASURE });
  assert.equal(await sight.get(() => squall.frame.boats.length), 200);
  await sight.until('the game runs', () => squall.state.phase === 'playing' && squall.t_s > 0);
  const drawn = await sight.get(() => squall.drawn);
  await sight.until('pictures are drawn', (before) => squall.drawn > before + 20, drawn);
  const all_ms = await median(sight);
  const said = [`all: ${all_ms.toFixed(1)} ms`];
  await sight.press('[data-vehicle]');
  await sight.press('#follow');
  await sight.page.focus('#sheet');
  await sight.keys('+', '+', '+', '+');
  const near_ms = await median(sight);
  said.push(`one selected, followed, from near: ${near_ms.toFixed(1)} ms`);
  // Two plots of all boats.
  await sight.keys('j');
  await sight.page.selectOption('#plot-boats', '*');
  await sight.until('all boats are plotted', () => squall.span.to_s - squall.span.from_s > 10 && /200 curves/.test(document.querySelector('.plot-values').textContent));
  const plotted = await pictures(sight);
  said.push(`with two plots of all: ${plotted[PICTURES >> 1].toFixed(1)} ms, one in twenty over ${plotted[Math.floor(0.95 * PICTURES)].toFixed(1)} ms`);
  const { fps, hz, rate, draw_ms } = await sight.get(() => ({ fps: squall.fps, hz: squall.state.frames_hz, rate: squall.state.rate, draw_ms: squall.draw_ms }));
  t.diagnostic(`median time of a picture: ${said.join('; ')}; ${fps.toFixed(0)} pictures per second, ${hz.toFixed(0)} frames per second, ${rate.toFixed(2)}x`);
  t.diagnostic(`the page reports ${draw_ms.toFixed(1)} ms`);
  assert(all_ms < PICTURE_MS && near_ms < PICTURE_MS && plotted[PICTURES >> 1] < PICTURE_MS, said.join('; '));
});
