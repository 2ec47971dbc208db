// Geofences of real boats: drawn on the chart by pointer or keys, copied for the gateway file, and shown as the gateways report them.

import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { Sight, folder, openBrowser } from './harness.mjs';
import { badge, realBoats } from './real_boats.mjs';

let browser;
before(async () => { browser = await openBrowser(); });
after(() => browser.close());

/** Clicks the chart at a position, m. */
const press = async (sight, x, y) => {
  const [right, down] = await sight.get(([x, y]) => {
    const { view } = squall;
    const { left, top, width, height } = document.getElementById('sheet').getBoundingClientRect();
    return [left + (x - view.x) * view.scale + width / 2, top + height / 2 - (y - view.y) * view.scale];
  }, [x, y]);
  await sight.page.mouse.click(right, down);
};
const text = (sight) => sight.page.inputValue('#fence-toml');
const corners = (toml) => [...toml.matchAll(/\[(-?\d+\.\d{7}), (-?\d+\.\d{7})\]/g)].map(([, lat, lon]) => [Number(lat), Number(lon)]);

test('a geofence is drawn by hand and by keys, and copied in the form of the gateway file', async (t) => {
  const boats = await realBoats(t);
  const sight = await Sight.open(t, browser, boats.url, { permissions: ['clipboard-read', 'clipboard-write'] });
  await badge(sight, 'blue_one', 'disarmed');
  const { datum } = await sight.get(() => squall.hello.chart.field);
  await sight.press('#draw-fence');
  for (const [x, y] of [[10, 10], [100, 10], [100, 70]]) await press(sight, x, y);
  assert.match(await sight.text('#fence-editor'), /3 corners/);
  // With keys, the fourth corner is at the centre of the chart; no sides cross.
  await sight.page.focus('#sheet');
  await sight.keys('Enter');
  assert.match(await sight.text('#fence-editor'), /4 corners/);
  await sight.keys('Backspace');
  assert.match(await sight.text('#fence-editor'), /3 corners/);
  await press(sight, 10, 70);
  const [first, , third] = corners(await text(sight));
  const north_m = (third[0] - first[0]) * 111_064;
  const east_m = (third[1] - first[1]) * 83_700;
  assert(Math.abs(north_m - 60) < 2 && Math.abs(east_m - 90) < 2, `${east_m} m by ${north_m} m`);
  assert(Math.abs(first[0] - datum[0]) < 0.001 && Math.abs(first[1] - datum[1]) < 0.001);
  await sight.page.selectOption('#fence-part', { label: 'Another keep-out' });
  for (const [x, y] of [[60, 30], [80, 30], [70, 50]]) await press(sight, x, y);
  assert.match(await text(sight), /^\[geofence\]\npolygon = \[\n( {2}\[[^\]]+\],\n){4}\]\nkeep_out = \[\n {2}\[\n( {4}\[[^\]]+\],\n){3} {2}\],\n\]\n$/);
  await sight.press('#fence-copy');
  assert.equal(await sight.get(() => navigator.clipboard.readText()), await text(sight));
  const cut = await sight.get(() => {
    const box = document.getElementById('fence-editor');
    const { right } = box.getBoundingClientRect();
    return [...box.querySelectorAll('button, select, textarea')].filter((each) => each.getBoundingClientRect().right > right - 8).map(({ id }) => id);
  });
  assert.deepEqual(cut, [], 'beyond the edge of the box');
  // The sides of a polygon must not cross.
  await sight.page.selectOption('#fence-part', { label: 'Outline' });
  await sight.press('#fence-undo');
  await press(sight, 60, -5);
  await press(sight, 110, 40);
  await sight.until('the page says so', () => /Two sides cross/.test(document.getElementById('fence-editor').textContent));
  assert.equal(await sight.get(() => squall.selected), null, 'no boat is selected meanwhile');
  await sight.keys('Escape');
  assert(!(await sight.page.isVisible('#fence-editor')));
});

