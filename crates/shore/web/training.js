// A training run: curves over samples, the newest evaluation against each opponent, and recorded episodes.

import { addressOfGame } from './address.js';
import { drawDiagram, partAt, sampleAt, ticksOf } from './diagram.js';
import { palette } from './palette.js';
import { cell, tableOf, watch } from './table.js';
import { make, number, plain, show } from './words.js';

const MARGIN = { left: 46, right: 12, top: 8, bottom: 24 };
const MILLION = 1e6;
/** Maximum number of evaluations listed. */
const ROWS_MAX = 200;
const DASHES = [[], [7, 4], [2, 3], [10, 3, 2, 3]];

/** The share of won, drawn or lost games. */
const share = ({ won, drawn, lost }) => (100 * (won + drawn / 2)) / Math.max(1, won + drawn + lost);

/** Curves of evaluations, one line per opponent: title, unit, value, and range if known. */
const AGAINST = [
  ['Games won (draws count half)', '%', share, [0, 100]],
  ['Points ahead', 'per game', ({ points, points_against }) => points - points_against],
  ['Left the field', 'times per game', ({ left_field }) => left_field],
];
/** Curves of updates: title, unit, column. */
const OF_UPDATES = [['Reward', 'per step', 'reward'], ['Entropy', 'nats', 'entropy'], ['Policy loss', '', 'policy_loss'],
  ['Value loss', '', 'value_loss'], ['KL divergence', 'nats', 'divergence']];

const isNumber = (value) => typeof value === 'number' && Number.isFinite(value);

/** A chart: title, legend with the values at the chosen position, and lines. */
class Chart {
  constructor(title, unit, span) {
    this.title = title;
    this.unit = unit;
    this.span = span;
    this.at = null;
    this.canvas = make('canvas');
    this.canvas.tabIndex = 0;
    this.canvas.setAttribute('role', 'img');
    this.legend = make('ul', 'legend');
    this.box = make('figure', 'card', '', make('figcaption', '', '', make('strong', '', title), make('span', 'faint', unit)), this.legend, this.canvas);
    this.canvas.addEventListener('pointermove', (event) => this.point(event));
    this.canvas.addEventListener('pointerdown', (event) => this.point(event));
    this.canvas.addEventListener('pointerleave', () => this.go(null));
    this.canvas.addEventListener('keydown', (event) => this.key(event));
  }

  /** Takes lines `{ name, xs, values }` and the starts of stages. */
  take(lines, steps) {
    this.lines = lines;
    this.steps = steps;
    const xs = lines.flatMap((line) => line.xs);
    show(this.box, lines.some((line) => line.values.some(isNumber)));
    [this.from, this.to] = [0, xs.reduce((most, each) => Math.max(most, each), 0) || 1];
    const values = lines.flatMap((line) => line.values).filter(isNumber);
    const [low, high] = this.span ?? [values.reduce((a, b) => Math.min(a, b), Infinity), values.reduce((a, b) => Math.max(a, b), -Infinity)];
    // A constant line is centred within a tenth of its value, so that rounding does not fill the chart.
    const size = Math.max(Math.abs(low), Math.abs(high));
    const room = this.span ? 0 : Math.max(0.06 * (high - low), high - low < 0.01 * size ? 0.1 * size : 0, 1e-6);
    [this.low, this.high] = [low - room, high + room];
    this.draw();
  }

  point(event) {
    this.go(this.from + partAt(event, this.canvas, MARGIN) * (this.to - this.from));
  }

  key(event) {
    const step = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
    const { xs } = this.lines[0] ?? { xs: [] };
    if (!step || xs.length === 0) return;
    const now = this.at === null ? xs.length : sampleAt(xs, this.at);
    this.go(xs[Math.min(xs.length - 1, Math.max(0, now + step))]);
    event.preventDefault();
  }

  go(at) {
    this.at = at;
    this.draw();
  }

  draw() {
    if (!this.lines || this.box.hidden) return;
    const valueAt = ({ xs, values }) => values[this.at === null ? values.length - 1 : sampleAt(xs, this.at)];
    const words = (line) => number(valueAt(line), this.high - this.low > 20 ? 0 : this.high - this.low > 0.5 ? 2 : 4);
    const styled = this.lines.map((line, which) => ({ ...line, colour: palette.teams[which % 4], width: 1.8, dash: DASHES[Math.floor(which / 4) % 4] }));
    const one = (line, which) => make('li', `team-${which % 4}`, '', ...(line.name ? [make('i', 'swatch'), make('span', '', plain(line.name))] : []), make('b', '', words(line)));
    this.legend.replaceChildren(...styled.map(one));
    const when = this.at === null ? 'at the end' : `at ${number(this.at, 2)} million samples`;
    this.canvas.setAttribute('aria-label', `${this.title}, ${when}: ${styled.map((line) => `${line.name ? `${plain(line.name)} ` : ''}${words(line)}`).join(', ')}. `
      + 'Arrow keys move along it.');
    if (this.canvas.clientWidth === 0) return;
    const tick = (places) => (at) => [at, number(at, places)];
    const rows = ticksOf(this.low, this.high, 4);
    const columns = ticksOf(this.from, this.to, 5);
    const placesOf = (ticks) => Math.max(0, ...ticks.map((each) => (String(Number(each.toPrecision(6))).split('.')[1] ?? '').length));
    drawDiagram(this.canvas, {
      lines: styled, from: this.from, to: this.to, low: this.low, high: this.high, margin: MARGIN, at: this.at, steps: this.steps,
      rows: rows.map(tick(placesOf(rows))), columns: columns.map(tick(placesOf(columns))),
    });
  }
}

