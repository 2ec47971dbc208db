// Line charts on a canvas: of boats over a game, and of a policy over its training.

import { palette } from './palette.js';

const FONT = '11px system-ui, sans-serif';

/** About `count` round numbers between `low` and `high`. */
export function ticksOf(low, high, count) {
  const raw = (high - low) / count;
  if (!(raw > 0) || !Number.isFinite(raw)) return [low];
  const power = 10 ** Math.floor(Math.log10(raw));
  const step = [1, 2, 5, 10].map((times) => times * power).find((each) => each >= raw * 0.999);
  const ticks = [];
  for (let i = Math.ceil(low / step - 1e-9); i * step <= high + 1e-9 * step; i += 1) ticks.push(Number((i * step).toPrecision(12)));
  return ticks;
}

/** The sample at a position on the axis: the last one up to it. */
export function sampleAt(xs, x) {
  let low = 0;
  let high = xs.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (xs[middle] <= x + 1e-6) low = middle + 1;
    else high = middle;
  }
  return Math.max(0, low - 1);
}

/** The pointer's position along the axis, 0 to 1. */
export function partAt(event, canvas, { left, right }) {
  const box = canvas.getBoundingClientRect();
  return Math.min(1, Math.max(0, (event.clientX - box.left - left) / Math.max(1, box.width - left - right)));
}

/** A line with gaps for missing values and where a compass course passes north. */
function trace(context, { xs, values }, x, y, round) {
  context.beginPath();
  let before = null;
  for (let i = 0; i < values.length; i++) {
    const value = values[i];
    if (value === null) {
      before = null;
      continue;
    }
    if (before === null || (round && Math.abs(value - before) > 180)) context.moveTo(x(xs[i]), y(value));
    else context.lineTo(x(xs[i]), y(value));
    before = value;
  }
}

/**
 * Draws lines `{ xs, values, colour, width, dash }` from `from` to `to` and from `low` to `high` on a canvas, within `margin`
 * `{ left, right, top, bottom }`. `at` marks a position on the axis, and `corner` is a text. `columns` and `rows` are ticks
 * `[where, text]`, and `steps` are faintly marked positions. `round` marks values as compass courses.
 */
export function drawDiagram(canvas, { lines, from, to, low, high, margin, at = null, corner = '', columns = [], rows = [], steps = [], round = false }) {
  const { clientWidth: width, clientHeight: height } = canvas;
  const ratio = Math.min(2, devicePixelRatio);
  Object.assign(canvas, { width: width * ratio, height: height * ratio });
  const context = canvas.getContext('2d');
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  const { left, right, top, bottom } = margin;
  const x = (value) => left + ((value - from) / Math.max(1e-9, to - from)) * (width - left - right);
  const y = (value) => height - bottom - ((value - low) / Math.max(1e-9, high - low)) * (height - top - bottom);
  context.font = FONT;
  context.fillStyle = palette.faint;
  context.strokeStyle = palette.grid;
  context.lineWidth = 1;
  context.strokeRect(left - 0.5, top - 0.5, width - left - right + 1, height - top - bottom + 1);
  context.textAlign = 'right';
  context.textBaseline = 'middle';
  for (const [where, text] of rows) {
    context.fillRect(left - 4, y(where) - 0.5, 4, 1);
    context.strokeRect(left, y(where), width - left - right, 0);
    context.fillText(text, left - 7, y(where));
  }
  context.textAlign = 'center';
  context.textBaseline = 'top';
  for (const [where, text] of columns) {
    context.fillRect(x(where) - 0.5, height - bottom, 1, 4);
    context.fillText(text, x(where), height - bottom + 6);
  }
  context.setLineDash([3, 3]);
  for (const step of steps) context.strokeRect(x(step), top, 0, height - top - bottom);
  for (const line of lines) {
    trace(context, line, x, y, round);
    context.setLineDash(line.dash ?? []);
    context.strokeStyle = line.colour;
    context.lineWidth = line.width;
    context.stroke();
  }
  context.setLineDash([]);
  if (at !== null) {
    context.fillStyle = palette.ink;
    context.fillRect(x(at) - 0.75, 0, 1.5, height - bottom + top);
  }
  context.textAlign = 'left';
  context.fillStyle = palette.faint;
  context.fillText(corner, left + 3, top + 1);
}
