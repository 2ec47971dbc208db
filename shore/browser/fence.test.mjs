// Geofences of real boats: drawn on the chart by hand or keys, copied for the gateway file, and shown as the gateways have them.

import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { Sight, openBrowser } from './harness.mjs';
import { badge, realBoats } from './real_boats.mjs';

let browser;
before(async () => { browser = await openBrowser(); });
after(() => browser.close());

/** Presses the chart at a place, m. */
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

test('a geofence is drawn by hand and by keys, and copied as the gateway file has it', async (t) => {
  const boats = await realBoats(t);
  const sight = await Sight.open(t, browser, boats.url, { permissions: ['clipboard-read', 'clipboard-write'] });
  await badge(sight, 'blue_one', 'disarmed');
  const { datum } = await sight.get(() => squall.hello.chart.field);
  await sight.press('#draw-fence');
  for (const [x, y] of [[10, 10], [100, 10], [100, 70]]) await press(sight, x, y);
  assert.match(await sight.text('#fence-editor'), /3 corners/);
  // By keys the fourth is taken in the middle of the chart; it makes no crossing.
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
  // Two sides that cross are no polygon.
  await sight.page.selectOption('#fence-part', { label: 'Outline' });
  await sight.press('#fence-undo');
  await press(sight, 60, -5);
  await press(sight, 110, 40);
  await sight.until('it says so', () => /Two sides cross/.test(document.getElementById('fence-editor').textContent));
  assert.equal(await sight.get(() => squall.selected), null, 'no boat is chosen meanwhile');
  await sight.keys('Escape');
  assert(!(await sight.page.isVisible('#fence-editor')));
});
