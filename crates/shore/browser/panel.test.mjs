// The side panel of the page: the rose is fully visible, events can be folded, and the lists are correct.

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
  return `${await new Program(t, 'replay', join(place, file), '--listen', '127.0.0.1:0').url()}#t=0`;
}

/** Whether an element is fully visible within its pane. */
const WHOLE = (selector) => {
  const box = document.querySelector(selector).getBoundingClientRect();
  const pane = document.querySelector(selector).closest('.pane').getBoundingClientRect();
  return box.width > 100 && Math.abs(box.width - box.height) < 1 && box.top >= pane.top && box.bottom <= pane.bottom && box.left >= pane.left
    && box.right <= pane.right;
};

test("the helm's rose is fully visible at once, in a game and in a replay, on each screen", async (t) => {
  const url = await replay(t, 'pav01_vs_pav01');
  const live = await new Program(t, 'run', scenario('games/pav01_vs_pav01.toml'), '--view', '--speed', '5x', '--no-record',
    '--listen', '127.0.0.1:0').url();
  for (const size of [DESK, HALL, PHONE]) {
    for (const at of [url, live]) {
      const sight = await Sight.open(t, browser, at, { size, deviceScaleFactor: size === PHONE ? 2 : 1 });
      await sight.press('[data-vehicle=red_two]');
      await sight.until('the rose is fully visible', WHOLE, '#rose');
      const [width, height] = await sight.get(() => [document.getElementById('rose').width, document.getElementById('rose').height]);
      assert.equal(width, height, 'the rose is round');
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

test('events fold and open again, separately below each tab, and stay that way', async (t) => {
  const url = await replay(t, 'pav01_vs_pav01');
  const sight = await Sight.open(t, browser, url, { size: DESK });
  const open = () => sight.get(() => [document.getElementById('events-fold').getAttribute('aria-expanded') === 'true',
    document.getElementById('events').offsetParent !== null]);
  await sight.until('there are events', () => document.querySelectorAll('#events li').length > 0);
  assert.deepEqual(await open(), [true, true], 'the events are open below the list of boats');
  await sight.press('[data-vehicle=red_two]');
  assert.deepEqual(await open(), [false, false], 'a helm needs the space');
  await sight.keys('n');
  await sight.until('the newest event is shown', () => {
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
  await sight.until('the page has reloaded', () => squall.drawn > 0 && squall.frame !== null);
  assert.deepEqual(await open(), [false, false], 'the setting survives a reload');
  await sight.press('[data-vehicle=red_two]');
  assert.deepEqual(await open(), [true, true]);
});

/** The contents of a line in the list of boats. */
const LINE = (name) => {
  const [, carries, heading, curve, speed] = document.querySelector(`[data-vehicle=${name}]`).children;
  const { data } = curve.getContext('2d').getImageData(0, 0, curve.width, curve.height);
  const inked = new Uint32Array(data.buffer).filter((pixel) => pixel !== 0).length;
  return { flag: carries.textContent, heading: heading.textContent, speed: speed.textContent, inked };
};

test('a line of the list shows heading, speed with its curve, mode and carried flag', async (t) => {
  const url = await replay(t, 'pav01_vs_pav01');
  const sight = await Sight.open(t, browser, url, { size: DESK });
  await sight.page.selectOption('#event-kind', { label: 'grabs' });
  await sight.press('#event-next');
  await sight.until('a flag is carried', () => squall.flags.some((each) => each.carrier !== null));
  await sight.until('every boat\'s mode is known', () => squall.modes?.length === 4 && squall.modes.every(Boolean));
  const { boats, flags } = await sight.get(() => ({ boats: squall.frame.boats, flags: squall.flags }));
  const teams = await sight.get(() => squall.hello.chart.teams.map(({ name }) => name));
  for (const [at, boat] of boats.entries()) {
    const want = { heading: `${String(Math.round(boat.heading_deg) % 360).padStart(3, '0')}°`, speed: `${boat.speed_m_s.toFixed(1)}\u00a0m/s` };
    await sight.until(`the line of ${boat.name} is up to date`, ([name, { heading, speed }]) => {
      const [, , told, , pace] = document.querySelector(`[data-vehicle=${name}]`).children;
      return told.textContent === heading && pace.textContent === speed;
    }, [boat.name, want]);
    const line = await sight.get(LINE, boat.name);
    const flag = flags.find((each) => each.carrier === boat.name);
    assert.equal(line.flag, flag ? `carries the ${teams[flag.team]} flag` : '', boat.name);
    // Modes arrive after the frame, and those of the previous moment come first.
    await sight.until(`the line of ${boat.name} shows its state`, ([name, at, isTagged]) => {
      const state = document.querySelector(`[data-vehicle=${name}]`).children[0].lastElementChild.textContent;
      return state === (isTagged ? 'tagged' : squall.modes[at].replaceAll('_', ' ').replaceAll(':', ' › '));
    }, [boat.name, at, boat.tagged]);
    assert(line.inked > 60, `${boat.name} has a curve of ${line.inked} pixels`);
  }
  const live = new Program(t, 'run', scenario('games/pav01_vs_pav01.toml'), '--view', '--speed', '5x', '--no-record', '--listen', '127.0.0.1:0');
  const game = await Sight.open(t, browser, await live.url(), { size: DESK });
  await game.until('modes are received in a live game too', () => squall.modes?.length === 4 && squall.modes.every(Boolean));
  await game.until('modes are shown', () => [...document.querySelectorAll('.boat-row .state')].every((each) => each.textContent !== ''));
});

/** The amount of a team's colour around a boat: the sum over a small square of the boats' layer. */
const INK = (name) => {
  const hull = squall.hulls.find((each) => each.name === name);
  const ratio = Math.min(2, devicePixelRatio);
  const [left, top, right, bottom] = [hull.left, hull.top, hull.right, hull.bottom].map((each) => Math.round(each * ratio));
  const layer = document.getElementById('layer-boats');
  const { data } = layer.getContext('2d').getImageData(left, top, Math.max(1, right - left), Math.max(1, bottom - top));
  let most = 0;
  for (let i = 3; i < data.length; i += 4) most = Math.max(most, data[i]);
  return most;
};

test('with twenty boats per side, names cover no boat, tagged boats fade, and circles appear when pointed at', async (t) => {
  const url = await replay(t, 'swarm_20v20', '--set', 'game.duration_s=120');
  const sight = await Sight.open(t, browser, url, { size: DESK, allows: /willReadFrequently/ });
  assert(!(await sight.page.isVisible('#weather')), 'calm weather takes no space');
  const overlaps = () => sight.get(() => {
    const cross = (a, b) => a.left < b.right && b.left < a.right && a.top < b.bottom && b.top < a.bottom;
    const { labels, hulls } = squall;
    return { labels: labels.length, bad: labels.flatMap((label, i) => [
      ...hulls.filter((hull) => cross(label, hull)).map((hull) => `${label.name} on ${hull.name}`),
      ...labels.slice(i + 1).filter((other) => cross(label, other)).map((other) => `${label.name} on the name ${other.name}`)]) };
  });
  await sight.page.focus('#sheet');
  for (const t_s of [10, 20, 40, 60, 80, 100]) {
    while ((await sight.get(() => squall.t_s)) < t_s) {
      const before_s = await sight.get(() => squall.t_s);
      await sight.page.locator('#timeline').press('Shift+ArrowRight');
      await sight.until('the replay has moved', (before_s) => squall.t_s > before_s, before_s);
    }
    const chosen = await sight.get(() => squall.frame.boats[(Math.round(squall.t_s) * 7) % 40].name);
    await sight.page.focus(`[data-vehicle=${chosen}]`);
    await sight.page.hover(`[data-vehicle=${chosen}]`);
    await sight.until('its name is shown', (name) => squall.labels.some((label) => label.name === name), chosen);
    const { labels, bad } = await overlaps();
    assert.deepEqual(bad, [], `at ${t_s} s`);
    assert(labels > 12, `only ${labels} names at ${t_s} s`);
  }
  await sight.page.hover('#game-name');
  const [tagged, free] = await sight.until('one boat is tagged and one is not', () => {
    const found = [true, false].map((tagged) => squall.frame.boats.find((boat) => boat.tagged === tagged)?.name);
    return found.every(Boolean) && found;
  });
  await sight.page.focus('#sheet');
  await sight.until('no boat is pointed at', (name) => !squall.labels.some((label) => label.name === name), tagged);
  const [faded, plain] = [await sight.get(INK, tagged), await sight.get(INK, free)];
  assert(faded < 0.7 * plain, `a tagged boat is drawn with ${faded}, another with ${plain}`);
  await sight.page.hover(`[data-vehicle=${tagged}]`);
  await sight.until('pointed at, it is drawn like others', (name) => squall.labels.some((label) => label.name === name), tagged);
  assert((await sight.get(INK, tagged)) > 0.9 * plain);
  await sight.press(`[data-vehicle=${tagged}]`);
  await sight.until('its mode is known', () => squall.helm?.report?.mode === 'tagged');
  await sight.until('its details say so once', () => document.querySelector('.boat-head').textContent.includes('tagged') && /^\d/.test(document.getElementById('boat-summary').textContent));
});

test('names are written consistently', async (t) => {
  const url = await replay(t, 'pav01_vs_pav01');
  const sight = await Sight.open(t, browser, url, { size: DESK });
  await sight.press('[data-vehicle=red_two]');
  await sight.until('the boat is selected', () => document.querySelector('#pane-boat h2').textContent !== '');
  const changed = await sight.get(() => [...document.querySelectorAll('h2, h3, .name, .event, #score *')]
    .filter((each) => getComputedStyle(each).textTransform !== 'none').map((each) => each.outerHTML));
  assert.deepEqual(changed, []);
  assert.equal(await sight.get(() => document.querySelector('#pane-boat h2').innerText), 'red two');
});

/** The rows of the first team's colour at a pixel from the left of the timeline, below the marks. */
const ROWS = (x) => {
  const canvas = document.getElementById('timeline');
  const ratio = canvas.width / canvas.clientWidth;
  const colour = getComputedStyle(document.documentElement).getPropertyValue('--team-0').trim().match(/\w\w/g).map((part) => parseInt(part, 16));
  const { data } = canvas.getContext('2d').getImageData(Math.round(x < 0 ? canvas.width + x * ratio : x * ratio), 0, 1, canvas.height);
  return [...Array(canvas.height).keys()].filter((y) => y > 29 * ratio && y < canvas.height - 28 * ratio
    && colour.every((part, i) => Math.abs(part - data[4 * y + i]) < 24)).map((y) => y / ratio);
};

test('a phone on its side shows the chart and the panel next to each other, and everything fits', async (t) => {
  const url = await replay(t, 'pav01_vs_pav01');
  const live = await new Program(t, 'run', scenario('games/pav01_vs_pav01.toml'), '--view', '--speed', '5x', '--no-record', '--listen', '127.0.0.1:0').url();
  for (const [width, height] of [[844, 390], [932, 430], [667, 375]]) {
    for (const [at, least] of [[url, 150], [live, 220]]) {
      const sight = await Sight.open(t, browser, at, { size: { width, height }, hasTouch: true, isMobile: true, allows: /willReadFrequently/ });
      const boxes = await sight.get(() => Object.fromEntries(['sheet', 'side', 'controls', 'pause', 'tab-events', 'estop', 'timeline', 'event-next'].map((id) => {
        const box = document.getElementById(id).getBoundingClientRect();
        return [id, { left: box.left, top: box.top, right: box.right, bottom: box.bottom, shown: box.width > 0 }];
      })));
      const where = `${width} by ${height}: ${JSON.stringify(boxes)}`;
      assert(boxes.sheet.right <= boxes.side.left + 1 && boxes.sheet.top === boxes.side.top, where);
      assert(boxes.sheet.bottom - boxes.sheet.top >= least, where);
      for (const box of Object.values(boxes).filter(({ shown }) => shown)) assert(box.left >= 0 && box.top >= 0 && box.right <= width + 0.5 && box.bottom <= height + 0.5, where);
      assert.deepEqual([boxes.estop.shown, boxes.timeline.shown], [at === live, at === url], where);
      if (at === url) {
        const [first, last] = await sight.until('the score is drawn', `(() => { const rows = ${ROWS}; const found = [rows(37), rows(-18)]; return found.every((each) => each.length > 0) && found; })()`);
        assert(last[0] < first[0] - 8, `the score rises from ${first} to ${last} at ${width} by ${height}`);
        await sight.page.tap('#show-plots');
        const { plots, axis } = await sight.until('a plot is drawn', () => {
          const [plots, axis] = ['#plots', '.plot-place'].map((each) => document.querySelector(each)?.getBoundingClientRect().toJSON());
          return axis?.height > 0 && { plots, axis };
        });
        assert(axis.height >= 100 && axis.bottom <= plots.bottom && plots.bottom >= height - 60, `${width} by ${height}: ${JSON.stringify({ plots, axis })}`);
        await sight.page.tap('#show-plots');
      }
      await sight.page.tap('#tab-events');
      assert(await sight.page.isVisible('#pane-events'));
      await sight.close();
    }
  }
});
