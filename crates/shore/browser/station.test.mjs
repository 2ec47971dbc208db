// The page as the operator station for real boats: emulated ones with their gateways.

import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { Sight, folder, openBrowser } from './harness.mjs';
import { arm, badge, realBoats } from './real_boats.mjs';

let browser;
before(async () => { browser = await openBrowser(); });
after(() => browser.close());

/** A sentence with its checksum. */
const sentence = (body) => `$${body}*${[...body].reduce((sum, letter) => sum ^ letter.charCodeAt(0), 0).toString(16).toUpperCase().padStart(2, '0')}`;

/** Sends a request this many times over its own connection, like a foreign page. Returns the first refusal. */
const forge = (sight, message, times = 1) => sight.get(([message, times]) => new Promise((done, fail) => {
  const socket = new WebSocket(`ws://${location.host}/ws${location.hash.replace('#', '?')}`);
  socket.onopen = () => { for (let i = 0; i < times; i++) socket.send(JSON.stringify(message)); };
  socket.onmessage = ({ data }) => {
    const heard = typeof data === 'string' ? JSON.parse(data) : {};
    if (heard.kind === 'refused') done(heard);
  };
  setTimeout(() => fail(new Error('no refusal arrived')), 20_000);
}), [message, times]);

const enabled = (sight, id) => sight.page.isEnabled(`#${id}`);

test('an operator arms, delegates and disarms a boat from the page, and everyone sees its state', async (t) => {
  const boats = await realBoats(t);
  const mine = await Sight.open(t, browser, boats.url);
  const theirs = await Sight.open(t, browser, boats.url.split('#')[0]);
  assert.deepEqual(await mine.get(() => [squall.hello.rights, squall.hello.operates]), [true, true]);
  assert.deepEqual(await theirs.get(() => [squall.hello.rights, squall.hello.operates]), [false, false]);
  await badge(theirs, 'blue_one', 'disarmed');
  await theirs.press('[data-vehicle=blue_one]');
  for (const id of ['operate', 'mission', 'operate-station_keep', 'operate-go_to_erp']) assert(!(await enabled(theirs, id)), `#${id} is off`);
  assert.match((await forge(theirs, { do: 'operate', vehicle: 'blue_one', command: 'arm' })).reason, /may only watch/);

  await mine.press('[data-vehicle=blue_one]');
  await mine.until('the boat is ready to arm', () => document.querySelector('#checks .good'));
  await mine.press('#operate');
  await mine.press('#operate-cancel');
  assert.equal((await badge(mine, 'blue_one', 'disarmed')).label, 'Disarmed', 'Cancel does not arm the boat');
  await arm(mine, 'blue_one');
  assert.match(await mine.text('#operated'), /blue one is armed/);
  await badge(theirs, 'blue_one', 'armed');
  assert.match(await mine.text('#gateway'), /Link.*up.*Fix.*s ago.*Battery\d+\s% \(\d\d\.\d\sV\), .*s ago.*In control.*secondary.*Mode(thrust|standby), /s);
  await mine.press('#tab-boats');
  await mine.until('the list shows the state', () => /Armed.*link.*fix [\d.]+\ss.*\d\s%/s.test(document.querySelector('[data-vehicle=blue_one] .badge-line').textContent));
  assert(await mine.get(() => document.querySelector('#boat-list [data-vehicle=blue_two] .badge-line') === null), 'a simulated boat has no badge');

  await mine.press('#tab-boat');
  await mine.press('#operate-station_keep');
  await mine.press('#operate-confirm');
  assert.equal((await badge(mine, 'blue_one', 'delegated')).detail, 'station keeping');
  await mine.press('#operate-go_to_erp');
  await mine.press('#operate-confirm');
  await mine.until('the refusal is shown', () => /Refused by .*: missing: a recovery point/.test(document.getElementById('operated').textContent));

  const place = folder(t);
  const { datum } = await mine.get(() => squall.hello.chart.field);
  const waypoint = (index, north_m, east_m) => {
    const [lat, lon] = [datum[0] + north_m / 111_100, datum[1] + east_m / (111_320 * Math.cos((datum[0] * Math.PI) / 180))];
    const minutes = (deg, width) => `${String(Math.floor(Math.abs(deg))).padStart(width, '0')}${((Math.abs(deg) % 1) * 60).toFixed(6).padStart(9, '0')}`;
    return sentence(`OIWPL,${minutes(lat, 2)},${lat < 0 ? 'S' : 'N'},${minutes(lon, 3)},${lon < 0 ? 'W' : 'E'},${index}`);
  };
  const write = (name, lines) => {
    writeFileSync(join(place, name), `${lines.join('\r\n')}\r\n`);
    return join(place, name);
  };
  const send = async (file) => {
    await mine.page.setInputFiles('#mission-file', file);
    await mine.press('#operate-confirm');
  };
  await send(write('bad.sea', ['no sentence at all']));
  await mine.until('a bad file is refused', () => /Not done: .*no sentence/.test(document.getElementById('operated').textContent));
  const settings = sentence('PSEAR,0,000,40,0,000');
  await send(write('good.sea', [settings, waypoint(0, 20, 30), waypoint(1, 40, 60), waypoint(2, 60, 60)]));
  await mine.until('the mission runs', () => squall.badges.find(({ name }) => name === 'blue_one').detail.startsWith('mission'));

  await mine.press('#operate-disarm');
  await badge(theirs, 'blue_one', 'disarmed');
});

