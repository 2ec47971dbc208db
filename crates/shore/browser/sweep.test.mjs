// The report of a sweep on the page.

import assert from 'node:assert/strict';
import { writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { Program, Sight, folder, gameFile, openBrowser, readJson, scenario, squall } from './harness.mjs';

let browser;
before(async () => { browser = await openBrowser(); });
after(() => browser.close());

/** Would change the page's title if it ever ran. */
const HOSTILE = '</script><script>document.title = "owned"</script><img src=x onerror="document.title=\'owned\'">';

/** Plays a sweep of short games: two entries, and two axes with two and three levels unless `more` has others. */
async function sweep(t, more = '') {
  const place = folder(t);
  const game = gameFile(t, 'short', 'surveyor_2v2.toml', 'duration_s = 60');
  const entry = (name) => `[[entry]]\nname = "${name}"\nstrategy = "${scenario(`strategies/${name}.toml`)}"\n`;
  const axes = more || '[[axis]]\nkey = "sea.wind.speed_m_s"\nvalues = [1, 12]\n'
    + '[[axis]]\nkey = "boat.gps.noise_m"\nrange = [0.1, 10]\nlog = true\ncount = 3\n';
  const file = join(place, 'short.toml');
  writeFileSync(file, `about = ${JSON.stringify(HOSTILE)}\ngame = "${game}"\nopponent = "${scenario('strategies/strategy_3.toml')}"\ngames = 10\n`
    + `${entry('strategy_4')}${entry('strategy_5')}${axes}`);
  const out = join(place, 'out');
  await squall(t, 'sweep', file, '--out', out, '--jobs', '2');
  return { out, report: readJson(join(out, 'report.json')) };
}

/** Opens the report in a folder, or a modified one. */
async function open(t, { out }, { report = null, hash = '', ...more } = {}) {
  if (report) writeFileSync(join(out, 'report.json'), JSON.stringify(report));
  const url = await new Program(t, 'view', out, '--listen', '127.0.0.1:0').url();
  const permissions = ['clipboard-read', 'clipboard-write'];
  const { page } = await Sight.load(t, browser, `${url}${hash}`, { size: { width: 1400, height: 900 }, permissions, ...more });
  await page.waitForSelector('#points-table tbody tr');
  return page;
}

/** A name as the pages show it. */
const spelled = (name) => name.replaceAll('_', ' ');
/** The index of a metric, and how the page writes its values. */
const metric = (report, name) => report.metrics.findIndex((each) => each.name === name);
const percent = (mean) => `${Number((100 * mean).toPrecision(3))}`.replace('-', '−');

test('the page of a sweep shows the report as curves, a heat map and a tornado chart', async (t) => {
  const played = await sweep(t);
  const { report } = played;
  const page = await open(t, played);
  assert.equal(await page.title(), `${report.sweep} – Squall`);
  assert.equal(await page.textContent('#facts'), HOSTILE);
  assert.equal(await page.textContent('#state'), `all ${report.games} games played`);

  assert.match(await page.innerText('#sweep-facts'), /Opponent\s+strategy 3/);
  const charts = page.locator('#curve-charts .card');
  assert.equal(await charts.count(), report.axes.length);
  for (const [axis, key] of report.axes.entries()) {
    const lines = charts.nth(axis).locator('path.line');
    assert.equal(await charts.nth(axis).getAttribute('data-axis'), key);
    assert.deepEqual(await lines.evaluateAll((all) => all.map((line) => line.dataset.entry)), report.entries.map(spelled));
    const corners = await lines.evaluateAll((all) => all.map((line) => line.getAttribute('d').match(/[ML]/g).length));
    assert.deepEqual(corners, report.entries.map(() => report.effects[axis * report.entries.length].levels.length));
    assert.equal(await charts.nth(axis).locator('path.band').count(), report.entries.length);
  }
  assert.equal(await charts.nth(1).locator('.scale').textContent(), 'logarithmic scale');

  const wins = metric(report, 'win_share');
  const cells = await page.locator('#heat-charts .card').first().locator('tbody td').allTextContents();
  assert.deepEqual(cells, report.points.map((point) => percent(point.entries[0].metrics[wins].mean)));
  await page.selectOption('#heat-rows', '1');
  assert.equal(await page.locator('#heat-charts .card').first().locator('tbody tr').count(), 3);

  for (const [i, entry] of report.entries.entries()) {
    const tornado = page.locator('#tornado-charts .card').nth(i);
    assert.equal(await tornado.locator('.effect').count(), report.axes.length);
    const means = report.effects.filter((effect) => effect.entry === entry).map((effect) => [effect.axis, Math.abs(effect.contrasts[wins].mean)]);
    const sorted = means.sort(([, a], [, b]) => b - a).map(([key]) => key);
    assert.deepEqual(await tornado.locator('li').evaluateAll((all) => all.map((row) => row.dataset.axis)), sorted);
  }
});

test('axes and metrics have titles and units, and the page can be switched to dark', async (t) => {
  const played = await sweep(t);
  const { report } = played;
  // The meanings come from the reference of scenario files.
  assert.deepEqual(report.axis_meanings, ['Mean speed at 10 m height, m/s.', 'Standard deviation of white noise, per axis, m.']);
  const faults = { ...report, axes: ['sea.wind.speed_m_s', 'fault.link.every_s'], axis_meanings: [report.axis_meanings[0], 'Instead of `at_s`: mean time to the next fault, s.'] };
  const page = await open(t, played, { report: faults });
  const cards = page.locator('#curve-charts .card');
  assert.deepEqual(await cards.locator('h3').allTextContents(), ['Wind speed (m/s) ', 'Fault link every (s) logarithmic scale']);
  assert.deepEqual(await cards.locator('.about-axis').allTextContents(), ['Mean speed at 10 m height sea.wind.speed_m_s', 'Mean time to the next fault fault.link.every_s']);
  const metrics = await page.locator('#metric option').allTextContents();
  assert.deepEqual([metrics[0], metrics[8], metrics[13]], ['Games won (%)', 'Time tagged (s)', 'Opponent: points']);
  assert.deepEqual(metrics.filter((text) => text.includes('_')), []);
  // No fraction lies beyond 0 to 100 %.
  const shares = await page.locator('#points-table td.estimate small').allTextContents();
  const numbers = shares.flatMap((text) => text.replaceAll('−', '-').match(/-?[\d.]+/g).map(Number));
  assert(numbers.length > 0 && numbers.every((each) => each >= 0 && each <= 100), numbers.join());

  const paper = () => page.evaluate(() => getComputedStyle(document.body).backgroundColor);
  const light = await paper();
  await page.click('#dark');
  const dark = await paper();
  assert.notEqual(dark, light);
  await page.reload();
  assert.equal(await paper(), dark, 'the browser remembers it');
  await page.click('#dark');
  assert.equal(await paper(), light);
  await page.emulateMedia({ colorScheme: 'dark' });
  // Without a choice, the theme follows the system.
  await page.waitForFunction((dark) => getComputedStyle(document.body).backgroundColor === dark, dark);
});

test('the chosen metric changes every chart, and a hidden entry disappears from them', async (t) => {
  const played = await sweep(t);
  const { report } = played;
  const page = await open(t, played);
  const places = ['#curve-charts', '#heat-charts', '#tornado-charts', '#differences-table', '#points-table'];
  const shown = () => Promise.all(places.map((place) => page.innerHTML(place)));
  const before = await shown();
  await page.selectOption('#metric', 'distance_m');
  (await shown()).forEach((now, i) => assert.notEqual(now, before[i], `${places[i]} stays as it was`));
  const { mean } = report.points[0].entries[0].metrics[metric(report, 'distance_m')];
  assert((await page.textContent('#points-table tbody td.estimate')).startsWith(mean >= 100 ? mean.toFixed(0) : `${Number(mean.toPrecision(3))}`));
  await page.reload();
  assert.equal(await page.inputValue('#metric'), 'distance_m', 'the address keeps the metric');

  await page.click('#entries button >> nth=0');
  assert.equal(await page.locator('#curve-charts .card >> nth=0 >> path.line').count(), report.entries.length - 1);
  assert.equal(await page.locator('#tornado-charts .card').count(), report.entries.length - 1);
  // No metric causes an error: at the end the console must be empty.
  for (const { name } of report.metrics) await page.selectOption('#metric', name);
});

test('the values of a level are shown by pointer and by keyboard', async (t) => {
  const played = await sweep(t);
  const { report } = played;
  const page = await open(t, played);
  const card = page.locator('#curve-charts .card').first();
  const { levels } = report.effects[0];
  const wins = metric(report, 'win_share');
  const has = async (level, box) => {
    const text = await box.textContent();
    assert(text.includes(percent(levels[level].metrics[wins].mean)), `level ${level}: ${text}`);
  };
  const box = card.locator('.values');
  assert(!(await box.isVisible()));
  const { x, y, width } = await card.locator('.chart').boundingBox();
  await page.mouse.move(x + width - 40, y + 60);
  assert(await box.isVisible());
  await has(1, box);
  await page.mouse.move(5, 5);
  assert(!(await box.isVisible()));
  await card.locator('.chart').focus();
  await has(0, box);
  await page.keyboard.press('ArrowRight');
  await has(1, box);
  assert((await page.textContent('#said')).includes(spelled(report.entries[1])));
  await page.keyboard.press('Escape');
  assert(!(await box.isVisible()));
});

test('a copied command is the command in the report', async (t) => {
  const played = await sweep(t);
  const { report } = played;
  const page = await open(t, played);
  const copied = () => page.evaluate(() => navigator.clipboard.readText());
  const rows = page.locator('#points-table tbody tr');
  assert.equal(await rows.count(), report.points.length);
  for (const at of [0, report.points.length - 1]) {
    await rows.nth(at).getByRole('button', { name: 'Copy' }).click();
    await page.waitForFunction((at) => document.querySelectorAll('#points-table .command button')[at].textContent === 'Copied', at);
    assert.equal(await copied(), report.points[at].command);
    assert.equal(await rows.nth(at).locator('code').textContent(), report.points[at].command);
  }
  const games = page.locator('#worst-list .game');
  assert.equal(await games.count(), report.worst.length);
  await games.last().getByRole('button').click();
  await page.waitForFunction(() => [...document.querySelectorAll('#worst-list button')].at(-1).textContent === 'Copied');
  assert.equal(await copied(), report.worst.at(-1).command);
});

test('the points are sorted by the column pressed', async (t) => {
  const played = await sweep(t);
  const { report } = played;
  const page = await open(t, played, { hash: '#metric=distance_m' });
  const column = page.getByRole('columnheader', { name: spelled(report.entries[1]) }).last().getByRole('button');
  const order = () => page.locator('#points-table tbody th').evaluateAll((all) => all.map((head) => Number(head.textContent)));
  const mean = (point) => report.points[point].entries[1].metrics[metric(report, 'distance_m')].mean;
  const rising = report.points.map((_, point) => point).sort((a, b) => mean(a) - mean(b));
  await column.click();
  assert.deepEqual(await order(), rising);
  await column.click();
  assert.deepEqual(await order(), rising.toReversed());
});

test('texts in a report are inserted as text, never as script', async (t) => {
  const played = await sweep(t);
  const { report } = played;
  const command = `squall run '${HOSTILE}'`;
  const hostile = { ...report, entries: report.entries.map(() => HOSTILE), axes: report.axes.map((key) => `${key}${HOSTILE}`),
    failures: Array.from({ length: 30 }, (_, game) => ({ game, why: HOSTILE, command })) };
  const page = await open(t, played, { report: hostile });
  assert.equal(await page.title(), `${report.sweep} – Squall`);
  assert.equal(await page.locator('img').count(), 0);
  const cards = page.locator('#failures-list .game');
  assert.equal(await cards.count(), 20, 'a page of them');
  assert.equal(await cards.first().locator('.why').textContent(), HOSTILE);
  assert.equal(await cards.first().locator('code').textContent(), command);
  await page.getByRole('navigation', { name: 'Pages of failures' }).getByRole('button', { name: 'Next' }).click();
  assert.equal(await cards.count(), 10);
  assert.match(await page.textContent('#remarks'), /30 games could not start/);
});

test('an unfinished sweep says so, and shows its results so far', async (t) => {
  const played = await sweep(t);
  const { report } = played;
  const none = (list) => list.map(() => null);
  const point = (each, i) => (i < 3 ? each : { ...each, seeds: 0, entries: each.entries.map((one) => ({ ...one, metrics: none(one.metrics) })),
    differences: each.differences.map((one) => ({ ...one, metrics: none(one.metrics) })) });
  const level = (each, i) => (i === 0 ? each : { ...each, metrics: none(each.metrics) });
  const effects = report.effects.map((effect) => ({ ...effect, contrasts: none(effect.contrasts), levels: effect.levels.map(level) }));
  const unfinished = { ...report, games_done: report.games / 2, points: report.points.map(point), interactions: [], effects };
  const page = await open(t, played, { report: unfinished, size: { width: 390, height: 844 } });
  const [name, dark] = await Promise.all(['#name', '#dark'].map((each) => page.locator(each).boundingBox()));
  assert(name.height < 40 && dark.x + dark.width <= 390, `the title on a phone: ${JSON.stringify({ name, dark })}`);
  assert.match(await page.textContent('#state'), new RegExp(`not finished: ${report.games / 2} of ${report.games} games`));
  assert.equal(await page.locator('#heat-charts .card >> nth=0 >> td.none').count(), report.points.length - 3);
  assert.equal(await page.locator('#tornado-charts .effect').count(), 0);
  assert(!/NaN|undefined|null|Infinity/.test(await page.innerText('body')), 'an invalid number');
});

test('the page fits screens from a phone to a desk', async (t) => {
  const files = ['strategy_3', 'strategy_4_assigned'].map((name) => scenario(`strategies/${name}.toml`));
  const axes = `[[axis]]\nkey = "opponent"\nvalues = ${JSON.stringify(files)}\n`;
  const played = await sweep(t, axes);
  for (const [width, height] of [[390, 844], [1400, 900], [1920, 1080]]) {
    for (const colorScheme of ['light', 'dark']) {
      const page = await open(t, played, { size: { width, height }, colorScheme });
      assert(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth), `wider than ${width}`);
      assert(!(await page.isVisible('#heat')), 'one axis has no heat map');
    }
  }
});
