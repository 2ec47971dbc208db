// Access: only a page with the token may act.

import assert from 'node:assert/strict';
import { networkInterfaces } from 'node:os';
import { after, before, test } from 'node:test';
import { Program, Sight, freePort, openBrowser, scenario } from './harness.mjs';

let browser;
before(async () => { browser = await openBrowser(); });
after(() => browser.close());

/** The reply to a forged page that sends this message over its own WebSocket. */
const forge = (sight, message) => sight.get((message) => new Promise((done, fail) => {
  const socket = new WebSocket(`ws://${location.host}/ws`);
  socket.onopen = () => socket.send(JSON.stringify(message));
  socket.onmessage = ({ data }) => {
    const heard = typeof data === 'string' ? JSON.parse(data) : {};
    if (heard.kind !== 'refused') return;
    socket.close();
    done(heard);
  };
  socket.onclose = () => fail(new Error('closed'));
  setTimeout(() => fail(new Error('no answer')), 20_000);
}), message);

test('a page without the token can only watch, and one with it can act', async (t) => {
  const port = await freePort();
  // The game has a boat that any page with the token may drive.
  const run = new Program(t, 'run', scenario('games/person_2v2.toml'), '--view', '--speed', '2x', '--no-record', '--listen', `0.0.0.0:${port}`,
    '--token', 'secret');
  const url = await run.url();
  assert.match(url, /#token=secret$/);
  const watching = await Sight.open(t, browser, `http://127.0.0.1:${port}/`);
  assert.equal(await watching.get(() => squall.hello.rights), false);
  assert(await watching.page.isVisible('#rights'));
  await watching.goesOn();
  for (const id of ['pause', 'step', 'speed', 'halt', 'estop']) assert(await watching.page.isDisabled(`#${id}`), `#${id} is off`);
  await watching.press('#tab-game');
  assert(await watching.page.isDisabled('#stop'));
  await watching.press('#tab-boats');
  await watching.press('[data-vehicle=blue_two]');
  await watching.until('the helm is visible', () => squall.helm?.report?.mode);
  await watching.page.focus('#sheet');
  await watching.keys(' ', 's', 'h', 'e', 'Enter', '.');
  for (const message of [{ do: 'control', what: 'pause' }, { do: 'control', what: 'e_stop' }, { do: 'control', what: 'stop' },
    { do: 'speed', factor: 50 }, { do: 'drive', vehicle: 'blue_one', course_deg: 0, speed_m_s: 1 }]) {
    const refused = await forge(watching, message);
    assert(refused.reason.length > 0, JSON.stringify(refused));
  }
  await watching.press('#tab-boats');
  await watching.press('[data-vehicle=blue_one]');
  assert(await watching.page.isDisabled('#drive'));
  await watching.keys('d');
  assert.equal(await watching.get(() => squall.driving), null);
  await watching.goesOn();
  const still = await watching.get(() => ({ phase: squall.state.phase, speed: squall.state.speed, stopped: squall.frame.stopped, over: squall.frame.over }));
  assert.deepEqual(still, { phase: 'playing', speed: 2, stopped: false, over: false });

  const wrong = await Sight.open(t, browser, `http://127.0.0.1:${port}/#token=secre`);
  assert.equal(await wrong.get(() => squall.hello.rights), false, 'a wrong token grants no rights');

  const acting = await Sight.open(t, browser, `http://127.0.0.1:${port}/#token=secret`);
  assert.equal(await acting.get(() => squall.hello.rights), true);
  assert(!(await acting.page.isVisible('#rights')));
  await acting.press('[data-vehicle=blue_one]');
  await acting.press('#drive');
  await acting.until('the page drives the boat', () => /You are driving this boat/.test(document.getElementById('pane-boat').textContent));
  await acting.press('#let-go');
  await acting.press('#pause');
  await acting.phase('paused');
  await watching.phase('paused');
  await acting.press('#pause');
  await watching.phase('playing');
});

test('the printed address is one that other machines can use', async (t) => {
  const own = Object.values(networkInterfaces()).flat().filter((each) => each.family === 'IPv4' && !each.internal);
  if (own.length === 0) return t.skip('this machine is on no network');
  const run = new Program(t, 'run', scenario('games/pav01_vs_pav01.toml'), '--view', '--speed', '2x', '--no-record', '--listen', '0.0.0.0:0', '--token',
    'a b&c');
  const url = await run.url();
  const sight = await Sight.open(t, browser, url);
  assert.equal(await sight.get(() => squall.hello.rights), true, `with ${url}`);
});

test('a token pasted into the open page takes effect at once', async (t) => {
  const port = await freePort();
  const run = new Program(t, 'run', scenario('games/pav01_vs_pav01.toml'), '--view', '--speed', '2x', '--no-record', '--listen', `0.0.0.0:${port}`,
    '--token', 'secret');
  await run.url();
  const sight = await Sight.open(t, browser, `http://127.0.0.1:${port}/`);
  assert.equal(await sight.get(() => squall.hello.rights), false);
  await sight.get(() => { window.same = true; });
  await sight.greetedAnew(() => sight.page.goto(`http://127.0.0.1:${port}/#token=secret`));
  assert(await sight.get(() => squall.hello.rights && window.same), 'without a reload');
  await sight.press('#pause');
  await sight.phase('paused');
});
