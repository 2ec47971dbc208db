// A game with real boats for tests of the page: two emulated ones with their gateways, and two simulated ones.

import { Program, freePort } from './harness.mjs';

const BOATS = ['blue_one', 'red_one'];

const hub = async () => ['--listen', `tcp/127.0.0.1:${await freePort()}`];

/** Starts the game. Returns its programs and the page's address. `page` has further arguments for `squall view`, `gateway` for each gateway. */
export async function realBoats(t, { page = ['--token', 'operators'], gateway = [] } = {}) {
  const mark = `${process.pid}_${Math.floor(performance.now())}`;
  const [water, game] = [`water_${mark}`, `match_${mark}`];
  const play = (...words) => new Program(t, ...words, '--game', game);
  new Program(t, 'sim', 'mixed_2v2', ...BOATS.flatMap((name) => ['--afloat', name]), '--pace', 'realtime', '--game', water, ...await hub());
  const boats = { emulators: {}, gateways: {} };
  boats.sim = new Program(t, 'sim', 'mixed_2v2', '--game', game, '--pace', 'realtime', '--join-s', '600', ...await hub());
  boats.agents = play('agent', '--vehicle', 'blue_one', 'blue_two', 'red_one', 'red_two');
  for (const name of BOATS) {
    const link = `tcp://127.0.0.1:${await freePort()}`;
    boats.emulators[name] = new Program(t, 'gateway', 'emulate', '--game', water, '--vehicle', name, '--listen', link);
    boats.gateways[name] = play('gateway', 'surveyor', '--vehicle', name, '--link', link, '--no-record', ...gateway);
  }
  boats.view = play('view', '--listen', '127.0.0.1:0', ...page);
  return { ...boats, url: await boats.view.url() };
}

/** Waits until a boat's badge is of this kind, and returns it. */
export const badge = (sight, name, kind) => sight.until(`${name} is ${kind}`, ([name, kind]) =>
  squall.badges.find((each) => each.name === name && each.kind === kind), [name, kind]);

/** Waits until a boat's gateway is ready to arm, and arms the boat from its panel. */
export async function arm(sight, name) {
  await sight.page.press('body', '1');
  await sight.press(`[data-vehicle=${name}]`);
  await sight.until(`${name} can be armed`, () => document.querySelector('#checks .good'));
  await sight.press('#operate');
  await sight.press('#operate-confirm');
  return badge(sight, name, 'armed');
}
