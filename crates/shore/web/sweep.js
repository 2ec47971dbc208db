// The report of a sweep: curves, heat maps, effects, differences and interactions of its axes, its points, and games, which can be watched.

import { addressOfGame, keepAddress } from './address.js';
import { commandOf } from './command.js';
import { ticksOf } from './diagram.js';
import { palette } from './palette.js';
import { scrolled, tableOf } from './table.js';
import { make, plain, significant, stem, svg } from './words.js';

/** Constant parts. Strings from a report only ever become text nodes. */
const SECTIONS = `
  <dl id="sweep-facts"></dl>
  <div class="bar">
    <label id="metric-label">Metric <select id="metric"></select></label>
    <p id="about-metric"></p>
    <div id="entries" role="group" aria-label="Entries"></div>
  </div>
  <section id="curves" aria-labelledby="curves-head">
    <h2 id="curves-head">Each axis</h2>
    <p class="faint" id="curves-note"></p>
    <div class="charts" id="curve-charts"></div>
  </section>
  <section id="heat" aria-labelledby="heat-head">
    <h2 id="heat-head">Two axes together</h2>
    <p class="faint" id="heat-note"></p>
    <div id="heat-body">
      <div class="choose">
        <label>Rows <select id="heat-rows"></select></label>
        <label>Columns <select id="heat-columns"></select></label>
      </div>
      <div id="heat-scale"><span id="heat-low"></span><i aria-hidden="true"></i><span id="heat-high"></span></div>
      <div class="charts wide" id="heat-charts"></div>
    </div>
  </section>
  <section id="tornado" aria-labelledby="tornado-head">
    <h2 id="tornado-head">Effect of each axis</h2>
    <p class="faint" id="tornado-note"></p>
    <div class="charts" id="tornado-charts"></div>
  </section>
  <section id="differences" aria-labelledby="differences-head">
    <h2 id="differences-head">Differences between entries</h2>
    <div id="differences-note"></div>
    <div id="differences-table"></div>
  </section>
  <section id="interactions" aria-labelledby="interactions-head">
    <h2 id="interactions-head">Significant interactions</h2>
    <div id="interactions-note"></div>
    <div class="charts" id="interactions-list"></div>
    <div id="interactions-pages"></div>
  </section>
  <section id="points" aria-labelledby="points-head">
    <h2 id="points-head">All points</h2>
    <p class="faint" id="points-note"></p>
    <div id="points-table"></div>
  </section>
  <section id="games" aria-labelledby="games-head" hidden>
    <h2 id="games-head" tabindex="-1"></h2>
    <p class="faint" id="games-note"></p>
    <div class="choose"><label>Show <select id="games-filter"></select></label></div>
    <div id="games-table"></div>
  </section>
  <section id="worst" aria-labelledby="worst-head">
    <h2 id="worst-head">Worst games</h2>
    <p class="faint" id="worst-note">The games that each entry did not win, lowest score difference first, regardless of the selected metric.</p>
    <div id="worst-list"></div>
  </section>
  <section id="failures" aria-labelledby="failures-head">
    <h2 id="failures-head">Games that could not start</h2>
    <div id="failures-list"></div>
  </section>
  <p id="said" class="hidden-text" aria-live="polite"></p>
`;

let report = null;
/** Whether games of the report can be watched. */
let isPlayable = false;

export class Sweep {
  constructor(place) {
    place.classList.add('sweep');
    place.innerHTML = SECTIONS;
  }

  /** Whether more data may come: never, because the report is complete. */
  get goesOn() {
    return false;
  }

  tell(told) {
    ({ report, playable: isPlayable } = told);
    report.entries = report.entries.map(plain);
    for (const one of [...report.worst, ...report.interactions]) one.entry = plain(one.entry);
    axisTitles = report.axes.map((key, axis) => titleOf(key, report.axis_meanings?.[axis]));
    axisDigits = report.axes.map((_, axis) => digitsFor(axis));
    keepAddress();
    drawFacts();
    drawChooser();
    makeCurves();
    makeHeat();
    draw();
    makeGames();
    drawFailures();
    let width = innerWidth;
    addEventListener('resize', () => {
      // The keyboard of a phone changes only the height.
      if (innerWidth === width) return;
      width = innerWidth;
      requestAnimationFrame(() => drawCurves());
    });
    addEventListener('beforeprint', () => drawCurves(PRINTED_WIDTH));
    addEventListener('afterprint', () => drawCurves());
    const { games, games_done: done, failures } = report;
    const chip = done < games ? [`not finished: ${done} of ${games} games played`, 'warn'] : [`all ${games} games played`, 'good'];
    return { name: report.sweep, facts: report.about, chip, remarks: [failures.length > 0 ? `${failures.length} games could not start.` : ''] };
  }

  /** There is nothing to redraw: the style sheets define the colours. */
  draw() {}
}

/* Elements */

const byId = (id) => document.getElementById(id);

/** A name that may be broken after dots, dashes and underscores. */
const soft = (text) => text.split(/(?<=[._/-])(?=\D..)/).flatMap((part, i) => (i === 0 ? [part] : [make('wbr'), part]));

function say(text) {
  byId('said').textContent = text;
}

/* Titles and units: of axes from the reference of scenario files, of metrics from their names. */

/** Suffixes of names that are units. */
const UNIT_SUFFIX = /_(m_s2?|rad_s2?|deg_s|m2|m|s|rad|deg|kn|nmi|kg|newton_m|newton|hz|kj|wh|pct|km)$/;
/** Units where a report has no meanings. */
const UNITS = { m_s: 'm/s', m_s2: 'm/s²', rad_s: 'rad/s', rad_s2: 'rad/s²', deg_s: '°/s', deg: '°', m2: 'm²', newton: 'N', newton_m: 'N m', hz: 'Hz', kj: 'kJ', wh: 'W h', pct: '%' };
const SPELLINGS = { gps: 'GPS', imu: 'IMU', hs: 'significant height', tp: 'peak period', rpm: 'RPM' };
const capital = (text) => text.charAt(0).toUpperCase() + text.slice(1);
const words = (name) => name.replace(UNIT_SUFFIX, '').split('_').map((word) => SPELLINGS[word] ?? word).join(' ');

/** The parts of an axis's title, from its key and from its meaning in the reference, such as `Mean speed at 10 m height, m/s.` */
function titleOf(key, meaning) {
  const [kind, ...path] = key.split('.');
  // The title of a key omits its kind of file, but not `link` or `fault`.
  const parts = path.length > 0 && ['sea', 'boat', 'rules', 'game', 'field', 'strategy'].includes(kind) ? path.filter((part) => part !== 'behaviour') : [kind, ...path];
  const sentence = (meaning ?? '').replace(/^Instead of [^:]*: /, '').split(/\. |\.$/)[0];
  const suffix = UNIT_SUFFIX.exec(key)?.[1];
  const unit = suffix ? /, ([^,]{1,12})$/.exec(sentence)?.[1] ?? (UNITS[suffix] ?? suffix) : '';
  const about = capital(sentence.endsWith(`, ${unit}`) ? sentence.slice(0, -unit.length - 2) : sentence);
  return { title: capital(parts.map(words).join(' ')), unit: unit.replace(/^degrees/, '°'), about };
}
const withParentheses = (title, unit) => (unit ? `${title} (${unit})` : title);
let axisTitles = [];
/** The title of an axis with its unit. */
const axisName = (axis) => withParentheses(axisTitles[axis].title, axisTitles[axis].unit);
const lower = (title) => (/^.[A-Z]/.test(title) ? title : title.charAt(0).toLowerCase() + title.slice(1));
/** A value of an axis with its title and unit, as in `wind speed 12 m/s`. */
const axisValue = (axis, value) => `${lower(axisTitles[axis].title)} ${valueText(axis, value)}${axisTitles[axis].unit ? `${NARROW}${axisTitles[axis].unit}` : ''}`;

