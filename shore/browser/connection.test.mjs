// Pages and servers that come and go.

import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { Program, Sight, freePort, gameFile, openBrowser, until } from './harness.mjs';

let browser;
before(async () => { browser = await openBrowser(); });
after(() => browser.close());

/** A browser says it, whatever the page does, when nobody listens. */
const NOBODY = /WebSocket connection to .* failed/;

test('a page that is loaded again, or whose server is, goes on by itself', async (t) => {
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
  await sight.until('the page is there again', () => squall.frame !== null && squall.state?.phase === 'playing');
  await sight.press('[data-vehicle=red_one]');
  const before_s = await sight.goesOn();

  await view.kill();
  await sight.until('the page says that nobody answers', () => !squall.connected
    && /Connection lost/.test(document.getElementById('connection').textContent) && !document.getElementById('connection').hidden);
  await sight.until('it says so beside the name', () => document.getElementById('phase').textContent.trim() === 'no connection');
  view = new Program(t, 'view', ...place, '--listen', listen);
  await sight.until('it is connected again, and to the same game', (before_s) => squall.connected && squall.t_s > before_s, before_s);
  await sight.goesOn();
  assert(await sight.get(() => document.getElementById('connection').hidden));
  assert.equal(await sight.get(() => squall.selected), 'red_one', 'the boat stays selected');
  await sight.until('its helm is told again', () => squall.helm?.report?.collective);

  await sim.kill();
  await sight.until('the game is gone', () => squall.state.phase === 'gone' && /gone/.test(document.getElementById('over').textContent));
  assert(await sight.get(() => squall.connected));
  assert.equal(view.code, undefined, 'the server stays');
  new Program(t, 'sim', file, '--speed', '5x', '--game', name, '--listen', endpoint);
  new Program(t, 'agent', ...place, '--vehicle', 'blue_one', 'blue_two', 'red_one', 'red_two');
  await sight.until('the next game is shown', () => squall.state?.phase === 'playing' && squall.t_s > 1 && document.getElementById('over').hidden);
  await until('the server still serves', async () => (await fetch(`http://${listen}/`)).ok);
});
