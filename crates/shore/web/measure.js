// The measure tool: range and bearing between two positions or boats on the chart, and the coordinates under the pointer.

import { latLonWords } from './datum.js';
import { haloText } from './field.js';
import { palette } from './palette.js';
import { bearing, number, plain, show, write } from './words.js';

const CROSS_PX = 9;

export class Measure {
  /** `on` has `changed()`. */
  constructor(on) {
    this.on = on;
    this.button = document.getElementById('measure');
    this.words = document.getElementById('measured');
    this.place = document.getElementById('place');
    this.sheet = document.getElementById('sheet');
    this.active = false;
    /** At most two ends: `{ boat }` with its index, or `{ x, y }`. */
    this.ends = [];
    /** Position of the pointer, px; null outside. */
    this.pointed = null;
    this.button.addEventListener('click', () => this.toggle());
  }

  toggle() {
    this.active = !this.active;
    this.ends = [];
    this.button.setAttribute('aria-pressed', String(this.active));
    this.sheet.classList.toggle('measuring', this.active);
    this.on.changed();
  }

  forget() {
    this.ends = [];
    if (this.active) this.toggle();
  }

  /** Moves the pointer, px; far outside the chart it is null. */
  point(x, y) {
    this.pointed = x < -1e8 ? null : { x, y };
    if (this.active && this.ends.length === 1) this.on.changed();
  }

  /** Adds an end, a boat's index or a position; a third end starts over. */
  take(end) {
    if (this.ends.length === 2) this.ends = [];
    this.ends.push(end);
    this.on.changed();
  }

  placeOf(game, end) {
    return end.boat === undefined ? [end.x, end.y] : [game.x[end.boat], game.y[end.boat]];
  }

  /** Range, m, and bearing, degrees, from the first end to the second, and both positions; null without two ends. */
  reading(game, view) {
    if (!this.active || this.ends.length === 0) return null;
    const from = this.placeOf(game, this.ends[0]);
    let to = null;
    if (this.ends.length === 2) to = this.placeOf(game, this.ends[1]);
    else if (this.pointed) to = view.placeOf(this.pointed.x, this.pointed.y);
    if (!to) return { from, to: from, range_m: 0, bearing_deg: NaN };
    const [east, north] = [to[0] - from[0], to[1] - from[1]];
    return { from, to, range_m: Math.hypot(east, north), bearing_deg: (Math.atan2(east, north) * 180) / Math.PI };
  }

  /** Draws the line above the boats. */
  draw(context, game, view) {
    if (!this.active) return;
    if (!this.pointed && this.ends.length < 2) this.cross(context, view.width / 2, view.height / 2);
    const reading = this.reading(game, view);
    if (!reading) return;
    const [fromX, fromY] = [view.xOf(...reading.from), view.yOf(...reading.from)];
    const [toX, toY] = [view.xOf(...reading.to), view.yOf(...reading.to)];
    for (const [width, colour] of [[4, palette.halo], [2, palette.accent]]) {
      context.beginPath();
      context.moveTo(fromX, fromY);
      context.lineTo(toX, toY);
      context.lineWidth = width;
      context.strokeStyle = colour;
      context.stroke();
    }
    for (const [x, y] of [[fromX, fromY], [toX, toY]]) {
      context.beginPath();
      context.arc(x, y, 4, 0, 2 * Math.PI);
      context.fillStyle = palette.accent;
      context.fill();
    }
    if (reading.range_m === 0) return;
    context.font = '600 13px system-ui, sans-serif';
    context.textAlign = 'center';
    context.textBaseline = 'bottom';
    haloText(context, this.short(reading), (fromX + toX) / 2, (fromY + toY) / 2 - 6);
  }

  /** Where Enter adds an end: the centre of the chart. */
  cross(context, x, y) {
    context.beginPath();
    context.moveTo(x - CROSS_PX, y);
    context.lineTo(x + CROSS_PX, y);
    context.moveTo(x, y - CROSS_PX);
    context.lineTo(x, y + CROSS_PX);
    context.lineWidth = 2;
    context.strokeStyle = palette.accent;
    context.stroke();
  }

  short({ range_m, bearing_deg }) {
    const range = range_m >= 1000 ? number(range_m / 1000, 2, 'km') : number(range_m, 1, 'm');
    return `${range} ${bearing(bearing_deg)}`;
  }

  name(game, end) {
    return end.boat === undefined ? `${number(end.x, 1)}, ${number(end.y, 1)}` : plain(game.vehicles[end.boat].name);
  }

  /** Writes the measurement and the position of the pointer or, without one, of the chart's centre for keyboard users. */
  tell(game, view) {
    show(this.words, this.active);
    if (this.active) write(this.words, this.told(game, view));
    const byKeys = !this.pointed && this.sheet.matches(':focus-visible');
    const at = this.pointed ?? (byKeys ? { x: view.width / 2, y: view.height / 2 } : null);
    show(this.place, at !== null);
    if (!at) return;
    const [x, y] = view.placeOf(at.x, at.y);
    const { datum } = game.chart.field ?? {};
    write(this.place, `x ${number(x, 1)} y ${number(y, 1)} m${datum ? ` · ${latLonWords(datum, x, y)}` : ''}`);
  }

  told(game, view) {
    if (this.ends.length === 0) return 'Measure: choose the first boat or place.';
    const from = this.name(game, this.ends[0]);
    if (this.ends.length === 1) return `Measure from ${from}: choose the second boat or place.`;
    return `${from} to ${this.name(game, this.ends[1])}: ${this.short(this.reading(game, view))}`;
  }
}