const METRIC_TITLES = { win_share: 'Games won', score: 'Points', tagged_s: 'Time tagged', outside_s: 'Time outside the field', edge_m: 'Distance from the edge',
  closest_m: 'Closest approach', score_difference: 'Points ahead', energy_kj: 'Energy drawn', distance_m: 'Distance travelled' };
const unitOf = ({ name, unit }) => (name.endsWith('_share') ? '%' : unit);

/** The title of a metric. */
function metricTitle({ name }) {
  const own = name.replace(/^opponent_/, '');
  const title = METRIC_TITLES[own] ?? capital(words(own));
  return own === name ? title : `Opponent: ${lower(title)}`;
}
const metricNow = () => metricTitle(report.metrics[state.metric]);

/* Numbers as people read them. */

const NONE = '\u2013';
const NARROW = '\u202f';
const isShare = () => report.metrics[state.metric].name.endsWith('_share');
const unit = () => unitOf(report.metrics[state.metric]);
const withUnit = (text) => (text === NONE || unit() === '' ? text : `${text}${NARROW}${unit()}`);
const bare = (x) => significant(typeof x === 'number' ? x * (isShare() ? 100 : 1) : x);
/** A number of the chosen metric, with its unit. */
const shown = (x) => withUnit(bare(x));
/** The same with its sign: a difference. */
const signed = (x) => (x > 0 ? '+' : '') + shown(x);
/** Minimum number of seeds for intervals in a report: as in crates/experiment/src/estimate.rs. */
const SEEDS_MIN = 5;
const hasIntervals = () => report.games_per_point >= 2 * SEEDS_MIN;
const isBounded = (estimate) => Number.isFinite(estimate?.low) && Number.isFinite(estimate?.high);

/** The interval of an estimate. Fractions are clamped to 0 to 1, and differences of two to at least -1. */
function interval(estimate, least = 0) {
  if (!estimate) return '';
  const [low, high] = isShare() ? [Math.max(least, estimate.low), Math.min(1, estimate.high)] : [estimate.low, estimate.high];
  if (isBounded(estimate)) return `${bare(low)} to ${shown(high)}`;
  return hasIntervals() ? 'no interval: fewer than five seeds' : '';
}

/** An estimate on two lines of a table. */
const twoLines = (estimate, of = shown) =>
  estimate ? [of(estimate.mean), interval(estimate) && make('small', '', interval(estimate, of === shown ? 0 : -1))] : [NONE];

/** A value of an axis: numbers with enough digits to distinguish its levels. */
function valueText(axis, text) {
  const value = Number(text);
  return text.trim() === '' || !Number.isFinite(value) ? text : significant(value, axisDigits[axis]);
}

function digitsFor(axis) {
  const labels = levelsOf(axis).map((level) => level.label);
  const values = labels.map(Number);
  if (values.some((value) => !Number.isFinite(value))) return 3;
  const wanted = new Set(values).size;
  for (let digits = 3; digits < 9; digits += 1) {
    if (new Set(values.map((value) => significant(value, digits))).size === wanted) return digits;
  }
  return 9;
}

/* The data of the report. */

const effectOf = (axis, entry) => report.effects[axis * report.entries.length + entry];
const levelsOf = (axis) => effectOf(axis, 0)?.levels ?? [];
const isSampled = () => report.design === 'sobol' || report.design === 'latin_hypercube';
/** The axes with more than one level: those with one are settings and have no effect. */
function variedAxes() {
  const all = report.axes.map((_, axis) => axis);
  const varied = all.filter((axis) => levelsOf(axis).length !== 1);
  return varied.length > 0 ? varied : all;
}
const metricOf = (list) => list?.[state.metric] ?? null;
const noneYet = () => (report.games_done < report.games ? 'none yet' : 'none');
const entriesShown = () => report.entries.map((_, entry) => entry).filter((entry) => !state.hidden.has(entry));
const DESIGNS = { grid: 'grid', one_at_a_time: 'one at a time', latin_hypercube: 'Latin hypercube', sobol: 'Sobol sequence' };

const state = { metric: 0, hidden: new Set(), rows: 0, columns: 1, pages: {}, sort: null, onlySure: false, point: null, games: null };
let axisDigits = [];

/* Tables. */

const columnHead = (children, isNumber, more = {}) => make('th', { scope: 'col', class: isNumber ? 'number' : null, ...more }, '', children);
const pointHead = (index) => make('th', { scope: 'row', class: 'number' }, String(index));
const estimateCell = (estimate) => make('td', 'estimate', '', twoLines(estimate));
const isOfNumbers = (axis) => levelsOf(axis).every((level) => level.value !== null);
const axisHeads = () => report.axes.map((_, axis) => columnHead(soft(axisName(axis)), isOfNumbers(axis)));
const valueCells = (values) => values.map((value, axis) =>
  make('td', { class: isOfNumbers(axis) ? 'value number' : 'value' }, '', soft(valueText(axis, value))));

/* Entries: a colour, a dash and a mark each. */

const DASHES = ['', '7 4', '2 4', '10 4 2 4'];
const MARKS = [
  (x, y) => `M${x - 4.5} ${y}a4.5 4.5 0 1 0 9 0a4.5 4.5 0 1 0 -9 0z`,
  (x, y) => `M${x - 4} ${y - 4}h8v8h-8z`,
  (x, y) => `M${x} ${y - 5.5}l5.5 9.5h-11z`,
  (x, y) => `M${x} ${y - 5.8}l5.8 5.8l-5.8 5.8l-5.8 -5.8z`,
  (x, y) => `M${x} ${y + 5.5}l5.5 -9.5h-11z`,
];
const entryClass = (entry) => `entry-${entry % 4}`;
const dashOf = (entry) => DASHES[Math.floor(entry / 4) % DASHES.length] || null;
const markOf = (entry, x, y) => svg('path', { class: `mark ${entryClass(entry)}`, d: MARKS[entry % MARKS.length](x, y) });
const sampleOf = (entry) => svg('svg', { width: 30, height: 14, 'aria-hidden': 'true', class: entryClass(entry) },
  svg('path', { class: 'sample', d: 'M0 7H30', 'stroke-dasharray': dashOf(entry) }), markOf(entry, 15, 7));
const entryHead = (entry) => make('h3', '', '', sampleOf(entry), ' ', soft(report.entries[entry]));

/* Head */

/** The first seed as text, because JavaScript numbers cannot represent all seeds. */
const firstSeed = () => /--seed (\d+)$/.exec(report.points[0]?.command ?? '')?.[1] ?? String(report.seed);

