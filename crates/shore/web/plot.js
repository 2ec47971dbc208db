// One plot: a quantity of boats over time, with axes, a cursor and the values at it.

import { Crowd, extentOf } from './crowd.js';
import { sampleAt } from './diagram.js';
import { palette, teamColour } from './palette.js';
import { QUANTITIES, quantityOf, rangeOf, sectionOf } from './quantity.js';
// Version 1.6.32 as published on npm. It draws thousands of samples within one frame; our own diagrams have no axes, cursor or zoom.
import uPlot from './vendor/uplot.js';
import { clock, clockShort, make, options, plain, show, write } from './words.js';

/** Up to this many curves have their own colour and their value in the header; more are thin lines in their teams' colours. */
const NAMED_MAX = 8;
/** Maximum number of samples drawn in a plot. */
const SAMPLES_MAX = 16_000;
/** Among many curves, the pointer selects the nearest within this distance, px. */
const REACH_PX = 14;
const FONT = '11px system-ui, sans-serif';
const STEPS_S = [0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 30, 60, 120, 300, 600, 1200, 1800, 3600];
const NONE = '';

/** For compass courses: breaks lines that would cross the whole plot where a course passes north. */
function courses(plot, series, first, last) {
  const stroke = new Path2D();
  const [times, values] = [plot.data[0], plot.data[series]];
  let before = null;
  for (let i = first; i <= last; i++) {
    const value = values[i];
    if (value === null || value === undefined) {
      before = null;
      continue;
    }
    const [x, y] = [plot.valToPos(times[i], 'x', true), plot.valToPos(value, 'y', true)];
    if (before === null || Math.abs(value - before) > 180) stroke.moveTo(x, y);
    stroke.lineTo(x, y);
    before = value;
  }
  return { stroke, fill: null, clip: null, band: null, gaps: null, flags: 1 };
}

/** The limits of the axis for values from `low` to `high`. */
function limits({ round, from0, least }, low, high) {
  if (round) return [0, 360];
  if (low === null || !Number.isFinite(low)) return [0, least];
  const spare = 0.06 * Math.max(least, high - low);
  if (from0) return [0, Math.max(least, high + spare)];
  const more = Math.max(0, least - (high - low)) / 2;
  return [low - spare - more, high + spare + more];
}

export class Plot {
  /** `on` has `changed()`, `remove(plot)`, `seek(t_s)`, and `span`. */
  constructor(on, { quantity, other = NONE }) {
    this.on = on;
    this.quantity = quantityOf(quantity);
    this.wantedOther = other;
    this.chooser = make('select');
    this.chooser.setAttribute('aria-label', 'Quantity');
    options(this.chooser, QUANTITIES.map(({ key, title, unit }) => [key, `${title}, ${unit}`]));
    this.chooser.value = this.quantity.key;
    this.other = make('select', 'plot-other');
    this.other.setAttribute('aria-label', 'Range to');
    this.values = make('span', 'plot-values');
    this.close = make('button', 'plot-close', '×');
    Object.assign(this.close, { type: 'button', title: 'Remove this plot' });
    this.close.setAttribute('aria-label', 'Remove this plot');
    this.now = make('div', 'plot-now');
    this.place = make('div', 'plot-place');
    this.box = make('figure', 'plot', '', make('figcaption', '', '', this.chooser, this.other, this.close), this.values, this.place);
    this.box.setAttribute('role', 'group');
    this.chooser.addEventListener('change', () => {
      this.quantity = quantityOf(this.chooser.value);
      on.changed();
    });
    this.other.addEventListener('change', () => {
      this.wantedOther = this.other.value;
      on.changed();
    });
    this.close.addEventListener('click', () => on.remove(this));
    this.built = '';
    this.drawn = '';
    this.focused = -1;
    this.pointed = null;
    this.crowd = new Crowd();
    this.range = [0, 1];
    this.resized = new ResizeObserver(() => { this.drawn = ''; });
    this.resized.observe(this.place);
  }

  remove() {
    this.resized.disconnect();
    this.chart?.destroy();
    this.box.remove();
  }

  greet(game) {
    options(this.other, [[NONE, 'choose a boat'], ...game.vehicles.map(({ name }) => [name, plain(name)])]);
    this.other.value = game.indexOf.has(this.wantedOther) ? this.wantedOther : NONE;
    this.built = '';
  }

  /** The stored settings. */
  get settings() {
    return { quantity: this.quantity.key, other: this.wantedOther };
  }

  /** The other boat, by index; -1 if there is none. */
  otherOf(game) {
    return this.quantity.to ? game.indexOf.get(this.other.value) ?? -1 : -1;
  }

