// Takes screenshots of the page: node shots.mjs FOLDER [NAME …]

import { copyFileSync, mkdirSync, readdirSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { Program, Sight, folder, gameFile, openBrowser, scenario, squall } from './harness.mjs';
import { arm, badge, realBoats } from './real_boats.mjs';
import { site } from './site.mjs';

const [place = 'shots', ...only] = process.argv.slice(2);
const DESK = { size: { width: 1400, height: 900 } };
const HALL = { size: { width: 1920, height: 1080 } };
const TABLET = { size: { width: 820, height: 1180 }, hasTouch: true };
const PHONE = { size: { width: 390, height: 844 }, deviceScaleFactor: 2, hasTouch: true };
const LANDSCAPE = { ...PHONE, size: { width: 844, height: 390 } };
const WAVES = ['--sea', scenario('seas/fresh_breeze.toml')];
const PAV01 = scenario('games/pav01_vs_pav01.toml');

/** Runs what was registered with `t.after`, like the end of a test. */
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

const at = (t_s) => (sight) => sight.until('the time is reached', (t_s) => squall.t_s > t_s, t_s);
const select = (name) => async (sight) => {
  await sight.page.press('body', '1');
  await sight.press(`[data-vehicle=${name}]`);
  await sight.until('the helm is known', () => squall.helm?.report?.collective || squall.helm?.reason);
};
const toGrab = async (sight) => {
  await sight.page.selectOption('#event-kind', { label: 'grabs' });
  await sight.press('#event-next');
  await sight.until('a flag is carried', () => squall.flags.some((flag) => flag.carrier !== null));
};
const keys = (...each) => (sight) => sight.keys(...each);
const plots = async (sight) => {
  await sight.press('#show-plots');
  await sight.page.selectOption('#plot-boats', 'blue_one');
  await sight.until('its curves are drawn', () => [...document.querySelectorAll('.plot .value')].every((each) => /\d/.test(each.textContent)));
};
const measure = async (sight) => {
  await sight.page.focus('#sheet');
  await sight.keys('[', 'm', 'Enter', '[', 'Enter', 'l');
  await sight.until('the range is measured', () => squall.measured);
};

const entry = (name) => `[[entry]]\nname = "${name}"\nstrategy = "${scenario(`strategies/${name}.toml`)}"\n`;
const view = async (t, path) => new Program(t, 'view', path, '--listen', '127.0.0.1:0').url();
const league = async (t) => {
  const place = folder(t);
  const file = join(place, 'harbour_cup.toml');
  const game = gameFile(t, 'short', 'surveyor_2v2.toml', 'duration_s = 240');
  writeFileSync(file, `game = "${game}"\ngames = 10\n${['strategy_2', 'strategy_3', 'strategy_4', 'strategy_5', 'pav01', 'observer'].map(entry).join('')}`);
  await squall(t, 'tournament', file, '--league', join(place, 'league'));
  return view(t, join(place, 'league'));
};
const leagueGame = async (t) => `${await league(t)}?game=7`;
const sweep = async (t) => {
  const place = folder(t);
  const file = join(place, 'wind.toml');
  const game = gameFile(t, 'short', 'surveyor_2v2.toml', 'duration_s = 60');
  writeFileSync(file, `about = "How much wind?"\ngame = "${game}"\nopponent = "${scenario('strategies/strategy_3.toml')}"\ngames = 10\n${entry('strategy_4')}${entry('strategy_5')}`
    + '[[axis]]\nkey = "sea.wind.speed_m_s"\nvalues = [1, 6, 12]\n');
  await squall(t, 'sweep', file, '--out', join(place, 'out'));
  return view(t, join(place, 'out'));
};
/** A training run's folder with invented numbers; a real one takes minutes. */
const training = async (t) => {
  const place = join(folder(t), 'first');
  mkdirSync(join(place, 'games'), { recursive: true });
  await squall(t, 'run', PAV01, '--in-process', '--record', place);
  copyFileSync(join(place, readdirSync(place).find((name) => name.endsWith('.mcap'))), join(place, 'games/7_1.mcap'));
  const noise = (i) => Math.sin(i * 12.9898) * 43758.5453 % 1;
  const rows = (count, row) => [...Array(count).keys()].map(row).join('\n');
  writeFileSync(join(place, 'updates.csv'), `samples,stage,reward,policy_loss,value_loss,entropy,divergence,clipped,epochs\n${rows(200, (i) =>
    `${(i + 1) * 10000},${i < 60 ? 'nobody_in_the_way' : 'against_pav01'},${0.02 * Math.log(i + 1) + 0.01 * noise(i)},${-0.01 + 0.002 * noise(i)},${2 / (1 + i / 30)},${2.7 - i / 150},0.01,0.1,4`)}\n`);
  writeFileSync(join(place, 'evaluations.csv'), `samples,stage,opponent,won,drawn,lost,points,points_against,left_field\n${rows(20, (i) => ['pav01', 'strategy_2', 'strategy_4'].map((name, k) =>
    `${(i + 1) * 100000},${i < 6 ? 'nobody_in_the_way' : 'against_pav01'},${name},${Math.max(0, i - 3 * k)},2,${18 - Math.max(0, i - 3 * k)},${4 + i / 4 - k},${8 - i / 6},${Math.max(0, 1.5 - i / 10)}`).join('\n'))}\n`);
  writeFileSync(join(place, 'episodes.csv'), `samples,stage,seed,team,opponent,points,points_against,steps,cut_off,recording\n${rows(5, (i) =>
    `${(i + 1) * 40000},nobody_in_the_way,${i},0,pav01,${i},2,600,false,games/7_1.mcap`)}\n`);
  return view(t, place);
};
const chosen = async (sight) => {
  await sight.page.waitForSelector('.matrix button');
  await sight.press('.matrix tbody tr:nth-child(2) td:nth-child(4) button');
  // The colours under the pointer differ from those of the cell.
  await sight.page.mouse.move(2, 2);
};
const shown = (selector) => (sight) => sight.page.waitForSelector(selector);
const worst = (sight) => sight.page.evaluate(() => document.getElementById('worst').scrollIntoView());
const lower = (sight) => sight.page.evaluate(() => scrollTo(0, document.body.scrollHeight));

/** With a shoreline or an image beneath the field. */
const withChart = (kind) => async (t) => live(PAV01, '--speed', '10x', '--chart', site(folder(t))[kind])(t);
const fence = async (sight) => {
  await badge(sight, 'red_one', 'disarmed');
  await sight.press('#draw-fence');
  for (const [x, y] of [[320, 300], [600, 300], [640, 520], [330, 600]]) await sight.page.mouse.click(x, y);
};

let boats;
const station = async (t) => {
  boats = await realBoats(t);
  return boats.url;
};
const armed = async (sight) => {
  for (const name of ['red_one', 'blue_one']) await arm(sight, name);
  await sight.page.waitForTimeout(4000);
};
/** One boat has lost its agent; the other continues. */
const alarm = async (sight) => {
  await armed(sight);
  await sight.press('#operate-station_keep');
  await sight.press('#operate-confirm');
  await badge(sight, 'blue_one', 'delegated');
  await boats.agents.kill();
  await badge(sight, 'red_one', 'failsafe');
  await sight.until('the alarm is shown', () => squall.alarms.length > 0);
};

const fast = live(PAV01, ...WAVES, '--speed', '10x');
const calm = live(PAV01, '--speed', '10x');
const fleet = live(scenario('games/fleet_20v20.toml'), '--speed', '5x', '--agents-per-process', '40');
const hundred = live(scenario('games/fleet_100v100.toml'), '--speed', '5x', '--agents-per-process', '100');
const pickState = (name) => (sight) => sight.press(`#boat-states [data-state="${name}"]`);
const SCENES = {
  'live-waves-selected': [fast, DESK, 'light', at(135), select('blue_two')],
  'live-waves-dark': [fast, DESK, 'dark', at(60), select('red_two')],
  'live-calm': [calm, DESK, 'light', at(40)],
  'live-game-tab': [fast, DESK, 'light', at(20), keys('4')],
  'estop': [calm, DESK, 'light', at(30), keys('E')],
  'help': [calm, DESK, 'light', at(10), keys('?')],
  'replay': [replay(PAV01, ...WAVES), DESK, 'light', toGrab, select('red_two')],
  'replay-plots': [replay(PAV01, ...WAVES), DESK, 'light', toGrab, select('red_two'), plots],
  'replay-plots-hall': [replay(PAV01, ...WAVES), HALL, 'dark', toGrab, select('red_two'), plots],
  'replay-measure': [replay(PAV01, ...WAVES), HALL, 'light', toGrab, measure],
  'replay-swarm': [replay(scenario('games/swarm_20v20.toml')), DESK, 'light', toGrab],
  'replay-dark': [replay(PAV01, ...WAVES), DESK, 'dark', toGrab],
  'harbour': [live(scenario('games/harbour_2v2.toml'), '--speed', '10x'), DESK, 'light', at(30)],
  'swarm': [live(scenario('games/swarm_20v20.toml'), '--speed', '5x', '--agents-per-process', '40'), DESK, 'dark', at(30)],
  'league-game': [leagueGame, DESK, 'light', at(5)],
  'phone-league-game': [leagueGame, PHONE, 'dark', at(5)],
  'station': [station, DESK, 'light', (sight) => badge(sight, 'red_one', 'disarmed'), (sight) => sight.press('[data-vehicle=blue_one]')],
  'station-armed': [station, HALL, 'dark', armed],
  'station-alarm': [station, DESK, 'light', alarm],
  'station-list': [station, DESK, 'dark', alarm, keys('1')],
  'station-fence': [station, DESK, 'light', fence],
  'tablet-station': [station, TABLET, 'light', alarm],
  'phone-station': [station, PHONE, 'light', alarm],
  'phone-station-list': [station, PHONE, 'dark', alarm, keys('1')],
  'chart': [withChart('geojson'), DESK, 'light', at(30)],
  'chart-dark': [withChart('geojson'), HALL, 'dark', at(30)],
  'chart-image': [withChart('image'), DESK, 'dark', at(30)],
  'station-few': [station, HALL, 'light', armed, keys('1')],
  'landscape-station': [station, LANDSCAPE, 'light', alarm],
  'landscape-station-list': [station, LANDSCAPE, 'dark', alarm, keys('1')],
  'phone-chart': [withChart('geojson'), PHONE, 'light', at(30)],
  'phone': [fast, PHONE, 'light', at(60)],
  'phone-selected': [fast, PHONE, 'dark', at(60), select('blue_two')],
  'phone-game': [fast, PHONE, 'light', at(20), keys('4')],
  'phone-replay': [replay(PAV01, ...WAVES), PHONE, 'light', toGrab],
  'phone-replay-plots': [replay(PAV01, ...WAVES), PHONE, 'dark', toGrab, select('red_two'), plots],
  'landscape': [fast, LANDSCAPE, 'light', at(60)],
  'landscape-replay': [replay(PAV01, ...WAVES), LANDSCAPE, 'light', toGrab],
  'landscape-replay-plots': [replay(PAV01, ...WAVES), LANDSCAPE, 'dark', toGrab, select('red_two'), plots],
  'landscape-game': [fast, LANDSCAPE, 'dark', at(20), keys('4')],
  'fleet': [fleet, DESK, 'light', at(40)],
  'fleet-dark': [fleet, HALL, 'dark', at(40)],
  'fleet-tagged': [fleet, DESK, 'light', at(40), pickState('tagged')],
  'phone-fleet': [fleet, PHONE, 'light', at(40)],
  'hundred': [hundred, DESK, 'light', at(60)],
  'hundred-dark': [hundred, HALL, 'dark', at(60)],
  'phone-drive': [live(scenario('games/person_2v2.toml'), '--pace', 'realtime'), PHONE, 'light', at(2), select('blue_one'), (sight) => sight.press('#drive')],
};
/** Pages of reports. */
const REPORTS = {
  'league': [league, DESK, 'light', chosen],
  'league-hall': [league, HALL, 'dark', chosen],
  'phone-league': [league, PHONE, 'light', chosen],
  'training': [training, DESK, 'light', shown('.card canvas')],
  'training-hall': [training, HALL, 'dark', shown('.card canvas')],
  'training-games': [training, DESK, 'dark', shown('.card canvas'), lower],
  'phone-training': [training, PHONE, 'dark', shown('.card canvas')],
  'sweep-games': [sweep, DESK, 'light', shown('#worst-list .watch'), worst],
  'phone-sweep-games': [sweep, PHONE, 'dark', shown('#worst-list .watch'), worst],
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
    if ((await sight.get(() => squall.mode)) === 'live') await sight.until('the background is drawn', (before) => squall.drawn > before + 20, drawn);
    await sight.page.screenshot({ path: join(place, `${name}.png`) });
    const wide = await sight.get(() => document.documentElement.scrollWidth > innerWidth);
    const boats = await sight.get(() => squall.frame.boats.map(({ name, x, y, heading_deg }) => `${name} ${x.toFixed(1)} E ${y.toFixed(1)} N ${heading_deg.toFixed(0)}°`));
    process.stdout.write(`${name}${wide ? ' (wider than the screen)' : ''}: ${boats.length > 8 ? `${boats.length} boats` : boats.join(', ')}\n`);
  } finally {
    await scene.close();
  }
}
for (const [name, [begin, { size, ...device }, colorScheme, ...acts]] of Object.entries(REPORTS)) {
  if (only.length > 0 && !only.includes(name)) continue;
  const scene = new Scene();
  try {
    const sight = await Sight.load(scene, browser, await begin(scene), { size, colorScheme, ...device });
    for (const act of acts) await act(sight);
    await sight.page.waitForTimeout(300);
    await sight.page.screenshot({ path: join(place, `${name}.png`) });
    process.stdout.write(`${name}${(await sight.get(() => document.documentElement.scrollWidth > innerWidth)) ? ' (wider than the screen)' : ''}\n`);
  } finally {
    await scene.close();
  }
}
await browser.close();