function drawFacts() {
  const { games, games_done: done, points } = report;
  const seeds = report.games_per_point / 2;
  const last = BigInt(firstSeed()) + BigInt(Math.max(1, Math.round(seeds))) - 1n;
  const axis = (key, i) => {
    const levels = levelsOf(i);
    const labels = levels.map((level) => valueText(i, level.label));
    let what = labels.length > 5 ? `${labels.length} levels from ${labels[0]} to ${labels.at(-1)}` : labels.join(', ');
    if (isSampled() && isOfNumbers(i)) {
      const values = points.map((point) => Number(point.values[i]));
      what = `sampled from ${significant(Math.min(...values))} to ${significant(Math.max(...values))}`;
    }
    return make('span', { title: key }, '', make('strong', '', '', soft(axisName(i))), ' ', soft(what));
  };
  const without = points.filter((point) => point.seeds === 0).length;
  const facts = [
    ['Game', make('span', { title: report.game }, '', plain(stem(report.game)))],
    ['Opponent', make('span', { title: report.opponent }, '', plain(stem(report.opponent)))],
    ['Design', `${DESIGNS[report.design] ?? report.design}, ${points.length} ${points.length === 1 ? 'point' : 'points'}`],
    ['Seeds', `${firstSeed()}${seeds > 1 ? ` to ${last}` : ''}; ${report.games_per_point} games per entry and point`],
    ['Games', `${done} of ${games}${without > 0 ? `; ${without} of ${points.length} points have no complete seed yet` : ''}`],
    ['Version', `Squall ${report.version}`],
    ['Axes', report.axes.map(axis)],
  ];
  const fact = ([term, what]) => make('div', { class: term === 'Axes' ? 'axes' : null }, '', make('dt', '', term), make('dd', '', '', what));
  byId('sweep-facts').replaceChildren(...facts.map(fact));
}

function groupOf(metric, i) {
  if (metric.name.startsWith('opponent_')) return "the opponent's";
  const first = report.metrics.findIndex((other) => other.name.startsWith('opponent_'));
  return first >= 0 && i > first ? "the game's" : "the entry's";
}

function drawChooser() {
  const groups = new Map();
  report.metrics.forEach((metric, i) => {
    const label = groupOf(metric, i);
    if (!groups.has(label)) groups.set(label, make('optgroup', { label }));
    groups.get(label).append(make('option', { value: metric.name }, '', withParentheses(metricTitle(metric), unitOf(metric))));
  });
  const chooser = byId('metric');
  chooser.replaceChildren(...groups.values());
  const wanted = new URLSearchParams(location.hash.slice(1)).get('metric') ?? 'win_share';
  state.metric = Math.max(0, report.metrics.findIndex((metric) => metric.name === wanted));
  chooser.addEventListener('change', () => choose(chooser.value));
}

function choose(name) {
  state.metric = report.metrics.findIndex((metric) => metric.name === name);
  state.pages = {};
  putInAddress('metric', name);
  draw();
}

/** Puts something into the page's address; its other parts are kept. */
function putInAddress(name, value) {
  const words = new URLSearchParams(location.hash.slice(1));
  words.set(name, value);
  history.replaceState(null, '', `#${words}`);
  keepAddress();
}

function drawLegend() {
  const { name, about, unit: unitName } = report.metrics[state.metric];
  byId('metric').value = name;
  byId('metric-label').dataset.metric = metricNow();
  byId('about-metric').replaceChildren(`${capital(isShare() ? `${about}; shown as %` : `${about}${unitName ? `, ${unitName}` : ''}`)} `, make('code', { title: 'Name in tables' }, name));
  const focused = document.activeElement?.dataset?.entry;
  byId('entries').replaceChildren(...report.entries.map((entry, i) => {
    if (report.entries.length === 1) return make('span', 'one', '', sampleOf(i), entry);
    const toggle = () => {
      if (!state.hidden.delete(i)) state.hidden.add(i);
      draw();
    };
    const pressed = String(!state.hidden.has(i));
    return make('button', { type: 'button', 'data-entry': i, 'aria-pressed': pressed, title: 'show or hide', onclick: toggle }, '', sampleOf(i), entry);
  }));
  if (focused !== undefined) byId('entries').querySelector(`[data-entry="${focused}"]`)?.focus();
}

/* Scales */

/** The limits of a numeric axis for these estimates: wide intervals are truncated. */
function domainOf(estimates) {
  if (isShare()) return [0, 1];
  const means = estimates.map((estimate) => estimate.mean);
  let [low, high] = [Math.min(...means), Math.max(...means)];
  const room = Math.max(1.2 * (high - low), 0.5 * Math.max(Math.abs(low), Math.abs(high)), 1e-9);
  const ends = estimates.filter(isBounded);
  const floor = low >= 0 ? 0 : -Infinity;
  const [least, most] = [Math.min(low, ...ends.map((one) => one.low)), Math.max(high, ...ends.map((one) => one.high))];
  [low, high] = [Math.max(floor, low - room, least), Math.min(high + room, most)];
  if (high - low < 1e-9 * Math.max(1, Math.abs(high))) {
    const half = Math.max(0.5 * Math.abs(high), 0.5);
    [low, high] = [Math.max(floor, low - half), high + half];
  }
  if (floor === 0 && low < 0.35 * high) low = 0;
  const margin = 0.04 * (high - low);
  return [low === 0 ? 0 : Math.max(floor, low - margin), high + margin];
}

/** The coefficient of variation of numbers: their standard deviation divided by their mean. */
function unevenness(numbers) {
  const mean = numbers.reduce((sum, each) => sum + each, 0) / numbers.length;
  return Math.sqrt(numbers.reduce((sum, each) => sum + (each - mean) ** 2, 0) / numbers.length) / Math.abs(mean);
}

/** Positions of an axis's levels, 0 to 1: to scale, logarithmic if they are spaced logarithmically, or side by side. */
function placesOf(levels) {
  const values = levels.map((level) => level.value);
  const apart = (i, count) => (count === 1 ? 0.5 : i / (count - 1));
  const side = () => ({ kind: 'categories', places: levels.map((_, i) => (i + 0.5) / levels.length) });
  if (values.some((value) => !Number.isFinite(value))) return side();
  const [low, high] = [Math.min(...values), Math.max(...values)];
  if (low === high) return { kind: 'numbers', places: values.map(() => apart(0, 1)) };
  const steps = (numbers) => numbers.slice(1).map((each, i) => each - numbers[i]);
  const sorted = [...values].sort((a, b) => a - b);
  const isLog = low > 0 && values.length > 2 && high / low >= 4
    && unevenness(steps(sorted.map(Math.log))) < 0.6 * unevenness(steps(sorted));
  const at = isLog ? Math.log : (value) => value;
  return { kind: isLog ? 'logarithms' : 'numbers', places: values.map((value) => (at(value) - at(low)) / (at(high) - at(low))) };
}

const ruler = document.createElement('canvas').getContext('2d');
function widthOf(text, size = 12.5) {
  ruler.font = `${size}px ${getComputedStyle(document.documentElement).fontFamily}`;
  return ruler.measureText(text).width;
}

/** A string limited to this width, with its middle omitted if necessary: names often differ at their ends. */
function shortened(text, wide) {
  if (widthOf(text) <= wide) return text;
  const without = (kept) => `${text.slice(0, Math.ceil(kept / 2))}…${text.slice(text.length - Math.floor(kept / 2))}`;
  let kept = text.length - 1;
  while (kept > 2 && widthOf(without(kept)) > wide) kept -= 1;
  return without(kept);
}

/* Curves */

/** Slant of labels, rad, and the maximum length of slanted labels. */
const SLANT = 0.7;
const SLANTED_MAX = 150;

