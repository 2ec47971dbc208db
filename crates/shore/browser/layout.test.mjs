// The layout around the chart: panels can be resized and hidden, the legend is beside the chart, and text keeps up with the chart.

import assert from 'node:assert/strict';
import { readdirSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { Program, Sight, folder, openBrowser, scenario, squall } from './harness.mjs';

let browser;
before(async () => { browser = await openBrowser(); });
after(() => browser.close());

const DESK = { width: 1400, height: 900 };
const PHONE = { width: 390, height: 844 };
const PAV01 = scenario('games/pav01_vs_pav01.toml');
const live = (t, ...words) => new Program(t, 'run', PAV01, '--view', '--no-record', '--listen', '127.0.0.1:0', ...words).url();

async function replay(t, game, ...words) {
  const place = folder(t);
  await squall(t, 'run', scenario(`games/${game}.toml`), ...words, '--in-process', '--record', place);
  const file = readdirSync(place).find((name) => name.endsWith('.mcap'));
  return `${await new Program(t, 'replay', join(place, file), '--listen', '127.0.0.1:0').url()}#t=0`;
}

const boxOf = (sight, selector) => sight.page.locator(selector).boundingBox();
/** Drags an edge by this many pixels. */
async function drag(sight, edge, right, down) {
  const box = await boxOf(sight, edge);
  const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
  await sight.page.mouse.move(x, y);
  await sight.page.mouse.down();
  await sight.page.mouse.move(x + right, y + down, { steps: 4 });
  await sight.page.mouse.up();
}
const reload = async (sight) => {
  await sight.page.reload();
  await sight.until('the page has reloaded', () => squall.drawn > 0 && squall.frame !== null);
};
const near = (found, want, what) => assert(Math.abs(found - want) < 2, `${what}: ${found}, expected ${want}`);

test('panels are made narrower, lower and hidden, and stay so', async (t) => {
  const sight = await Sight.open(t, browser, await live(t, '--speed', '2x'), { size: DESK });
  const usual = (await boxOf(sight, '#side')).width;
  await drag(sight, '#side-edge', 90, 0);
  near((await boxOf(sight, '#side')).width, usual - 90, 'dragged');
  near((await boxOf(sight, '#sheet')).width, DESK.width - usual + 90, 'the chart has the rest');
  await sight.page.focus('#side-edge');
  await sight.keys('ArrowLeft');
  near((await boxOf(sight, '#side')).width, usual - 66, 'by a key');
  const events = (await boxOf(sight, '#pane-events')).height;
  await drag(sight, '#pane-events-edge', 0, -60);
  near((await boxOf(sight, '#pane-events')).height, events + 60, 'events');
  await sight.page.focus('#sheet');
  await sight.keys('j');
  const plots = (await boxOf(sight, '#plots')).height;
  await drag(sight, '#plots-edge', 0, -50);
  near((await boxOf(sight, '#plots')).height, plots + 50, 'plots');
  await reload(sight);
  near((await boxOf(sight, '#side')).width, usual - 66, 'after a reload');
  near((await boxOf(sight, '#plots')).height, plots + 50, 'plots after a reload');
  await sight.page.dblclick('#side-edge');
  near((await boxOf(sight, '#side')).width, usual, 'the usual width');
  await sight.press('#show-plots');
  await sight.press('#side-hide');
  assert(!(await sight.page.isVisible('#side')));
  near((await boxOf(sight, '#sheet')).width, DESK.width, 'the chart has the whole width');
  // The field is fitted again.
  await sight.until('the field is larger', () => squall.view.scale * 160 > 900);
  await reload(sight);
  assert(!(await sight.page.isVisible('#side')), 'it stays hidden');
  await sight.page.focus('#sheet');
  await sight.keys('k');
  assert(await sight.page.isVisible('#side'));
});

test('the legend is beside the chart and never over it', async (t) => {
  const sight = await Sight.open(t, browser, await live(t), { size: DESK });
  await sight.press('#show-legend');
  await sight.until('the legend is shown', () => document.querySelectorAll('#chart-legend li canvas').length > 8);
  const [legend, sheet] = [await boxOf(sight, '#chart-legend'), await boxOf(sight, '#sheet')];
  assert(legend.x + legend.width <= sheet.x + 1, JSON.stringify({ legend, sheet }));
  // The whole field is visible on the remaining part of the chart.
  await sight.until('the field fits', () => {
    const { clientWidth } = document.getElementById('sheet');
    return squall.hello.chart.field.corners.every(([x]) => Math.abs((x - squall.view.x) * squall.view.scale) < clientWidth / 2);
  });
  await sight.page.setViewportSize(PHONE);
  await sight.press('#tab-game');
  await sight.until('it is in the tab on a phone', () => document.querySelector('#pane-game #chart-legend')?.checkVisibility());
  const [low, chart] = [await boxOf(sight, '#chart-legend'), await boxOf(sight, '#sheet')];
  assert(low.y >= chart.y + chart.height, JSON.stringify({ low, chart }));
});

test('the list of events follows the time from the start', async (t) => {
  const sight = await Sight.open(t, browser, await replay(t, 'swarm_20v20', '--set', 'game.duration_s=200'), { size: DESK });
  await sight.page.focus('#sheet');
  const inSight = (at_s) => sight.until(`the events around ${at_s} s are in sight`, ([at_s]) => {
    const pane = document.getElementById('pane-events').getBoundingClientRect();
    const next = squall.events.find((event) => event.at_s > squall.t_s + 1e-6);
    return [...document.querySelectorAll('#events li')].some((row) => {
      const box = row.getBoundingClientRect();
      const time = row.querySelector('time').textContent;
      const [, minutes, seconds] = time.match(/(\d+):([\d.]+)/).map(Number);
      return Math.abs(60 * minutes + seconds - Math.floor(next.at_s * 10 + 1e-6) / 10) < 0.06 && box.top >= pane.top && box.bottom <= pane.bottom + 1;
    }) && squall.events.filter((event) => event.at_s > at_s).length > 20;
  }, [at_s]);
  assert((await sight.get(() => squall.t_s)) < 0.1);
  await inSight(0);
  await sight.keys('n', 'n', 'n', 'n', 'n');
  await sight.until('the replay has moved', () => squall.t_s > 1);
  await inSight(1);
});

test('details keep up with the chart at ten times real time', async (t) => {
  const sight = await Sight.open(t, browser, await live(t, '--speed', '10x'), { size: DESK });
  await sight.press('[data-vehicle=blue_two]');
  await sight.until('the helm is known', () => squall.helm?.report?.collective);
  // In each picture: whether the speed in the details is that of the frame shown, and the age of the helm's report, simulated s.
  const looks = await sight.get(() => new Promise((done) => {
    const seen = [];
    const look = () => {
      const boat = squall.frame.boats.find(({ name }) => name === 'blue_two');
      const row = [...document.querySelectorAll('#boat-facts div')].find((each) => each.firstElementChild.textContent === 'Over ground');
      seen.push({ same: row.lastElementChild.textContent.includes(`at ${boat.speed_m_s.toFixed(2)}`), age_s: squall.t_s - squall.helm.report.at_s, t_s: squall.t_s, at_ms: performance.now() });
      if (seen.length < 240) requestAnimationFrame(look);
      else done(seen);
    };
    requestAnimationFrame(look);
  }));
  const rate = (1000 * (looks.at(-1).t_s - looks[0].t_s)) / (looks.at(-1).at_ms - looks[0].at_ms);
  const same = looks.filter((each) => each.same).length / looks.length;
  const age_s = looks.map((each) => each.age_s).sort((a, b) => a - b)[looks.length >> 1];
  t.diagnostic(`${(100 * same).toFixed(0)} % of pictures have their details; reports are ${age_s.toFixed(2)} s old (median) at about ${rate.toFixed(1)}x`);
  assert(same > 0.5, `${same} of the pictures`);
  assert(age_s <= 1, `reports are ${age_s} s old`);
});

test('the rose has scales and can be folded', async (t) => {
  const sight = await Sight.open(t, browser, await live(t, '--speed', '2x'), { size: DESK });
  await sight.press('[data-vehicle=blue_two]');
  await sight.until('the rose is shown', () => document.getElementById('rose').checkVisibility() && squall.helm?.report?.collective);
  assert.match(await sight.text('.heat-scale'), /utility 0.*100/);
  await sight.press('.helm-picture > summary');
  assert(!(await sight.page.isVisible('#rose')));
  await reload(sight);
  await sight.press('[data-vehicle=blue_two]');
  await sight.until('the helm is known', () => squall.helm?.report);
  assert(!(await sight.page.isVisible('#rose')), 'it stays folded');
});

test('the help shows all keys and marks at once', async (t) => {
  const sight = await Sight.open(t, browser, await live(t, '--speed', '2x'), { size: DESK });
  await sight.keys('?');
  const { scrolled, seen } = await sight.get(() => {
    const box = document.getElementById('help-box');
    return { scrolled: box.scrollHeight - box.clientHeight, seen: box.querySelectorAll('dt').length };
  });
  assert(seen > 30 && scrolled <= 0, `${scrolled} pixels of ${seen} rows are hidden`);
});
