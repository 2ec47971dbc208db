// The side of the page: the helm's picture is whole, events fold, lists tell.

import assert from 'node:assert/strict';
import { readdirSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { Program, Sight, folder, openBrowser, scenario, squall } from './harness.mjs';

let browser;
before(async () => { browser = await openBrowser(); });
after(() => browser.close());

const DESK = { width: 1400, height: 900 };
const HALL = { width: 1920, height: 1080 };
const PHONE = { width: 390, height: 844 };

/** Plays a game, and opens its replay. */
async function replay(t, game, ...words) {
  const place = folder(t);
  await squall(t, 'run', scenario(`games/${game}.toml`), ...words, '--in-process', '--record', place);
  const file = readdirSync(place).find((name) => name.endsWith('.mcap'));
  return new Program(t, 'replay', join(place, file), '--listen', '127.0.0.1:0').url();
}

/** Whether all of an element is within what its pane shows. */
const WHOLE = (selector) => {
  const box = document.querySelector(selector).getBoundingClientRect();
  const pane = document.querySelector(selector).closest('.pane').getBoundingClientRect();
  return box.width > 100 && Math.abs(box.width - box.height) < 1 && box.top >= pane.top && box.bottom <= pane.bottom && box.left >= pane.left
    && box.right <= pane.right;
};

test("the helm's picture is whole at once, in a game and in a replay, on each screen", async (t) => {
  const url = await replay(t, 'pav01_vs_pav01');
  const live = await new Program(t, 'run', scenario('games/pav01_vs_pav01.toml'), '--view', '--speed', '5x', '--no-record',
    '--listen', '127.0.0.1:0').url();
  for (const size of [DESK, HALL, PHONE]) {
    for (const at of [url, live]) {
      const sight = await Sight.open(t, browser, at, { size, deviceScaleFactor: size === PHONE ? 2 : 1 });
      await sight.press('[data-vehicle=red_two]');
      await sight.until('the picture is whole', WHOLE, '#rose');
      const [width, height] = await sight.get(() => [document.getElementById('rose').width, document.getElementById('rose').height]);
      assert.equal(width, height, 'it is round');
      const head = await sight.get(() => ['h2', '#follow', '#deselect'].map((each) => {
        const box = document.querySelector(`#pane-boat ${each}`).getBoundingClientRect();
        return [box.top, box.bottom];
      }));
      const middle = (head[0][0] + head[0][1]) / 2;
      assert(head.every(([top, bottom]) => top < middle && middle < bottom), `name and buttons share a line: ${head}`);
      await sight.close();
    }
  }
});

test('events fold and open again, below each tab by itself, and stay so', async (t) => {
  const url = await replay(t, 'pav01_vs_pav01');
  const sight = await Sight.open(t, browser, url, { size: DESK });
  const open = () => sight.get(() => [document.getElementById('events-fold').getAttribute('aria-expanded') === 'true',
    document.getElementById('events').offsetParent !== null]);
  await sight.until('there are events', () => document.querySelectorAll('#events li').length > 0);
  assert.deepEqual(await open(), [true, true], 'below the list of boats they are open');
  await sight.press('[data-vehicle=red_two]');
  assert.deepEqual(await open(), [false, false], 'a helm needs the room');
  await sight.keys('n');
  await sight.until('the newest is told', () => {
    const event = squall.events.findLast((each) => each.at_s <= squall.t_s + 1e-6);
    return event && document.getElementById('events-newest').textContent.endsWith(event.text.replaceAll('_', ' '));
  });
  await sight.page.focus('#events-fold');
  await sight.keys('Enter');
  assert.deepEqual(await open(), [true, true]);
  await sight.press('#tab-boats');
  await sight.press('#events-fold');
  assert.deepEqual(await open(), [false, false]);
  await sight.page.reload();
  await sight.until('it is back', () => squall.drawn > 0 && squall.frame !== null);
  assert.deepEqual(await open(), [false, false], 'the page keeps it');
  await sight.press('[data-vehicle=red_two]');
  assert.deepEqual(await open(), [true, true]);
});