/** Layout of the labels below a chart: horizontal, or slanted if they would touch; of many numbers, some are omitted. */
function labelsBelow(labels, xs, kind, wide) {
  const widths = labels.map((label) => widthOf(label));
  if (kind === 'categories') {
    const room = wide / labels.length - 6;
    if (widths.every((each) => each <= room)) return { slanted: false, texts: labels, height: 22 };
    const texts = labels.map((label, i) => shortened(label, Math.min(SLANTED_MAX, xs[i] / Math.cos(SLANT))));
    const most = Math.max(...texts.map((text) => widthOf(text)));
    const every = Math.ceil(22 / (wide / labels.length));
    return { slanted: true, texts: texts.map((text, i) => (i % every === 0 ? text : null)), height: 22 + most * Math.sin(SLANT) };
  }
  const order = xs.map((_, i) => i).sort((a, b) => xs[a] - xs[b]);
  const last = order.at(-1);
  const texts = labels.map(() => null);
  let end = -Infinity;
  for (const i of order) {
    const fits = xs[i] - widths[i] / 2 > end + 7;
    const clears = i === last || xs[i] + widths[i] / 2 + 7 < xs[last] - widths[last] / 2;
    if (fits && clears) {
      texts[i] = labels[i];
      end = xs[i] + widths[i] / 2;
    }
  }
  return { slanted: false, texts, height: 22 };
}

/** A path through positions, interrupted where one is missing. */
function pathOf(places) {
  const step = (place, i) => `${i > 0 && places[i - 1] ? 'L' : 'M'}${place[0].toFixed(1)} ${place[1].toFixed(1)}`;
  return places.map((place, i) => (place ? step(place, i) : '')).join('');
}

/** Runs of neighbours that have intervals. */
function runsOf(estimates) {
  const runs = [];
  estimates.forEach((estimate, i) => {
    if (!isBounded(estimate)) return;
    if (i > 0 && isBounded(estimates[i - 1])) runs.at(-1).push(i);
    else runs.push([i]);
  });
  return runs;
}

function drawEntry(estimates, entry, { xs, y, low, high }) {
  const clamp = (value) => y(Math.min(high, Math.max(low, value)));
  const parts = { bands: [], lines: [] };
  for (const run of runsOf(estimates)) {
    const [one] = run;
    if (run.length === 1) {
      const d = `M${xs[one]} ${clamp(estimates[one].low)}V${clamp(estimates[one].high)}`;
      parts.bands.push(svg('path', { class: `band whisker ${entryClass(entry)}`, d }));
      continue;
    }
    const edge = (end) => run.map((i) => `${xs[i].toFixed(1)} ${clamp(estimates[i][end]).toFixed(1)}`);
    parts.bands.push(svg('path', { class: `band ${entryClass(entry)}`, d: `M${edge('high').join('L')}L${edge('low').reverse().join('L')}Z` }));
  }
  const places = estimates.map((estimate, i) => estimate && [xs[i], y(estimate.mean)]);
  const line = { class: `line ${entryClass(entry)}`, 'data-entry': report.entries[entry], d: pathOf(places) };
  parts.lines.push(svg('path', { ...line, 'stroke-dasharray': dashOf(entry) }));
  places.filter(Boolean).forEach(([x, at]) => parts.lines.push(markOf(entry, x, at)));
  return parts;
}

const LEFT_LABEL_MIN = 34;
/** Width of a chart for printing, two side by side. */
const PRINTED_WIDTH = 340;

/** Draws one axis's curves into its card; returns whether a band was cut. */
function drawCurve(axis, card, width) {
  const holder = card.querySelector('.chart');
  const wide = Math.max(240, width ?? (holder.clientWidth || 420));
  const levels = levelsOf(axis);
  const labels = levels.map((level) => valueText(axis, level.label));
  const of = new Map(entriesShown().map((entry) => [entry, effectOf(axis, entry).levels.map((level) => metricOf(level.metrics))]));
  const all = [...of.values()].flat().filter(Boolean);
  const [low, high] = all.length > 0 ? domainOf(all) : domainOf([{ mean: 0 }]);
  const ticks = ticksOf(low, high, 5);
  const [right, top, deep] = [22, 10, 220];
  const { kind, places } = placesOf(levels);
  // The first slanted name extends to the left.
  const first = kind === 'categories' ? Math.min(widthOf(labels[0]), SLANTED_MAX) * Math.cos(SLANT) - (0.5 * wide) / labels.length : 0;
  const left = Math.max(LEFT_LABEL_MIN, Math.min(first, 0.22 * wide), ...ticks.map((tick) => widthOf(shown(tick)) + 12));
  const inset = kind === 'categories' ? 0 : 14;
  const xs = places.map((place) => left + inset + place * (wide - left - right - 2 * inset));
  const y = (value) => top + deep * (1 - (value - low) / (high - low));
  const below = labelsBelow(labels, xs, kind, wide - left - right);
  const tall = top + deep + below.height + 8;
  const picture = svg('svg', { viewBox: `0 0 ${wide} ${tall}`, 'aria-hidden': 'true' });
  for (const tick of ticks) {
    picture.append(svg('path', { class: 'gridline', d: `M${left} ${y(tick)}H${wide - right}` }),
      svg('text', { x: left - 8, y: y(tick) + 4, 'text-anchor': 'end' }, shown(tick)));
  }
  below.texts.forEach((text, i) => {
    picture.append(svg('path', { class: 'frame', d: `M${xs[i]} ${top + deep}v5` }));
    if (text === null) return;
    const [x, at] = [xs[i], top + deep + 19];
    const turned = { transform: `rotate(${(-SLANT * 180) / Math.PI} ${x + 4} ${at - 4})`, x: x + 4, y: at - 4 };
    picture.append(svg('text', below.slanted ? { 'text-anchor': 'end', ...turned } : { 'text-anchor': 'middle', x, y: at }, text));
  });
  picture.append(svg('path', { class: 'frame', d: `M${left} ${top}V${top + deep}H${wide - right}` }));
  const guide = svg('path', { class: 'guide', d: '' });
  const drawn = [...of].map(([entry, estimates]) => drawEntry(estimates, entry, { xs, y, low, high }));
  picture.append(...drawn.flatMap((parts) => parts.bands), guide, ...drawn.flatMap((parts) => parts.lines));
  const why = of.size === 0 ? 'all entries are hidden' : noneYet();
  if (all.length === 0) picture.append(svg('text', { class: 'none', x: (left + wide - right) / 2, y: top + deep / 2 }, why));
  holder.replaceChildren(picture);
  holder.setAttribute('aria-label', `${metricNow()} by ${axisName(axis)}: ${levels.length} levels, ${kind}. `
    + 'Arrow keys go from level to level.');
  card.querySelector('.scale').textContent = kind === 'logarithms' ? 'logarithmic scale' : '';
  card.look = { xs, labels, levels, of, guide, top, deep, wide };
  showLevel(card, null);
  drawCurveTable(card, axis);
  return all.filter(isBounded).some((estimate) => estimate.low < low || estimate.high > high);
}

/** Shows the values of a level, or none, in a box beside it. */
function showLevel(card, at) {
  const { xs, labels, levels, of, guide, top, deep, wide } = card.look;
  const box = card.querySelector('.values');
  card.at = at;
  box.hidden = at === null;
  guide.setAttribute('d', at === null ? '' : `M${xs[at]} ${top}v${deep}`);
  if (at === null) return;
  const rows = [...of].map(([entry, estimates]) => make('tr', '', '', make('td', '', '', sampleOf(entry)), make('td', '', report.entries[entry]),
    make('td', '', '', make('strong', '', shown(estimates[at]?.mean))), make('td', 'faint', interval(estimates[at]))));
  const { points } = levels[at];
  const heading = `${labels[at]}${points > 1 ? ` (${points} points)` : ''}`;
  box.replaceChildren(make('strong', '', heading), make('table', '', '', make('tbody', '', '', rows.slice(0, 12))));
  const holder = card.querySelector('.chart');
  const scale = holder.clientWidth / wide;
  const x = holder.offsetLeft + xs[at] * scale;
  const room = card.clientWidth - box.offsetWidth - 8;
  const beside = x + 14 > room ? x - 14 - box.offsetWidth : x + 14;
  box.style.left = `${Math.min(Math.max(8, room), Math.max(8, beside))}px`;
  box.style.top = `${Math.max(4, holder.offsetTop + top - 4)}px`;
  const spoken = [...of].map(([entry, estimates]) => `${report.entries[entry]} ${shown(estimates[at]?.mean)}, ${interval(estimates[at]) || 'none'}`);
  if (document.activeElement === holder) say(`${heading}: ${spoken.join('; ')}`);
}

