// Reports on the page: a tournament, a league, a sweep and a training run, and the games behind their tables.

import assert from 'node:assert/strict';
import { copyFileSync, existsSync, mkdirSync, readFileSync, readdirSync, rmSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { Program, Sight, folder, gameFile, openBrowser, readJson, scenario, squall, until } from './harness.mjs';

let browser;
before(async () => { browser = await openBrowser(); });
after(() => browser.close());

/** Would change the page's title if it ever ran. */
const HOSTILE = '</script><script>document.title = "owned"</script><img src=x onerror="document.title=\'owned\'">';

const entry = (name) => `[[entry]]\nname = "${name}"\nstrategy = "${scenario(`strategies/${name}.toml`)}"\n`;

/** Plays a tournament of short games. Returns its report and the file. */
async function tournament(t, ...words) {
  const place = folder(t);
  const game = gameFile(t, 'short', 'pav01_vs_pav01.toml', 'duration_s = 60');
  const file = join(place, 'short.toml');
  writeFileSync(file, `game = "${game}"\nsea = "${scenario('seas/moderate_breeze.toml')}"\ngames = 4\n${['strategy_4', 'pav01', 'idle'].map(entry).join('')}`);
  const path = join(place, 'report.json');
  await squall(t, 'tournament', file, '--json', path, ...words);
  return { place, file, path, report: readJson(path) };
}

const view = async (t, path) => (await new Program(t, 'view', path, '--listen', '127.0.0.1:0')).url();

/** Whether a string was inserted only as text. */
const isText = (sight) => sight.get(() => document.title !== 'owned' && document.querySelector('img') === null);

/** Elements with a contrast below 4.5 (WCAG 2.1, 1.4.3). */
function faint() {
  const numbers = (colour) => {
    const found = colour.match(/[\d.]+/g).map(Number);
    return colour.startsWith('color(') ? found.map((each, i) => (i < 3 ? each * 255 : each)) : found;
  };
  const behind = (element) => {
    const colour = numbers(getComputedStyle(element).backgroundColor);
    return colour[3] === 0 && element.parentElement ? behind(element.parentElement) : colour;
  };
  const linear = (part) => (part <= 0.04045 ? part / 12.92 : ((part + 0.055) / 1.055) ** 2.4);
  const luminance = (colour) => [0.2126, 0.7152, 0.0722].reduce((sum, weight, i) => sum + weight * linear(colour[i] / 255), 0);
  const own = (element) => [...element.childNodes].some((node) => node.nodeType === 3 && node.textContent.trim() !== '');
  return [...document.querySelectorAll('body *')].filter((each) => own(each) && each.offsetParent !== null).map((each) => {
    const [low, high] = [numbers(getComputedStyle(each).color), behind(each)].map(luminance).sort((a, b) => a - b);
    return [(high + 0.05) / (low + 0.05), each.textContent];
  }).filter(([contrast]) => contrast < 4.5);
}

test('from a cell of the win matrix to its games, to a replay of one, and back', async (t) => {
  const { path, report } = await tournament(t);
  const sight = await Sight.load(t, browser, await view(t, path));
  const cells = await sight.until('the matrix is shown', () => {
    const buttons = [...document.querySelectorAll('.matrix button')];
    return buttons.length > 0 && buttons.map((button) => button.getAttribute('aria-label'));
  });
  assert.equal(cells.length, report.matrix.length);
  const rows = await sight.get(() => [...document.querySelectorAll('.ratings tbody tr')].map((row) => [...row.children].map((each) => each.textContent)));
  // The same order as on the terminal; two seeds are too few for intervals.
  assert.deepEqual(rows.map((row) => [row[1], row[2], row[3], row[7]]),
    report.entries.map(({ name, rating, wins }) => [name.replaceAll('_', ' '), rating.elo.toFixed(0), 'too few seeds', String(wins)]));
  assert(!/±/.test(await sight.text('.ratings')), 'no intervals');

  assert.deepEqual(await sight.get(faint), []);
  await sight.press('#dark');
  assert.deepEqual(await sight.get(faint), [], 'in the dark');
  const [row, column] = ['strategy_4', 'pav01'];
  const cell = `.matrix button[aria-label^="strategy 4 against pav01:"]`;
  await sight.page.focus(cell);
  await sight.keys('Enter');
  const want = report.matches.filter(({ blue, red }) => [blue, red].sort().join() === [column, row].sort().join());
  const games = await sight.until('its games are listed', () => {
    const listed = [...document.querySelectorAll('#games tbody tr')];
    return listed.length > 0 && listed.map((each) => [...each.children].map((one) => one.textContent));
  });
  const result = (game, side) => (game.winner === null ? 'drawn' : game.winner === side ? 'won' : 'lost');
  assert.deepEqual(games, want.map((game) => {
    const side = game.blue === row ? 0 : 1;
    return ['Watch', String(game.seed), report.teams[side], `${game.score[side]} : ${game.score[1 - side]}`, result(game, side), '01:00'];
  }));

  await sight.press('#games tbody tr:nth-child(2) a');
  await sight.until('the game is shown', () => window.squall?.mode === 'replay' && squall.frame !== null);
  const about = await sight.text('#about');
  assert.match(about, new RegExp(`strategy 4 .*seed ${want[1].seed}; rerun, identical to the report$`), about);
  await sight.page.press('#timeline', 'End');
  await sight.until('the replay is at its end', () => squall.t_s > 59.9);
  assert.deepEqual(await sight.get(() => squall.score), want[1].score);
  await sight.press('#back');
  await sight.until('the report is unchanged', () => document.querySelector('.matrix [aria-pressed="true"]') !== null);
  assert.equal(await sight.get(() => document.querySelectorAll('#games tbody tr').length), want.length);
  await sight.page.selectOption('#games-filter', 'won');
  const won = want.filter((game) => result(game, game.blue === row ? 0 : 1) === 'won').length;
  assert.equal(await sight.get(() => [...document.querySelectorAll('#games tbody tr')].length), won);
});

test('the ratings are sorted by any column, and each entry has its opponents, its games and its rating over time', async (t) => {
  const { path, report } = await tournament(t, '--games', '10');
  const sight = await Sight.load(t, browser, await view(t, path));
  const column = (place, i) => sight.get(([place, i]) => [...document.querySelectorAll(`${place} tbody tr`)].map((row) => row.children[i].textContent), [place, i]);
  const sort = (title) => sight.press(`th button:text-matches("^${title}")`);
  await sight.page.waitForSelector('.ratings tbody tr');
  const names = report.entries.map(({ name }) => name.replaceAll('_', ' '));
  assert.deepEqual(await column('.ratings', 1), names);
  assert.match((await column('.ratings', 3)).join(), /^\d+ to \d+/, 'five seeds have intervals');
  await sort('Tags');
  const byTags = [...report.entries].sort((a, b) => b.tags.mean - a.tags.mean).map(({ tags }) => tags.mean.toFixed(2));
  const tags = async () => (await column('.ratings', 13)).map((text) => text.split(' ')[0]);
  assert.deepEqual(await tags(), byTags);
  await sort('Tags');
  assert.deepEqual(await tags(), byTags.toReversed());
  assert.equal(await sight.get(() => document.querySelector('.ratings [aria-sort]').ariaSort), 'ascending');
  await sort('Entry');
  assert.deepEqual(await column('.ratings', 1), names.toSorted());

  // The curve of ratings ends at the final rating.
  const chart = () => sight.get(() => document.querySelector('.curve').ariaLabel);
  assert.match(await chart(), new RegExp(`^Rating, at the end: ${report.entries.map(({ name, rating }) => `${name.replaceAll('_', ' ')} ${rating.elo.toFixed(0)}`).join(', ')}\\.`));
  await sight.press('.ratings tbody th a:text-is("strategy 4")');
  await sight.page.waitForSelector('#entry tbody tr');
  assert(!(await sight.page.isVisible('.ratings')), 'a separate view');
  const cells = report.matrix.filter(({ row }) => row === 'strategy_4');
  const share = ({ wins, draws, games }) => (wins + draws / 2) / games;
  const hardest = cells.toSorted((a, b) => share(a) - share(b));
  assert.deepEqual(await column('#entry', 0), hardest.map((cell) => cell.column.replaceAll('_', ' ')));
  assert.deepEqual(await column('#entry', 3), hardest.map(({ wins }) => String(wins)));
  const { rating } = report.entries.find(({ name }) => name === 'strategy_4');
  assert.match(await chart(), new RegExp(`^Rating, at the end: strategy 4 ${rating.elo.toFixed(0)}\\. `));
  assert.deepEqual(await sight.get(faint), []);
  await sight.press('button[aria-label="List the games against idle"]');
  await sight.page.waitForSelector('#games tbody tr');
  assert.equal(await sight.get(() => document.querySelectorAll('#games tbody tr').length), 10);
  // The address leads to this view, and the browser's Back button leads to all entries.
  await sight.page.reload();
  await sight.page.waitForSelector('#games tbody tr');
  assert.equal(await sight.text('#entry h2'), 'strategy 4');
  await sight.press('#entry .watch');
  await sight.until('all entries are shown', () => document.querySelector('.ratings').checkVisibility());
  await sight.page.goBack();
  await sight.until('the entry is shown again', () => document.querySelector('#entry').checkVisibility());
});

test('faults in a report or game are explained in text', async (t) => {
  const { place, path, report } = await tournament(t);
  // Hostile strings, a game with a different result, and a seed with more digits than a JavaScript number can hold.
  const seed = '9007199254740993';
  report.tournament = HOSTILE;
  report.game = HOSTILE;
  report.failures = [{ blue: HOSTILE, red: 'b', seed: 1, why: HOSTILE }];
  report.matches.forEach((game) => { game.digest = 'another'; });
  const changed = join(place, 'changed.json');
  writeFileSync(changed, JSON.stringify(report).replaceAll('"seed":2,', `"seed":${seed},`));
  const url = await view(t, changed);
  const sight = await Sight.load(t, browser, url);
  await sight.until('the failure is shown', () => document.getElementById('remarks').textContent.includes('Could not start'));
  assert.equal(await sight.text('#name'), HOSTILE.replaceAll('_', ' '));
  assert(await isText(sight));
  await sight.page.evaluate(() => { location.hash = '#row=strategy_4&column=pav01'; });
  await sight.until('the seed has all its digits', (seed) => [...document.querySelectorAll('#games tbody td:nth-child(2)')].some((each) => each.textContent === seed), seed);
  const game = report.matches.find(({ seed }) => seed === 1).game;
  const other = await Sight.open(t, browser, `${url}?game=${game}`);
  assert.match(await other.text('#about'), /NOT identical to the report/);
  for (const [name, why] of [['999', /there is no game "999", expected a number from 0 to 11/], [HOSTILE, /there is no game .*expected a number/]]) {
    const none = await Sight.load(t, browser, `${url}?game=${encodeURIComponent(name)}`);
    await none.until('the game is refused', () => document.getElementById('about').textContent !== '');
    assert.match(await none.text('#about'), why);
    assert.equal(await none.text('#phase'), 'no game');
    assert(await isText(none));
  }
  // A report without its plan is shown, but its games cannot be watched.
  delete report.plan;
  writeFileSync(path, JSON.stringify(report));
  const bare = await Sight.load(t, browser, `${await view(t, path)}#row=strategy_4&column=pav01`);
  await bare.until('the page says so', () => /Games cannot be watched/.test(document.getElementById('remarks').textContent));
  assert.equal(await bare.get(() => document.querySelectorAll('.watch').length), 0);
});

test('a league is limited to a sea or a kind, and shows who beats whom and every cycle', async (t) => {
  const place = folder(t);
  const game = gameFile(t, 'short', 'pav01_vs_pav01.toml', 'duration_s = 20');
  const file = join(place, 'short.toml');
  const seas = ['calm', 'moderate_breeze'].map((sea) => `"${scenario(`seas/${sea}.toml`)}"`);
  writeFileSync(file, `game = "${game}"\nseas = [${seas}]\ngames = 10\n${['strategy_4', 'pav01', 'idle'].map(entry).join('')}kind = "planner"\n`);
  const league = join(place, 'league');
  await squall(t, 'league', '--file', file, '--folder', league);
  // Results that form a cycle in calm water, whatever the games were.
  const path = join(league, 'report.json');
  const report = readJson(path);
  const cycle = ['strategy_4', 'pav01', 'idle'];
  const beats = (row, column) => cycle[(cycle.indexOf(row) + 1) % 3] === column;
  for (const cell of report.seas[0].matrix) cell.share = beats(cell.row, cell.column) ? { mean: 0.9, low: 0.8, high: 1 } : { mean: 0.1, low: 0, high: 0.2 };
  report.seas[0].cycles = [cycle];
  writeFileSync(path, JSON.stringify(report));
  const sight = await Sight.load(t, browser, await view(t, league));
  await sight.page.waitForSelector('#beats .node');
  await sight.page.selectOption('#filter-sea', 'calm');
  await sight.until('the arrows are those of calm water', () => document.querySelectorAll('#beats .arrow').length === 3);
  const arrows = () => sight.get(() => [...document.querySelectorAll('#beats .arrow')].map(({ dataset }) => `${dataset.from} ${dataset.to}`).sort());
  assert.deepEqual(await arrows(), ['idle strategy_4', 'pav01 idle', 'strategy_4 pav01']);
  const upsets = await sight.get(() => document.querySelectorAll('#beats .upset').length);
  assert(upsets === 1 || upsets === 2, 'a cycle contradicts every order');
  await sight.press('.cycles button');
  assert.equal(await sight.get(() => document.querySelectorAll('#beats .arrow.cycle').length), 3);
  assert.equal(await sight.text('.cycles button'), 'strategy 4 → pav01 → idle → strategy 4');
  await sight.page.hover('#beats .node circle');
  assert.equal(await sight.get(() => document.querySelectorAll('#beats .arrow.won').length), 1);
  assert.deepEqual(await sight.get(faint), []);
  // Only games in calm water are listed; all seas have twice as many, and name their sea.
  await sight.press('.matrix button[aria-label^="strategy 4 against pav01:"]');
  const listed = () => sight.get(() => [...document.querySelectorAll('#games tbody tr')].map((row) => row.children[3].textContent));
  assert.equal((await listed()).length, 10);
  await sight.page.selectOption('#filter-sea', '');
  await sight.until('all games are listed', () => document.querySelectorAll('#games tbody tr').length === 20);
  assert.deepEqual([...new Set(await listed())], ['calm', 'moderate breeze']);
  await sight.page.selectOption('#filter-kind', 'planner');
  const names = await sight.get(() => [...document.querySelectorAll('.ratings tbody th')].map((each) => each.textContent));
  assert.deepEqual(names, ['idle']);
  assert.equal(await sight.get(() => document.querySelectorAll('.matrix tbody tr').length), 1);
  await sight.page.reload();
  await sight.until('the address keeps the kind', () => document.querySelectorAll('.ratings tbody tr').length === 1);
});

test('a new league entry plays only its own games, and the folder is shown', async (t) => {
  const { file, place } = await tournament(t);
  const league = join(place, 'league');
  const text = readFileSync(file, 'utf8');
  writeFileSync(file, text.replace(entry('idle'), ''));
  assert.match(await squall(t, 'tournament', file, '--league', league), /0 of 4 games already played/);
  writeFileSync(file, text);
  const said = await squall(t, 'tournament', file, '--league', league);
  assert.match(said, /4 of 12 games already played/);
  assert.match(said, /8 games in/);
  const sight = await Sight.load(t, browser, await view(t, league));
  await sight.until('all three are rated', () => document.querySelectorAll('.ratings tbody tr').length === 3);
});

/** Plays a sweep of short games at two winds with two seeds each. Returns its folder. */
async function sweep(t) {
  const place = folder(t);
  const game = gameFile(t, 'short', 'surveyor_2v2.toml', 'duration_s = 60');
  const file = join(place, 'wind.toml');
  writeFileSync(file, `about = ${JSON.stringify(HOSTILE)}\ngame = "${game}"\nopponent = "${scenario('strategies/strategy_3.toml')}"\ngames = 4\n`
    + `${['strategy_4', 'idle'].map(entry).join('')}[[axis]]\nkey = "sea.wind.speed_m_s"\nvalues = [1, 12]\n`);
  const out = join(place, 'out');
  await squall(t, 'sweep', file, '--out', out);
  return out;
}

test('the worst games of a sweep are watched from its page', async (t) => {
  const out = await sweep(t);
  const [worst] = readJson(join(out, 'report.json')).worst;
  const sight = await Sight.load(t, browser, await view(t, out));
  await sight.page.waitForSelector('#worst-list .watch');
  assert(await isText(sight));
  assert.equal(await sight.text('#facts'), HOSTILE);
  assert.equal(await sight.get(() => getComputedStyle(document.querySelector('.tornado .effect')).position), 'absolute', 'the style sheet is served');
  await sight.press('#worst-list .watch');
  await sight.until('the game is shown', () => window.squall?.mode === 'replay' && squall.frame !== null);
  assert.match(await sight.text('#about'), /strategy 4 \(\w+\) at sea.wind.speed_m_s \d+, seed \d+; rerun, identical to the report/);
  await sight.page.press('#timeline', 'End');
  await sight.until('the replay is at its end', () => squall.t_s > 59.9);
  assert.deepEqual((await sight.get(() => squall.score)).sort(), [...worst.score].sort());
});

test('from a point of a sweep to all its games, to a replay of one, and back', async (t) => {
  const out = await sweep(t);
  // Lines of `games.csv`: each game's result, by its columns.
  const [heads, ...lines] = readFileSync(join(out, 'games.csv'), 'utf8').trim().split('\n').map((line) => line.split(','));
  const games = lines.map((line) => Object.fromEntries(heads.map((head, i) => [head, line[i]])));
  const url = await view(t, out);
  const sight = await Sight.load(t, browser, url);
  await sight.page.waitForSelector('#points-table tbody button');
  assert(!(await sight.page.isVisible('#games')));
  const listed = () => sight.get(() => [...document.querySelectorAll('#games-table tbody tr')].map((row) => [...row.children].map((each) => each.textContent.trim())));
  const result = ({ score, opponent_score }) => (score === opponent_score ? 'drawn' : Number(score) > Number(opponent_score) ? 'won' : 'lost');
  const rows = (of) => of.map((game) => ['Watch', game.entry.replaceAll('_', ' '), game.side, game.seed, `${game.score} : ${game.opponent_score}`, result(game)]);
  const own = games.filter(({ point }) => point === '1');
  assert.equal(own.length, 8);
  await sight.press('button[aria-label="List the games of point 1"]');
  await sight.page.waitForSelector('#games-table tbody tr');
  assert.deepEqual(await listed(), rows(own));
  assert.equal(await sight.text('#games-head'), 'Games at wind speed 12\u202fm/s');
  assert.deepEqual(await sight.get(faint), []);
  await sight.page.selectOption('#games-filter', 'won');
  assert.deepEqual(await listed(), rows(own.filter((game) => result(game) === 'won')));
  await sight.page.selectOption('#games-filter', 'all');
  await sight.press('#entries button >> nth=1');
  assert.deepEqual(await listed(), rows(own.filter((game) => game.entry === 'strategy_4')), 'a hidden entry');

  // The last game has a different seed and side from the point's command.
  await sight.press('#games-table tbody tr:last-child .watch');
  await sight.until('the game is shown', () => window.squall?.mode === 'replay' && squall.frame !== null);
  const last = own.findLast((game) => game.entry === 'strategy_4');
  assert.equal(await sight.text('#about'), `strategy 4 (${last.side}) at sea.wind.speed_m_s 12, seed ${last.seed}; rerun, identical to the report`);
  await sight.page.press('#timeline', 'End');
  await sight.until('the replay is at its end', () => squall.t_s > 59.9);
  assert.deepEqual((await sight.get(() => squall.score)).sort(), [last.score, last.opponent_score].map(Number).sort());
  await sight.press('#back');
  await sight.page.waitForSelector('#games-table tbody tr');
  assert.deepEqual(await listed(), rows(own), 'the list is unchanged');

  for (const none of ['2', '-1', 'x', '']) {
    const answer = await fetch(new URL(`/sweep_games/${none}.json`, url));
    assert.equal(answer.status, 404, none);
  }
  // Without the table, games are listed without results; without the plan, none are listed.
  rmSync(join(out, 'games.csv'));
  const bare = await Sight.load(t, browser, `${await view(t, out)}#point=0`);
  await bare.page.waitForSelector('#games-table .watch');
  assert.match(await bare.text('#games-note'), /8 games of point 0\..*unknown: cannot read .*games\.csv/);
  rmSync(join(out, 'plan.json'));
  const without = await Sight.load(t, browser, `${await view(t, out)}#point=0`);
  await without.page.waitForSelector('#points-table tbody button');
  assert.equal(await without.get(() => document.querySelectorAll('.watch, button[aria-label^="List"]').length), 0);
});

/** Writes a training run of invented numbers, which improve from stage to stage. `more` is added to the reward, to tell runs apart. */
function trainingRun(place, more = 0) {
  mkdirSync(join(place, 'games'), { recursive: true });
  const updates = [...Array(50).keys()].map((i) => `${(i + 1) * 20000},${i < 20 ? 'alone' : 'against'},${i / 10 + more},0.1,${i < 3 ? '' : 2 - i / 50},1.5,0.01,0.1,4,${i / 100}`);
  writeFileSync(join(place, 'updates.csv'), `samples,stage,reward,policy_loss,value_loss,entropy,divergence,clipped,epochs,explained_variance\n${updates.join('\n')}\n99`);
  // The first tenth of the samples takes half the time.
  writeFileSync(join(place, 'times.csv'), `samples,elapsed_s\n${[...Array(50).keys()].map((i) => `${(i + 1) * 20000},${i < 5 ? 720 * (i + 1) : 3600 + 80 * (i - 4)}`).join('\n')}\n`);
  writeFileSync(join(place, 'evaluations.csv'), 'samples,stage,opponent,won,drawn,lost,points,points_against,left_field,best\n'
    + '500000,alone,pav01,5,5,10,3.5,6.25,0.5,true\n500000,alone,<b>x</b>,20,0,0,9,1,0,true\n1000000,against,pav01,12,2,6,8,5,0.1,false\n1000000,against,<b>x</b>,10,0,10,4,4,0,false\n');
  writeFileSync(join(place, 'episodes.csv'), 'samples,stage,seed,team,opponent,points,points_against,steps,cut_off,recording\n'
    + `20000,alone,6,0,pav01,1,2,300,false,\n40000,alone,9007199254740993,0,pav01,3,2,300,false,games/7_1.mcap\n`);
  writeFileSync(join(place, 'run.json'), '{"samples": 4000000, "seed": "9007199254740993", "game": "pav01_afloat", "sea": "gale"}');
  writeFileSync(join(place, 'best.toml'), '');
}

/** The text that screen readers read for a curve. */
const curve = (sight, title) => sight.until(`the curve ${title} is drawn`, (title) => [...document.querySelectorAll('.card:not([hidden]) .curve')]
  .map(({ ariaLabel }) => ariaLabel).find((text) => text?.startsWith(title)), title);

test('a training run shows curves that follow its tables, and its recorded episodes', async (t) => {
  const place = join(folder(t), 'first_steps');
  trainingRun(place);
  await squall(t, 'run', gameFile(t, 'short', 'pav01_vs_pav01.toml', 'duration_s = 60'), '--in-process', '--record', place);
  copyFileSync(join(place, readdirSync(place).find((name) => name.endsWith('.mcap'))), join(place, 'games/7_1.mcap'));
  const url = await view(t, place);
  const sight = await Sight.load(t, browser, url);
  assert.match(await curve(sight, 'Win rate'), /at the end: pav01 65, <b>x<\/b> 50\./);
  for (const title of ['Mean reward', 'Policy loss', 'Value loss', 'Entropy', 'KL divergence', 'Explained variance', 'Clip fraction', 'Samples per second']) await curve(sight, title);
  assert.deepEqual(await sight.get(faint), []);
  await sight.page.focus('.card .curve');
  await sight.keys('ArrowLeft', 'ArrowLeft');
  // All charts follow the cursor.
  assert.match(await curve(sight, 'Win rate'), /at 0\.50 million samples: pav01 38, <b>x<\/b> 100\./);
  assert.match(await curve(sight, 'Explained variance'), /at 0\.50 million samples/);
  const painted = await sight.get(() => {
    const canvas = document.querySelector('.card canvas');
    return new Set(new Uint32Array(canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height).data.buffer)).size;
  });
  assert(painted > 6, `the curves have only ${painted} colours`);
  assert.equal(await sight.get(() => document.querySelector('b:not(.legend b)')), null, 'names are inserted as text');
  assert.deepEqual(await sight.get(() => [...document.querySelectorAll('#episodes tbody td')].map((each) => each.textContent)),
    ['Watch', '0.04 M', 'alone', 'pav01', '9007199254740993', '3 : 2', '300']);
  await sight.press('#episodes .watch');
  await sight.until('the episode is shown', () => window.squall?.mode === 'replay' && squall.frame !== null);
  for (const escape of ['../7_1.mcap', '..%2fupdates.csv', 'none.mcap', '/etc/passwd', 'games/7_1.mcap']) {
    const none = await Sight.load(t, browser, `${url}?game=${encodeURIComponent(escape)}`);
    await none.until('the game is refused', () => /there is no recording/.test(document.getElementById('about').textContent));
  }
});

