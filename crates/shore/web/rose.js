// The rose: an objective function of a helm as a polar heat map. The angle is the course, the radius the speed.

import { haloText } from './field.js';
import { palette } from './palette.js';
import { number, wrapDeg } from './words.js';

/** Space around the rose for its letters, px. */
const RIM = 20;

/** The heat map's colour for every utility. */
const SHADES = Uint32Array.from({ length: 101 }, (_, value) => {
  const at = (value / 100) * (palette.heat.length - 1);
  const low = Math.min(palette.heat.length - 2, Math.floor(at));
  const [below, above] = [palette.heat[low], palette.heat[low + 1]];
  const [r, g, b] = below.map((channel, i) => Math.round(channel + (above[i] - channel) * (at - low)));
  return (255 << 24) | (b << 16) | (g << 8) | r;
});

export class Rose {
  constructor(canvas) {
    this.canvas = canvas;
    this.context = canvas.getContext('2d');
    this.small = document.createElement('canvas');
    this.drawn = null;
    /** The bearing that is up, as on the chart. */
    this.up_deg = 0;
  }

  /** Draws `utilities` of a report; null draws an empty rose. `now` is the boat's true course and speed. */
  draw(report, utilities, now) {
    const side = this.canvas.clientWidth;
    if (side === 0) return;
    const ratio = Math.min(2, devicePixelRatio);
    const key = [report?.at_s, utilities, palette.version, side, ratio, Math.round(now.course_deg), now.speed_m_s.toFixed(1), this.up_deg];
    if (this.drawn?.every((each, i) => each === key[i])) return;
    this.drawn = key;
    if (this.canvas.width !== side * ratio || this.canvas.height !== side * ratio) {
      this.canvas.width = side * ratio;
      this.canvas.height = side * ratio;
    }
    const { context } = this;
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.clearRect(0, 0, side, side);
    const middle = side / 2;
    const radius = middle - RIM;
    if (utilities && report.courses > 0 && report.speeds > 0) this.heat(report, utilities.flat(), middle, radius, ratio);
    this.frame(middle, radius, report?.speed_max_m_s ?? now.speed_max_m_s);
    const speedMax = report?.speed_max_m_s || now.speed_max_m_s;
    this.dot(middle, radius, now.course_deg, now.speed_m_s / speedMax, false);
    if (report && report.course_deg !== null && report.course_deg !== undefined) {
      this.dot(middle, radius, report.course_deg, report.speed_m_s / speedMax, true);
    }
  }

  heat(report, utilities, middle, radius, ratio) {
    const size = Math.ceil(radius * 2 * ratio);
    if (this.small.width !== size) {
      this.small.width = size;
      this.small.height = size;
    }
    const context = this.small.getContext('2d');
    const image = context.createImageData(size, size);
    const pixels = new Uint32Array(image.data.buffer);
    const { courses, speeds } = report;
    const cells = this.cellsOf(size, courses, speeds);
    for (let at = 0; at < cells.length; at++) {
      if (cells[at] >= 0) pixels[at] = SHADES[Math.min(100, Math.max(0, Math.round(utilities[cells[at]] ?? 0)))];
    }
    context.putImageData(image, 0, 0);
    this.context.drawImage(this.small, middle - radius, middle - radius, 2 * radius, 2 * radius);
  }

  /** The option of each pixel, -1 outside: the same for all reports. */
  cellsOf(size, courses, speeds) {
    const key = `${size} ${courses} ${speeds} ${this.up_deg}`;
    if (key === this.cellsKey) return this.cells;
    this.cellsKey = key;
    this.cells = new Int32Array(size * size).fill(-1);
    const half = size / 2;
    for (let row = 0; row < size; row++) {
      const up = half - row - 0.5;
      for (let column = 0; column < size; column++) {
        const right = column + 0.5 - half;
        const out = Math.hypot(right, up) / half;
        if (out > 1) continue;
        const turn = Math.atan2(right, up) / (2 * Math.PI) + this.up_deg / 360;
        const course = ((Math.round(turn * courses) % courses) + courses) % courses;
        this.cells[row * size + column] = course * speeds + Math.round(out * (speeds - 1));
      }
    }
    return this.cells;
  }

  frame(middle, radius, speedMax) {
    const { context } = this;
    context.strokeStyle = palette.edge;
    context.lineWidth = 1;
    for (const part of [0.5, 1]) {
      context.globalAlpha = part === 1 ? 1 : 0.5;
      context.beginPath();
      context.arc(middle, middle, radius * part, 0, 2 * Math.PI);
      context.stroke();
    }
    context.globalAlpha = 1;
    context.font = '600 12px system-ui, sans-serif';
    context.textAlign = 'center';
    context.textBaseline = 'middle';
    context.fillStyle = palette.ink;
    ['N', 'E', 'S', 'W'].forEach((letter, quarter) => {
      const angle = ((quarter * 90 - this.up_deg) * Math.PI) / 180;
      context.fillText(letter, middle + Math.sin(angle) * (radius + 11), middle - Math.cos(angle) * (radius + 11));
    });
    context.font = '11px system-ui, sans-serif';
    context.fillStyle = palette.faint;
    context.textAlign = 'left';
    if (!(speedMax > 0)) return;
    // A small rose has no space for the unit, nor for the inner ring's speed.
    context.fillText(number(speedMax, 1, radius > 80 ? 'm/s' : ''), middle + radius * Math.SQRT1_2 + 3, middle + radius * Math.SQRT1_2 + 7);
    if (radius > 80) haloText(context, number(speedMax / 2, 1), middle + radius * Math.SQRT1_2 * 0.5 + 2, middle + radius * Math.SQRT1_2 * 0.5 + 6);
  }

  /** The chosen course and speed as a ring with a point, those of the boat as a small diamond. */
  dot(middle, radius, course_deg, out, chosen) {
    const { context } = this;
    const angle = (wrapDeg(course_deg - this.up_deg) * Math.PI) / 180;
    const far = radius * Math.min(1, Math.max(0, out || 0));
    const x = middle + Math.sin(angle) * far;
    const y = middle - Math.cos(angle) * far;
    context.beginPath();
    if (chosen) context.arc(x, y, 7, 0, 2 * Math.PI);
    else {
      context.moveTo(x, y - 6);
      context.lineTo(x + 6, y);
      context.lineTo(x, y + 6);
      context.lineTo(x - 6, y);
      context.closePath();
    }
    context.lineWidth = 4.5;
    context.strokeStyle = '#000000';
    context.stroke();
    context.lineWidth = 2;
    context.strokeStyle = '#ffffff';
    context.stroke();
    if (!chosen) return;
    context.beginPath();
    context.arc(x, y, 2, 0, 2 * Math.PI);
    context.fillStyle = '#ffffff';
    context.fill();
  }
}