function nearest(card, event) {
  const holder = card.querySelector('.chart');
  const box = holder.getBoundingClientRect();
  const x = (event.clientX - box.left) * (card.look.wide / box.width);
  return card.look.xs.reduce((best, each, i, all) => (Math.abs(each - x) < Math.abs(all[best] - x) ? i : best), 0);
}

function stepLevel(card, event) {
  const last = card.look.xs.length - 1;
  const to = { ArrowLeft: Math.max(0, card.at - 1), ArrowRight: Math.min(last, (card.at ?? -1) + 1), Home: 0, End: last, Escape: null }[event.key];
  if (to === undefined) return;
  event.preventDefault();
  showLevel(card, to);
}

function drawCurveTable(card, axis) {
  const levels = levelsOf(axis);
  const row = (level, i) => make('tr', '', '', make('th', { scope: 'row', class: 'value' }, '', soft(valueText(axis, level.label))),
    entriesShown().map((entry) => estimateCell(metricOf(effectOf(axis, entry).levels[i].metrics))));
  const heads = [columnHead(soft(axisName(axis)), false), ...entriesShown().map((entry) => columnHead(soft(report.entries[entry]), true))];
  card.querySelector('details .scroll').replaceWith(tableOf(axisName(axis), heads, levels.map(row)));
}

function makeCurves() {
  const cards = variedAxes().map((axis) => {
    const key = report.axes[axis];
    const chart = make('div', { class: 'chart', tabindex: 0, role: 'group', 'aria-roledescription': 'chart' });
    const card = make('figure', { class: 'card', 'data-axis': key }, '', make('h3', '', '', soft(axisName(axis)), ' ', make('small', 'scale')),
      make('p', 'about-axis faint', '', `${axisTitles[axis].about} `, make('code', '', '', soft(key))), chart,
      make('div', { class: 'values', hidden: true, 'aria-hidden': 'true' }),
      make('details', '', '', make('summary', '', '', 'As a table', make('span', 'hidden-text', `: ${axisName(axis)}`)), make('div', 'scroll')));
    chart.addEventListener('pointermove', (event) => showLevel(card, nearest(card, event)));
    chart.addEventListener('pointerdown', (event) => showLevel(card, nearest(card, event)));
    chart.addEventListener('pointerleave', () => document.activeElement === chart || showLevel(card, null));
    chart.addEventListener('focus', () => card.at === null && showLevel(card, 0));
    chart.addEventListener('blur', () => showLevel(card, null));
    chart.addEventListener('keydown', (event) => stepLevel(card, event));
    card.axis = axis;
    return card;
  });
  byId('curve-charts').replaceChildren(...cards);
}

function drawCurves(width) {
  const cut = [...byId('curve-charts').children].map((card) => drawCurve(card.axis, card, width)).some(Boolean);
  const meaning = {
    grid: 'each level is the mean over all points that have it.',
    one_at_a_time: 'each level is one point, with all other axes at their nominal values.',
  }[report.design] ?? 'points are grouped by ascending values of the axis; each level is the mean over a group, at the mean of its values.';
  const bands = hasIntervals() ? 'Bands are 95 % intervals over seeds.' : 'Fewer than five seeds have no intervals.';
  const edges = cut ? ' Bands that reach beyond a chart are cut at its edge.' : '';
  byId('curves-note').textContent = `${metricNow()}: ${meaning} ${bands}${edges}`;
}

/* Heat maps */

/** The colour at a fraction of the scale, and black or white, whichever is more legible on it. */
function heatColour(share) {
  const { heat } = palette;
  const place = Math.min(1, Math.max(0, share)) * (heat.length - 1);
  const at = Math.min(heat.length - 2, Math.floor(place));
  const colour = heat[at].map((low, i) => Math.round(low + (heat[at + 1][i] - low) * (place - at)));
  const linear = colour.map((each) => (each / 255 <= 0.03928 ? each / 255 / 12.92 : ((each / 255 + 0.055) / 1.055) ** 2.4));
  const luminance = 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2];
  return { background: `rgb(${colour.join(' ')})`, ink: luminance > 0.179 ? '#000000' : '#ffffff' };
}

/** By point of a grid: the position of its level on each axis. The last axis varies fastest. */
function placesInGrid() {
  const counts = report.axes.map((_, axis) => levelsOf(axis).length);
  if (report.design !== 'grid' || counts.length < 2 || counts.reduce((a, b) => a * b, 1) !== report.points.length) return null;
  return report.points.map((_, index) => {
    let rest = index;
    return counts.map((count) => count).reverse().map((count) => {
      const at = rest % count;
      rest = Math.floor(rest / count);
      return at;
    }).reverse();
  });
}

/** The means of an entry by level of two axes, over all others; null where a point has none. */
function heatCells(places, entry) {
  const cells = levelsOf(state.rows).map(() => levelsOf(state.columns).map(() => []));
  places.forEach((place, point) => cells[place[state.rows]][place[state.columns]].push(metricOf(report.points[point].entries[entry].metrics)));
  return cells.map((row) => row.map((estimates) => {
    const known = estimates.filter(Boolean);
    const mean = known.length === estimates.length ? known.reduce((sum, each) => sum + each.mean, 0) / known.length : null;
    const lacking = mean === null ? `, of which ${estimates.length - known.length} have none` : '';
    const title = estimates.length === 1 ? interval(known[0]) : `mean of ${estimates.length} points${lacking}`;
    return { mean, title };
  }));
}

function heatTable(cells, [low, high], entry) {
  const [rows, columns] = [state.rows, state.columns];
  const header = (axis, scope) => levelsOf(axis).map((level) => make('th', { scope }, '', soft(valueText(axis, level.label))));
  const rowHeads = header(rows, 'row');
  const cell = ({ mean, title }) => {
    if (mean === null) return make('td', { class: 'none', title }, '', NONE);
    const { background, ink } = heatColour(high > low ? (mean - low) / (high - low) : 0.5);
    return make('td', { style: `background: ${background}; color: ${ink}`, title }, bare(mean));
  };
  const table = make('table', 'heat', '',
    make('caption', 'hidden-text', `${metricNow()} of ${report.entries[entry]}`),
    make('thead', '', '', make('tr', '', '', make('th', 'axis', '', soft(axisName(rows))),
      make('th', { class: 'axis', colspan: cells[0].length, scope: 'colgroup' }, '', soft(axisName(columns)))),
      make('tr', '', '', make('td', { class: 'corner', style: 'height: 0; border: 0' }), header(columns, 'col'))),
    make('tbody', '', '', cells.map((row, i) => make('tr', '', '', rowHeads[i], row.map(cell)))));
  return make('div', 'card', '', entryHead(entry), scrolled(`Heat map of ${report.entries[entry]}`, table));
}

function makeHeat() {
  const [first = 0, second = 1] = variedAxes();
  Object.assign(state, { rows: first, columns: second });
  const [rows, columns] = [byId('heat-rows'), byId('heat-columns')];
  for (const [select, own, other] of [[rows, 'rows', 'columns'], [columns, 'columns', 'rows']]) {
    select.replaceChildren(...report.axes.map((_, axis) => make('option', { value: axis }, axisName(axis))));
    select.addEventListener('change', () => {
      const before = state[own];
      state[own] = Number(select.value);
      if (state[own] === state[other]) state[other] = before;
      drawHeat();
    });
  }
}

