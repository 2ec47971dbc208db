// A replay over time: it plays by itself, its address contains the current time, and the chart can be saved.

import assert from 'node:assert/strict';
import { readFileSync, readdirSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { Program, Sight, folder, openBrowser, scenario, squall } from './harness.mjs';

let browser;
before(async () => { browser = await openBrowser(); });
after(() => browser.close());

const SIZE = { size: { width: 1400, height: 900 } };

/** Plays and records a game. Returns the address of its replay. */
async function replay(t) {
  const place = folder(t);
  await squall(t, 'run', scenario('games/pav01_vs_pav01.toml'), '--in-process', '--record', place);
  const file = readdirSync(place).find((name) => name.endsWith('.mcap'));
  return new Program(t, 'replay', join(place, file), '--listen', '127.0.0.1:0').url();
}

test('a replay begins to play, and its address carries time and boat', async (t) => {
  const url = await replay(t);
  const sight = await Sight.open(t, browser, url, SIZE);
  await sight.until('the replay plays by itself', () => squall.player.playing && squall.t_s > 0.3);
  await sight.page.focus('#sheet');
  await sight.keys(' ', 'n');
  await sight.press('[data-vehicle=red_two]');
  await sight.until('the replay is paused at an event', () => !squall.player.playing && squall.t_s > 10);
  const before_s = await sight.get(() => squall.t_s);
  await sight.press('#share');
  const address = await sight.until('the address is updated', () => /boat=red_two/.test(location.hash) && location.href);
  const again = await Sight.open(t, browser, address, SIZE);
  await again.until('a second page shows the same moment', (before_s) => squall.selected === 'red_two' && Math.abs(squall.t_s - before_s) < 0.11, before_s);
  assert.equal(await again.get(() => squall.player.playing), false, 'the linked moment stays');
  for (const [odd, want_s] of [['t=9e99', 600], ['t=whale', null], ['boat=whale&t=5', 5]]) {
    const other = await Sight.open(t, browser, `${url}#${odd}`, SIZE);
    await other.until(`#${odd} is accepted as far as possible`, (want_s) => (want_s === null ? squall.player.playing : Math.abs(squall.t_s - want_s) < 0.11), want_s);
    await other.close();
  }
});

test('the chart is saved as PNG, and a section of the game as a video', async (t) => {
  const sight = await Sight.open(t, browser, `${await replay(t)}#t=30`, { ...SIZE, acceptDownloads: true });
  const [picture] = await Promise.all([sight.page.waitForEvent('download'), sight.press('#png')]);
  assert(/^pav01_vs_pav01.*_00-30\.\d\.png$/.test(picture.suggestedFilename()), picture.suggestedFilename());
  const png = readFileSync(await picture.path());
  assert.deepEqual([...png.subarray(1, 4)], [...Buffer.from('PNG')]);
  const [width, height] = [png.readUInt32BE(16), png.readUInt32BE(20)];
  assert(width > 900 && height > 500 && png.length > 20_000, `${width} by ${height}, ${png.length} bytes`);
  await sight.press('#film');
  await sight.page.focus('#sheet');
  await sight.keys(' ');
  await sight.until('the replay continues', () => squall.t_s > 32);
  const [film] = await Promise.all([sight.page.waitForEvent('download'), sight.press('#film')]);
  const webm = readFileSync(await film.path());
  assert.deepEqual([...webm.subarray(0, 4)], [0x1a, 0x45, 0xdf, 0xa3], 'the file is EBML');
  assert(webm.includes('webm') && webm.length > 10_000, `${webm.length} bytes`);
  await sight.until('the button can start a new video', () => document.getElementById('film').textContent === 'Video');
});

/** The number of pictures, the size, and the colour of two pixels of the last picture of a GIF, decoded by the browser. */
const DECODE = async (base64) => {
  const data = Uint8Array.from(atob(base64), (letter) => letter.charCodeAt(0));
  const decoder = new ImageDecoder({ data, type: 'image/gif' });
  await decoder.tracks.ready;
  await decoder.completed;
  const { frameCount } = decoder.tracks.selectedTrack;
  const { image } = await decoder.decode({ frameIndex: frameCount - 1 });
  const canvas = new OffscreenCanvas(image.displayWidth, image.displayHeight);
  const context = canvas.getContext('2d', { willReadFrequently: true });
  context.drawImage(image, 0, 0);
  const at = (x, y) => [...context.getImageData(x, y, 1, 1).data.slice(0, 3)];
  return { frameCount, width: canvas.width, height: canvas.height, paper: at(4, 4), water: at(canvas.width - 4, 60) };
};

test('a section of the game is saved as a GIF that other programs can read, on a phone too', async (t) => {
  const url = `${await replay(t)}#t=30`;
  for (const how of [SIZE, { size: { width: 390, height: 844 }, hasTouch: true, isMobile: true }]) {
    const sight = await Sight.open(t, browser, url, { ...how, acceptDownloads: true });
    const press = how.hasTouch ? (selector) => sight.page.tap(selector) : (selector) => sight.press(selector);
    if (how.hasTouch) {
      await press('#tab-game');
      const [picture] = await Promise.all([sight.page.waitForEvent('download'), press('#png')]);
      assert.match(picture.suggestedFilename(), /\.png$/);
    }
    await press('#gif');
    const from_s = await sight.get(() => squall.t_s);
    await press('#pause');
    await sight.until('the replay continues', (from_s) => squall.t_s > from_s + 2, from_s);
    const [kept] = await Promise.all([sight.page.waitForEvent('download'), press('#gif')]);
    assert.match(kept.suggestedFilename(), /\.gif$/);
    const gif = readFileSync(await kept.path());
    const { frameCount, width, height, paper, water } = await sight.get(DECODE, gif.toString('base64'));
    assert(frameCount >= 4 && width >= 380 && width <= 800 && height > 200, `${frameCount} pictures, ${width} by ${height}`);
    const colours = await sight.get(() => ['--paper', '--water'].map((name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim()));
    const parts = (colour) => [1, 3, 5].map((at) => Number.parseInt(colour.slice(at, at + 2), 16));
    for (const [got, want] of [[paper, parts(colours[0])], [water, parts(colours[1])]]) assert(got.every((part, i) => Math.abs(part - want[i]) < 24), `${got}, not ${want}`);
    t.diagnostic(`${frameCount} pictures, ${width} by ${height}, ${(gif.length / 1024).toFixed(0)} kB`);
    await sight.close();
  }
});
