// A training run: curves over samples or hours, its best policy, evaluations and recorded episodes; beside another run if one is chosen.

import { addressOfGame, keepAddress } from './address.js';
import { commandOf } from './command.js';
import { CurveChart, isNumber, smoothed } from './curve_chart.js';
import { keep, recallObject } from './storage.js';
import { cell, tableOf, watch } from './table.js';
import { make, number, options, plain, show, write } from './words.js';

const KEY = 'squall.training';
const MILLION = 1e6;
const HOUR_S = 3600;
/** Maximum number of evaluations listed. */
const ROWS_MAX = 200;
/** The newest part of a run whose rate counts as the current one. */
const RECENT_S = 60;

/** The fraction of won, drawn or lost games. */
const share = ({ won, drawn, lost }) => (100 * (won + drawn / 2)) / Math.max(1, won + drawn + lost);

/** Curves of evaluations, one per opponent: title, unit, value, and range if known. */
const AGAINST = [
  ['Win rate', '%, draws count half', share, [0, 100]],
  ['Points ahead', 'per game', ({ points, points_against }) => points - points_against],
  ['Left the field', 'times per game', ({ left_field }) => left_field, [0, null]],
];
/** Curves of updates: title, unit, column. */
const OF_UPDATES = [['Mean reward', 'per step', 'reward'], ['Policy loss', '', 'policy_loss'], ['Value loss', '', 'value_loss'], ['Entropy', 'nats', 'entropy'],
  ['KL divergence', 'nats', 'divergence'], ['Explained variance', '1: perfect critic', 'explained_variance'], ['Clip fraction', '', 'clipped']];

/** `1 h 05 min`, `12 min` or `40 s`. */
function duration(s) {
  if (s < 60) return `${Math.round(s)} s`;
  const minutes = Math.round(s / 60);
  return minutes < 60 ? `${minutes} min` : `${Math.floor(minutes / 60)} h ${String(minutes % 60).padStart(2, '0')} min`;
}

const millions = (samples) => number(samples / MILLION, 2);
const perSecond = (rate) => `${rate < 10 ? rate.toPrecision(2) : Math.round(rate).toLocaleString('en')} samples/s`;

/** A run, prepared for its page. */
class Run {
  constructor(report, style) {
    Object.assign(this, report, { style });
    this.times ??= [];
    this.last = this.updates.at(-1);
    this.runs ??= [];
    const at = this.evaluations.some(({ best }) => best) ? this.evaluations.findLast(({ best }) => best === 'true')?.samples : this.bestOfEarlierVersion();
    this.best = this.evaluations.filter(({ samples }) => samples === at);
  }

  /** Runs of earlier versions do not record which policy is the best: the newest with the highest win rate, as in crates/learn/src/train/mod.rs. */
  bestOfEarlierVersion() {
    const all = [...new Set(this.evaluations.map(({ samples }) => samples))];
    const won = (at) => this.evaluations.filter(({ samples }) => samples === at).reduce((sum, each) => sum + share(each), 0);
    return all.reduce((best, at) => (best === null || won(at) >= won(best) ? at : best), null);
  }

  /** The samples of its best policy, or null. */
  get bestSamples() {
    return this.best[0]?.samples ?? null;
  }

  /** The mean win rate of its best policy, %, or null. */
  get bestShare() {
    return this.best.length > 0 ? this.best.reduce((sum, each) => sum + share(each), 0) / this.best.length : null;
  }

  /** The time spent, s; null if it was not recorded. */
  get elapsed_s() {
    return this.times.at(-1)?.elapsed_s ?? null;
  }

  /** Samples per second: recent while it is running, otherwise the average; null if unknown. */
  get rate() {
    const last = this.times.at(-1);
    const from = this.running ? this.times.findLast(({ elapsed_s }) => elapsed_s < last.elapsed_s - RECENT_S) : null;
    const [samples, s] = [last?.samples - (from?.samples ?? 0), last?.elapsed_s - (from?.elapsed_s ?? 0)];
    return s > 0 ? samples / s : null;
  }