  /** The curves: name, colour, and where the values are. */
  curvesOf(game, boats, colourOf) {
    const { quantity } = this;
    if (quantity.teams) return game.chart.teams.map((team, index) => ({ name: plain(team.name), colour: teamColour(index), read: (source) => source.score(index) }));
    const other = this.otherOf(game);
    const wanted = quantity.to ? boats.filter((boat) => other >= 0 && boat !== other) : boats;
    const beside = quantity.beside && boats.length <= NAMED_MAX / 2 ? quantity.beside : null;
    return wanted.flatMap((boat) => {
      const [name, colour] = [plain(game.vehicles[boat].name), colourOf(boat)];
      const read = (source) => (quantity.to ? rangeOf(source, boat, other) : source.list(boat, quantity.key));
      const own = { name: beside && quantity.names ? `${name} ${quantity.names}` : name, colour, read };
      return beside ? [own, { name: beside[0], colour, dash: [4, 3], read: (source) => source.list(boat, beside[1]) }] : [own];
    });
  }

  /** Rebuilds the plot if its curves, colours or visibility have changed, and draws it if anything has changed. Returns whether it was drawn. */
  draw(game, source, boats, colourOf) {
    const { clientWidth: width, clientHeight: height } = this.place;
    if (width < 40 || height < 40) return false;
    show(this.other, this.quantity.to === true);
    const build = `${game.greeted} ${this.quantity.key} ${this.other.value} ${boats.join()} ${palette.version}`;
    const { span } = this.on;
    // A crowd is drawn over several frames.
    const { job } = this.crowd;
    if (job && build === this.built && job.size === `${width} ${height}`) return this.drawCrowd();
    const drawn = `${build} ${source.version} ${span.version} ${width} ${height}`;
    if (drawn === this.drawn) return false;
    this.drawn = drawn;
    if (build !== this.built) {
      this.built = build;
      this.curves = this.curvesOf(game, boats, colourOf);
      this.chart?.destroy();
      this.crowd.job = null;
      this.focused = -1;
      this.chart = this.curves.length > 0 ? this.build(width, height) : null;
      write(this.values, '');
      this.told = '';
    }
    if (!this.chart) return true;
    if (this.chart.width !== width || this.chart.height !== height) this.chart.setSize({ width, height });
    this.lists = this.curves.map((curve) => curve.read(source));
    this.times = source.times;
    if (this.many) return this.beginCrowd(`${width} ${height}`);
    const most = Math.min(2 * width, Math.max(80, SAMPLES_MAX / this.curves.length));
    this.chart.setData(sectionOf(source.times, this.lists, span.from_s, span.to_s, most, this.quantity.round));
    return true;
  }

  get many() {
    return this.curves.length > NAMED_MAX;
  }

  /** Starts to draw many curves; the axes follow at the end. */
  beginCrowd(size) {
    const { span } = this.on;
    const [from_s, to_s] = [span.from_s, span.to_s];
    const [low, high] = limits(this.quantity, ...extentOf(this.times, this.lists, from_s, to_s));
    const { clientWidth: width, clientHeight: height } = this.chart.over;
    const colours = this.curves.map(({ colour }) => colour);
    this.crowd.begin({ size, times: this.times, lists: this.lists, colours, from_s, to_s, low, high, width, height, round: this.quantity.round });
    return this.drawCrowd();
  }

  drawCrowd() {
    const { job } = this.crowd;
    if (!this.crowd.go()) return true;
    if (this.crowd.canvas.parentElement !== this.chart.under) this.chart.under.replaceChildren(this.crowd.canvas);
    this.section = [job.from_s, job.to_s];
    this.range = [job.low, job.high];
    this.drawFocused();
    return true;
  }

  /** Draws the curve pointed at among many, with the axes. */
  drawFocused() {
    const [from_s, to_s] = this.section;
    const list = this.lists[this.focused] ?? null;
    this.chart.setData(list ? sectionOf(this.times, [list], from_s, to_s, SAMPLES_MAX, this.quantity.round) : [[from_s, to_s], [null, null]]);
  }

  /** Finds the curve pointed at among many. */
  focus() {
    if (!this.many || !this.section) return;
    const { height } = this.chart.over.getBoundingClientRect();
    let best = -1;
    if (this.pointed) {
      const at = sampleAt(this.times, this.pointed.t_s);
      let least = (REACH_PX / height) * (this.range[1] - this.range[0]);
      const value = this.range[1] - (this.pointed.y / height) * (this.range[1] - this.range[0]);
      this.lists.forEach((list, i) => {
        if (!(Math.abs(list?.[at] - value) < least)) return;
        least = Math.abs(list[at] - value);
        best = i;
      });
    }
    if (best === this.focused) return;
    this.focused = best;
    this.drawFocused();
  }

