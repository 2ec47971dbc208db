// The background of the chart: an image or a shoreline of the site.

import assert from 'node:assert/strict';
import { copyFileSync, readdirSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { Program, Sight, folder, openBrowser, scenario, squall } from './harness.mjs';
import { site } from './site.mjs';

let browser;
before(async () => { browser = await openBrowser(); });
after(() => browser.close());

const GAME = scenario('games/pav01_vs_pav01.toml');
/** The browser's warning when a test reads single pixels. */
const allows = /willReadFrequently/;
const live = async (t, chart) => new Program(t, 'run', GAME, '--view', '--speed', '2x', '--no-record', '--listen', '127.0.0.1:0', '--chart', chart).url();

/** The colour of the field's layer at a position, m: red, green, blue, opacity. */
const colour = (sight, x, y) => sight.get(([x, y]) => {
  const canvas = document.getElementById('layer-field');
  const ratio = canvas.width / canvas.clientWidth;
  const { view } = squall;
  const [right, down] = [(x - view.x) * view.scale + canvas.clientWidth / 2, canvas.clientHeight / 2 - (y - view.y) * view.scale];
  return [...canvas.getContext('2d').getImageData(Math.round(right * ratio), Math.round(down * ratio), 1, 1).data];
}, [x, y]);
const isNear = (found, want, off = 12) => found.every((value, i) => Math.abs(value - want[i]) <= off);
const land = (sight) => sight.get(() => {
  const bits = Number.parseInt(getComputedStyle(document.documentElement).getPropertyValue('--land').trim().slice(1), 16);
  return [bits >> 16, (bits >> 8) & 255, bits & 255, 255];
});

test('a shoreline lies at its latitudes and longitudes, in light and dark, in a game and in its replay', async (t) => {
  const { geojson, beside, within } = site(folder(t));
  const recorded = folder(t);
  await squall(t, 'run', GAME, '--in-process', '--record', recorded);
  const file = join(recorded, readdirSync(recorded).find((name) => name.endsWith('.mcap')));
  const replay = await new Program(t, 'replay', file, '--listen', '127.0.0.1:0', '--chart', geojson).url();
  for (const url of [await live(t, geojson), `${replay}#t=0`]) {
    for (const colorScheme of ['light', 'dark']) {
      const sight = await Sight.open(t, browser, url, { colorScheme, allows });
      await sight.until('the background is drawn', () => squall.background);
      await sight.get(() => new Promise(requestAnimationFrame));
      assert(isNear(await colour(sight, ...within), await land(sight)), `land at ${within}: ${await colour(sight, ...within)} (${colorScheme})`);
      assert.equal((await colour(sight, ...beside))[3], 0, 'water beside it');
      await sight.press('#show-chart');
      await sight.until('the chart is switched off', () => document.getElementById('show-chart').getAttribute('aria-pressed') === 'false');
      await sight.get(() => new Promise(requestAnimationFrame));
      assert.equal((await colour(sight, ...within))[3], 0);
      await sight.close();
    }
  }
});

test('an image lies where its world file says', async (t) => {
  const { image, red, green } = site(folder(t));
  const sight = await Sight.open(t, browser, await live(t, image), { colorScheme: 'light', allows });
  await sight.until('the background is drawn', () => squall.background);
  await sight.get(() => new Promise(requestAnimationFrame));
  const [at, other] = [await colour(sight, ...red), await colour(sight, ...green)];
  assert(at[0] > 200 && at[1] < 60, `red to the west: ${at}`);
  assert(other[1] > 200 && other[0] < 60, `green to the east: ${other}`);
});

test('a chart of another site is not drawn, and its place is given', async (t) => {
  const { geojson } = site(folder(t), [51.5, -0.1]);
  const sight = await Sight.open(t, browser, await live(t, geojson));
  await sight.until('the notice gives its position', () => /is not drawn: it is at 51\.\d+° N .*\skm from the field at 41/.test(document.getElementById('notices').textContent));
  assert(!(await sight.get(() => squall.background)) && !(await sight.page.isVisible('#show-chart')));
});

test('a file that is not a chart is refused before the page opens', async (t) => {
  const { geojson, image } = site(folder(t));
  const place = folder(t);
  const lone = join(place, 'lone.png');
  copyFileSync(image, lone);
  const bad = join(place, 'bad.geojson');
  writeFileSync(bad, '{"type":"LineString","coordinates":[[0,0],[712345,4512345]]}');
  for (const [chart, want] of [[join(place, 'none.geojson'), /none\.geojson: No such file/], [GAME, /unknown format, expected PNG or JPEG/],
    [lone, /lone\.png: has no world file beside it/], [bad, /bad\.geojson: coordinates\[1\] is at \[712345, 4512345\], expected \[longitude/]]) {
    const run = new Program(t, 'run', GAME, '--view', '--no-record', '--chart', chart);
    assert.equal(await run.ended, 1, run.said);
    assert.match(run.said, want);
  }
  assert(geojson);
});
