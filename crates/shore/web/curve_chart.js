// A chart of curves over samples, hours or games, with the values at the cursor. All charts of a page share the cursor and the zoom.

import { sampleAt } from './diagram.js';
import { palette } from './palette.js';
import uPlot from './vendor/uplot.js';
import { make, number, plain, show } from './words.js';

const FONT = '11px system-ui, sans-serif';
/** Dashes of curves beyond four, and of a second run. */
const DASHES = [[], [7, 4], [2, 3], [10, 3, 2, 3]];
/** Classes of their samples in the legend. */
const STYLES = ['solid', 'dashed', 'dotted', 'dashed'];

export const isNumber = (value) => typeof value === 'number' && Number.isFinite(value);

/** The exponential moving average, corrected for its start; `weight` is the weight of the past, 0 to 1. */
export function smoothed(values, weight) {
  let [sum, part] = [0, 0];
  return values.map((value) => {
    if (!isNumber(value)) return null;
    sum = weight * sum + (1 - weight) * value;
    part = weight * part + (1 - weight);
    return sum / part;
  });
}

/** Limits that show these values; a constant is centred within a tenth of its value, so that rounding does not fill the chart. */
function limits(values) {
  const [low, high] = [values.reduce((a, b) => Math.min(a, b), Infinity), values.reduce((a, b) => Math.max(a, b), -Infinity)];
  if (!Number.isFinite(low)) return [0, 1];
  const size = Math.max(Math.abs(low), Math.abs(high));
  const room = Math.max(0.06 * (high - low), high - low < 0.01 * size ? 0.1 * size : 0, 1e-6);
  return [low >= 0 && low < 0.35 * high ? 0 : low - room, high + room];
}

/** A five-pointed star, px. */
function star(context, x, y, size) {
  context.beginPath();
  for (let i = 0; i < 10; i++) {
    const [angle, far] = [(Math.PI * i) / 5 - Math.PI / 2, i % 2 === 0 ? size : 0.45 * size];
    context.lineTo(x + far * Math.cos(angle), y + far * Math.sin(angle));
  }
  context.closePath();
}

export class CurveChart {
  /** `span` are limits of the values: numbers, or null where the values decide. */
  constructor(title, unit, span = [null, null]) {
    Object.assign(this, { title, unit, span, at: null, curves: [] });
    this.legend = make('ul', 'legend');
    this.place = make('div', 'curve');
    this.place.tabIndex = 0;
    this.place.setAttribute('role', 'img');
    this.box = make('figure', 'card', '', make('figcaption', '', '', make('strong', '', title), make('span', 'faint', unit)), this.legend, this.place);
    this.place.addEventListener('keydown', (event) => this.key(event));
    new ResizeObserver(() => this.fit()).observe(this.place);
  }

  /**
   * Shows `curves`: `{ name, xs, values, raw, colour, style, dots, best }`, where `raw` are the values before smoothing, `colour` and `style` are
   * numbers, `dots` marks the values, and `best` is where the best policy was. `axis` is `{ title, words, begins, to }`: `begins` are the starts
   * and names of stages, and `to` is the end of the axis.
   */
  take(curves, axis) {
    this.curves = curves.map((curve) => ({ colour: 0, style: 0, raw: null, best: null, ...curve }));
    this.axis = axis;
    show(this.box, curves.some(({ values }) => values.some(isNumber)));
    this.to = axis.to ?? curves.reduce((most, { xs }) => Math.max(most, xs.at(-1) ?? 0), 0);
    const range = limits(curves.flatMap(({ values, raw }) => [...values, ...(raw ?? [])]).filter(isNumber));
    this.range = range.map((limit, i) => this.span[i] ?? limit);
    this.draw();
  }

  /** Builds the chart again, with the current colours. */
  draw() {
    this.chart?.destroy();
    this.chart = null;
    this.fit();
    this.tell();
  }

  fit() {
    const { clientWidth: width, clientHeight: height } = this.place;
    if (this.box.hidden || this.curves.length === 0 || width < 40 || height < 40) return;
    if (this.chart) this.chart.setSize({ width, height });
    else this.build(width, height);
  }