test('gateways enforce and show the geofence that was drawn', async (t) => {
  const drawn = [[-10, -10], [170, -10], [170, 90], [60, 95], [-10, 90]];
  const by = await Sight.open(t, browser, (await realBoats(t)).url);
  await by.until('the field and its margin', () => squall.fences.length === 1);
  const [x, y] = await by.get(() => [0, 1].map((axis) => squall.fences[0].outline.map((corner) => corner[axis])));
  assert(Math.abs(Math.max(...x) - Math.min(...x) - 220) < 1 && Math.abs(Math.max(...y) - Math.min(...y) - 140) < 1, `${x}; ${y}`);
  const datum = await by.get(() => squall.hello.chart.field.datum);
  const file = join(folder(t), 'fenced.toml');
  const inside = [[70, 55], [90, 55], [80, 70]];
  writeFileSync(file, await by.get(async ([datum, polygons]) => (await import('/fence_editor.js')).toml(datum, polygons), [datum, [drawn, inside]]));
  const boats = await realBoats(t, { gateway: ['--config', file] });
  const sight = await Sight.open(t, browser, boats.url);
  const fence = await sight.until('the fence is shown', () => squall.fences.length === 1 && squall.fences[0].keepOuts.length === 1 && squall.fences[0]);
  for (const [found, want] of [[fence.outline, drawn], [fence.keepOuts[0], inside]]) {
    assert.equal(found.length, want.length);
    want.forEach(([east, north]) => assert(found.some(([x, y]) => Math.hypot(x - east, y - north) < 0.1), `${east}, ${north} among ${JSON.stringify(found)}`));
  }
  await sight.until('the boats\' distances from it are shown', () => squall.stops.length === 2 && squall.stops.every(({ clearance_m }) => clearance_m > 1));
});

/** Replaces geofences and stopping distances in the status of each boat. */
const FENCED = () => {
  const places = (corners) => corners.map(([east, north]) => ({ east, north }));
  window.WebSocket = class extends WebSocket {
    set onmessage(take) {
      super.onmessage = take && (({ data }) => {
        const message = typeof data === 'string' ? JSON.parse(data) : {};
        if (message.kind !== 'status') return take({ data });
        message.status.geofence = {
          outline: places([[-30, -20], [-30, 100], [190, 100], [190, -20]]), keep_out: [places([[70, 5], [90, 5], [80, 20]])],
          clearance_m: 6.25, stopping_m: message.vehicle === 'red_one' ? 14 : 4, stops_at: { east: 40, north: 60 },
        };
        return take({ data: JSON.stringify(message) });
      });
    }
  };
};

test('the geofence that gateways report is drawn with its keep-outs and the boats too close to stop', async (t) => {
  const boats = await realBoats(t);
  const sight = await Sight.open(t, browser, boats.url, { before: FENCED, allows: /willReadFrequently/, colorScheme: 'light' });
  await badge(sight, 'blue_one', 'disarmed');
  await sight.until('a fence is shown', () => squall.fences.length === 1 && squall.stops.length === 2);
  // The whole fence is on the chart.
  const { x, y, scale } = await sight.get(() => squall.view);
  const { width, height } = await sight.page.locator('#sheet').boundingBox();
  for (const [east, north] of [[-30, -20], [190, 100]]) {
    assert(Math.abs(east - x) * scale < width / 2 && Math.abs(north - y) * scale < height / 2, `${east}, ${north} is on the chart`);
  }
  /** The number of danger-coloured pixels around a position. */
  const red = (east, north) => sight.get(([east, north]) => {
    const canvas = document.getElementById('layer-boats');
    const { view } = squall;
    const [right, down] = [(east - view.x) * view.scale + canvas.clientWidth / 2, canvas.clientHeight / 2 - (north - view.y) * view.scale];
    const ratio = canvas.width / canvas.clientWidth;
    const { data } = canvas.getContext('2d').getImageData(Math.round((right - 8) * ratio), Math.round((down - 8) * ratio), 16, 16);
    let count = 0;
    for (let i = 0; i < data.length; i += 4) if (data[i] > 150 && data[i + 1] < 60 && data[i + 2] < 60 && data[i + 3] > 200) count += 1;
    return count;
  }, [east, north]);
  await sight.get(() => new Promise(requestAnimationFrame));
  assert(await red(190, 40) > 8, 'its eastern edge');
  assert(await red(80, 5) > 3, 'the edge of the keep-out');
  assert.equal(await red(150, 40), 0, 'water');
  const near = await sight.get(() => squall.frame.boats.find(({ name }) => name === 'red_one'));
  const clear = await sight.get(() => squall.frame.boats.find(({ name }) => name === 'blue_one'));
  assert(await red(near.x, near.y + 14) > 3, 'the circle of the boat that cannot stop in time is red');
  assert.equal(await red(clear.x, clear.y + 4), 0, 'the other boat\'s circle is not red');
  await sight.press('[data-vehicle=red_one]');
  assert.match(await sight.text('#gateway'), /Geofence6\.3\sm to its edge, stops in 14\.0\sm/);
  // A drawing can start from the gateway's fence.
  await sight.press('#draw-fence');
  await sight.press('#fence-present');
  assert.equal(corners(await text(sight)).length, 7);
});