  /** Converts samples to hours. */
  hours(samples) {
    const { times } = this;
    const next = times.findIndex((each) => each.samples >= samples);
    if (next < 0) return (times.at(-1)?.elapsed_s ?? 0) / HOUR_S;
    const [before, after] = [times[next - 1] ?? { samples: 0, elapsed_s: 0 }, times[next]];
    const part = (samples - before.samples) / Math.max(1, after.samples - before.samples);
    return (before.elapsed_s + part * (after.elapsed_s - before.elapsed_s)) / HOUR_S;
  }

  get state() {
    const all = this.plan?.samples;
    if (all && this.last?.samples >= all) return ['finished', 'good'];
    return this.running === null || this.running === undefined ? ['', ''] : this.running ? ['running', 'good'] : ['stopped', 'warn'];
  }

  /** Its size and speed, in words. */
  facts() {
    if (!this.last) return 'Nothing learned yet.';
    const all = this.plan?.samples;
    const done = all ? `${millions(this.last.samples)} of ${millions(all)} million samples (${Math.floor((100 * this.last.samples) / all)} %)`
      : `${millions(this.last.samples)} million samples`;
    const left = this.running && all && this.rate ? `, about ${duration((all - this.last.samples) / this.rate)} left` : '';
    const time = this.elapsed_s === null ? [] : [`${duration(this.elapsed_s)}${left}`];
    return [done, `stage ${plain(this.last.stage)}`, ...(this.rate ? [perSecond(this.rate)] : []), ...time].join(' · ');
  }
}

export class Training {
  constructor(place) {
    const kept = recallObject(KEY) ?? {};
    this.axis = kept.axis === 'hours' ? 'hours' : 'samples';
    this.weight = Number.isFinite(kept.weight) ? Math.min(0.99, Math.max(0, kept.weight)) : 0.6;
    this.own = null;
    this.other = null;
    this.against = AGAINST.map(([title, unit, , span]) => new CurveChart(title, unit, span));
    this.ofUpdates = OF_UPDATES.map(([title, unit]) => new CurveChart(title, unit));
    this.rates = new CurveChart('Samples per second', '', [0, null]);
    this.best = make('section');
    this.best.id = 'best';
    this.newest = make('section');
    this.episodes = make('section');
    this.episodes.id = 'episodes';
    const group = (title, charts) => make('section', '', '', make('h2', '', title), make('div', 'charts', '', ...charts.map(({ box }) => box)));
    place.replaceChildren(this.best, this.makeBar(), group('Evaluations', this.against), group('Learning', [...this.ofUpdates, this.rates]), this.newest, this.episodes);
    addEventListener('hashchange', () => this.again());
  }

  makeBar() {
    [this.axes, this.slider, this.runs] = [make('select'), make('input'), make('select')];
    Object.assign(this.axes, { id: 'axis' });
    Object.assign(this.runs, { id: 'other-run' });
    Object.assign(this.slider, { id: 'smoothing', type: 'range', min: '0', max: '0.99', step: '0.01', value: String(this.weight) });
    this.weightText = make('output', '', number(this.weight, 2));
    this.axes.addEventListener('change', () => this.set({ axis: this.axes.value }));
    this.slider.addEventListener('input', () => this.set({ weight: Number(this.slider.value) }));
    this.runs.addEventListener('change', () => this.choose(this.runs.value));
    const label = (text, ...inputs) => make('label', '', '', make('span', '', text), ...inputs);
    return make('div', 'bar', '', label('X axis', this.axes), label('Smoothing', this.slider, this.weightText), label('Compare with', this.runs),
      make('span', 'faint on-screen', 'Drag to zoom, double-click to reset.'));
  }

  set(setting) {
    Object.assign(this, setting);
    keep(KEY, JSON.stringify({ axis: this.axis, weight: this.weight }));
    this.show();
  }