  build(width, height) {
    const { axis } = this;
    const lines = this.curves.flatMap((curve) => (curve.raw ? [{ ...curve, values: curve.raw, faint: true }, curve] : [curve]));
    const side = { stroke: palette.faint, font: FONT, grid: { stroke: palette.grid, width: 1 }, ticks: { stroke: palette.grid, size: 4, width: 1 } };
    const words = (_, ticks) => {
      const places = Math.max(0, ...ticks.map((each) => (String(Number(each.toPrecision(6))).split('.')[1] ?? '').length));
      return ticks.map((each) => number(each, places));
    };
    this.chart = new uPlot({
      width, height, legend: { show: false }, padding: [this.axis.begins?.length ? 18 : 10, 14, 0, 0],
      cursor: { y: false, sync: { key: 'curves', scales: ['x', null] }, points: { size: 7 } },
      scales: { x: { time: false, range: (_, low, high) => (isNumber(low) && low < high ? [0, Math.max(high, this.to)] : [0, this.to || 1]) }, y: { range: () => this.range } },
      axes: [
        { ...side, size: 22, gap: 3, label: axis.title, labelFont: FONT, labelSize: 16, values: words },
        { ...side, size: 46, gap: 4, space: 28, values: words },
      ],
      series: [{}, ...lines.map(({ name, colour, style, faint, dots }) => ({
        label: name, stroke: palette.teams[colour % 4], dash: DASHES[style % 4], width: faint ? 1 : 1.8, alpha: faint ? 0.28 : 1,
        points: { show: dots === true, size: 6, fill: palette.teams[colour % 4] }, spanGaps: true,
      }))],
      hooks: { draw: [(chart) => this.mark(chart)], setCursor: [(chart) => this.move(chart)] },
    }, uPlot.join(lines.map(({ xs, values }) => [xs, values])), this.place);
  }

  /** Marks the starts of stages and the best policy. */
  mark({ ctx: context, bbox, valToPos }) {
    const ratio = devicePixelRatio;
    context.save();
    context.lineWidth = ratio;
    context.font = `${11 * ratio}px system-ui, sans-serif`;
    context.beginPath();
    context.rect(bbox.left, 0, bbox.width + 8 * ratio, bbox.top + bbox.height);
    context.clip();
    context.setLineDash([3 * ratio, 3 * ratio]);
    context.strokeStyle = palette.faint;
    context.fillStyle = palette.faint;
    for (const [x, name] of this.axis.begins ?? []) {
      const left = valToPos(x, 'x', true);
      context.strokeRect(left, bbox.top, 0, bbox.height);
      // Above the curves, from the line to the right as far as space permits.
      const right = bbox.left + bbox.width - context.measureText(plain(name)).width;
      context.fillText(plain(name), Math.min(left, right), bbox.top - 6 * ratio);
    }
    context.setLineDash([]);
    for (const { xs, values, best, colour } of this.curves) {
      const at = best === null ? -1 : xs.indexOf(best);
      if (at < 0 || !isNumber(values[at])) continue;
      star(context, valToPos(best, 'x', true), valToPos(values[at], 'y', true), 9 * ratio);
      context.fillStyle = palette.teams[colour % 4];
      context.strokeStyle = palette.paper;
      context.lineWidth = 1.5 * ratio;
      context.fill();
      context.stroke();
    }
    context.restore();
  }

  /** Follows the pointer, here or on another chart. */
  move(chart) {
    const { left } = chart.cursor;
    const at = left === null || left < 0 ? null : chart.posToVal(left, 'x');
    if (at === this.at) return;
    this.at = at;
    this.tell();
  }

  key(event) {
    const step = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
    const xs = this.curves[0]?.xs ?? [];
    if (!step || xs.length === 0 || !this.chart) return;
    const now = this.at === null ? xs.length : sampleAt(xs, this.at);
    this.chart.setCursor({ left: this.chart.valToPos(xs[Math.min(xs.length - 1, Math.max(0, now + step))], 'x') + 1e-3, top: 1 }, true, true);
    event.preventDefault();
  }

  /** Writes the values at the cursor, or the last ones. */
  tell() {
    const [low, high] = this.range ?? [0, 1];
    const places = high - low > 20 ? 0 : high - low > 0.5 ? 2 : 4;
    const words = ({ xs, values }) => {
      const reached = this.at !== null && this.at < (xs[0] ?? Infinity);
      return number(reached ? null : values[this.at === null ? values.length - 1 : sampleAt(xs, this.at)], places);
    };
    const one = (curve) => {
      const swatch = make('i', `line-swatch ${STYLES[curve.style % 4]}`);
      return make('li', `team-${curve.colour % 4}`, '', ...(curve.name ? [swatch, make('span', '', plain(curve.name))] : []), make('b', '', words(curve)));
    };
    this.legend.replaceChildren(...this.curves.map(one));
    const when = this.at === null ? 'at the end' : `at ${this.axis?.words(this.at) ?? ''}`;
    const said = this.curves.map((curve) => `${curve.name ? `${plain(curve.name)} ` : ''}${words(curve)}`).join(', ');
    this.place.setAttribute('aria-label', `${this.title}, ${when}: ${said}. Arrow keys move the cursor.`);
  }
}
