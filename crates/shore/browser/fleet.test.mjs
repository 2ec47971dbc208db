// Fleets too large to read boat by boat: counts, search, order, filter, and a chart that is not covered in letters.

import assert from 'node:assert/strict';
import { readdirSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { Program, Sight, folder, openBrowser, scenario, squall } from './harness.mjs';

let browser;
before(async () => { browser = await openBrowser(); });
after(() => browser.close());

/** Records a fleet's first minutes, and opens its replay at a moment with many tagged boats. */
async function fleet(t) {
  const place = folder(t);
  await squall(t, 'run', scenario('games/fleet_20v20.toml'), '--set', 'game.duration_s=60', '--in-process', '--record', place);
  const file = readdirSync(place).find((name) => name.endsWith('.mcap'));
  return `${await new Program(t, 'replay', join(place, file), '--listen', '127.0.0.1:0').url()}#t=50`;
}

/** The names in the list, in the order shown. */
const LISTED = () => [...document.querySelectorAll('#boat-list [data-vehicle]')].filter((row) => row.checkVisibility()).map((row) => row.dataset.vehicle);
const CHIPS = () => Object.fromEntries([...document.querySelectorAll('#boat-states button')].map((chip) => [chip.dataset.state || 'all', Number(chip.firstChild.textContent)]));

test('a fleet is counted by state, filtered, searched and sorted', async (t) => {
  const sight = await Sight.open(t, browser, await fleet(t));
  await sight.until('the moment is shown', () => squall.t_s > 49.9);
  const tagged = await sight.get(() => squall.frame.boats.filter((boat) => boat.tagged).map(({ name }) => name));
  assert(tagged.length > 3, `${tagged.length} boats are tagged`);
  await sight.until('boats are counted', (count) => document.querySelector('[data-state=tagged] strong')?.textContent === String(count), tagged.length);
  const chips = await sight.get(CHIPS);
  const playing = await sight.get(() => squall.frame.boats.filter((boat) => !boat.tagged && !boat.disabled).length);
  assert.deepEqual([chips.all, chips.tagged, chips['in play']], [40, tagged.length, playing]);

  await sight.press('[data-state=tagged]');
  assert.deepEqual(await sight.get(LISTED), tagged);
  assert.match(await sight.text('#boat-list h3 small'), new RegExp(` ${tagged.filter((name) => name.startsWith('blue')).length} of 20`));
  await sight.press('[data-state=tagged]');
  assert.equal((await sight.get(LISTED)).length, 40, 'a second press shows all again');

  await sight.page.focus('#sheet');
  await sight.keys('/');
  await sight.page.keyboard.type('red 1');
  const found = await sight.get(LISTED);
  assert(found.includes('red_1') && found.includes('red_12') && found.every((name) => name.startsWith('red_') && name.includes('1')), found.join());
  assert(await sight.get(() => squall.player.playing === false), 'letters in the field are not commands');
  await sight.page.keyboard.type(' nobody');
  await sight.until('no boat matches', () => [...document.querySelectorAll('.roster p')].some((line) => line.checkVisibility() && /No boat/.test(line.textContent)));
  await sight.keys('Escape');
  assert.equal((await sight.get(LISTED)).length, 40, 'Escape clears the field');

  await sight.page.selectOption('#boat-order', 'speed');
  const speeds = await sight.get((list) => Object.groupBy(list.map((name) => squall.frame.boats.find((boat) => boat.name === name)), ({ team }) => team), await sight.get(LISTED));
  for (const boats of Object.values(speeds)) assert.deepEqual(boats.map(({ speed_m_s }) => speed_m_s), boats.map(({ speed_m_s }) => speed_m_s).sort((a, b) => b - a));
  const [, second] = await sight.get(LISTED);
  await sight.page.focus('#boat-list [data-vehicle]');
  await sight.keys('ArrowDown');
  assert.equal(await sight.get(() => document.activeElement.dataset.vehicle), second, 'arrow keys follow the order shown');
});

test('in a crowd, only the hull shows that a boat is tagged, and a selected boat has its letter', async (t) => {
  const sight = await Sight.open(t, browser, await fleet(t));
  await sight.until('the moment is shown', () => squall.t_s > 49.9);
  const tagged = await sight.get(() => squall.frame.boats.find((boat) => boat.tagged).name);
  await sight.page.hover('#tab-boats');
  await sight.until('no letters', () => squall.letters.length === 0);
  await sight.press(`[data-vehicle=${tagged}]`);
  await sight.page.hover('#tab-boats');
  await sight.until('its letter', (name) => squall.letters.length === 1 && squall.letters[0].name === name && squall.letters[0].letter === 'T', tagged);
});