export class Training {
  constructor(place) {
    this.against = AGAINST.map(([title, unit, , span]) => new Chart(title, unit, span));
    this.ofUpdates = OF_UPDATES.map(([title, unit]) => new Chart(title, unit));
    this.newest = make('section');
    this.episodes = make('section');
    const charts = make('div', 'charts', '', ...[...this.against, ...this.ofUpdates].map(({ box }) => box));
    place.replaceChildren(make('section', '', '', make('h2', '', 'Curves'), make('p', 'faint', 'Over samples in millions. Dashed lines: start of a stage.'), charts),
      this.newest, this.episodes);
    new ResizeObserver(() => this.draw()).observe(charts);
  }

  /** Whether more data may come. */
  get goesOn() {
    return true;
  }

  draw() {
    for (const chart of [...this.against, ...this.ofUpdates]) chart.draw();
  }

  tell(report) {
    if (report.problem) throw new Error(report.problem);
    const { name, updates, evaluations, episodes } = report;
    const begins = updates.filter(({ stage }, i) => i > 0 && stage !== updates[i - 1].stage).map(({ samples }) => samples / MILLION);
    const opponents = [...new Set(evaluations.map(({ opponent }) => opponent))];
    AGAINST.forEach(([, , value], which) => this.against[which].take(opponents.map((opponent) => {
      const seen = evaluations.filter((each) => each.opponent === opponent);
      return { name: opponent, xs: seen.map(({ samples }) => samples / MILLION), values: seen.map(value) };
    }), begins));
    OF_UPDATES.forEach(([, , column], which) => this.ofUpdates[which].take([
      { name: '', xs: updates.map(({ samples }) => samples / MILLION), values: updates.map((each) => each[column]) },
    ], begins));
    this.drawEvaluations(evaluations);
    this.drawEpisodes(episodes);
    const last = updates.at(-1);
    const facts = last ? `${number(last.samples / MILLION, 2)} million samples, stage ${plain(last.stage)}, ${new Set(evaluations.map(({ samples }) => samples)).size} evaluations.`
      : 'Nothing learnt yet.';
    return { name, facts, remarks: [] };
  }

  /** The evaluation of each checkpoint, newest first. */
  drawEvaluations(evaluations) {
    show(this.newest, evaluations.length > 0);
    const heads = [['Samples', 'number'], ['Stage'], ['Opponent'], ...['Won', 'Drawn', 'Lost', 'Points', 'Left the field'].map((text) => [text, 'number'])];
    const row = (each) => make('tr', '', '', ...this.first(each), ...[String(each.won), String(each.drawn), String(each.lost),
      `${number(each.points, 1)} : ${number(each.points_against, 1)}`, number(each.left_field, 1)].map((text) => cell(text, 'number')));
    this.newest.replaceChildren(make('h2', '', 'Evaluations'), make('p', 'faint', 'Games of each checkpoint against each opponent, newest first. Points are means per game.'),
      tableOf('Evaluations', heads, evaluations.slice(-ROWS_MAX).reverse().map(row)));
  }

  /** The first cells of every row. */
  first({ samples, stage, opponent }) {
    return [cell(`${number(samples / MILLION, 2)} M`, 'number'), cell(plain(stage)), cell(plain(opponent))];
  }

  drawEpisodes(episodes) {
    const heads = [[''], ['Samples', 'number'], ['Stage'], ['Opponent'], ...['Seed', 'Points', 'Steps'].map((text) => [text, 'number'])];
    const row = (each) => make('tr', '', '',
      watch(addressOfGame(each.recording.replace(/^games\//, '')), `Watch the episode with seed ${each.seed} against ${plain(each.opponent)}`), ...this.first(each),
      ...[each.seed, `${each.points} : ${each.points_against}`, String(each.steps)].map((text) => cell(text, 'number')));
    this.episodes.replaceChildren(make('h2', '', 'Recorded episodes'), episodes.length === 0
      ? make('p', 'faint', 'None. To record episodes, use squall train --record-every N.')
      : tableOf('Recorded episodes', heads, [...episodes].reverse().map(row)));
  }
}