function drawHeat() {
  const places = placesInGrid();
  byId('heat').hidden = variedAxes().length < 2;
  byId('heat-body').hidden = places === null;
  if (places === null) {
    byId('heat-note').textContent = `Heat maps require a grid; the design of this sweep is: ${DESIGNS[report.design] ?? report.design}.`;
    return;
  }
  byId('heat-rows').value = state.rows;
  byId('heat-columns').value = state.columns;
  const entries = entriesShown();
  const maps = entries.map((entry) => heatCells(places, entry));
  const means = maps.flat(2).map((cell) => cell.mean).filter((mean) => mean !== null);
  const domain = isShare() ? [0, 1] : [Math.min(...means), Math.max(...means)];
  const others = report.axes.length > 2 ? ' Each number is the mean over all levels of the other axes.' : '';
  const inUnit = unit() ? `, in ${unit()}` : '';
  byId('heat-note').textContent = `${metricNow()} by two axes${inUnit}, with the same colours for all entries.${others}`;
  byId('heat-scale').hidden = means.length === 0;
  byId('heat-low').textContent = shown(domain[0]);
  byId('heat-high').textContent = shown(domain[1]);
  const wide = levelsOf(state.columns).length > 8;
  byId('heat-charts').className = wide ? 'charts wide' : 'charts';
  byId('heat-charts').style.gridTemplateColumns = wide ? 'minmax(0, 1fr)' : '';
  byId('heat-charts').replaceChildren(...maps.map((cells, i) => heatTable(cells, domain, entries[i])));
}

/* Tornado charts */

function tornadoDomain(contrasts) {
  const means = contrasts.map((one) => Math.abs(one.mean));
  const most = Math.max(...means, 1e-9);
  const cap = isShare() ? Math.min(1, 2.5 * most) : 2.5 * most;
  const ends = contrasts.filter(isBounded).flatMap((one) => [one.low, one.high]).concat(contrasts.map((one) => one.mean), 0);
  const low = Math.max(-cap, Math.min(...ends));
  const high = Math.min(cap, Math.max(...ends));
  const margin = 0.03 * (high - low || 1);
  const whole = isShare() ? 1 : Infinity;
  return [Math.max(-whole, low - (low < 0 ? margin : 0)), Math.min(whole, high + (high > 0 || low === 0 ? margin : 0))];
}

function track(contrast, [low, high]) {
  const at = (value) => 100 * ((Math.min(high, Math.max(low, value)) - low) / (high - low));
  const piece = (name, from, to) => make('div', { class: name, style: `left: ${at(from).toFixed(2)}%; width: ${(at(to) - at(from)).toFixed(2)}%` });
  const parts = [make('div', { class: 'zero', style: `left: ${at(0).toFixed(2)}%` })];
  if (contrast) parts.push(piece('effect', Math.min(0, contrast.mean), Math.max(0, contrast.mean)));
  if (isBounded(contrast)) {
    const cut = `${contrast.low < low ? ' cut-low' : ''}${contrast.high > high ? ' cut-high' : ''}`;
    parts.push(piece(`span${cut}`, contrast.low, contrast.high));
  }
  return make('div', { class: 'track', 'aria-hidden': 'true' }, '', parts);
}

/** The numbers below a tornado chart: its ends, and 0 if it does not overlap them. */
function endsOf([low, high]) {
  const zero = 100 * (-low / (high - low));
  const marks = [make('span', { style: 'left: 0' }, signed(low)), make('span', { style: 'right: 0' }, signed(high))];
  if (zero < 1) marks[0] = make('span', { style: 'left: 0' }, '0');
  else if (zero > 99) marks[1] = make('span', { style: 'right: 0' }, '0');
  else if (zero > 24 && zero < 76) marks.push(make('span', { style: `left: ${zero}%; transform: translateX(-50%)` }, '0'));
  return make('div', { class: 'ends', 'aria-hidden': 'true' }, '', marks);
}

function tornadoOf(entry, domain) {
  const of = report.axes.map((_, axis) => metricOf(effectOf(axis, entry).contrasts));
  const size = (axis) => (of[axis] ? Math.abs(of[axis].mean) : -1);
  const order = variedAxes().sort((a, b) => size(b) - size(a) || a - b);
  const row = (axis) => {
    const contrast = of[axis];
    const levels = levelsOf(axis);
    const ends = levels.length > 1 ? ` ${valueText(axis, levels[0].label)} → ${valueText(axis, levels.at(-1).label)}` : '';
    const without = make('small', '', '', levels.length > 1 ? noneYet() : 'one level only');
    const amount = contrast ? [make('strong', '', signed(contrast.mean)), ' ', make('small', '', interval(contrast, -1))] : [without];
    const what = make('span', '', '', soft(axisName(axis)), make('small', '', '', soft(ends)));
    return make('li', { 'data-axis': report.axes[axis] }, '',
      make('div', 'what', '', what, make('span', 'amount', '', amount)), track(contrast, domain));
  };
  return make('div', { class: `card ${entryClass(entry)}`, 'data-entry': report.entries[entry] }, '',
    entryHead(entry), make('ol', 'tornado', '', order.map(row)), of.some(Boolean) ? endsOf(domain) : null);
}

function drawTornado() {
  const contrasts = entriesShown().flatMap((entry) => report.axes.map((_, axis) => metricOf(effectOf(axis, entry).contrasts))).filter(Boolean);
  const domain = tornadoDomain(contrasts);
  const isCut = contrasts.filter(isBounded).some((one) => one.low < domain[0] || one.high > domain[1]);
  byId('tornado-note').textContent = `${metricNow()} at the last level of an axis minus that at the first`
    + `${hasIntervals() ? ', with 95 % intervals' : ''}; largest differences first, same scale for all entries.`
    + `${isCut ? ' Intervals without an end mark extend beyond the chart.' : ''}`;
  byId('tornado-charts').replaceChildren(...entriesShown().map((entry) => tornadoOf(entry, domain)));
}

/* Pages of long lists */

const PAGE_ROWS = 20;

/** The rows of the current page, and buttons for the others, if any. */
function paged(name, rows, redraw, size = PAGE_ROWS) {
  const pages = Math.max(1, Math.ceil(rows.length / size));
  const page = Math.min(pages - 1, state.pages[name] ?? 0);
  const go = (to, which) => () => {
    state.pages[name] = to;
    redraw();
    const wanted = document.querySelector(`[data-pages="${name}"] [data-go="${which}"]`);
    const other = document.querySelector(`[data-pages="${name}"] button:not(:disabled)`);
    (wanted?.disabled ? other : wanted)?.focus();
    say(`Page ${to + 1} of ${pages}`);
  };
  const button = (text, which, to) =>
    make('button', { type: 'button', 'data-go': which, disabled: to < 0 || to >= pages, onclick: go(to, which) }, text);
  const nav = pages === 1 ? null : make('nav', { class: 'pages', 'data-pages': name, 'aria-label': `Pages of ${name}` }, '',
    button('Back', 'back', page - 1),
    make('span', '', `${page * size + 1} to ${Math.min(rows.length, (page + 1) * size)} of ${rows.length}`), button('Next', 'next', page + 1));
  return { rows: rows.slice(page * size, (page + 1) * size), nav };
}

/* Differences */

