// Pictures of the page for people to look at: node shots.mjs FOLDER [NAME …]

import { mkdirSync, readdirSync } from 'node:fs';
import { join } from 'node:path';
import { Program, Sight, folder, openBrowser, scenario, squall } from './harness.mjs';

const [place = 'shots', ...only] = process.argv.slice(2);
const DESK = { size: { width: 1400, height: 900 } };
const HALL = { size: { width: 1920, height: 1080 } };
const PHONE = { size: { width: 390, height: 844 }, deviceScaleFactor: 2, hasTouch: true };
const WAVES = ['--sea', scenario('seas/fresh_breeze.toml')];
const PAV01 = scenario('games/pav01_vs_pav01.toml');

/** Ends what `t.after` was told of, as a test does. */
class Scene {
  ends = [];

  after(end) {
    this.ends.unshift(end);
  }

  async close() {
    for (const end of this.ends) await end();
  }
}

const live = (...words) => async (t) => {
  const run = new Program(t, 'run', ...words, '--view', '--no-record', '--listen', '127.0.0.1:0');
  return run.url();
};

const replay = (...words) => async (t) => {
  const into = folder(t);
  await squall(t, 'run', ...words, '--in-process', '--record', into);
  const file = readdirSync(into).find((name) => name.endsWith('.mcap'));
  return `${await new Program(t, 'replay', join(into, file), '--listen', '127.0.0.1:0').url()}#t=0`;
};

const at = (t_s) => (sight) => sight.until('it is time', (t_s) => squall.t_s > t_s, t_s);
const select = (name) => async (sight) => {
  await sight.page.press('body', '1');
  await sight.press(`[data-vehicle=${name}]`);
  await sight.until('its helm is known', () => squall.helm?.report?.collective || squall.helm?.reason);
};
const toGrab = async (sight) => {
  await sight.page.selectOption('#event-kind', { label: 'grabs' });
  await sight.press('#event-next');
  await sight.until('a flag is carried', () => squall.flags.some((flag) => flag.carrier !== null));
};
const keys = (...each) => (sight) => sight.keys(...each);
const plots = async (sight) => {
  await sight.press('#show-plots');
  await sight.page.selectOption('#plot-other', 'blue_one');
  await sight.until('its curves are drawn', () => /\d/.test(document.querySelector('.plot:last-child .value').textContent));
};
const measure = async (sight) => {
  await sight.page.focus('#sheet');
  await sight.keys('[', 'm', 'Enter', '[', 'Enter', 'l');
  await sight.until('it is measured', () => squall.measured);
};

const fast = live(PAV01, ...WAVES, '--speed', '10x');
const calm = live(PAV01, '--speed', '10x');
const SCENES = {
  'live-waves-selected': [fast, DESK, 'light', at(135), select('blue_two')],
  'live-waves-dark': [fast, DESK, 'dark', at(60), select('red_two')],
  'live-calm': [calm, DESK, 'light', at(40)],
  'live-game-tab': [fast, DESK, 'light', at(20), keys('4')],
  'estop': [calm, DESK, 'light', at(30), keys('e')],
  'help': [calm, DESK, 'light', at(10), keys('?')],
  'replay': [replay(PAV01, ...WAVES), DESK, 'light', toGrab, select('red_two')],
  'replay-plots': [replay(PAV01, ...WAVES), DESK, 'light', toGrab, select('red_two'), plots],
  'replay-plots-hall': [replay(PAV01, ...WAVES), HALL, 'dark', toGrab, select('red_two'), plots],
  'replay-measure': [replay(PAV01, ...WAVES), HALL, 'light', toGrab, measure],
  'replay-swarm': [replay(scenario('games/swarm_20v20.toml')), DESK, 'light', toGrab],
  'replay-dark': [replay(PAV01, ...WAVES), DESK, 'dark', toGrab],
  'harbour': [live(scenario('games/harbour_2v2.toml'), '--speed', '10x'), DESK, 'light', at(30)],
  'swarm': [live(scenario('games/swarm_20v20.toml'), '--speed', '5x', '--agents-per-process', '40'), DESK, 'dark', at(30)],
  'phone': [fast, PHONE, 'light', at(60)],
  'phone-selected': [fast, PHONE, 'dark', at(60), select('blue_two')],
  'phone-game': [fast, PHONE, 'light', at(20), keys('4')],
  'phone-replay': [replay(PAV01, ...WAVES), PHONE, 'light', toGrab],
  'phone-replay-plots': [replay(PAV01, ...WAVES), PHONE, 'dark', toGrab, select('red_two'), plots],
  'phone-drive': [live(scenario('games/person_2v2.toml'), '--pace', 'realtime'), PHONE, 'light', at(2), select('blue_one'), (sight) => sight.press('#drive')],
};

mkdirSync(place, { recursive: true });
const browser = await openBrowser();
for (const [name, [begin, { size, ...device }, colorScheme, ...acts]] of Object.entries(SCENES)) {
  if (only.length > 0 && !only.includes(name)) continue;
  const scene = new Scene();
  try {
    const sight = await Sight.open(scene, browser, await begin(scene), { size, colorScheme, ...device });
    await sight.page.focus('#sheet');
    for (const act of acts) await act(sight);
    const drawn = await sight.get(() => squall.drawn);
    if ((await sight.get(() => squall.mode)) === 'live') await sight.until('it is drawn', (before) => squall.drawn > before + 20, drawn);
    await sight.page.screenshot({ path: join(place, `${name}.png`) });
    const wide = await sight.get(() => document.documentElement.scrollWidth > innerWidth);
    const boats = await sight.get(() => squall.frame.boats.map(({ name, x, y, heading_deg }) => `${name} ${x.toFixed(1)} E ${y.toFixed(1)} N ${heading_deg.toFixed(0)}°`));
    process.stdout.write(`${name}${wide ? ' (wider than the screen)' : ''}: ${boats.length > 8 ? `${boats.length} boats` : boats.join(', ')}\n`);
  } finally {
    await scene.close();
  }
}
await browser.close();