  /** Puts the other run into the address, and shows it. */
  choose(id) {
    const words = new URLSearchParams(location.hash.slice(1));
    if (id) words.set('run', id);
    else words.delete('run');
    history.replaceState(null, '', `#${words}`);
    keepAddress();
    this.again();
  }

  /** Whether more data may come. */
  get goesOn() {
    return true;
  }

  draw() {
    for (const chart of [...this.against, ...this.ofUpdates, this.rates]) chart.draw();
  }

  async again() {
    const wanted = new URLSearchParams(location.hash.slice(1)).get('run');
    const known = wanted && this.own?.runs.some(({ id }) => id === wanted);
    let [other, problem] = [null, ''];
    if (known) {
      try {
        const answer = await fetch(`/training_run/${wanted}.json`);
        if (!answer.ok) throw new Error(await answer.text());
        other = await answer.json();
        if (other.problem) throw new Error(other.problem);
      } catch (error) {
        [other, problem] = [null, `The other run cannot be shown: ${error.message}`];
      }
    }
    // Another run may have been chosen meanwhile.
    if (wanted !== new URLSearchParams(location.hash.slice(1)).get('run')) return;
    this.other = other && new Run(other, 1);
    this.problem = problem;
    this.show();
  }

  tell(report) {
    if (report.problem) throw new Error(report.problem);
    this.own = new Run(report, 0);
    this.again();
    const [words, tone] = this.own.state;
    return { name: report.name, facts: this.own.facts(), chip: [words, tone], remarks: [] };
  }

  show() {
    const shown = [this.own, this.other].filter(Boolean);
    const timed = shown.every(({ times }) => times.length > 0);
    options(this.axes, [['samples', 'million samples'], ['hours', timed ? 'hours' : 'hours (not recorded)']]);
    this.axes.options[1].disabled = !timed;
    const axis = timed ? this.axis : 'samples';
    this.axes.value = axis;
    options(this.runs, [['', this.own.runs.length > 0 ? 'no other run' : 'no other runs in this folder'], ...this.own.runs.map(({ id, name }) => [id, name])]);
    this.runs.value = new URLSearchParams(location.hash.slice(1)).get('run') ?? '';
    this.runs.disabled = this.own.runs.length === 0;
    write(this.weightText, number(this.weight, 2));
    this.drawCurves(shown, axis);
    this.drawBest(shown);
    this.drawEvaluations(this.own.evaluations);
    this.drawEpisodes(this.own.episodes);
  }

  drawCurves(shown, axis) {
    const at = (run, samples) => (axis === 'hours' ? run.hours(samples) : samples / MILLION);
    const to = Math.max(...shown.map((run) => at(run, run.last?.samples ?? 0)));
    const { updates } = this.own;
    const begins = updates.filter(({ stage }, i) => i > 0 && stage !== updates[i - 1].stage).map(({ samples, stage }) => [at(this.own, samples), stage]);
    const words = (x) => (axis === 'hours' ? `${number(x, 2)} hours` : `${number(x, 2)} million samples`);
    const how = { title: axis === 'hours' ? 'hours' : 'million samples', words, begins, to };
    const name = (run, opponent) => [opponent, shown.length > 1 ? run.name : ''].filter(Boolean).join(' · ');
    const opponents = [...new Set(shown.flatMap(({ evaluations }) => evaluations.map(({ opponent }) => opponent)))];
    AGAINST.forEach(([, , value], which) => this.against[which].take(shown.flatMap((run) => opponents.map((opponent, colour) => {
      const seen = run.evaluations.filter((each) => each.opponent === opponent);
      const best = run.bestSamples === null ? null : at(run, run.bestSamples);
      // With a single opponent, colours distinguish the runs.
      const style = opponents.length > 1 ? { colour, style: Math.floor(colour / 4) + run.style } : { colour: run.style, style: run.style };
      return { name: name(run, opponent), xs: seen.map(({ samples }) => at(run, samples)), values: seen.map(value), best, dots: true, ...style };
    }).filter(({ xs }) => xs.length > 0)), how));
    const curve = (run, rows, values) => {
      const isRaw = this.weight > 0;
      return { name: name(run, ''), colour: run.style, style: run.style, xs: rows.map(({ samples }) => at(run, samples)), values: isRaw ? smoothed(values, this.weight) : values,
        raw: isRaw ? values : null };
    };
    OF_UPDATES.forEach(([, , column], which) => this.ofUpdates[which].take(shown.map((run) => curve(run, run.updates, run.updates.map((each) => each[column]))), how));
    const rates = ({ times }) => times.map(({ samples, elapsed_s }, i) => {
      const before = times[i - 1] ?? { samples: 0, elapsed_s: 0 };
      return elapsed_s > before.elapsed_s ? (samples - before.samples) / (elapsed_s - before.elapsed_s) : null;
    });
    this.rates.take(shown.map((run) => curve(run, run.times, rates(run))), how);
  }

