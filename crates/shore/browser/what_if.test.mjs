// What if: the page plays futures of a recording, with the numbers of `squall whatif`.

import assert from 'node:assert/strict';
import { readdirSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { Program, Sight, folder, openBrowser, readJson, scenario, squall } from './harness.mjs';

let browser;
before(async () => { browser = await openBrowser(); });
after(() => browser.close());

/** Plays and records a game of two minutes. Returns its file. */
async function recording(t) {
  const place = folder(t);
  await squall(t, 'run', scenario('games/pav01_vs_pav01.toml'), '--in-process', '--set', 'game.duration_s=120', '--record', place);
  return join(place, readdirSync(place).find((name) => name.endsWith('.mcap')));
}

test('the page and the terminal give the same futures', async (t) => {
  const file = await recording(t);
  const json = join(folder(t), 'futures.json');
  const url = await new Program(t, 'replay', file, '--listen', '127.0.0.1:0').url();
  const sight = await Sight.open(t, browser, `${url}#t=30`);
  await sight.press('#what-if');
  assert.equal(await sight.page.isDisabled('#what-if-play'), true, 'nothing would change');
  await sight.page.selectOption('#what-if-team-blue', 'idle');
  await sight.page.selectOption('#what-if-sea', 'gale');
  await sight.page.selectOption('#what-if-futures', '20');
  // Keys typed in the form do not reach the game.
  const before_s = await sight.get(() => squall.t_s);
  await sight.page.focus('#what-if-play');
  await sight.keys('n', 'Home');
  const command = await sight.text('#what-if-command');
  assert.equal(command, `squall whatif ${file} --at 30 --blue idle --sea gale --futures 20`);
  await squall(t, ...command.split(' ').slice(1), '--json', json);
  await sight.press('#what-if-play');
  await sight.until('all futures are played', () => document.getElementById('what-if-said').textContent.startsWith('20 futures'));
  assert.equal(await sight.get(() => squall.t_s), before_s);
  const { quantities, futures } = readJson(json);
  const shown = await sight.get(() => [...document.querySelectorAll('#what-if-table tbody tr')].map((row) => [...row.cells].map((cell) => cell.textContent.trim().replaceAll('−', '-'))));
  const want = quantities.map(({ team, quantity, is_share: share, recorded, changed, difference }) => {
    const value = ({ mean }) => (share ? (100 * mean).toFixed(0) : mean.toFixed(2));
    return [`${team} ${quantity}`, value(recorded), value(changed), `${difference.mean > 0 ? '+' : ''}${value(difference)}`];
  });
  assert.deepEqual(shown.map(([name, ...values]) => [name, ...values.map((text) => text.split(' ')[0])]), want);
  const points = futures.map(([, { score }]) => score[0]).sort((a, b) => a - b);
  const end = await sight.page.getAttribute('.fans figure:last-child .fan', 'aria-label');
  assert(end.includes(`blue ${points[9]}, ${points[0]} to ${points[18]};`), `${end} of ${points}`);
  const inked = await sight.get(() => [...document.querySelectorAll('.fan canvas')].map((canvas) => canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height).data.some((value) => value !== 0)));
  assert.deepEqual(inked, [true, true]);
});

test('futures stop when the page wants no more, and need the right to control', async (t) => {
  const file = await recording(t);
  const url = await new Program(t, 'replay', file, '--listen', '127.0.0.1:0', '--token', 'secret').url();
  const watching = await Sight.open(t, browser, url.replace(/#.*/, ''));
  assert.equal(await watching.page.isDisabled('#what-if'), true);
  const sight = await Sight.open(t, browser, url);
  await sight.press('#what-if');
  await sight.page.selectOption('#what-if-team-red', 'idle');
  await sight.page.selectOption('#what-if-futures', '500');
  await sight.press('#what-if-play');
  await sight.until('some futures are played', () => document.getElementById('what-if-progress').value > 0);
  await sight.press('#what-if-play');
  assert.equal(await sight.text('#what-if-said'), 'Stopped');
  // The first question does not delay the next one.
  await sight.page.selectOption('#what-if-futures', '20');
  await sight.press('#what-if-play');
  await sight.until('other futures are played', () => document.getElementById('what-if-said').textContent.startsWith('20 futures'));
});