test('two training runs are compared over samples or hours, smoothed, with the best policy and the command that plays it', async (t) => {
  const runs = folder(t);
  const place = join(runs, 'first');
  trainingRun(place);
  trainingRun(join(runs, 'second'), 100);
  const url = await view(t, place);
  const sight = await Sight.load(t, browser, url, { permissions: ['clipboard-read', 'clipboard-write'] });
  const row = (i) => sight.get((i) => [...document.querySelectorAll('#best tbody tr')[i].children].map((each) => each.textContent), i);
  await sight.page.waitForSelector('#best tbody tr');
  assert.deepEqual(await row(0), ['first', 'stopped', '1.00 M', '2 h 00 min', '139 samples/s', '★ 69 %', '0.50 M', '9007199254740993']);
  assert.deepEqual([await sight.text('#state'), await sight.text('#facts')], ['stopped', '1.00 of 4.00 million samples (25 %) · stage against · 139 samples/s · 2 h 00 min']);
  assert.deepEqual(await sight.get(() => [...document.querySelectorAll('tr.best')].map((each) => each.children[2].textContent)), ['<b>x</b>', 'pav01']);
  const command = await sight.text('.command code');
  assert.match(command, /^squall run pav01_afloat --sea gale --blue \/.*\/first\/best\.toml$/);
  await sight.press('.command button');
  await sight.until('it is copied', () => document.querySelector('.command button').textContent === 'Copied');
  assert.equal(await sight.get(() => navigator.clipboard.readText()), command);

  // The smoothing of TensorBoard: an exponential average, corrected for its start.
  const reward = async () => Number((await curve(sight, 'Mean reward')).match(/at the end: (?:\w+ )?(\d+\.\d+)/)[1]);
  const average = (weight) => [...Array(50).keys()].reduce((sum, i) => weight * sum + (1 - weight) * (i / 10), 0) / (1 - weight ** 50);
  for (const weight of [0.6, 0, 0.9]) {
    await sight.page.fill('#smoothing', String(weight));
    assert.equal(await reward(), Number(average(weight).toFixed(2)), `smoothing ${weight}`);
  }

  await sight.page.selectOption('#other-run', { label: 'second' });
  await sight.until('both runs are shown', () => document.querySelectorAll('#best tbody tr').length === 2);
  assert.deepEqual((await row(1)).slice(0, 2), ['second', 'stopped']);
  assert.match(await curve(sight, 'Mean reward'), /at the end: first 4, second 104\./);
  assert.match(await curve(sight, 'Win rate'), /pav01 · first 65, <b>x<\/b> · first 50, pav01 · second 65, /);
  assert.deepEqual(await sight.get(faint), []);
  await sight.page.selectOption('#axis', 'hours');
  await sight.page.focus('.card .curve');
  await sight.keys('ArrowLeft', 'ArrowLeft');
  assert.match(await curve(sight, 'Mean reward'), /at 1\.44 hours/, 'half of the samples');
  // The address contains the other run, and the browser stores the other choices.
  await sight.page.reload();
  await sight.until('both runs are shown again', () => document.querySelectorAll('#best tbody tr').length === 2);
  assert.deepEqual(await sight.get(() => [document.getElementById('axis').value, document.getElementById('smoothing').value]), ['hours', '0.9']);
  for (const none of ['', '2e2e', '..', '6e6f6e65']) assert.equal((await fetch(new URL(`/training_run/${none}.json`, url))).status, 404, none);
  for (const size of [{ width: 390, height: 844 }, { width: 844, height: 390 }]) {
    await sight.page.setViewportSize(size);
    assert(await sight.get(() => document.documentElement.scrollWidth <= innerWidth), `wider than ${size.width}`);
  }
  // A run of an earlier version has neither times nor a plan.
  for (const name of ['times.csv', 'run.json']) rmSync(join(runs, 'second', name));
  await sight.page.reload();
  await sight.until('hours are not offered', () => document.getElementById('axis').options[1]?.disabled === true);
});

test('a training run is shown as running while it runs', async (t) => {
  const place = join(folder(t), 'run');
  const training = new Program(t, 'train', scenario('training/first.toml'), '--out', place, '--jobs', '1');
  await until('it has learned', () => existsSync(join(place, 'times.csv')) && readFileSync(join(place, 'times.csv'), 'utf8').split('\n').length > 3);
  const sight = await Sight.load(t, browser, await view(t, place));
  await sight.until('it runs', () => document.getElementById('state').textContent === 'running');
  assert.match(await sight.text('#facts'), /of 2\.30 million samples \(\d %\) · stage nobody in the way · [\d,]+ samples\/s · .*about .* left/);
  await training.end();
  await sight.until('it is stopped', () => document.getElementById('state').textContent === 'stopped');
});
