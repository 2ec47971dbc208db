// Names beside boats: each is drawn once and then copied, and put where no other name stands.

import { palette } from './palette.js';
import { plain } from './words.js';

const FONT = '600 12px system-ui, sans-serif';
const HEIGHT = 18;
/** Cells in which room is counted, px. */
const CELL = 9;
/** Places of a name about its boat: right, left, below, above; parts of its width, of its height, and of the room it keeps. */
const PLACES = [[0, -0.5, 1, 0], [-1, -0.5, -1, 0], [-0.5, 0, 0, 1], [-0.5, -1, 0, -1]];

export class Labels {
  constructor() {
    this.sprites = [];
    this.key = '';
    this.taken = new Uint8Array(0);
    this.place = new Uint8Array(0);
  }

  /** To be called before the labels of a picture; `ratio` is device pixels to a pixel. */
  begin(vehicles, view, ratio) {
    const key = `${palette.version} ${ratio} ${vehicles.length} ${vehicles[0]?.name}`;
    if (key !== this.key) {
      this.key = key;
      this.sprites = [];
      this.place = new Uint8Array(vehicles.length);
    }
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

  /** Whether a box is free; takes it if so, or if `force`. */
  claim(x, y, width, height, force) {
    const left = Math.max(0, Math.floor(x / CELL));
    const right = Math.min(this.across - 1, Math.floor((x + width) / CELL));
    const top = Math.max(0, Math.floor(y / CELL));
    const bottom = Math.min(this.down - 1, Math.floor((y + height) / CELL));
    if (!force) {
      for (let row = top; row <= bottom; row++) {
        for (let column = left; column <= right; column++) if (this.taken[row * this.across + column]) return false;
      }
    }
    for (let row = top; row <= bottom; row++) {
      for (let column = left; column <= right; column++) this.taken[row * this.across + column] = 1;
    }
    return true;
  }

  /** Draws a name at least `room` pixels from its boat's middle, where it stood before if there is room. `force` draws it anyhow. */
  draw(context, index, x, y, room, force) {
    const { canvas, width } = this.sprite(index);
    for (let attempt = 0; attempt <= PLACES.length; attempt++) {
      const place = attempt === 0 ? this.place[index] : attempt - 1;
      const [alongX, alongY, outX, outY] = PLACES[place];
      const left = x + alongX * width + outX * room;
      const top = y + alongY * HEIGHT + outY * room;
      const last = force && attempt === PLACES.length;
      const within = left >= 0 && top >= 0 && left + width <= this.width && top + HEIGHT <= this.height;
      if (!within && !last) continue;
      if (!this.claim(left, top, width - 2, HEIGHT - 3, last)) continue;
      this.place[index] = place;
      context.drawImage(canvas, left, top, width, HEIGHT);
      return;
    }
  }
}
