// A tall field: the chart turns so that the field fits, and everything on it stays where it belongs.

import assert from 'node:assert/strict';
import { writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { Program, Sight, folder, gameFile, openBrowser, scenario } from './harness.mjs';
import { site } from './site.mjs';

let browser;
before(async () => { browser = await openBrowser(); });
after(() => browser.close());

/** The browser's warning when a test reads single pixels. */
const allows = /willReadFrequently/;
const NEAR_PX = 1.5;

/** A game on a field 80 m wide and 240 m long. `more` is more text of its file. */
async function tall(t, base, more, ...words) {
  const field = join(folder(t), 'tall.toml');
  writeFileSync(field, '# A field of a test.\ndatum = { lat_deg = 41.35480, lon_deg = -74.0551 }\nwidth_m = 80\ndepth_m = 240\nflag_inset_m = 20\n');
  const run = new Program(t, 'run', gameFile(t, 'tall', base, `field = "${field}"\n${more}`), '--view', '--no-record', '--listen', '127.0.0.1:0', ...words);
  return run.url();
}

/** Where a position is on the page, from the published view: turned by the bearing that is up. */
const PLACE = ([x, y]) => {
  const { view } = squall;
  const { left, top, width, height } = document.getElementById('sheet').getBoundingClientRect();
  const turn = (view.up_deg * Math.PI) / 180;
  const [east, north] = [x - view.x, y - view.y];
  const right = east * Math.cos(turn) - north * Math.sin(turn);
  const up = east * Math.sin(turn) + north * Math.cos(turn);
  return [left + width / 2 + right * view.scale, top + height / 2 - up * view.scale];
};
const placeOf = (sight, x, y) => sight.get(PLACE, [x, y]);

/** The colour of a layer at a position. */
const colourAt = async (sight, layer, x, y) => sight.get(([id, right, down]) => {
  const canvas = document.getElementById(id);
  const { left, top } = document.getElementById('sheet').getBoundingClientRect();
  const ratio = canvas.width / canvas.clientWidth;
  return [...canvas.getContext('2d').getImageData(Math.round((right - left) * ratio), Math.round((down - top) * ratio), 1, 1).data];
}, [layer, ...(await placeOf(sight, x, y))]);

async function paused(sight) {
  await sight.goesOn();
  await sight.press('#pause');
  await sight.phase('paused');
  await sight.until('the picture is up to date', () => Math.abs(squall.state.now_s - squall.t_s) < 1e-6);
  await sight.page.waitForTimeout(300);
}

test('a tall field lies across the chart, larger, and the choice of north up is remembered', async (t) => {
  const sight = await Sight.open(t, browser, await tall(t, 'pav01_vs_pav01.toml', '', '--speed', '5x'));
  const turned = await sight.get(() => squall.view);
  assert.equal(turned.up_deg, 90);
  const corners = await sight.get(() => squall.hello.chart.field.corners);
  const box = await sight.page.locator('#sheet').boundingBox();
  const places = [];
  for (const [x, y] of corners) places.push(await placeOf(sight, x, y));
  for (const [right, down] of places) assert(right > box.x && right < box.x + box.width && down > box.y && down < box.y + box.height, `${places}`);
  const across = Math.max(...places.map(([right]) => right)) - Math.min(...places.map(([right]) => right));
  assert(across > 0.8 * box.width, `the field is ${across} px of ${box.width} px`);
  await sight.press('#north-up');
  const upright = await sight.get(() => squall.view);
  assert(upright.up_deg === 0 && upright.scale < turned.scale / 1.25, JSON.stringify({ turned, upright }));
  await sight.page.reload();
  await sight.until('the page has reloaded', () => squall.drawn > 0);
  assert.equal(await sight.get(() => squall.view.up_deg), 0, 'the choice survives a reload');
  await sight.press('#north-up');
  assert.equal(await sight.get(() => squall.view.up_deg), 90);
});

test('boats, pointer, shoreline, measurements and arrows agree with the turned chart', async (t) => {
  const { geojson, within, beside } = site(folder(t));
  const sight = await Sight.open(t, browser, await tall(t, 'pav01_vs_pav01.toml', '', '--speed', '5x', '--chart', geojson), { allows, colorScheme: 'light' });
  await sight.until('the shoreline is drawn', () => squall.background);
  await paused(sight);
  assert.equal(await sight.get(() => squall.view.up_deg), 90);
  const { boats, hulls } = await sight.get(() => ({ boats: squall.frame.boats, hulls: squall.hulls }));
  const box = await sight.page.locator('#sheet').boundingBox();
  for (const [i, { name, x, y }] of boats.entries()) {
    const [right, down] = await placeOf(sight, x, y);
    const hull = hulls[i];
    const off = Math.hypot((hull.left + hull.right) / 2 + box.x - right, (hull.top + hull.bottom) / 2 + box.y - down);
    assert(off < NEAR_PX, `${name} is drawn ${off} px from its place`);
    assert((await colourAt(sight, 'layer-boats', x, y))[3] > 0, `${name} has ink`);
  }
  // A press selects the boat there, and the bow points as on the chart: ink ahead and none abeam.
  const [, , boat] = boats;
  await sight.page.mouse.click(...await placeOf(sight, boat.x, boat.y));
  assert.equal(await sight.get(() => squall.selected), boat.name);
  // The pointer's position.
  const [x, y] = [20, 200];
  await sight.page.mouse.move(...await placeOf(sight, x, y));
  await sight.until('the position is shown', ([x, y]) => {
    const [, east, north] = (document.getElementById('place').textContent.match(/x (\S+) y (\S+) m/) ?? []).map((each) => Number(each.replace('−', '-')));
    return Math.hypot(east - x, north - y) < 1;
  }, [x, y]);
  // The wheel zooms there.
  const before = await placeOf(sight, x, y);
  await sight.page.mouse.wheel(0, -200);
  await sight.until('it is zoomed', (scale) => squall.view.scale > scale * 1.2, (await sight.get(() => squall.view.scale)) / 1.5);
  const now = await placeOf(sight, x, y);
  assert(Math.hypot(now[0] - before[0], now[1] - before[1]) < NEAR_PX, `${before} and ${now}`);
  // Dragging moves the chart with the pointer.
  await sight.page.mouse.down();
  await sight.page.mouse.move(before[0] + 60, before[1] - 25, { steps: 3 });
  await sight.page.mouse.up();
  const dragged = await placeOf(sight, x, y);
  assert(Math.hypot(dragged[0] - before[0] - 60, dragged[1] - before[1] + 25) < 2 * NEAR_PX, `${before} and ${dragged}`);
  await sight.press('#fit');
  await sight.get(() => new Promise(requestAnimationFrame));
  assert((await colourAt(sight, 'layer-field', ...within))[3] === 255 && (await colourAt(sight, 'layer-field', ...beside))[3] === 0, 'the shoreline is where it belongs');
  // Measured to the east: upwards on this chart.
  await sight.press('#measure');
  await sight.page.mouse.click(...await placeOf(sight, 15, 100));
  await sight.page.mouse.click(...await placeOf(sight, 65, 100));
  const measured = await sight.until('a range is measured', () => squall.measured);
  assert(Math.abs(measured.range_m - 50) < 1 && Math.abs(measured.bearing_deg - 90) < 2, JSON.stringify(measured));
  // The north arrow points to the left: its tip has ink, where that of an upright one has none.
  const arrow = await sight.get(() => {
    const canvas = document.getElementById('layer-field');
    const ratio = canvas.width / canvas.clientWidth;
    const ink = (right, down) => canvas.getContext('2d').getImageData(Math.round((canvas.clientWidth - 33 + right) * ratio), Math.round((34 + down) * ratio), 1, 1).data[3];
    return { left: ink(-12, 0), up: ink(0, -12) };
  });
  assert(arrow.left > arrow.up, JSON.stringify(arrow));
  // An arrow in the list, turned by its style, points like the hull, which may have turned a little further since.
  await sight.press('#tab-boats');
  const { arrow_deg, heading_deg } = await sight.get((name) => {
    const svg = document.querySelector(`[data-vehicle=${name}] .heading svg`);
    const { rotate, transform } = getComputedStyle(svg);
    const { a, b } = new DOMMatrix(transform);
    return { arrow_deg: parseFloat(rotate) + (Math.atan2(b, a) * 180) / Math.PI, heading_deg: squall.frame.boats.find((boat) => boat.name === name).heading_deg };
  }, boat.name);
  assert(Math.abs((((arrow_deg - heading_deg + 90) % 360) + 540) % 360 - 180) < 30, `an arrow at ${arrow_deg}° for a heading of ${heading_deg}°`);
});

test('the driving dial turns with the chart', async (t) => {
  // The other boats stay still, because the helm would avoid them.
  const vehicles = ['blue_one', 'blue_two', 'red_one', 'red_two'].map((name, i) =>
    `[[vehicle]]\nname = "${name}"\nteam = "${name.split('_')[0]}"\nstrategy = "${scenario(`strategies/${i === 0 ? 'teleop' : 'idle'}.toml`)}"\n`).join('');
  const sight = await Sight.open(t, browser, await tall(t, 'person_2v2.toml', vehicles, '--pace', 'realtime'));
  await sight.press('[data-vehicle=blue_one]');
  await sight.press('#drive');
  const dial = await sight.page.locator('#steering').boundingBox();
  const middle = [dial.x + dial.width / 2, dial.y + dial.height / 2];
  for (const [right, up, want] of [[60, 0, '180'], [0, 60, '090'], [-60, 0, '000']]) {
    await sight.page.mouse.click(middle[0] + right, middle[1] - up);
    await sight.until(`${want}° is ordered`, (want) => document.getElementById('steering-text').textContent.startsWith(want), want);
  }
  // The trail grows in the direction in which the boat moves on the chart: to the left.
  const before = await sight.get(() => squall.frame.boats.find(({ name }) => name === 'blue_one'));
  await sight.until('the boat moves north', (y) => squall.frame.boats.find(({ name }) => name === 'blue_one').y > y + 3, before.y);
  const now = await sight.get(() => squall.frame.boats.find(({ name }) => name === 'blue_one'));
  assert((await placeOf(sight, now.x, now.y))[0] < (await placeOf(sight, before.x, before.y))[0]);
});
