// The curves of many boats in one plot, drawn a few at a time, so that no frame is late.

import { sectionOf } from './quantity.js';

/** Time budget for one picture, ms. */
const PICTURE_MS = 3;
/** Minimum number of curves drawn per frame, even on a slow machine. */
const LINES_MIN = 8;
/** Maximum number of samples of a curve. */
const SAMPLES_MAX = 120;
const STRENGTH = 0.6;

export class Crowd {
  constructor() {
    this.canvas = document.createElement('canvas');
    this.canvas.className = 'plot-crowd';
    this.next = document.createElement('canvas');
    this.job = null;
  }

  /** Starts to draw `lists` in `colours`, from `from_s` to `to_s` and from `low` to `high`, on `width` by `height` pixels. */
  begin(job) {
    const ratio = Math.min(2, devicePixelRatio);
    Object.assign(this.next, { width: job.width * ratio, height: job.height * ratio, className: this.canvas.className });
    const context = this.next.getContext('2d');
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.globalAlpha = STRENGTH;
    context.lineWidth = 1;
    context.lineJoin = 'round';
    this.job = { ...job, context, drawn: 0 };
  }

  /** Draws more curves. Returns whether all are drawn now; they are then on `canvas`, which replaces the previous one. */
  go() {
    const { job } = this;
    if (!job) return false;
    const end_ms = performance.now() + PICTURE_MS;
    const least = job.drawn + LINES_MIN;
    while (job.drawn < job.lists.length && (job.drawn < least || performance.now() < end_ms)) this.line(job, job.drawn++);
    if (job.drawn < job.lists.length) return false;
    this.job = null;
    this.canvas.replaceWith(this.next);
    [this.canvas, this.next] = [this.next, this.canvas];
    return true;
  }

  line({ context, times, lists, colours, from_s, to_s, low, high, width, height, round }, i) {
    const [xs, values] = sectionOf(times, [lists[i]], from_s, to_s, SAMPLES_MAX, round);
    const [across, down] = [width / (to_s - from_s), height / (high - low)];
    context.beginPath();
    let before = null;
    for (let at = 0; at < values.length; at++) {
      const value = values[at];
      if (value !== null) {
        const [x, y] = [(xs[at] - from_s) * across, height - (value - low) * down];
        if (before === null || (round && Math.abs(value - before) > 180)) context.moveTo(x, y);
        else context.lineTo(x, y);
      }
      before = value;
    }
    context.strokeStyle = colours[i];
    context.stroke();
  }
}

/** The minimum and the maximum value from `from_s` to `to_s`; null if there is none. */
export function extentOf(times, lists, from_s, to_s) {
  let [low, high] = [Infinity, -Infinity];
  let [first, last] = [0, times.length];
  while (first < last && times[first] < from_s) first += 1;
  while (last > first && times[last - 1] > to_s) last -= 1;
  for (const list of lists) {
    for (let i = first; list && i < last; i++) {
      if (list[i] < low) low = list[i];
      if (list[i] > high) high = list[i];
    }
  }
  return Number.isFinite(low) ? [low, high] : [null, null];
}