  build(width, height) {
    const { quantity, on, many } = this;
    this.section = null;
    const curves = many ? [{ name: 'pointed at', colour: palette.ink }] : this.curves;
    const paths = quantity.round ? courses : quantity.teams ? uPlot.paths.stepped({ align: 1 }) : undefined;
    const axis = { stroke: palette.faint, font: FONT, grid: { stroke: palette.grid, width: 1 }, ticks: { stroke: palette.grid, size: 4, width: 1 } };
    const chart = new uPlot({
      width, height, legend: { show: false }, padding: [8, 20, 0, 0],
      cursor: { y: false, drag: { x: true, y: false, setScale: false }, points: { size: 6, ...(many ? { show: false } : {}) } },
      scales: { x: { time: false, range: () => this.section ?? [on.span.from_s, on.span.to_s] }, y: { range: (_, low, high) => (many ? this.range : limits(quantity, low, high)) } },
      axes: [
        { ...axis, size: 24, gap: 3, space: 64, incrs: STEPS_S, values: (_, splits, i, space, step) => splits.map(step < 1 ? clock : clockShort) },
        { ...axis, size: 48, gap: 4, space: 26, ...(quantity.round ? { splits: () => (height > 120 ? [0, 90, 180, 270, 360] : [0, 180, 360]) } : {}),
          ...(quantity.teams ? { incrs: [1, 2, 5, 10, 20, 50, 100, 200, 500] } : {}),
          values: (_, splits) => splits.map((value) => (quantity.round ? `${String(value).padStart(3, '0')}°` : String(value).replace('-', '−'))) },
      ],
      series: [{}, ...curves.map(({ name, colour, dash }) => ({
        label: name, stroke: colour, dash, paths, width: many ? 2.5 : dash ? 1 : 1.75, points: { show: false }, spanGaps: false,
      }))],
      hooks: {
        setSelect: [({ select }) => {
          if (select.width < 4) return;
          on.span.show(chart.posToVal(select.left, 'x'), chart.posToVal(select.left + select.width, 'x'));
          chart.setSelect({ left: 0, width: 0, top: 0, height: 0 }, false);
        }],
      },
    }, [[], ...curves.map(() => [])], this.place);
    this.bindOver(chart);
    return chart;
  }

  bindOver(chart) {
    const { span, seek } = this.on;
    const at = (event) => chart.posToVal(event.clientX - chart.over.getBoundingClientRect().left, 'x');
    chart.over.append(this.now);
    chart.over.addEventListener('pointermove', (event) => {
      this.pointed = { t_s: at(event), y: event.clientY - chart.over.getBoundingClientRect().top };
      span.point(this.pointed.t_s);
    });
    chart.over.addEventListener('pointerleave', () => {
      this.pointed = null;
      span.point(null);
    });
    chart.over.addEventListener('click', (event) => seek(at(event)));
    chart.over.addEventListener('dblclick', () => span.showAll());
    chart.over.addEventListener('wheel', (event) => span.wheel(event, at(event)), { passive: false });
  }

  /** Moves the cursor to the moment pointed at, marks the current one, and writes the values there. */
  mark(game) {
    const { chart } = this;
    if (!chart || !this.times) return;
    this.focus();
    const { span } = this.on;
    const { pointed_s } = span;
    const x = (t_s) => ((t_s - span.from_s) / (span.to_s - span.from_s)) * chart.over.clientWidth;
    const now_px = game.mode === 'replay' && game.t_s >= span.from_s && game.t_s <= span.to_s ? Math.round(x(game.t_s)) : -10;
    const key = `${pointed_s} ${this.pointed === null} ${now_px} ${this.drawn} ${this.focused} ${pointed_s === null ? game.t_s : ''}`;
    if (key === this.told) return;
    this.told = key;
    this.now.style.transform = `translateX(${now_px}px)`;
    const outside = pointed_s === null || pointed_s < span.from_s || pointed_s > span.to_s;
    // In the plot under the pointer, the pointer moves the cursor.
    if (this.pointed === null) chart.setCursor({ left: outside ? -10 : x(pointed_s), top: outside ? -10 : 1 });
    this.tell(pointed_s ?? game.t_s);
  }

  /** Writes the values at a moment. */
  tell(t_s) {
    const { curves, lists, quantity } = this;
    const at = sampleAt(this.times, t_s);
    const wordsOf = (i) => (Number.isFinite(lists[i]?.[at]) ? quantity.words(lists[i][at]) : '–');
    // The unit is in the title.
    const bare = (words) => words.split('\u00a0')[0];
    const shown = !this.many ? curves.map((_, i) => i) : [this.focused].filter((i) => i >= 0);
    // Orders are known for only a few boats.
    const said = shown.map((i) => ({ ...curves[i], words: wordsOf(i) })).filter(({ dash, words }) => !dash || words !== '–');
    this.values.replaceChildren(make('span', 'plot-time', clock(t_s)), ...said.map(({ name, colour, dash, words }) => {
      const swatch = make('span', dash ? 'plot-swatch dashed' : 'plot-swatch');
      swatch.style.setProperty('--team', colour);
      return make('span', 'plot-value', '', swatch, make('span', '', name), make('strong', 'value', bare(words)));
    }), ...(this.many && said.length === 0 ? [make('span', 'faint', `${curves.length} curves; point at one`)] : []));
    const label = `${quantity.title} at ${clock(t_s)}: ${said.map(({ name, words }) => `${name} ${words}`).join(', ')}`;
    this.box.setAttribute('aria-label', label);
  }
}
