// Plots of the selected boat over a recorded game, below the time line and synchronised with the chart.

import { drawDiagram, partAt, sampleAt } from './diagram.js';
import { palette, teamColour } from './palette.js';
import { keep, recall } from './storage.js';
import { bearing, clock, make, number, options, plain, show, write } from './words.js';

const KEY = 'squall.plots';
const MARGIN = { left: 4, right: 4, top: 4, bottom: 4 };
const NONE = '';
/** Minimum range of a plot, m or m/s, so that noise does not fill it. */
const LEAST = 1;

const metres = (value) => number(value, 1, 'm');
const speed = (value) => number(value, 2, 'm/s');

/** Each plot: title, the boat's curves (the ordered one first), the format of values, and whether they wrap around. */
const PLOTS = [
  ['Speed', ['ordered_speed_m_s', 'speed_m_s'], speed, false],
  ['Heading', ['ordered_heading_deg', 'heading_deg'], bearing, true],
  ['To the flag', ['flag_m'], metres, false],
  ['Navigation error', ['error_m'], metres, false],
  ['Range', ['range_m'], metres, false],
];

export class Plots {
  /** `on` has `send(message)`, `seek(t_s)`, and `moved()`, called when the chart's size changes. */
  constructor(on) {
    this.on = on;
    this.button = document.getElementById('show-plots');
    this.place = document.getElementById('plots');
    this.other = make('select');
    this.other.id = 'plot-other';
    this.other.setAttribute('aria-label', 'Range to');
    this.open = recall(KEY) === 'true';
    this.asked = '';
    this.curves = null;
    this.button.addEventListener('click', () => this.toggle());
    this.other.addEventListener('change', () => { this.asked = ''; });
    this.plots = PLOTS.map(([title, keys, words, round]) => this.build(title, keys, words, round));
    this.none = make('p', 'faint', 'Select a boat to see its curves.');
    this.place.replaceChildren(this.none, ...this.plots.map(({ box }) => box));
  }

  build(title, keys, words, round) {
    const canvas = make('canvas');
    canvas.setAttribute('role', 'img');
    const value = make('span', 'value');
    const head = make('figcaption', '', '', make('span', '', title), ...(title === 'Range' ? [this.other] : []), value);
    canvas.addEventListener('pointerdown', (event) => this.press(event, canvas));
    canvas.addEventListener('pointermove', (event) => event.buttons > 0 && this.press(event, canvas));
    return { box: make('figure', 'plot', '', head, canvas), canvas, value, title, keys, words, round, drawn: '' };
  }

  press(event, canvas) {
    const { t_s } = this.curves ?? {};
    if (t_s?.length > 0) this.on.seek(t_s[0] + partAt(event, canvas, MARGIN) * (t_s.at(-1) - t_s[0]));
  }

  toggle() {
    this.open = !this.open;
    keep(KEY, String(this.open));
    this.on.moved();
  }

  greet(game) {
    this.curves = null;
    this.asked = '';
    options(this.other, [[NONE, 'to …'], ...game.vehicles.map(({ name }) => [name, `to ${plain(name)}`])]);
  }

  /** Takes curves from the server. The score alone is for the time line. */
  take(message) {
    if (message.vehicle === null) return;
    this.curves = message;
  }

  /** Requests the curves of the selected boat once they are visible, and draws them. */
  tell(game) {
    const replay = game.mode === 'replay';
    show(this.button, replay);
    this.button.setAttribute('aria-pressed', String(this.open));
    show(this.place, replay && this.open);
    if (!replay || !this.open) return;
    const boat = game.selected;
    const other = this.other.value === boat ? NONE : this.other.value;
    const wanted = `${boat} ${other}`;
    if (boat !== null && wanted !== this.asked && this.on.send({ do: 'curves', vehicle: boat, other: other || null })) this.asked = wanted;
    show(this.none, boat === null);
    for (const plot of this.plots) {
      show(plot.box, boat !== null);
      if (boat !== null) this.draw(plot, game);
    }
  }

  /** The known curves of a plot. */
  lists(plot, boat) {
    if (this.curves?.vehicle !== boat) return [];
    return plot.keys.map((key) => (key === 'range_m' ? this.curves.range_m : this.curves.boat?.[key]) ?? []);
  }

  draw(plot, game) {
    const lists = this.lists(plot, game.selected);
    const times = this.curves?.t_s ?? [];
    const at = sampleAt(times, game.t_s);
    const now = lists.at(-1)?.[at];
    const words = Number.isFinite(now) ? plot.words(now) : '–';
    write(plot.value, words);
    const label = `${plot.title} of ${plain(game.selected)} over the game; at ${clock(game.t_s)}: ${words}`;
    if (plot.canvas.getAttribute('aria-label') !== label) plot.canvas.setAttribute('aria-label', label);
    const { clientWidth: width, clientHeight: height } = plot.canvas;
    const ratio = Math.min(2, devicePixelRatio);
    const key = `${width} ${height} ${ratio} ${palette.version} ${at} ${this.curves?.vehicle} ${this.curves?.other} ${game.selected}`;
    if (key === plot.drawn || width === 0) return;
    plot.drawn = key;
    const most = plot.round ? 360 : Math.max(LEAST, ...lists.map((list) => list.reduce((most, each) => Math.max(most, each ?? 0), 0)));
    const { team } = game.vehicles[game.indexOf.get(game.selected)];
    const line = (values, which) => (lists.length === 2 && which === 0
      ? { xs: times, values, colour: palette.faint, width: 1 } : { xs: times, values, colour: teamColour(team), width: 1.5 });
    drawDiagram(plot.canvas, {
      lines: lists.map(line), from: times[0] ?? 0, to: times.at(-1) ?? 1, low: 0, high: most, margin: MARGIN, at: game.t_s,
      corner: plot.round ? '360°' : plot.words(most), round: plot.round,
    });
  }
}
