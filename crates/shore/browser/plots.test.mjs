// Plots: any quantities of any boats, in a replay and in a running game; all plots share a time range and a cursor with the timeline.

import assert from 'node:assert/strict';
import { readdirSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { Program, Sight, folder, openBrowser, readJson, scenario, squall } from './harness.mjs';

let browser;
before(async () => { browser = await openBrowser(); });
after(() => browser.close());

const SIZE = { size: { width: 1400, height: 900 } };
const PAV01 = scenario('games/pav01_vs_pav01.toml');
/** Tolerances of speed and range: the curves of a long game are thinned, so a sample may be half a second old. */
const OFF_M_S = 1;
const OFF_M = 3.2;
/** The time that one pixel of the timeline covers, s. */
const PIXEL_S = 0.6;

/** Plays and records a game. Returns the address of its replay at its start, and the result. */
async function replay(t) {
  const place = folder(t);
  await squall(t, 'run', PAV01, '--in-process', '--record', place, '--json', join(place, 'result.json'));
  const file = readdirSync(place).find((name) => name.endsWith('.mcap'));
  return { url: `${await new Program(t, 'replay', join(place, file), '--listen', '127.0.0.1:0').url()}#t=0`, result: readJson(join(place, 'result.json')) };
}

/** The plots as shown: quantity, and value by curve. */
const SHOWN = () => [...document.querySelectorAll('.plot')].map((plot) => ({
  quantity: plot.querySelector('select').selectedOptions[0].textContent,
  time: plot.querySelector('.plot-time')?.textContent,
  values: Object.fromEntries([...plot.querySelectorAll('.plot-value')].map((each) => [each.children[1].textContent, parseFloat(each.querySelector('.value').textContent)])),
}));
const shown = (sight) => sight.get(SHOWN);

/** Points at a fraction of the width of a plot's area. */
async function pointAt(sight, plot, part, press = false) {
  const box = await sight.page.locator('.plot .u-over').nth(plot).boundingBox();
  const at = [box.x + box.width * part, box.y + box.height / 2];
  await sight.page.mouse.move(...at);
  if (press) await sight.page.mouse.click(...at);
}

test('values at the cursor are those of the boats, in all plots at once, and a press moves the replay there', async (t) => {
  const sight = await Sight.open(t, browser, (await replay(t)).url, SIZE);
  await sight.press('#show-plots');
  await sight.until('a text asks for a boat', () => /Select a boat/.test(document.getElementById('plots').textContent));
  await sight.press('[data-vehicle=red_two]');
  await sight.page.selectOption('#plot-boats', 'blue_one');
  await sight.press('#plot-add');
  await sight.page.locator('.plot').nth(2).locator('select').first().selectOption({ label: 'Range to, m' });
  await sight.page.locator('.plot-other').nth(2).selectOption('blue_two');
  await sight.until('all curves are known', () => {
    const known = [...document.querySelectorAll('.plot')].map((plot) => [...plot.querySelectorAll('.value')].filter((each) => each.textContent !== '–').length);
    return known.length === 3 && known.every((count) => count >= 2);
  });
  for (const part of [0.3, 0.6, 0.9]) {
    await pointAt(sight, 0, part, true);
    await sight.until('the chart follows', (part) => Math.abs(squall.t_s - 600 * part) < 2, part);
    await pointAt(sight, 1, part);
    await sight.until('all plots show this moment', () => new Set([...document.querySelectorAll('.plot-time')].map((each) => each.textContent)).size === 1
      && [...document.querySelectorAll('.plot')[2].querySelectorAll('.value')].every((each) => each.textContent !== '–'));
    const [speed, heading, range] = await shown(sight);
    assert.deepEqual([speed.quantity, heading.quantity, range.quantity], ['Speed, m/s', 'Heading, °', 'Range to, m']);
    const boats = await sight.get(() => squall.frame.boats);
    for (const name of ['red_two', 'blue_one']) {
      const boat = boats.find((each) => each.name === name);
      const other = boats.find((each) => each.name === 'blue_two');
      const called = name.replace('_', ' ');
      assert(Math.abs(speed.values[called] - boat.speed_m_s) < OFF_M_S, `${speed.values[called]} for ${boat.speed_m_s}`);
      assert(heading.values[called] >= 0 && heading.values[called] <= 360);
      const range_m = Math.hypot(boat.x - other.x, boat.y - other.y);
      assert(Math.abs(range.values[called] - range_m) < OFF_M, `${range.values[called]} for ${range_m}`);
    }
    // A cursor in each plot, at the same fraction of its width.
    await sight.until(`each plot has a cursor at ${part} of its width`, (part) => [...document.querySelectorAll('.plot .u-over')].every((over) => {
      const { left, width } = over.getBoundingClientRect();
      return Math.abs((over.querySelector('.u-cursor-x').getBoundingClientRect().left - left) / width - part) < 0.02;
    }), part);
  }
  const label = await sight.get(() => document.querySelector('.plot').getAttribute('aria-label'));
  assert(/^Speed at \d\d:\d\d\.\d: blue one [\d.]+\sm\/s, /.test(label), label);
  await sight.page.reload();
  await sight.until('the plots survive a reload', () => document.querySelectorAll('.plot').length === 3 && document.querySelectorAll('.plot-other')[2].value === 'blue_two');
});

test('a section chosen in a plot applies to all plots and the timeline', async (t) => {
  const sight = await Sight.open(t, browser, (await replay(t)).url, SIZE);
  await sight.press('#show-plots');
  await sight.press('[data-vehicle=red_two]');
  await sight.until('curves are drawn', () => document.querySelectorAll('.plot canvas').length === 2);
  const box = await sight.page.locator('.plot .u-over').first().boundingBox();
  const at = (part) => [box.x + box.width * part, box.y + 40];
  await sight.page.mouse.move(...at(0.25));
  await sight.page.mouse.down();
  await sight.page.mouse.move(...at(0.5), { steps: 4 });
  await sight.page.mouse.up();
  const span = await sight.until('a section is chosen', () => squall.span.to_s - squall.span.from_s < 200 && squall.span);
  assert(Math.abs(span.from_s - 150) < 4 && Math.abs(span.to_s - 300) < 4, JSON.stringify(span));
  assert(Math.abs(await sight.get(() => squall.t_s)) < 1, 'choosing a section does not move the replay');
  // The timeline has the same section: its middle is at 225 s.
  const line = await sight.page.locator('#timeline').boundingBox();
  await sight.page.mouse.click(line.x + 34 + (line.width - 48) / 2, line.y + 20);
  await sight.until('the replay is in the middle of the section', () => Math.abs(squall.t_s - 225) < 3);
  await pointAt(sight, 1, 0.5);
  const [speed, heading] = await sight.until('all plots show this moment', () => {
    const times = [...document.querySelectorAll('.plot-time')].map((each) => each.textContent);
    return new Set(times).size === 1 && times;
  });
  assert(/^03:4\d/.test(speed) && speed === heading, `${speed} ${heading}`);
  await sight.page.mouse.dblclick(box.x + 20, box.y + 20);
  await sight.until('the whole game is shown', () => squall.span.from_s === 0 && Math.abs(squall.span.to_s - 600) < 1e-6);
});

test('the timeline shows time, score and event under the pointer, has a scale, and zooms', async (t) => {
  const { url, result } = await replay(t);
  const sight = await Sight.open(t, browser, url, { ...SIZE, allows: /willReadFrequently/ });
  await sight.until('the score is known', () => {
    const canvas = document.getElementById('timeline');
    const { data } = canvas.getContext('2d').getImageData(0, 0, 30, canvas.height);
    return data.some((each) => each !== 0);
  });
  const line = await sight.page.locator('#timeline').boundingBox();
  const x = async (t_s) => {
    const { from_s, to_s } = await sight.get(() => squall.span);
    return line.x + 34 + ((t_s - from_s) / (to_s - from_s)) * (line.width - 48);
  };
  const pointTo = async (t_s) => {
    await sight.page.mouse.move(await x(t_s), line.y + 30);
    await sight.until('the moment is pointed at', (t_s) => Math.abs(squall.span.pointed_s - t_s) < 0.5, t_s);
  };
  const tip = () => sight.get(() => document.getElementById('timeline-tip').innerText.replace(/\s+/g, ' '));
  const scores = result.events.filter(({ event }) => ['grabbed', 'captured'].includes(event));
  for (const event of scores.slice(0, 3)) {
    await pointTo(event.at_s);
    const text = await tip();
    const [, minutes, seconds] = text.match(/^(\d\d):(\d\d\.\d)/).map(Number);
    assert(Math.abs(60 * minutes + seconds - event.at_s) < 0.6, `${text} for ${event.at_s}`);
    assert(text.includes(event.vehicle.replaceAll('_', ' ')) && text.includes(event.event === 'captured' ? 'CAPTURES' : 'grabs'), text);
    await pointTo(event.at_s + 1.5);
    // The same score as on the chart at that moment.
    const told = [...(await tip()).matchAll(/(?:blue|red) (\d+)/g)].slice(0, 2).map(([, points]) => Number(points));
    await sight.page.mouse.click(await x(event.at_s + 1.5), line.y + 30);
    await sight.until('the replay is there', (t_s) => Math.abs(squall.t_s - t_s) < 0.7, event.at_s + 1.5);
    await sight.until('the score is the one in the tip', (told) => squall.score.join() === told.join(), told);
  }
  const [event] = scores;
  // The section follows the replay, whose moment must be in it.
  await sight.page.mouse.click(await x(event.at_s), line.y + 30);
  await sight.until('the replay is at the event', (t_s) => Math.abs(squall.t_s - t_s) < 0.7, event.at_s);
  await pointTo(event.at_s);
  const before = await sight.get(() => squall.span);
  await sight.page.mouse.wheel(0, -400);
  await sight.page.mouse.wheel(0, -400);
  // Both turns of the wheel must arrive before the position of a moment is known.
  await sight.page.waitForTimeout(300);
  const after = await sight.until('the section is shorter', (length) => squall.span.to_s - squall.span.from_s < length / 3 && squall.span, before.to_s - before.from_s);
  assert(Math.abs(after.pointed_s - before.pointed_s) < PIXEL_S, `the moment under the pointer stays: ${JSON.stringify({ before, after })}`);
  assert((await tip()).includes(event.vehicle.replaceAll('_', ' ')), 'the event stays under the pointer');
  await sight.page.mouse.click(await x(event.at_s + 5), line.y + 30);
  await sight.until('a press goes to the moment', (t_s) => Math.abs(squall.t_s - t_s) < 0.25, event.at_s + 5);
  // Going to a moment outside the section moves the section there.
  await sight.page.press('#timeline', 'End');
  await sight.until('the section follows', () => squall.t_s > 50 && squall.t_s <= squall.span.to_s + 0.2 && squall.t_s >= squall.span.from_s - 0.2);
  await sight.press('#time-whole');
  assert.deepEqual(await sight.get(() => [squall.span.from_s, Math.round(squall.span.to_s)]), [0, 600]);
  await sight.page.mouse.move(5, 5);
  await sight.until('the tip is gone', () => !document.getElementById('timeline-tip').checkVisibility());
});

test('a live game also has plots, of what the page has received', async (t) => {
  const run = new Program(t, 'run', PAV01, '--view', '--speed', '5x', '--no-record', '--listen', '127.0.0.1:0');
  const sight = await Sight.open(t, browser, await run.url(), SIZE);
  await sight.press('#show-plots');
  await sight.page.selectOption('#plot-boats', '*');
  await sight.until('twenty seconds are plotted', () => squall.span.to_s - squall.span.from_s > 20);
  await sight.press('#pause');
  await sight.phase('paused');
  await sight.until('the picture is up to date', () => Math.abs(squall.state.now_s - squall.t_s) < 1e-6);
  await sight.until('the values are those of now', () => {
    const values = [...document.querySelectorAll('.plot')[0].querySelectorAll('.plot-value')].map((each) => [each.children[1].textContent, parseFloat(each.querySelector('.value').textContent)]);
    return squall.frame.boats.every(({ name, speed_m_s }) => values.some(([called, value]) => called === name.replace('_', ' ') && Math.abs(value - speed_m_s) < 0.3));
  });
  // Each boat's curve is drawn: the plot has the colours of four boats, whose curves never coincide.
  await sight.page.locator('.plot select').first().selectOption({ label: 'East, m' });
  await sight.until('the quantity is shown', () => /East/.test(document.querySelector('.plot').getAttribute('aria-label')));
  const colours = await sight.get(() => {
    const canvas = document.querySelector('.plot canvas');
    const copy = Object.assign(document.createElement('canvas'), { width: canvas.width, height: canvas.height }).getContext('2d', { willReadFrequently: true });
    copy.drawImage(canvas, 0, 0);
    const { data } = copy.getImageData(0, 0, canvas.width, canvas.height);
    const counts = new Map();
    for (let i = 0; i < data.length; i += 4) if (data[i + 3] === 255) counts.set(data.slice(i, i + 3).join(), (counts.get(data.slice(i, i + 3).join()) ?? 0) + 1);
    const style = getComputedStyle(document.documentElement);
    return [...document.querySelectorAll('.plot')[0].querySelectorAll('.plot-value .plot-swatch:not(.dashed)')].map((each) => {
      const bits = Number.parseInt(getComputedStyle(each).getPropertyValue('--team').trim().slice(1), 16);
      return counts.get([bits >> 16, (bits >> 8) & 255, bits & 255].join()) ?? 0;
    });
  });
  assert(colours.length === 4 && colours.every((count) => count > 30), `${colours} pixels`);
});
