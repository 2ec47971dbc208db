// The background of the chart: an image of the site or its shoreline, placed beneath the field by latitude and
// longitude.

import { latLonOf, latLonWords, placeOf } from './datum.js';
import { haloText } from './field.js';
import { palette } from './palette.js';
import { notice } from './status.js';
import { number, show } from './words.js';

/** A background farther from the field's datum than this belongs to another site, m. */
const FAR_M = 50_000;
/** Opacity of images: field and boats must stay visible, and in dark mode images must not dazzle. */
const IMAGE_LIGHT = 0.85;
const IMAGE_DARK = 0.45;
/** Minimum scale at which place names are drawn, pixels per metre. */
const NAMES_SCALE = 0.2;

export class Background {
  /** `on` has `changed()`, called when the image changes. */
  constructor(on) {
    this.on = on;
    this.button = document.getElementById('show-chart');
    /** The background as received from the server; null if there is none. */
    this.given = null;
    this.image = null;
    this.datum = null;
    this.forget();
  }

  forget() {
    /** Transform from image pixels to metres, for a canvas. */
    this.matrix = null;
    this.areas = null;
    this.lines = null;
    this.points = [];
  }

  get drawn() {
    return this.matrix !== null || this.areas !== null;
  }

  async load() {
    try {
      const answer = await fetch('/background.json');
      const given = answer.ok ? await answer.json() : null;
      if (given?.image) {
        const image = new Image();
        image.src = '/background-image';
        await image.decode();
        this.image = image;
      }
      // Set it only when complete: the game may have arrived first.
      this.given = given;
    } catch (error) {
      notice(`Cannot show the chart beneath the field: ${error.message}`);
    }
    this.lay();
  }

  greet(chart) {
    const { datum } = chart.field ?? {};
    if (JSON.stringify(datum) === JSON.stringify(this.datum)) return;
    this.datum = datum ?? null;
    this.lay();
  }

  /** Aligns the background with the field. */
  lay() {
    this.forget();
    if (this.given && this.datum && !this.isFar()) {
      if (this.given.image) this.layImage(this.given.image.world);
      else this.layShoreline(this.given);
    }
    show(this.button, this.drawn);
    this.on.changed();
  }

  /** Converts a position, longitude first, to metres from the datum. */
  at([lon, lat]) {
    return placeOf(this.datum, lat, lon);
  }

  /** The corners of the image, or all positions. */
  positions() {
    const { image, areas = [], lines = [], points = [] } = this.given;
    if (!image) return [...areas.flat(2), ...lines.flat(1), ...points];
    const [a, d, b, e, c, f] = image.world;
    return [[0, 0], [image.width, 0], [image.width, image.height], [0, image.height]].map(([right, down]) =>
      [a * (right - 0.5) + b * (down - 0.5) + c, d * (right - 0.5) + e * (down - 0.5) + f]);
  }

  /** Whether the background belongs to another site; if so, a notice gives its position. */
  isFar() {
    const box = { left: Infinity, right: -Infinity, bottom: Infinity, top: -Infinity };
    for (const position of this.positions()) {
      const [x, y] = this.at(position);
      Object.assign(box, { left: Math.min(box.left, x), right: Math.max(box.right, x), bottom: Math.min(box.bottom, y), top: Math.max(box.top, y) });
    }
    const off = (low, high) => Math.max(0, low, -high);
    const far_m = Math.hypot(off(box.left, box.right), off(box.bottom, box.top));
    if (far_m <= FAR_M) return false;
    const middle = latLonOf(this.datum, (box.left + box.right) / 2, (box.bottom + box.top) / 2);
    notice(`${this.given.name} is not drawn: it is at ${latLonWords(middle, 0, 0)}, about ${number(far_m / 1000, 0, 'km')} from the field at ${latLonWords(this.datum, 0, 0)}. Its longitudes and latitudes may be swapped.`);
    return true;
  }

  layImage([a, d, b, e, c, f]) {
    // World files refer to the centre of the first pixel, canvases to its corner.
    const [x, y] = this.at([c - (a + b) / 2, f - (d + e) / 2]);
    const [acrossX, acrossY] = this.at([c - (a + b) / 2 + a, f - (d + e) / 2 + d]);
    const [downX, downY] = this.at([c - (a + b) / 2 + b, f - (d + e) / 2 + e]);
    this.matrix = [acrossX - x, acrossY - y, downX - x, downY - y, x, y];
  }

  layShoreline({ areas, lines, points }) {
    this.areas = new Path2D();
    this.lines = new Path2D();
    for (const rings of areas) for (const ring of rings) this.trace(this.areas, ring, true);
    for (const line of lines) this.trace(this.lines, line, false);
    this.points = points.map(([lon, lat, name]) => [...this.at([lon, lat]), name]);
  }

  trace(path, places, closed) {
    places.forEach((place, index) => {
      const [x, y] = this.at(place);
      if (index === 0) path.moveTo(x, y);
      else path.lineTo(x, y);
    });
    if (closed) path.closePath();
  }

  /** Draws the background beneath the rest of the field. */
  draw(context, view) {
    if (!this.drawn) return;
    context.save();
    context.translate(view.width / 2, view.height / 2);
    context.rotate(-view.up_rad);
    context.scale(view.scale, -view.scale);
    context.translate(-view.centreX, -view.centreY);
    if (this.matrix) this.drawImage(context);
    else this.drawShoreline(context, view);
    context.restore();
    if (!this.matrix) this.drawPoints(context, view);
  }

  drawImage(context) {
    context.globalAlpha = document.documentElement.style.colorScheme === 'dark' ? IMAGE_DARK : IMAGE_LIGHT;
    context.transform(...this.matrix);
    context.drawImage(this.image, 0, 0);
  }

  drawShoreline(context, view) {
    context.fillStyle = palette.land;
    context.fill(this.areas, 'evenodd');
    context.lineWidth = 1.5 / view.scale;
    context.lineJoin = 'round';
    context.strokeStyle = palette.wall;
    context.stroke(this.areas);
    context.stroke(this.lines);
  }

  drawPoints(context, view) {
    context.textAlign = 'left';
    context.textBaseline = 'middle';
    for (const [east, north, name] of this.points) {
      const [x, y] = [view.xOf(east, north), view.yOf(east, north)];
      context.beginPath();
      context.arc(x, y, 3, 0, 2 * Math.PI);
      context.fillStyle = palette.wall;
      context.fill();
      if (name && view.scale > NAMES_SCALE) haloText(context, name, x + 6, y, palette.ink);
    }
  }
}
