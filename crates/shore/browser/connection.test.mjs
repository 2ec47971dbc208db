// Pages and servers that end and restart.

import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { join } from 'node:path';
import { Program, Sight, folder, freePort, gameFile, openBrowser, until } from './harness.mjs';

let browser;
before(async () => { browser = await openBrowser(); });
after(() => browser.close());

/** A connection that has been silent for this long is closed, s. */
const SILENCE_S = 4;

/** Lets a test cut the newest connection like a phone that leaves a network: nothing arrives, leaves or closes. */
const CUTTABLE = () => {
  const Real = window.WebSocket;
  window.sockets = [];
  window.WebSocket = class extends Real {
    constructor(...place) {
      super(...place);
      window.sockets.push(this);
      this.addEventListener('message', (event) => this.isCut && event.stopImmediatePropagation());
    }

    send(text) {
      if (!this.isCut) super.send(text);
    }

    close() {
      if (!this.isCut) super.close();
    }
  };
};

/** Records the page's messages about its connection, which may be brief. */
const NOTE = () => {
  window.noted = [];
  const box = document.getElementById('connection');
  new MutationObserver(() => window.noted.push(box.hidden ? '' : box.textContent)).observe(box, { attributes: true });
};

/** The browser's own error when no server listens. */
const NOBODY = /WebSocket connection to .* failed/;

test('a page reconnects by itself after a reload or a restart of its server', async (t) => {
  const file = gameFile(t, 'long', 'pav01_vs_pav01.toml', 'duration_s = 3600');
  const name = `page-test-${process.pid}`;
  const endpoint = `tcp/127.0.0.1:${await freePort()}`;
  const place = ['--game', name, '--connect', endpoint];
  const sim = new Program(t, 'sim', file, '--speed', '5x', '--game', name, '--listen', endpoint);
  await sim.hears(/game \S+ at/);
  new Program(t, 'agent', ...place, '--vehicle', 'blue_one', 'blue_two', 'red_one', 'red_two');
  const listen = `127.0.0.1:${await freePort()}`;
  let view = new Program(t, 'view', ...place, '--listen', listen);
  const sight = await Sight.open(t, browser, await view.url(), { allows: NOBODY });
  await sight.goesOn();
  await sight.page.reload();
  await sight.until('the page is back', () => squall.frame !== null && squall.state?.phase === 'playing');
  await sight.press('[data-vehicle=red_one]');
  const before_s = await sight.goesOn();

  await sight.greetedAnew(async () => {
    await view.kill();
    await sight.until('the page reports the lost connection', () => !squall.connected
      && /Connection lost/.test(document.getElementById('connection').textContent) && !document.getElementById('connection').hidden);
    await sight.until('the chip reports it', () => document.getElementById('phase').textContent.trim() === 'no connection');
    view = new Program(t, 'view', ...place, '--listen', listen);
  });
  assert((await sight.goesOn()) > before_s, 'the game is the same');
  assert(await sight.get(() => document.getElementById('connection').hidden));
  assert.equal(await sight.get(() => squall.selected), 'red_one', 'the boat stays selected');
  await sight.until('its helm is received again', () => squall.helm?.report?.collective);

  await sim.kill();
  await sight.until('the game is gone', () => squall.state.phase === 'gone' && /The game has disappeared/.test(document.getElementById('over').textContent));
  assert(await sight.get(() => squall.connected));
  assert.equal(view.code, undefined, 'the server still runs');
  new Program(t, 'sim', file, '--speed', '5x', '--game', name, '--listen', endpoint);
  new Program(t, 'agent', ...place, '--vehicle', 'blue_one', 'blue_two', 'red_one', 'red_two');
  await sight.until('the next game is shown', () => squall.state?.phase === 'playing' && squall.t_s > 1 && document.getElementById('over').hidden);
  await until('the server still serves', async () => (await fetch(`http://${listen}/`)).ok);
});

test('a silently dead connection is closed; an idle one is not', async (t) => {
  const game = gameFile(t, 'long', 'pav01_vs_pav01.toml', 'duration_s = 3600');
  const run = new Program(t, 'run', game, '--view', '--speed', '2x', '--no-record', '--listen', '127.0.0.1:0');
  const sight = await Sight.open(t, browser, await run.url(), { before: CUTTABLE });
  await sight.goesOn();
  await sight.press('#pause');
  await sight.phase('paused');
  const stands_s = await sight.get(() => squall.t_s);
  await sight.page.waitForTimeout((SILENCE_S + 3) * 1000);
  assert.equal(await sight.get(() => window.sockets.length), 1, 'a paused game is not a dead connection');
  await sight.get(NOTE);
  await sight.greetedAnew(async () => {
    await sight.get(() => { window.sockets.at(-1).isCut = true; });
    await sight.press('#pause');
  });
  const { noted, notices } = await sight.get(() => ({ noted: window.noted, notices: document.getElementById('notices').textContent }));
  assert(noted.some((text) => /Connection lost/.test(text)), `the page reports it: ${noted}`);
  assert.match(notices, /may not have arrived/);
  assert(await sight.get(() => document.getElementById('connection').hidden));
  await sight.phase('paused');
  assert.equal(await sight.get(() => squall.t_s), stands_s, 'the command was lost');
  await sight.press('#pause');
  await sight.phase('playing');
  await sight.goesOn();
});

test('a page without a game says why and what to type, and shows the result of a game that has ended', async (t) => {
  const name = `page-none-${process.pid}`;
  const endpoint = `tcp/127.0.0.1:${await freePort()}`;
  const place = ['--game', name, '--connect', endpoint];
  const view = new Program(t, 'view', ...place, '--listen', '127.0.0.1:0');
  const sight = await Sight.load(t, browser, await view.url(), { allows: NOBODY });
  await sight.until('the page says so', () => /No game to show: .*no response.*squall run surveyor_2v2/s.test(document.getElementById('over').textContent));
  assert.equal(await sight.text('#phase'), 'no game');
  for (const [width, height] of [[1400, 900], [390, 844], [844, 390]]) {
    await sight.page.setViewportSize({ width, height });
    const [sheet, over] = await Promise.all(['#sheet', '#over'].map((each) => sight.page.locator(each).boundingBox()));
    assert(over.y >= sheet.y && over.y + over.height <= sheet.y + sheet.height, `the text is cut off at ${width}×${height}`);
    assert(!(await sight.page.isVisible('text=No boat matches')) && !(await sight.page.isVisible('#pause')), 'no controls without a game');
  }
  const file = gameFile(t, 'brief', 'pav01_vs_pav01.toml', 'duration_s = 3');
  const record = join(folder(t), 'brief.mcap');
  new Program(t, 'sim', file, '--pace', 'realtime', '--game', name, '--listen', endpoint, '--join-s', '0', '--record', record);
  await sight.until('the game appears by itself', () => squall.frame !== null);
  await sight.until('its result stays, and the page waits', () => squall.state.phase === 'gone' && /Waiting for another/.test(document.getElementById('over').textContent));
  assert.match(await sight.text('#over'), /^pav01 0 : 0 pav01\. A draw\.\nTo see it again, type: squall replay .*brief\.mcap\nWaiting for another game\./);
  assert.equal(await sight.text('#phase'), 'game over');
});
