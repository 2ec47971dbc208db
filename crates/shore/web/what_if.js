// What if: futures of a recorded game from the current moment, with other strategies or in another sea.

import { palette } from './palette.js';
import uPlot from './vendor/uplot.js';
import { clock, clockShort, make, number, options, plain, show, write } from './words.js';

const FONT = '11px system-ui, sans-serif';
const COUNTS = [20, 50, 100, 200, 500];
const USUAL = 100;
const AS_RECORDED = '';
/** Opacity of the middle 90 and 50 %. */
const BANDS = [0.16, 0.3];

const byId = (id) => document.getElementById(id);

/** A word of a shell command, in quotes where it needs them. */
const quoted = (word) => (/^[\w./=:@-]+$/.test(word) ? word : `'${word.replaceAll("'", "'\\''")}'`);

/** A fan chart of both teams' points: medians, with the middle 50 and 90 % of futures. */
class FanChart {
  constructor(title) {
    this.place = make('div', 'fan');
    this.box = make('figure', '', '', make('figcaption', '', '', make('strong', '', title), make('span', 'faint', ' median, middle 50 and 90 %')), this.place);
  }

  /** `fans` has for each team a list of points for each quantile; `most` is the top of the scale. */
  take(t_s, fans, teams, most) {
    this.chart?.destroy();
    const { clientWidth: width, clientHeight: height } = this.place;
    const side = { stroke: palette.faint, font: FONT, grid: { stroke: palette.grid, width: 1 }, ticks: { stroke: palette.grid, size: 4, width: 1 } };
    const colour = (team) => palette.teams[team] ?? palette.ink;
    const fade = (team, share) => `color-mix(in srgb, ${colour(team)} ${100 * share}%, transparent)`;
    const steps = uPlot.paths.stepped({ align: 1 });
    const series = fans.flatMap((quantiles, team) => quantiles.map((_, i) => ({
      label: `${teams[team]} ${i}`, stroke: i === 2 ? colour(team) : 'transparent', width: i === 2 ? 2 : 0, paths: steps, points: { show: false },
    })));
    const bands = fans.flatMap((_, team) => BANDS.map((share, i) => ({ series: [5 * team + 5 - i, 5 * team + 1 + i], fill: fade(team, share) })));
    this.chart = new uPlot({
      width, height, legend: { show: false }, padding: [8, 22, 0, 0], cursor: { show: false },
      scales: { x: { time: false }, y: { range: () => [0, most] } },
      axes: [
        { ...side, size: 24, gap: 3, values: (_, ticks) => ticks.map(clockShort) },
        { ...side, size: 34, gap: 4, space: 26, incrs: [1, 2, 5, 10, 20, 50, 100, 200, 500], values: (_, ticks) => ticks.map((each) => number(each, 0)) },
      ],
      series: [{}, ...series], bands,
    }, [t_s, ...fans.flat()], this.place);
    const end = fans.map(([low, , median, , high], team) => `${plain(teams[team])} ${median.at(-1)}, ${low.at(-1)} to ${high.at(-1)}`);
    this.place.setAttribute('role', 'img');
    this.place.setAttribute('aria-label', `Points at the end, median and the middle 90 %: ${end.join('; ')}`);
  }
}

export class WhatIf {
  /** `at()` is the current moment of the replay, s. */
  constructor(send, at) {
    Object.assign(this, { send, at, running: false, result: null, choices: null });
    this.button = byId('what-if');
    this.box = byId('what-if-box');
    this.button.addEventListener('click', () => this.open());
    this.box.addEventListener('close', () => this.stop());
    // Keys belong to the form, not to the game.
    this.box.addEventListener('keydown', (event) => event.stopPropagation());
  }

  greet({ mode, chart, rights }) {
    const known = mode === 'replay' ? chart.what_if : null;
    show(this.button, Boolean(known));
    if (this.box.open) this.box.close();
    this.choices = known ?? null;
    this.running = false;
    this.button.disabled = !rights;
    this.button.title = rights ? 'Play futures from this moment with other strategies or in another sea' : 'This page may only watch. To play futures, open it with the token.';
    if (known) this.build(chart);
  }

