// The chart: it moves to a selected boat, keys zoom at that boat, and ranges are measured; coordinates, legend and dark mode.

import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { Program, Sight, openBrowser, scenario } from './harness.mjs';

let browser;
before(async () => { browser = await openBrowser(); });
after(() => browser.close());

/** Metres per degree of latitude, mean of the ellipsoid WGS 84. */
const DEGREE_M = 111_132.95;
/** Tolerance of coordinates, m: positions are shown to the decimetre, degrees to about a metre. */
const WRITTEN_M = 1.2;

/** A game paused at its start. */
async function paused(t, more = {}) {
  const run = new Program(t, 'run', scenario('games/pav01_vs_pav01.toml'), '--view', '--speed', '5x', '--no-record', '--listen', '127.0.0.1:0');
  const sight = await Sight.open(t, browser, await run.url(), { size: { width: 1400, height: 900 }, ...more });
  await sight.goesOn();
  await sight.press('#pause');
  await sight.phase('paused');
  await sight.until('the game is paused', () => Math.abs(squall.state.now_s - squall.t_s) < 1e-6);
  return sight;
}

/** A boat's position on the chart, px from its centre, according to the page's view. */
const OFF = (name) => {
  const { x, y } = squall.frame.boats.find((boat) => boat.name === name);
  return [(x - squall.view.x) * squall.view.scale, (squall.view.y - y) * squall.view.scale];
};

test('selecting brings the boat into the chart, and keys zoom at it', async (t) => {
  const sight = await paused(t);
  const [width, height] = await sight.get(() => [document.getElementById('sheet').clientWidth, document.getElementById('sheet').clientHeight]);
  const fitted = await sight.get(() => squall.view);
  await sight.press('[data-vehicle=red_one]');
  assert.deepEqual(await sight.get(() => squall.view), fitted, 'what is visible stays where it is');
  await sight.page.focus('#sheet');
  const before = await sight.get(OFF, 'red_one');
  await sight.keys('+', '+', '+');
  const near = await sight.get(OFF, 'red_one');
  assert(Math.hypot(near[0] - before[0], near[1] - before[1]) < 0.01, `keys zoom at the boat: ${before} and ${near}`);
  await sight.keys('+', '+', '+', '+');
  await sight.keys('1');
  await sight.press('[data-vehicle=blue_one]');
  const [right, down] = await sight.get(OFF, 'blue_one');
  assert(Math.abs(right) < width * 0.3 + 1 && Math.abs(down) < height * 0.3 + 1, `${right} px and ${down} px from the middle`);
  await sight.page.focus('#sheet');
  await sight.keys(']');
  assert.equal(await sight.get(() => squall.selected), 'blue_two');
  const next = await sight.get(OFF, 'blue_two');
  assert(Math.abs(next[0]) < width * 0.3 + 1 && Math.abs(next[1]) < height * 0.3 + 1, `${next} px from the middle`);
});

test('ranges are measured between boats and places, by hand and by keys', async (t) => {
  const sight = await paused(t);
  const boats = await sight.get(() => squall.frame.boats);
  const box = await sight.page.locator('#sheet').boundingBox();
  const at = async (name) => {
    const [right, down] = await sight.get(OFF, name);
    return [box.x + box.width / 2 + right, box.y + box.height / 2 + down];
  };
  const want = (from, to) => {
    const [one, other] = [from, to].map((name) => boats.find((boat) => boat.name === name));
    const [east, north] = [other.x - one.x, other.y - one.y];
    return { range_m: Math.hypot(east, north), bearing_deg: (Math.atan2(east, north) * 180) / Math.PI };
  };
  const same = (got, { range_m, bearing_deg }) => {
    assert(Math.abs(got.range_m - range_m) < 0.01 && Math.abs(got.bearing_deg - bearing_deg) < 0.01, JSON.stringify({ got, range_m, bearing_deg }));
  };
  await sight.press('#measure');
  await sight.page.mouse.click(...await at('blue_one'));
  await sight.page.mouse.click(...await at('red_two'));
  same(await sight.until('both ends are chosen', () => squall.measured), want('blue_one', 'red_two'));
  await sight.until('the measurement is shown', (range) => document.getElementById('measured').textContent.startsWith('blue one to red two')
    && document.getElementById('measured').textContent.includes(range), want('blue_one', 'red_two').range_m.toFixed(1));
  assert.equal(await sight.get(() => squall.selected), null, 'measuring selects no boat');
  await sight.page.focus('#sheet');
  await sight.keys('Escape');
  assert.equal(await sight.get(() => squall.measured), null);
  await sight.until('the measurement is hidden', () => !document.getElementById('measured').checkVisibility());
  // With keys only.
  await sight.keys('m', ']', 'Enter', ']', ']', 'Enter');
  same(await sight.until('both ends are chosen', () => squall.measured), want('blue_one', 'red_one'));
});