/** The sign of a significant difference: 1, -1, or 0 if there is none. */
const sureness = (estimate) => (!isBounded(estimate) ? 0 : estimate.low > 0 ? 1 : estimate.high < 0 ? -1 : 0);

function differenceCell(estimate) {
  const sure = sureness(estimate);
  if (sure === 0) return make('td', 'estimate unsure', '', twoLines(estimate, signed));
  const mark = make('span', `sure ${sure > 0 ? 'more' : 'less'}`, '', sure > 0 ? '▲ significantly more' : '▼ significantly less');
  return make('td', 'estimate', '', make('strong', '', signed(estimate.mean)), make('small', '', interval(estimate, -1)), mark);
}

function drawDifferences() {
  byId('differences').hidden = report.entries.length < 2;
  if (report.entries.length < 2) return;
  const others = report.entries.slice(1);
  const of = (point, k) => metricOf(point.differences[k]?.metrics);
  const summary = others.map((entry, k) => {
    const all = report.points.map((point) => of(point, k)).filter(Boolean);
    const count = (sign) => all.filter((estimate) => sureness(estimate) === sign).length;
    const counts = `significantly more at ${count(1)} and less at ${count(-1)} of ${all.length} points`;
    const what = hasIntervals() ? counts : 'significance requires five seeds';
    return make('li', '', '', make('strong', '', '', soft(entry)), ` less ${report.entries[0]}: ${what}`);
  });
  const toggle = make('input', { type: 'checkbox', id: 'only-sure', onchange: (event) => {
    state.onlySure = event.target.checked;
    state.pages.differences = 0;
    drawDifferences();
    byId('only-sure').focus();
  } });
  toggle.checked = state.onlySure;
  const text = `${metricNow()}: each other entry minus ${report.entries[0]}, on the same seeds. A difference is significant if its 95 % interval does not `
    + 'contain 0; without any true difference, about one in twenty would still be significant.';
  const choice = make('p', 'on-screen', '', make('label', '', '', toggle, ' only points with a significant difference'));
  byId('differences-note').replaceChildren(make('p', 'faint', text), make('ul', '', '', summary), hasIntervals() ? choice : '');
  const rows = report.points.map((point, index) => ({ point, index }))
    .filter(({ point }) => !state.onlySure || others.some((_, k) => sureness(of(point, k)) !== 0));
  const page = paged('differences', rows, drawDifferences);
  const less = (entry) => columnHead([...soft(entry), make('br'), make('small', '', '', 'minus ', soft(report.entries[0]))], true);
  const heads = [columnHead('Point', true), ...axisHeads(), ...others.map(less)];
  const row = ({ point, index }) => make('tr', '', '', pointHead(index), valueCells(point.values), others.map((_, k) => differenceCell(of(point, k))));
  const table = rows.length === 0 ? make('p', '', 'None.') : tableOf('Differences', heads, page.rows.map(row));
  byId('differences-table').replaceChildren(table, page.nav ?? '');
}

/* Interactions */

/** The low and the high part of an axis: the halves of its levels. */
function halvesOf(key) {
  const axis = report.axes.indexOf(key);
  const labels = levelsOf(axis).map((level) => valueText(axis, level.label));
  const middle = Math.floor(labels.length / 2);
  const text = (part) => (part.length > (isOfNumbers(axis) ? 1 : 3) ? `${part[0]} to ${part.at(-1)}` : part.join(', '));
  return [text(labels.slice(0, middle)), text(labels.slice(labels.length - middle))];
}

function interactionCard(one) {
  const [low, second, first, both] = one.cells;
  const [rows, columns] = one.axes.map(halvesOf);
  const p = one.p < 0.001 ? 'p < 0.001' : `p = ${significant(one.p, 2)}`;
  const head = (text) => make('th', { scope: 'col' }, '', soft(text));
  const names = one.axes.map((key) => axisName(report.axes.indexOf(key)));
  return make('div', 'card interaction', '', make('h3', '', '', names[0], ' with ', names[1]),
    make('div', '', '', soft(one.entry), ': ', make('strong', '', signed(one.contrast.mean)), ' ', make('small', '', `${interval(one.contrast, -1)}; ${p}`)),
    make('div', 'scroll', '', make('table', 'cells', '',
      make('thead', '', '', make('tr', '', '', make('th', 'axis', '', names[0]),
        make('th', { class: 'axis', colspan: 2, scope: 'colgroup' }, '', names[1])),
        make('tr', '', '', make('td'), head(columns[0]), head(columns[1]))),
      make('tbody', '', '', make('tr', '', '', make('th', { scope: 'row' }, '', soft(rows[0])), make('td', '', shown(low)), make('td', '', shown(second))),
        make('tr', '', '', make('th', { scope: 'row' }, '', soft(rows[1])), make('td', '', shown(first)), make('td', '', shown(both)))))));
}

function drawInteractions() {
  byId('interactions').hidden = report.axes.length < 2 || report.design === 'one_at_a_time';
  const { name } = report.metrics[state.metric];
  const looked = report.interactions.filter((one) => one.metric === name);
  const matter = looked.filter((one) => one.matters && entriesShown().includes(report.entries.indexOf(one.entry)));
  const metrics = [...new Set(report.interactions.map((one) => one.metric))];
  const countOf = (metric) => report.interactions.filter((one) => one.metric === metric && one.matters).length;
  const elsewhere = metrics.filter((metric) => metric !== name && countOf(metric) > 0);
  let text = `${matter.length} of ${looked.length} tested pairs of axes and entries, by Holm's procedure at 5 %. `
    + 'The contrast is the effect of the second axis where the first is high, minus its effect where the first is low.';
  if (report.interactions.length === 0) text = 'No pair of axes could be tested: this requires five complete seeds at all points.';
  else if (looked.length === 0) text = `Interactions are tested for ${metrics.map((name) => metricTitle({ name })).join(', ')}, not for ${metricNow()}.`;
  else if (matter.length === 0) text = `None of ${looked.length} tested pairs of axes and entries, by Holm's procedure at 5 %.`;
  const follow = (metric) => () => {
    choose(metric);
    byId('metric').focus();
  };
  const links = elsewhere.map((metric) => make('button', { type: 'button', onclick: follow(metric) }, `${metricTitle({ name: metric })}: ${countOf(metric)}`));
  const others = links.length > 0 ? make('p', 'pages', '', 'In other metrics:', links) : '';
  byId('interactions-note').replaceChildren(make('p', 'faint', text), others);
  const page = paged('interactions', matter, drawInteractions, 12);
  byId('interactions-list').replaceChildren(...page.rows.map(interactionCard));
  byId('interactions-pages').replaceChildren(page.nav ?? '');
}

/** A link to a game, if a server can replay it. */
function watchOf(game, what = `game ${game}`) {
  return isPlayable ? make('a', { class: 'watch', href: addressOfGame(game), 'aria-label': `Watch ${what}` }, 'Watch') : null;
}

/* All points */

function sortKey(point, index, column) {
  if (column === 'point') return index;
  const [kind, at] = column.split(' ');
  if (kind === 'axis') return Number.isFinite(Number(point.values[at])) ? Number(point.values[at]) : point.values[at];
  return metricOf(point.entries[at].metrics)?.mean ?? null;
}

function sortedPoints() {
  const rows = report.points.map((point, index) => ({ point, index }));
  if (state.sort === null) return rows;
  const { column, down } = state.sort;
  const compare = (a, b) => {
    const [one, other] = [sortKey(a.point, a.index, column), sortKey(b.point, b.index, column)];
    // Points without a number come last, in either order.
    if (one === null || other === null) return Number(one === null) - Number(other === null) || a.index - b.index;
    const order = typeof one === 'string' ? one.localeCompare(other) : one - other;
    return (down ? -order : order) || a.index - b.index;
  };
  return rows.sort(compare);
}