test('without its own token a page may stop real boats, and with the token from the terminal it operates them', async (t) => {
  const boats = await realBoats(t, { page: [] });
  const sight = await Sight.open(t, browser, boats.url);
  assert.deepEqual(await sight.get(() => [squall.hello.rights, squall.hello.operates]), [true, false]);
  const [, address, token] = await boats.view.hears(/to operate real boats, open (http:\S+#token=([0-9a-f]{32}))/);
  await badge(sight, 'blue_one', 'disarmed');
  await sight.press('[data-vehicle=blue_one]');
  assert(!(await enabled(sight, 'operate')));
  for (const command of ['arm', 'release', 'station_keep', { mission: { throttle_pct: 40, erp: [0, 0], waypoints: [[0, 0]] } }]) {
    assert.match((await forge(sight, { do: 'operate', vehicle: 'blue_one', command })).reason, /operator's token/, JSON.stringify(command));
  }
  assert.match((await forge(sight, { do: 'mission', vehicle: 'blue_one', lines: '' })).reason, /operator's token/);
  await sight.page.fill('#operator-token', 'no');
  await sight.greetedAnew(() => sight.page.press('#operator-token', 'Enter'));
  assert(!(await sight.get(() => squall.hello.operates)), 'a wrong token grants no rights');
  await sight.page.fill('#operator-token', token);
  await sight.greetedAnew(() => sight.page.press('#operator-token', 'Enter'));
  assert(await sight.get(() => squall.hello.operates));
  assert(!(await sight.page.isVisible('#operator-token')));
  assert.equal(new URL(await sight.get(() => location.href)).hash, new URL(address).hash);
  await arm(sight, 'blue_one');
  // Without the token, a page may still stop one boat or all, but release none.
  const looking = await Sight.open(t, browser, boats.url);
  await looking.press('[data-vehicle=blue_one]');
  await looking.press('#operate-disarm');
  await badge(sight, 'blue_one', 'disarmed');
  await looking.press('#estop');
  await badge(sight, 'blue_one', 'stopped');
  await looking.until('the page cannot release them', () => document.getElementById('estop').disabled);
  await sight.press('#estop');
  await sight.press('#estop-confirm');
  await badge(sight, 'blue_one', 'disarmed');
});

test('a failsafe is seen and heard until it is acknowledged, and no flood keeps the E-stop waiting', async (t) => {
  const boats = await realBoats(t);
  const sight = await Sight.open(t, browser, boats.url);
  assert.match(await sight.text('#mute'), /Enable sound/, 'browsers play no sound before the first press');
  await badge(sight, 'blue_one', 'disarmed');
  await arm(sight, 'blue_one');
  await arm(sight, 'red_one');
  await sight.until('alarms are audible', () => document.getElementById('mute').textContent === 'Alarms on');
  assert.deepEqual(await sight.get(() => [squall.alarms, squall.sounded]), [[], 0], 'there are no alarms');

  // Without its agents a boat receives no orders.
  await boats.agents.kill();
  for (const name of ['blue_one', 'red_one']) {
    const failed = await badge(sight, name, 'failsafe');
    assert.match(failed.detail, /order/);
  }
  await sight.until('two alarms are shown', () => squall.alarms.length === 2 && squall.alarms.every(({ active, text }) => active && /^Failsafe: .*order/.test(text)));
  const before = await sight.get(() => squall.sounded);
  await sight.until('the alarm sounds repeatedly', (before) => squall.sounded >= before + 6, before);
  assert(await sight.page.isVisible('#alarms'));
  await sight.press('#mute');
  const muted = await sight.get(() => squall.sounded);
  assert.equal(await sight.text('#mute'), 'Alarms muted');
  await sight.page.waitForTimeout(2500);
  assert.equal(await sight.get(() => squall.sounded), muted, 'muted alarms are silent');
  assert(await sight.page.isVisible('#alarms'), 'muted alarms are still visible');
  await sight.press('#mute');
  await sight.until('the alarm sounds again', (muted) => squall.sounded > muted, muted);

  // The missing condition is listed beside the button. The button looks disabled, and gives the same reason when pressed.
  await sight.press('#tab-boats');
  await sight.press('[data-vehicle=red_one]');
  await sight.until('the condition is listed', () => /Missing before arming:.*a fresh order/s.test(document.querySelector('.arming').textContent));
  assert.equal(await sight.page.getAttribute('#operate', 'aria-disabled'), 'true');
  // Playwright waits until a button is enabled, unless forced.
  await sight.page.click('#operate', { force: true });
  assert(!(await sight.page.isVisible('#operate-confirm')), 'no question about a command that would be refused');
  assert.match(await sight.text('#operated'), /red one cannot be armed yet\. Missing: .*a fresh order/);
  await sight.press('#tab-boats');

  // After a reset on another page, the alarm stays until it is acknowledged on this one.
  const theirs = await Sight.open(t, browser, boats.url);
  await theirs.press('[data-vehicle=red_one]');
  assert.equal(await theirs.text('#operate-disarm'), 'Reset failsafe');
  await theirs.press('#operate-disarm');
  await badge(sight, 'red_one', 'disarmed');
  await sight.until('the alarm is over but still shown', () => squall.alarms.some(({ boat, active }) => boat === 'red_one' && !active));
  await sight.press('#alarm-list li:has-text("red one") >> text=Acknowledge');
  await sight.until('the other alarm is still shown', () => squall.alarms.length === 1 && squall.alarms[0].boat === 'blue_one');
  await sight.press('#alarm-list li:has-text("blue one") .alarm-words');
  assert.equal(await sight.get(() => squall.selected), 'blue_one', 'pressing an alarm selects its boat');
  await sight.press('#operate-disarm');
  await sight.until('resetting acknowledges the alarm', () => squall.alarms.length === 0);
  assert(!(await sight.page.isVisible('#alarms')));

  // One page floods the server with commands; one press on another stops all boats.
  const flood = forge(theirs, { do: 'operate', vehicle: 'blue_one', command: 'arm' }, 5000);
  await sight.press('#estop');
  const pressed_ms = Date.now();
  await badge(sight, 'blue_one', 'stopped');
  await badge(sight, 'red_one', 'stopped');
  t.diagnostic(`stopped and seen ${Date.now() - pressed_ms} ms after the press`);
  assert.match((await flood).reason, /has not answered the previous command/);
  assert(Date.now() - pressed_ms < 5000);

  // A gateway that has ended is silent.
  await boats.gateways.red_one.kill();
  assert.match((await badge(sight, 'red_one', 'silent')).detail, /no report from its gateway for/);
  await sight.until('the silent gateway raises an alarm', () => squall.alarms.some(({ boat, text }) => boat === 'red_one' && /silent/.test(text)));
});

test('a boat holds a heading and changes mode on an operator’s command, and its faults raise alarms', async (t) => {
  const file = join(folder(t), 'careful.toml');
  writeFileSync(file, '[currents]\nthruster_max_a = 1\n');
  const boats = await realBoats(t, { gateway: ['--config', file] });
  const sight = await Sight.open(t, browser, boats.url);
  await badge(sight, 'blue_one', 'disarmed');
  await sight.press('[data-vehicle=blue_one]');
  await sight.until('the boat has a position', () => !/navigation|link/.test(document.getElementById('checks').textContent));
  await sight.press('#modes summary');
  await sight.page.fill('#mode-heading', '0');
  await sight.page.fill('#mode-thrust', '71');
  await sight.press('#mode-set');
  await sight.press('#operate-confirm');
  await sight.until('excessive thrust is refused', () => /Refused by .*: the thrust is 71, expected 0 to 70 %/.test(document.getElementById('operated').textContent));
  await sight.page.fill('#mode-thrust', '20');
  await sight.press('#mode-set');
  assert.match(await sight.text('#operate-question'), /Let blue one’s own controller hold heading 0° at 20 %/);
  await sight.press('#operate-confirm');
  assert.equal((await badge(sight, 'blue_one', 'delegated')).detail, 'heading 000 at 20 %');
  // Its thrusters draw more than the file allows.
  await sight.until('each thruster raises an alarm', () => squall.alarms.length === 2 && squall.alarms.every(({ active, text }) => active && /thruster draws too much, 1\.\d A/.test(text)));
  assert.match(await sight.text('#gateway'), /Alarm.*thruster draws too much/s);
  await sight.page.selectOption('#mode', 'autopilot');
  assert(!(await sight.page.isVisible('#mode-heading')));
  await sight.press('#mode-set');
  await sight.press('#operate-confirm');
  await sight.until('the boat has changed its mode', () => squall.badges.find(({ name }) => name === 'blue_one').detail === 'autopilot');
  // An emulated boat does nothing in that mode.
  await sight.until('the alarms are over but still shown', () => squall.alarms.length === 2 && squall.alarms.every(({ active }) => !active));
  assert(!/Alarm/.test(await sight.text('#gateway')));
  await sight.press('#operate-disarm');
  await badge(sight, 'blue_one', 'disarmed');
  await sight.until('acknowledged', () => squall.alarms.length === 0);
});

test('badges cover no boat and no other badge, however close the boats are', async (t) => {
  const boats = await realBoats(t);
  for (const size of [{ width: 1400, height: 900 }, { width: 390, height: 844 }]) {
    const sight = await Sight.open(t, browser, boats.url, { size });
    for (const name of ['blue_one', 'red_one']) await badge(sight, name, 'disarmed');
    await sight.page.focus('#sheet');
    for (let zoom = 0; zoom < 7; zoom++) {
      const covered = await sight.get(() => {
        const areas = squall.badges.map(({ area }) => area).filter(Boolean);
        const others = squall.hulls.map(({ left, top, right, bottom }) => [left, top, right, bottom]);
        const overlap = (a, b) => a[0] < b[2] && b[0] < a[2] && a[1] < b[3] && b[1] < a[3];
        return { count: areas.length, covered: areas.some((area, i) => [...others, ...areas.slice(i + 1)].some((other) => overlap(area, other))) };
      });
      assert.deepEqual(covered, { count: 2, covered: false }, `after ${zoom} steps at ${size.width} px`);
      const drawn = await sight.get(() => squall.drawn);
      await sight.keys('-');
      await sight.until('the chart is drawn again', (before) => squall.drawn > before + 3, drawn);
    }
    await sight.close();
  }
});

test('the normal end of a game causes no failsafe and no alarm', async (t) => {
  const boats = await realBoats(t);
  const sight = await Sight.open(t, browser, boats.url);
  await badge(sight, 'blue_one', 'disarmed');
  await arm(sight, 'blue_one');
  await sight.page.focus('#sheet');
  await sight.keys('4');
  await sight.press('#stop');
  await sight.press('#stop-confirm');
  await sight.until('the result is shown', () => /^pav01 \d+ : \d+ pav01\. A draw\./.test(document.getElementById('over').textContent));
  assert.match(await boats.gateways.blue_one.hears(/the game is over: disarming the boat/).then(([text]) => text), /disarming/);
  const ended = await badge(sight, 'blue_one', 'ended');
  assert.deepEqual([ended.label, await sight.get(() => squall.alarms), await sight.text('#phase')], ['Game over', [], 'game over']);
  // Orders are stale by now.
  assert(!/failsafe/.test(boats.gateways.blue_one.said), boats.gateways.blue_one.said);
});

test('the E-stop is large only where it stops real boats', async (t) => {
  const boats = await realBoats(t);
  for (const [size, least] of [[{ width: 1400, height: 900 }, 60], [{ width: 390, height: 844 }, 68]]) {
    const sight = await Sight.open(t, browser, boats.url, { size });
    const { height } = await sight.page.locator('#estop').boundingBox();
    assert(height >= least, `${height} px high at ${size.width}`);
    assert(await sight.get(() => document.documentElement.scrollWidth <= innerWidth), 'the page fits the screen');
  }
});
