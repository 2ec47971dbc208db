// Plots of boats over the game, below the chart: any quantities of any boats, with the section and the current time of
// the timeline.

import { Curves } from './curves.js';
import { History } from './history.js';
import { palette, teamColour } from './palette.js';
import { Plot } from './plot.js';
import { keep, recallObject } from './storage.js';
import { make, options, plain, show, write } from './words.js';

const KEY = 'squall.plots';
const ADD = '';
const EVERYBODY = '*';
const DEFAULT = [{ quantity: 'speed_m_s' }, { quantity: 'heading_deg' }];
const PLOTS_MAX = 6;
/** Boats with their own colour. */
const COLOURS = 8;
/** Reciprocal of the maximum share of time that drawing takes in a live game. */
const SHARE = 25;
/** Minimum interval between drawings of new samples, ms. */
const AGAIN_MS = 250;

export class Plots {
  /** `on` has `send(message)`, which returns whether it was sent, `seek(t_s)`, and `span`. */
  constructor(on) {
    this.on = on;
    this.button = document.getElementById('show-plots');
    this.place = document.getElementById('plots');
    this.curves = new Curves(on.send);
    this.history = new History();
    const stored = recallObject(KEY);
    this.open = stored === true || stored?.open === true;
    this.boats = Array.isArray(stored?.boats) ? stored.boats : [];
    this.rest_ms = 0;
    this.spent_ms = 0;
    this.build();
    for (const each of Array.isArray(stored?.plots) && stored.plots.length > 0 ? stored.plots.slice(0, PLOTS_MAX) : DEFAULT) this.add(each);
    this.button.addEventListener('click', () => this.toggle());
  }

  build() {
    this.chips = make('span', 'plot-boats');
    this.chooser = make('select');
    this.chooser.id = 'plot-boats';
    this.chooser.setAttribute('aria-label', 'Boats');
    this.chooser.addEventListener('change', () => this.choose(this.chooser.value));
    this.more = make('button', '', '+ Plot');
    Object.assign(this.more, { id: 'plot-add', type: 'button', title: 'Add a plot' });
    this.more.addEventListener('click', () => {
      this.add({ quantity: 'flag_m' });
      this.changed();
    });
    this.whole = make('button', '', 'Whole game');
    Object.assign(this.whole, { type: 'button', title: 'Show the whole game (double-click)' });
    this.whole.addEventListener('click', () => this.on.span.showAll());
    this.box = make('div', 'plot-grid');
    this.place.append(make('div', 'plots-head', '', this.chips, this.chooser, this.more, this.whole), this.box);
    this.plots = [];
  }

  add(settings) {
    const plot = new Plot({
      span: this.on.span, seek: (t_s) => this.game.mode === 'replay' && this.on.seek(t_s),
      changed: () => this.changed(), remove: (each) => this.remove(each),
    }, settings);
    this.plots.push(plot);
    this.box.append(plot.box);
    if (this.game) plot.greet(this.game);
  }

  remove(plot) {
    plot.remove();
    this.plots = this.plots.filter((each) => each !== plot);
    this.changed();
  }

  /** Stores the settings. */
  changed() {
    keep(KEY, JSON.stringify({ open: this.open, boats: this.boats, plots: this.plots.map(({ settings }) => settings) }));
    show(this.more, this.plots.length < PLOTS_MAX);
    this.rest_ms = 0;
  }

  toggle() {
    this.open = !this.open;
    this.changed();
    this.showOpen();
  }

  showOpen() {
    show(this.place, this.open && Boolean(this.game));
    document.body.classList.toggle('plotting', this.open);
    this.button.setAttribute('aria-pressed', String(this.open));
  }

  /** Adds a boat, a team or all boats. */
  choose(value) {
    const { vehicles, chart } = this.game;
    const team = chart.teams.findIndex((_, index) => value === `team ${index}`);
    const more = vehicles.filter((vehicle) => value === EVERYBODY || vehicle.name === value || vehicle.team === team).map(({ name }) => name);
    this.boats = [...new Set([...this.boats, ...more])];
    this.chooser.value = ADD;
    this.changed();
  }