  build(chart) {
    const select = (choices, of) => {
      const field = make('select', of);
      options(field, choices);
      field.addEventListener('change', () => this.tell());
      return field;
    };
    const { strategies, seas, futures_max: most } = this.choices;
    const named = (names) => [[AS_RECORDED, 'as recorded'], ...names.map((name) => [name, plain(name)])];
    this.teams = chart.teams.slice(0, 2).map(({ name }) => name);
    this.ofTeams = this.teams.map((name) => select(named(strategies), { id: `what-if-team-${name}` }));
    this.ofBoats = chart.vehicles.map(({ name }) => [name, select(named(strategies), { id: `what-if-boat-${name}` })]);
    this.sea = select(named(seas), { id: 'what-if-sea' });
    this.count = select(COUNTS.filter((count) => count <= most).map((count) => [String(count), String(count)]), { id: 'what-if-futures' });
    this.count.value = String(USUAL);
    const row = (label, field, team) => make('label', team === undefined ? '' : `team-${team}`, '', make('span', '', label), field);
    this.moment = make('strong');
    this.play = make('button', { type: 'button', id: 'what-if-play', class: 'primary', onclick: () => (this.running ? this.stop() : this.start()) });
    this.progress = make('progress', { id: 'what-if-progress', hidden: true });
    this.said = make('p', { id: 'what-if-said', role: 'status', class: 'faint' });
    this.table = make('table', { id: 'what-if-table', hidden: true });
    this.charts = ['Points as recorded', 'Points with the changes'].map((title) => new FanChart(title));
    this.fans = make('div', { class: 'fans', hidden: true }, '', ...this.charts.map(({ box }) => box));
    this.command = make('code', { id: 'what-if-command' });
    const boats = make('details', '', '', make('summary', '', 'Single boats'), make('div', 'what-if-form', '', ...this.ofBoats.map(([name, field], i) => row(plain(name), field, chart.vehicles[i].team))));
    this.box.replaceChildren(
      make('header', '', '', make('h2', { id: 'what-if-title' }, 'What if'), make('button', { type: 'button', 'aria-label': 'Close', onclick: () => this.box.close() }, '×')),
      make('p', '', 'Plays futures of this game from ', this.moment, ' on, each once as recorded and once with these changes, with the same random numbers.'),
      make('div', 'what-if-form', '', ...this.teams.map((name, team) => row(`${plain(name)} plays`, this.ofTeams[team], team)), row('Sea', this.sea), row('Futures', this.count)),
      boats,
      make('div', 'what-if-row', '', this.play, this.progress, this.said),
      this.fans, this.table,
      make('p', 'faint', 'In a terminal: ', this.command, '. Add ', make('code', '', '--record FILE'), ' to keep the future that changes most.'),
    );
  }

  open() {
    this.at_s = Math.floor(this.at() * 10) / 10;
    write(this.moment, clock(this.at_s));
    this.tell();
    this.box.showModal();
  }

  /** The changes by team, by boat and of the sea. */
  get question() {
    const chosen = (pairs) => Object.fromEntries(pairs.filter(([, field]) => field.value !== AS_RECORDED).map(([name, field]) => [name, field.value]));
    return {
      at_s: this.at_s, futures: Number(this.count.value), sea: this.sea.value || null,
      teams: chosen(this.teams.map((name, team) => [name, this.ofTeams[team]])), vehicles: chosen(this.ofBoats),
    };
  }

  tell() {
    const { at_s, futures, teams, vehicles, sea } = this.question;
    const changes = [...Object.entries(teams).map(([team, name]) => `--${team} ${quoted(name)}`), ...Object.entries(vehicles).map(([boat, name]) => `--vehicle ${quoted(`${boat}=${name}`)}`), ...(sea ? [`--sea ${quoted(sea)}`] : [])];
    this.changed = changes.length > 0;
    write(this.play, this.running ? 'Stop' : 'Play');
    this.play.disabled = !this.running && !this.changed;
    write(this.command, `squall whatif ${quoted(this.recording ?? 'GAME.mcap')} --at ${at_s} ${changes.join(' ')}${changes.length > 0 ? ' ' : ''}--futures ${futures}`);
    if (!this.running && !this.changed && !this.result) write(this.said, 'Choose a strategy or a sea.');
    else if (!this.running && !this.result) write(this.said, '');
  }

  /** The file of the recording, for the command. */
  setRecording(file) {
    this.recording = file;
  }

  start() {
    this.running = true;
    this.result = null;
    show(this.fans, false);
    show(this.table, false);
    show(this.progress, true);
    this.progress.removeAttribute('value');
    write(this.said, 'Replaying the game up to this moment');
    this.send({ do: 'what_if', question: this.question });
    this.tell();
  }

  stop() {
    if (!this.running) return;
    this.send({ do: 'what_if', question: null });
    this.end('Stopped');
  }

  end(text) {
    this.running = false;
    show(this.progress, false);
    this.tell();
    write(this.said, text);
  }

  /** Takes progress, a failure or the result. */
  take({ done, total, result, failed }) {
    if (!this.running) return;
    if (failed) return this.end(failed);
    this.progress.max = total;
    if (done > 0) this.progress.value = done;
    if (!result) return write(this.said, done > 0 ? `${done} of ${total} futures` : 'Replaying the game up to this moment');
    this.result = result;
    this.end(`${total} futures; ± 95 %`);
    this.show(result);
  }

  show({ quantities, t_s, recorded, changed }) {
    show(this.fans, true);
    show(this.table, true);
    const most = Math.max(1, ...[...recorded, ...changed].map((quantiles) => quantiles[4].at(-1)));
    [recorded, changed].forEach((fans, i) => this.charts[i].take(t_s, fans, this.teams, Math.ceil(most * 1.08)));
    const cell = ({ mean, low, high }, share, signed) => {
      const [times, places, unit] = share ? [100, 0, ' %'] : [1, 2, ''];
      const half = low === null || high === null ? null : ((high - low) / 2) * times;
      const certain = signed && low !== null && (low > 0 || high < 0);
      return make('td', certain ? 'certain' : '', `${signed && mean > 0 ? '+' : ''}${number(mean * times, places)} ± ${number(half, places)}${unit}`);
    };
    const rows = quantities.map((row) => make('tr', `team-${this.teams.indexOf(row.team)}`, '', make('th', { scope: 'row' }, '', make('span', 'swatch'), ` ${plain(row.team)} ${row.quantity}`),
      cell(row.recorded, row.is_share), cell(row.changed, row.is_share), cell(row.difference, row.is_share, true)));
    this.table.replaceChildren(
      make('thead', '', '', make('tr', '', '', ...['Per game', 'As recorded', 'Changed', 'Difference'].map((title) => make('th', { scope: 'col' }, title)))),
      make('tbody', '', '', ...rows),
    );
  }
}