  /** The runs shown, and the command that plays the best policy of each. */
  drawBest(shown) {
    const row = (run) => make('tr', `team-${run.style}`, '', make('th', '', '', ...(shown.length > 1 ? [make('i', `line-swatch ${run.style ? 'dashed' : 'solid'}`)] : []), run.name),
      cell(run.state[0] || '–'), cell(`${millions(run.last?.samples ?? 0)} M`, 'number'), cell(run.elapsed_s === null ? '–' : duration(run.elapsed_s), 'number'),
      cell(run.rate ? perSecond(run.rate) : '–', 'number'), cell(isNumber(run.bestShare) ? `★ ${number(run.bestShare, 0)} %` : '–', 'number strong'),
      cell(run.bestSamples === null ? '–' : `${millions(run.bestSamples)} M`, 'number'), cell(run.plan?.seed ?? '–', 'number'));
    const heads = [['Run'], ['State'], ['Samples', 'number'], ['Time', 'number'], ['Speed', 'number'], ['Best win rate', 'number'], ['Best after', 'number'], ['Seed', 'number']];
    const plays = shown.filter(({ plan }) => plan?.play).flatMap(({ name, plan }) => [
      make('p', 'play', shown.length > 1 ? `Play the best policy of ${name}:` : 'Play the best policy:'), commandOf(plan.play, `plays the best policy of ${name}`)]);
    const none = shown.every(({ plan }) => !plan?.play) ? [make('p', 'faint', 'No best policy yet: the first evaluation determines it.')] : [];
    this.best.replaceChildren(...(this.problem ? [make('p', 'note', this.problem)] : []), tableOf('Runs', heads, shown.map(row)), ...plays, ...none);
  }

  /** The evaluation of each checkpoint, newest first. */
  drawEvaluations(evaluations) {
    show(this.newest, evaluations.length > 0);
    const heads = [['Samples', 'number'], ['Stage'], ['Opponent'], ...['Won', 'Drawn', 'Lost', 'Points', 'Left the field'].map((text) => [text, 'number'])];
    const row = (each) => make('tr', each.samples === this.own.bestSamples ? 'best' : '', '', ...this.first(each), ...[String(each.won), String(each.drawn), String(each.lost),
      `${number(each.points, 1)} : ${number(each.points_against, 1)}`, number(each.left_field, 1)].map((text) => cell(text, 'number')));
    this.newest.replaceChildren(make('h2', '', 'Evaluation games'), make('p', 'faint', 'Games of each checkpoint against each opponent, newest first. Points are means per game. ★ marks the best policy.'),
      tableOf('Evaluation games', heads, evaluations.slice(-ROWS_MAX).reverse().map(row)));
  }

  /** The first cells of every row. */
  first({ samples, stage, opponent }) {
    return [cell(`${millions(samples)} M`, 'number'), cell(plain(stage)), cell(plain(opponent))];
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