function drawPoints() {
  const head = (column, children, isNumber) => {
    const is = state.sort?.column === column;
    const sort = () => {
      state.sort = { column, down: is && !state.sort.down };
      state.pages.points = 0;
      drawPoints();
      document.querySelector(`[data-sort="${column}"]`).focus();
    };
    const order = is ? (state.sort.down ? 'descending' : 'ascending') : null;
    const arrow = is ? (state.sort.down ? ' ▼' : ' ▲') : '';
    const button = make('button', { type: 'button', 'data-sort': column, title: 'sort by this', onclick: sort }, '', children, arrow);
    return columnHead(button, isNumber, { 'aria-sort': order });
  };
  const entries = entriesShown();
  const heads = [head('point', 'Point', true), ...report.axes.map((_, axis) => head(`axis ${axis}`, soft(axisName(axis)), isOfNumbers(axis))),
    columnHead('Seeds', true), ...entries.map((entry) => head(`entry ${entry}`, soft(report.entries[entry]), true)),
    isPlayable ? columnHead('Games', false) : null, columnHead('Command', false)].filter(Boolean);
  const row = ({ point, index }) => make('tr', '', '', pointHead(index), valueCells(point.values), make('td', 'number', String(point.seeds)),
    entries.map((entry) => estimateCell(metricOf(point.entries[entry].metrics))),
    isPlayable ? make('td', '', '', gamesOf(index)) : null,
    make('td', '', '', commandOf(point.command, `plays a game of point ${index}`)));
  byId('points-note').textContent = `${metricNow()}: means per game${hasIntervals() ? ', with 95 % intervals over seeds' : ''}. `
    + "The command plays one of the point's games: that of the first seed, with the first entry as the first team."
    + `${isPlayable ? ' Games lists all of them.' : ''}`;
  const page = paged('points', sortedPoints(), drawPoints);
  byId('points-table').replaceChildren(tableOf('All points', heads, page.rows.map(row)), page.nav ?? '');
}

/** A button that lists all games of a point. */
function gamesOf(index) {
  const show = () => showGames(index, true);
  return make('button', { type: 'button', 'aria-pressed': String(state.point === index), 'aria-label': `List the games of point ${index}`, onclick: show }, 'Games');
}

/* The games of a point, from the server: all of them together would be many times the size of the report. */

const RESULTS = { all: 'all', won: 'won', drawn: 'drawn', lost: 'lost', none: 'without a result' };
const resultOf = ({ score }) => (score === null ? 'none' : score[0] === score[1] ? 'drawn' : score[0] > score[1] ? 'won' : 'lost');

async function showGames(point, isAsked) {
  putInAddress('point', point);
  Object.assign(state, { point, games: null });
  state.pages.games = 0;
  drawPoints();
  drawGames();
  let found;
  try {
    const answer = await fetch(`/sweep_games/${point}.json`);
    if (!answer.ok) throw new Error(await answer.text());
    found = await answer.json();
  } catch (error) {
    found = { games: [], left_out: 0, problem: error.message };
  }
  // Another point may have been requested in the meantime.
  if (state.point !== point) return;
  state.games = found;
  drawGames();
  if (!isAsked) return;
  byId('games').scrollIntoView();
  byId('games-head').focus({ preventScroll: true });
}

function gameRow({ game, entry, team, seed, score, why }) {
  const points = score === null ? NONE : `${significant(score[0])} : ${significant(score[1])}`;
  const name = report.entries[entry] ?? '';
  const result = score === null ? why ?? 'not played yet' : resultOf({ score });
  return make('tr', '', '', make('td', '', '', watchOf(game, `seed ${seed}, ${name} as ${team}, ${points}`)), make('td', '', '', sampleOf(entry), ' ', soft(name)),
    make('td', '', team), make('td', 'number', seed), make('td', 'number', points), make('td', '', result));
}

function drawGames() {
  const point = report.points[state.point];
  byId('games').hidden = point === undefined;
  if (point === undefined) return;
  const values = point.values.map((value, axis) => axisValue(axis, value)).join(', ');
  byId('games-head').textContent = `Games at ${values}`;
  const shownGames = (state.games?.games ?? []).filter(({ entry }) => !state.hidden.has(entry));
  const wanted = byId('games-filter').value;
  const rows = shownGames.filter((game) => wanted === 'all' || resultOf(game) === wanted);
  const { problem, left_out } = state.games ?? {};
  const about = state.games === null ? 'Loading the list.' : `${rows.length} games of point ${state.point}${left_out ? `, of the first ${state.games.games.length}` : ''}. `
    + 'Before you can watch a game, it is rerun, which takes a few seconds.';
  byId('games-note').textContent = problem ? `${about} Their results are unknown: ${problem}` : about;
  const heads = [columnHead('', false), columnHead('Entry', false), columnHead('Team', false), columnHead('Seed', true), columnHead('Points', true),
    columnHead('Result', false)];
  const page = paged('games', rows, drawGames);
  byId('games-table').replaceChildren(rows.length === 0 ? '' : tableOf('Games of the point', heads, page.rows.map(gameRow)), page.nav ?? '');
}

function makeGames() {
  if (!isPlayable) return;
  const filter = byId('games-filter');
  filter.replaceChildren(...Object.entries(RESULTS).map(([value, text]) => make('option', { value }, text)));
  filter.addEventListener('change', () => {
    state.pages.games = 0;
    drawGames();
  });
  const wanted = new URLSearchParams(location.hash.slice(1)).get('point') ?? '';
  if (/^\d+$/.test(wanted) && Number(wanted) < report.points.length) showGames(Number(wanted), false);
}

/* Worst games, and those that could not start */

function worstCard(game) {
  const values = game.values.map((value, axis) => axisValue(axis, value)).join(', ');
  const [own, theirs] = game.score;
  const counts = [['contacts', game.contacts], ['times out of bounds', game.out_of_bounds]].map(([what, count]) => `${significant(count)} ${what}`);
  return make('div', 'card game', '', make('p', '', '', make('strong', '', `${significant(own)} : ${significant(theirs)}`), ` at ${values}; ${counts.join(', ')} `,
    make('small', '', `game ${game.game}`)), make('div', 'replay', '', watchOf(game.game), commandOf(game.command, `plays game ${game.game}`)));
}

function drawWorst() {
  const gamesOf = (entry) => report.worst.filter((game) => game.entry === report.entries[entry]);
  const groups = entriesShown().filter((entry) => gamesOf(entry).length > 0);
  byId('worst-list').replaceChildren(...groups.map((entry) => make('div', '', '', entryHead(entry), gamesOf(entry).map(worstCard))));
  if (report.worst.length === 0) byId('worst-list').replaceChildren(make('p', '', 'No entry has lost or drawn a game.'));
}

function drawFailures() {
  byId('failures').hidden = report.failures.length === 0;
  const page = paged('failures', report.failures, drawFailures, 20);
  const card = (failure) => make('div', 'card game', '', make('p', '', '', make('small', '', `game ${failure.game}`)),
    make('p', 'why', '', failure.why), commandOf(failure.command, `plays game ${failure.game}`));
  byId('failures-list').replaceChildren(...page.rows.map(card), page.nav ?? '');
}

/* All of it */

function draw() {
  drawLegend();
  drawCurves();
  drawHeat();
  drawTornado();
  drawDifferences();
  drawInteractions();
  drawPoints();
  drawGames();
  drawWorst();
}