test('the pointer’s coordinates are field coordinates', async (t) => {
  const sight = await paused(t);
  const [lat, lon] = await sight.get(() => squall.hello.chart.field.datum);
  const box = await sight.page.locator('#sheet').boundingBox();
  await sight.page.mouse.move(box.x + 600, box.y + 200);
  const { view, width, height } = await sight.get(() => ({ view: squall.view, width: document.getElementById('sheet').clientWidth, height: document.getElementById('sheet').clientHeight }));
  const [x, y] = [view.x + (600 - width / 2) / view.scale, view.y - (200 - height / 2) / view.scale];
  const text = await sight.until('the position is shown', () => document.getElementById('place').checkVisibility() && document.getElementById('place').textContent);
  const [, east, north, northDeg, eastDeg] = text.match(/x (\S+) y (\S+) m · (\S+)° N (\S+)° W/).map((each) => Number(each.replace('−', '-')));
  assert(Math.abs(east - x) < 0.06 && Math.abs(north - y) < 0.06, `${text}, expected ${x} ${y}`);
  assert(Math.abs((northDeg - lat) * DEGREE_M - y) < WRITTEN_M, text);
  assert(Math.abs((-eastDeg - lon) * DEGREE_M * Math.cos((lat * Math.PI) / 180) - x) < WRITTEN_M, text);
  await sight.page.mouse.move(5, 5);
  await sight.until('the position is hidden', () => !document.getElementById('place').checkVisibility());
});

test('a legend explains the marks, and the dark theme is remembered', async (t) => {
  const sight = await paused(t, { colorScheme: 'light', allows: /willReadFrequently/ });
  const colours = () => sight.get(() => {
    const style = getComputedStyle(document.documentElement);
    return [style.getPropertyValue('--paper').trim(), style.colorScheme, document.getElementById('dark').getAttribute('aria-pressed')];
  });
  const light = await colours();
  assert.equal(light[2], 'false');
  assert(!(await sight.page.isVisible('#chart-legend')));
  await sight.page.focus('#sheet');
  await sight.keys('l');
  await sight.until('the legend is shown', () => document.querySelectorAll('#chart-legend li canvas').length > 8);
  assert((await sight.text('#chart-legend')).includes('tagged'));
  await sight.press('#dark');
  await sight.until('the page is dark', (paper) => getComputedStyle(document.documentElement).getPropertyValue('--paper').trim() !== paper, light[0]);
  const dark = await colours();
  assert.deepEqual(dark.slice(1), ['dark', 'true']);
  await sight.until('the chart is dark too', () => {
    const { data } = document.getElementById('layer-sea').getContext('2d').getImageData(2, 2, 1, 1);
    return data[3] > 0 && data[0] + data[1] + data[2] < 300;
  });
  await sight.page.reload();
  await sight.until('the page has reloaded', () => squall.drawn > 0);
  assert.deepEqual(await colours(), dark, 'the setting survives a reload');
  await sight.press('#dark');
  await sight.until('the page is light', (paper) => getComputedStyle(document.documentElement).getPropertyValue('--paper').trim() === paper, light[0]);
  assert.deepEqual(await colours(), light);
  assert.equal(await sight.get(() => localStorage.getItem('squall.theme')), null, 'the page follows the system again');
  await sight.until('the chart is light too', () => {
    const { data } = document.getElementById('layer-sea').getContext('2d').getImageData(2, 2, 1, 1);
    return data[0] + data[1] + data[2] > 300;
  });
});