  greet(game) {
    this.game = game;
    this.curves.greet(game);
    this.history.greet(game);
    options(this.chooser, [[ADD, '+ Boats'], [EVERYBODY, 'all boats'], ...game.chart.teams.map(({ name }, index) => [`team ${index}`, `all of ${plain(name)}`]),
      ...game.vehicles.map(({ name }) => [name, plain(name)])]);
    for (const plot of this.plots) plot.greet(game);
    this.on.span.forget();
    this.showOpen();
  }

  get source() {
    return this.game.mode === 'replay' ? this.curves : this.history;
  }

  /** The boats shown, by index: the added ones and the selected one. */
  shown(game) {
    const names = game.selected === null || this.boats.includes(game.selected) ? this.boats : [...this.boats, game.selected];
    return names.map((name) => game.indexOf.get(name)).filter((index) => index !== undefined);
  }

  /** The first boat of a team has the team's colour, the others have further colours; in a crowd, all have their team's colour. */
  colours(game, boats) {
    const taken = new Set();
    let extra = game.chart.teams.length;
    return new Map(boats.map((boat) => {
      const team = game.teams[boat];
      const own = boats.length > COLOURS || !taken.has(team);
      taken.add(team);
      return [boat, own ? teamColour(team) : palette.series[extra++ % COLOURS]];
    }));
  }

  /** Samples a frame, and requests missing curves. */
  tell(game) {
    if (game.mode === 'live') {
      const { times } = this.history;
      if (times.length > 0) this.on.span.setWhole(times[0], times.at(-1));
    }
    if (!this.open || !game.hello) return;
    const boats = this.shown(game);
    const others = this.plots.map((plot) => plot.otherOf(game)).filter((index) => index >= 0);
    if (game.mode === 'replay') this.curves.want([...boats, ...others]);
    this.tellChips(game, boats);
    show(this.whole, this.on.span.zoomed);
  }

  tellChips(game, boats) {
    const key = `${boats.join()} ${game.selected} ${this.boats.join()} ${palette.version} ${game.greeted}`;
    if (key === this.chipped) return;
    this.chipped = key;
    const colours = this.colours(game, boats);
    const chips = boats.length > COLOURS ? [this.chip(`${boats.length} boats`, 'transparent', () => { this.boats = []; })]
      : boats.map((boat) => {
        const { name } = game.vehicles[boat];
        const added = this.boats.includes(name);
        return this.chip(plain(name), colours.get(boat), added ? () => { this.boats = this.boats.filter((each) => each !== name); } : null);
      });
    this.chips.replaceChildren(...(chips.length > 0 ? chips : [make('span', 'faint', 'Select a boat, or add boats.')]));
  }

  /** A boat with its colour; `remove` removes it. */
  chip(name, colour, remove) {
    const swatch = make('span', 'plot-swatch');
    swatch.style.setProperty('--team', colour);
    const chip = make(remove ? 'button' : 'span', 'plot-chip', '', swatch, make('span', '', name));
    if (!remove) return chip;
    Object.assign(chip, { type: 'button', title: `Remove ${name}` });
    chip.append(make('span', 'cross', '×'));
    chip.addEventListener('click', () => {
      remove();
      this.changed();
      this.tell(this.game);
    });
    return chip;
  }

  /** Draws at most one plot per frame, and in a live game only as often as time permits. */
  draw(game, now_ms) {
    if (!this.open || !game.hello) return;
    const live = game.mode === 'live';
    if (!live || now_ms >= this.rest_ms) this.drawNext(game, now_ms, live);
    for (const plot of this.plots) plot.mark(game);
  }

  drawNext(game, now_ms, live) {
    const boats = this.shown(game);
    const colours = this.colours(game, boats);
    const colourOf = (boat) => colours.get(boat);
    const first = this.turn ?? 0;
    for (let i = 0; i < this.plots.length; i++) {
      const at = (first + i) % this.plots.length;
      const began_ms = performance.now();
      if (!this.plots[at].draw(game, this.source, boats, colourOf)) continue;
      this.turn = at + 1;
      this.spent_ms += performance.now() - began_ms;
      // A crowd is not finished yet.
      if (this.plots[at].crowd.job) {
        this.turn = at;
        return;
      }
      if (live) this.rest_ms = now_ms + Math.max(AGAIN_MS / this.plots.length, this.spent_ms * SHARE);
      this.spent_ms = 0;
      return;
    }
  }
}
