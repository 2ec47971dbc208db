// Names beside boats: drawn once and then copied, placed where no other name is.

import { palette } from './palette.js';
import { plain } from './words.js';

const FONT = '600 12px system-ui, sans-serif';
const HEIGHT = 18;
/** Size of a cell for checking free space, px. */
const CELL = 4;
/** Positions of a name around its boat: beside, below, above and at the corners, as fractions of its width, its height and its clearance. */
const PLACES = [[0, -0.5, 1, 0], [-1, -0.5, -1, 0], [-0.5, 0, 0, 1], [-0.5, -1, 0, -1],
  [0, 0, 0.7, 0.7], [-1, 0, -0.7, 0.7], [0, -1, 0.7, -0.7], [-1, -1, -0.7, -0.7]];
/** A wanted name may be this far away, in clearances, with a line to its boat. */
const FAR = [2.5, 4, 6, 9, 13];

export class Labels {
  constructor() {
    this.sprites = [];
    this.vehicles = [];
    /** In the last picture: index, left, top, right and bottom of each name, one after the other. */
    this.drawn = [];
    this.key = '';
    this.taken = new Uint8Array(0);
    this.place = new Uint8Array(0);
  }

  /** Call before the labels of a picture; `ratio` is device pixels per pixel. */
  begin(vehicles, view, ratio) {
    const key = `${palette.version} ${ratio} ${vehicles.length} ${vehicles[0]?.name}`;
    if (key !== this.key) {
      this.key = key;
      this.sprites = [];
      this.place = new Uint8Array(vehicles.length);
    }
    this.drawn = [];
    this.vehicles = vehicles;
    this.ratio = ratio;
    this.width = view.width;
    this.height = view.height;
    this.across = Math.ceil(view.width / CELL);
    this.down = Math.ceil(view.height / CELL);
    if (this.taken.length < this.across * this.down) this.taken = new Uint8Array(this.across * this.down);
    else this.taken.fill(0);
  }

  sprite(index) {
    const known = this.sprites[index];
    if (known) return known;
    const canvas = document.createElement('canvas');
    const context = canvas.getContext('2d');
    context.font = FONT;
    const name = plain(this.vehicles[index].name);
    const width = Math.ceil(context.measureText(name).width) + 8;
    canvas.width = Math.ceil(width * this.ratio);
    canvas.height = Math.ceil(HEIGHT * this.ratio);
    context.scale(this.ratio, this.ratio);
    context.font = FONT;
    context.textBaseline = 'middle';
    context.lineJoin = 'round';
    context.lineWidth = 3.5;
    context.strokeStyle = palette.halo;
    context.strokeText(name, 4, HEIGHT / 2);
    context.fillStyle = palette.ink;
    context.fillText(name, 4, HEIGHT / 2);
    const made = { canvas, width };
    this.sprites[index] = made;
    return made;
  }

  /** Reserves a box, so that no name is placed there. */
  block(left, top, right, bottom) {
    this.each(left, top, right, bottom, (cell) => {
      this.taken[cell] = 1;
      return true;
    });
  }

  /** Reserves a box if it is free. Returns whether it was. */
  claim(left, top, right, bottom) {
    if (!this.each(left, top, right, bottom, (cell) => this.taken[cell] === 0)) return false;
    this.block(left, top, right, bottom);
    return true;
  }

  /** Whether `visit` accepts every cell of a box. */
  each(left, top, right, bottom, visit) {
    const first = Math.max(0, Math.floor(left / CELL));
    const last = Math.min(this.across - 1, Math.floor(right / CELL));
    const low = Math.min(this.down - 1, Math.floor(bottom / CELL));
    for (let row = Math.max(0, Math.floor(top / CELL)); row <= low; row++) {
      for (let column = first; column <= last; column++) if (!visit(row * this.across + column)) return false;
    }
    return true;
  }

  /** Reserves a box of this size beside a position, at `first` in `PLACES` if that is free, or else nearby or farther away. Returns
   * `{ left, top, place, out }`, the last in pixels from the position; null if there is no space. */
  fit(width, height, x, y, room, first) {
    for (const times of [1, ...FAR]) {
      for (let i = -1; i < PLACES.length; i++) {
        const place = i < 0 ? first : i;
        const [alongX, alongY, outX, outY] = PLACES[place];
        const out = room * times;
        const left = Math.round(x + alongX * width + outX * out);
        const top = Math.round(y + alongY * height + outY * out);
        if (left < 2 || top < 2 || left + width > this.width - 2 || top + height > this.height - 2) continue;
        if (this.claim(left, top, left + width, top + height)) return { left, top, place, out };
      }
    }
    return null;
  }

  /** Draws a name at least `room` pixels from its boat's centre, at its last position if that is free. Without free space it is left
   * out, unless `wanted`: then it is placed farther away. No name covers a boat or another name. */
  draw(context, index, x, y, room, wanted) {
    if (this.put(context, index, x, y, room, this.place[index])) return;
    for (let place = 0; place < PLACES.length; place++) {
      if (!this.put(context, index, x, y, room, place)) continue;
      this.place[index] = place;
      return;
    }
    for (let far = 0; wanted && far < FAR.length; far++) {
      for (let place = 0; place < PLACES.length; place++) if (this.put(context, index, x, y, room * FAR[far], place, room)) return;
    }
  }

  /** Draws a name at a position around its boat if that is free, with a line that starts `lead` pixels from the boat. */
  put(context, index, x, y, room, place, lead = 0) {
    const { canvas, width } = this.sprite(index);
    const [alongX, alongY, outX, outY] = PLACES[place];
    const left = x + alongX * width + outX * room;
    const top = y + alongY * HEIGHT + outY * room;
    const [right, bottom] = [left + width - 2, top + HEIGHT - 3];
    if (left < 0 || top < 0 || left + width > this.width || top + HEIGHT > this.height) return false;
    if (!this.claim(left, top, right, bottom)) return false;
    if (lead > 0) {
      const part = lead / room;
      context.beginPath();
      context.moveTo(x + outX * room * part, y + outY * room * part);
      context.lineTo(x + outX * room, y + outY * room);
      context.lineWidth = 1;
      context.strokeStyle = palette.ink;
      context.stroke();
    }
    context.drawImage(canvas, left, top, width, HEIGHT);
    this.drawn.push(index, left, top, right, bottom);
    return true;
  }

  /** The names in the last picture and their areas. */
  boxes() {
    const boxes = [];
    for (let i = 0; i < this.drawn.length; i += 5) {
      const [index, left, top, right, bottom] = this.drawn.slice(i, i + 5);
      boxes.push({ name: this.vehicles[index].name, left, top, right, bottom });
    }
    return boxes;
  }
}
