// The timeline of a replay: the current moment, the events, and ways to reach them.

import { sampleAt, ticksOf } from './diagram.js';
import { palette } from './palette.js';
import { clock, clockShort, make, number, options, plain, show } from './words.js';

/** Kinds of marks: name, key, events, shape. */
export const KINDS = [
  ['Grabs', 'g', ['grabbed'], 'triangle'],
  ['Captures', 'c', ['captured'], 'diamond'],
  ['Tags', 't', ['tagged', 'tagged_by_boundary', 'tagged_by_obstacle'], 'dot'],
  ['Collisions', 'b', ['collided'], 'cross'],
  ['Failsafes', 'i', ['failsafe'], 'square'],
];

const ANY = 'any';
/** Minimum time between two seeks while scrubbing, ms. */
const SEEK_MS = 50;
/** Space beside the timeline: on the left for the scale of the score, px. */
const LEFT = 34;
const RIGHT = 14;
/** Rows of marks, one for each kind, above the score, px. */
const LANE_TOP = 8;
/** The maximum and the minimum height of a row, px. */
const LANE = 9;
const LANE_LOW = 4;
/** Height of a timeline without its rows, px: the score, its space and the times. */
const BESIDE_LANES = 60;
/** Events this close to the pointer are listed, px. */
const NEAR_PX = 6;
const TOLD_MAX = 4;
const STEPS_S = [0.1, 0.2, 0.5, 1, 2, 5, 10, 30, 60, 120, 300, 600, 1200, 3600];
/** A step of the zoom buttons and keys. */
const ZOOM = 2;
/** A change of the moment by more than this is a jump, s. */
const JUMP_S = 2;
/** Jumping back skips an event reached less than this long ago, s. */
const STICK_S = 0.05;

function drawShape(context, shape, x, y, r) {
  context.beginPath();
  if (shape === 'triangle') {
    context.moveTo(x, y - r);
    context.lineTo(x + r, y + r * 0.8);
    context.lineTo(x - r, y + r * 0.8);
    context.closePath();
  } else if (shape === 'diamond') {
    context.moveTo(x, y - r * 1.3);
    context.lineTo(x + r * 1.1, y);
    context.lineTo(x, y + r * 1.3);
    context.lineTo(x - r * 1.1, y);
    context.closePath();
  } else if (shape === 'dot') context.arc(x, y, r * 0.75, 0, 2 * Math.PI);
  else if (shape === 'square') context.rect(x - r * 0.85, y - r * 0.85, r * 1.7, r * 1.7);
  else {
    context.moveTo(x - r * 0.85, y - r * 0.85);
    context.lineTo(x + r * 0.85, y + r * 0.85);
    context.moveTo(x + r * 0.85, y - r * 0.85);
    context.lineTo(x - r * 0.85, y + r * 0.85);
    context.lineWidth = 2;
    context.stroke();
    return;
  }
  context.fill();
}

export class Timeline {
  /** `span` is the section that is shown, shared with the plots. */
  constructor(send, span) {
    this.send = send;
    this.span = span;
    this.box = document.getElementById('replay');
    this.canvas = document.getElementById('timeline');
    this.context = this.canvas.getContext('2d');
    /** Everything but the handle and the pointer. */
    this.still = document.createElement('canvas');
    this.tip = document.getElementById('timeline-tip');
    this.kind = document.getElementById('event-kind');
    this.legend = document.getElementById('legend');
    this.whole = document.getElementById('time-whole');
    this.marks = [];
    this.score = null;
    this.wanted_s = null;
    this.followed_s = null;
    this.sent_ms = -1e9;
    this.timer = 0;
    this.drawn = '';
    this.kept = '';
    /** The pointers pressed on it: positions from the left, px. */
    this.pointers = new Map();
    options(this.kind, [[ANY, 'any event'], ...KINDS.map(([name], index) => [String(index), name.toLowerCase()])]);
    this.bind();
  }

  bind() {
    const { canvas, span } = this;
    canvas.addEventListener('pointerdown', (event) => this.press(event));
    canvas.addEventListener('pointermove', (event) => this.move(event));
    canvas.addEventListener('pointerup', (event) => this.release(event));
    canvas.addEventListener('pointercancel', (event) => this.release(event));
    canvas.addEventListener('pointerleave', () => this.point(null));
    canvas.addEventListener('wheel', (event) => this.wheel(event), { passive: false });
    canvas.addEventListener('keydown', (event) => this.key(event));
    const press = (id, act) => document.getElementById(id).addEventListener('click', act);
    press('event-back', () => this.jump(this.kind.value, -1));
    press('event-next', () => this.jump(this.kind.value, 1));
    press('time-in', () => span.zoomAt(this.at_s, ZOOM));
    press('time-out', () => span.zoomAt(this.at_s, 1 / ZOOM));
    press('time-whole', () => span.showAll());
  }

  greet(game) {
    this.game = game;
    // A pending jump belonged to the previous view.
    clearTimeout(this.timer);
    this.timer = 0;
    this.scrubbing = false;
    this.wanted_s = null;
    this.marksVersion = -1;
    this.score = null;
    this.chances = game.chart.chances ?? null;
    this.pointers.clear();
    this.point(null);
    show(this.box, game.mode === 'replay');
  }

  get from_s() {
    return this.game.player?.from_s ?? 0;
  }

  get to_s() {
    return Math.max(this.from_s + 1e-3, this.game.player?.to_s ?? this.game.chart.duration_s ?? 1);
  }

  /** Position of the handle: where it is dragged, or else the replay's time. */
  get at_s() {
    return this.wanted_s ?? this.game.player?.t_s ?? this.game.t_s ?? 0;
  }

  /** The time at a pixel from the left of the page. */
  timeAt(clientX) {
    const box = this.canvas.getBoundingClientRect();
    const part = Math.min(1, Math.max(0, (clientX - box.left - LEFT) / Math.max(1, box.width - LEFT - RIGHT)));
    return this.span.from_s + part * (this.span.to_s - this.span.from_s);
  }

  /** Pixels from the left of the canvas. */
  xOf(t_s) {
    const { from_s, to_s } = this.span;
    return LEFT + ((t_s - from_s) / (to_s - from_s)) * (this.canvas.clientWidth - LEFT - RIGHT);
  }

  press(event) {
    if (event.button !== 0) return;
    this.canvas.setPointerCapture(event.pointerId);
    this.pointers.set(event.pointerId, event.clientX);
    this.scrubbing = this.pointers.size === 1;
    if (this.scrubbing) this.seek(this.timeAt(event.clientX));
  }

  move(event) {
    if (this.pointers.size === 2 && this.pointers.has(event.pointerId)) this.pinch(event);
    else if (this.scrubbing) this.seek(this.timeAt(event.clientX));
    this.point(this.timeAt(event.clientX));
  }

  /** Two fingers zoom, and move the section. */
  pinch({ pointerId, clientX }) {
    const [, other] = [...this.pointers].find(([id]) => id !== pointerId);
    const before = this.pointers.get(pointerId);
    const [was, is] = [Math.abs(before - other), Math.abs(clientX - other)];
    const from_s = this.timeAt((before + other) / 2);
    if (was > 4 && is > 4) this.span.zoomAt(from_s, is / was);
    this.span.moveBy(from_s - this.timeAt((clientX + other) / 2));
    this.pointers.set(pointerId, clientX);
  }

  release(event) {
    this.pointers.delete(event.pointerId);
    if (event.pointerType !== 'mouse') this.point(null);
    if (!this.scrubbing) return;
    this.scrubbing = false;
    this.settle();
  }

  wheel(event) {
    if (Math.abs(event.deltaX) > Math.abs(event.deltaY) || event.shiftKey) {
      event.preventDefault();
      this.span.moveBy(((event.deltaX || event.deltaY) / this.canvas.clientWidth) * (this.span.to_s - this.span.from_s));
    } else this.span.wheel(event, this.timeAt(event.clientX));
    this.point(this.timeAt(event.clientX));
  }

  /** Points at a time, or nowhere, and lists the events there. */
  point(t_s) {
    this.span.point(t_s);
    show(this.tip, t_s !== null);
    if (t_s === null) return;
    const px_s = (this.span.to_s - this.span.from_s) / Math.max(1, this.canvas.clientWidth - LEFT - RIGHT);
    const near = this.marks.filter(({ at_s }) => Math.abs(at_s - t_s) <= NEAR_PX * px_s).sort((a, b) => Math.abs(a.at_s - t_s) - Math.abs(b.at_s - t_s));
    const told = near.slice(0, TOLD_MAX).sort((a, b) => a.at_s - b.at_s);
    const lines = told.map(({ at_s, text, team }) => make('li', `team-${team}`, '', make('span', 'swatch'), make('time', '', clock(at_s)), make('span', '', text)));
    if (near.length > told.length) lines.push(make('li', 'faint', `and ${near.length - told.length} more`));
    this.tip.replaceChildren(make('strong', '', clock(t_s)), this.scoreAt(t_s), make('ul', '', '', ...lines));
    const half = this.tip.offsetWidth / 2;
    const width = this.box.clientWidth;
    const { offsetLeft } = this.canvas;
    this.tip.style.left = `${Math.min(width - half - 4, Math.max(half + 4, offsetLeft + this.xOf(t_s)))}px`;
    this.tip.style.bottom = `${this.box.clientHeight - this.canvas.offsetTop + 4}px`;
  }

  /** The score at a moment, and the chance of winning if it is known. */
  scoreAt(t_s) {
    const line = make('span', 'tip-score');
    if (this.chances) {
      const at = sampleAt(this.chances.t_s, t_s);
      const [chance, low, high] = ['chance', 'low', 'high'].map((key) => number(100 * this.chances[key][at], 0));
      line.append(make('span', '', `${plain(this.game.chart.teams[0].name)} wins: ${chance} % (${low} to ${high})`));
    }
    if (!this.score) return line;
    const at = sampleAt(this.score.t_s, t_s);
    this.score.score.forEach((points, team) => line.append(make('span', `team-${team}`, '', make('span', 'swatch'), plain(this.game.chart.teams[team]?.name ?? ''), make('strong', '', number(points[at] ?? 0, 0)))));
    return line;
  }

  /** Goes to a time, now or a little later if seeks come too often; the last one is always sent. */
  seek(t_s) {
    this.wanted_s = Math.min(this.to_s, Math.max(this.from_s, t_s));
    if (this.timer !== 0) return;
    const wait_ms = this.sent_ms + SEEK_MS - performance.now();
    if (wait_ms <= 0) this.sendSeek();
    else this.timer = setTimeout(() => this.sendSeek(), wait_ms);
  }

  /** Plays the replay from its start. */
  watch() {
    this.seek(this.from_s);
    this.send({ do: 'control', what: 'resume' });
  }

  sendSeek() {
    this.timer = 0;
    this.sent_ms = performance.now();
    this.send({ do: 'seek', t_s: this.wanted_s });
    this.settle();
  }

  /** Returns the handle to the replay once it has had time to follow. */
  settle() {
    clearTimeout(this.settling);
    this.settling = setTimeout(() => {
      if (!this.scrubbing && this.timer === 0) this.wanted_s = null;
    }, 400);
  }

  key(event) {
    const step = { ArrowLeft: -1, ArrowRight: 1, PageDown: -10, PageUp: 10, ArrowDown: -1, ArrowUp: 1 }[event.key];
    if (step) this.seek(this.at_s + step * (event.shiftKey ? 10 : 1));
    else if (event.key === 'Home') this.seek(this.from_s);
    else if (event.key === 'End') this.seek(this.to_s);
    else if ('+=-_'.includes(event.key)) this.span.zoomAt(this.at_s, '+='.includes(event.key) ? ZOOM : 1 / ZOOM);
    else if (event.key === '0') this.span.showAll();
    else return;
    event.preventDefault();
    event.stopPropagation();
  }

  /** Goes to the next (1) or previous (-1) event of the given kind: its index, or any. */
  jump(kind, way) {
    if (this.game?.mode !== 'replay') return;
    const marks = kind === ANY ? this.marks : this.marks.filter((mark) => mark.kind === Number(kind));
    const now_s = this.at_s;
    const seen = (mark) => this.seen_s(mark.at_s);
    const next = way > 0 ? marks.find((mark) => seen(mark) > now_s + STICK_S) : marks.findLast((mark) => seen(mark) < now_s - STICK_S);
    if (next) this.seek(seen(next));
  }

  /** The time of the first frame that shows an event: frames are at decisions, and events may fall between two. */
  seen_s(at_s) {
    const decision_s = this.game.chart.decision_s;
    if (!(decision_s > 0)) return at_s;
    // Slightly later, so that rounding does not show the previous frame.
    return Math.ceil(at_s / decision_s - 1e-6) * decision_s + 1e-6;
  }

  tell(game) {
    if (game.mode !== 'replay') return;
    if (this.marksVersion !== game.eventVersion) this.mark(game);
    const at = this.at_s;
    this.span.setWhole(this.from_s, this.to_s);
    this.follow(at);
    show(this.whole, this.span.zoomed);
    this.canvas.setAttribute('aria-valuemin', this.from_s.toFixed(1));
    this.canvas.setAttribute('aria-valuemax', this.to_s.toFixed(1));
    this.canvas.setAttribute('aria-valuenow', at.toFixed(1));
    this.canvas.setAttribute('aria-valuetext', `${clock(at)} of ${clock(this.to_s)}`);
  }

  /** Keeps the moment in the section, unless someone has moved the section away from it. */
  follow(at_s) {
    const before_s = this.followed_s ?? at_s;
    const was = before_s >= this.span.from_s && before_s <= this.span.to_s;
    if (at_s !== before_s && (was || Math.abs(at_s - before_s) > JUMP_S)) this.span.follow(at_s);
    this.followed_s = at_s;
  }

  mark(game) {
    this.marksVersion = game.eventVersion;
    this.marks = [];
    const counts = KINDS.map(() => 0);
    for (const event of game.events) {
      const kind = KINDS.findIndex(([, , events]) => events.includes(event.event));
      if (kind < 0) continue;
      counts[kind] += 1;
      const team = game.vehicles[game.indexOf.get(event.vehicle)]?.team;
      this.marks.push({ at_s: event.at_s, kind, team, text: plain(event.text ?? event.event) });
    }
    this.marks.sort((a, b) => a.at_s - b.at_s);
    this.legend.replaceChildren(...KINDS.map(([name, , , shape], kind) => this.legendEntry(name, shape, counts[kind])));
    this.kept = '';
  }

  legendEntry(name, shape, count) {
    const canvas = make('canvas');
    canvas.width = 32;
    canvas.height = 32;
    const context = canvas.getContext('2d');
    context.scale(2, 2);
    context.fillStyle = palette.ink;
    context.strokeStyle = palette.ink;
    drawShape(context, shape, 8, 8, 5);
    return make('span', 'legend-entry', '', canvas, make('span', '', name), make('span', 'count', String(count)));
  }

  draw() {
    if (this.game?.mode !== 'replay') return;
    const { clientWidth: width, clientHeight: height } = this.canvas;
    if (width === 0) return;
    const ratio = Math.min(2, devicePixelRatio);
    const still = `${width} ${height} ${ratio} ${palette.version} ${this.span.version} ${this.marksVersion}`;
    const at = this.xOf(this.at_s);
    const pointed = this.span.pointed_s === null ? null : Math.round(this.xOf(this.span.pointed_s));
    const key = `${still} ${at.toFixed(1)} ${pointed}`;
    if (key === this.drawn && this.kept !== '') return;
    this.drawn = key;
    if (still !== this.kept) this.drawStill(still, width, height, ratio);
    const { context } = this;
    if (this.canvas.width !== this.still.width || this.canvas.height !== this.still.height) Object.assign(this.canvas, { width: this.still.width, height: this.still.height });
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.clearRect(0, 0, this.canvas.width, this.canvas.height);
    context.drawImage(this.still, 0, 0);
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    const base = height - 20;
    if (pointed !== null && pointed >= LEFT - 1 && pointed <= width - RIGHT + 1) {
      context.fillStyle = palette.faint;
      context.fillRect(pointed - 0.5, 2, 1, base);
    }
    this.drawHandle(context, at, base, width);
  }

  /** Draws everything that does not change while the replay is playing. */
  drawStill(key, width, height, ratio) {
    // The legend has the same colours.
    if (this.kept !== '' && this.kept.split(' ')[3] !== String(palette.version)) this.marksVersion = -1;
    this.kept = key;
    Object.assign(this.still, { width: width * ratio, height: height * ratio });
    const context = this.still.getContext('2d');
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    const base = height - 20;
    this.lane = Math.min(LANE, Math.max(LANE_LOW, (height - BESIDE_LANES) / KINDS.length));
    this.drawScale(context, width, base);
    context.save();
    context.beginPath();
    context.rect(LEFT - 6, 0, width - LEFT - RIGHT + 12, height);
    context.clip();
    this.drawChances(context, base);
    this.drawScore(context, base);
    for (const mark of this.marks) {
      context.fillStyle = palette.teams[mark.team] ?? palette.ink;
      context.strokeStyle = context.fillStyle;
      drawShape(context, KINDS[mark.kind][3], this.xOf(mark.at_s), LANE_TOP + mark.kind * this.lane, 4.5);
    }
    context.restore();
    this.drawOverview(context, width, height);
  }

  drawScale(context, width, base) {
    const { from_s, to_s } = this.span;
    context.fillStyle = palette.grid;
    context.fillRect(LEFT, base - 3, width - LEFT - RIGHT, 6);
    const room = (to_s - from_s) / ((width - LEFT - RIGHT) / 70);
    const step = STEPS_S.find((each) => each >= room) ?? 7200;
    context.font = '11px system-ui, sans-serif';
    context.textAlign = 'center';
    context.textBaseline = 'bottom';
    context.fillStyle = palette.faint;
    for (let t_s = Math.ceil(from_s / step - 1e-9) * step; t_s <= to_s + 1e-6; t_s += step) {
      context.fillText((step < 1 ? clock : clockShort)(t_s), Math.min(width - 18, Math.max(18, this.xOf(t_s))), base + 17);
    }
    if (!this.score) return;
    context.textAlign = 'right';
    context.textBaseline = 'middle';
    const points = base - this.scoreTop > 30 ? ticksOf(0, this.score.most, 2).filter(Number.isInteger) : [0, this.score.most];
    for (const each of points) {
      const y = this.scoreY(each, base);
      context.fillStyle = palette.grid;
      context.fillRect(LEFT - 3, y - 0.5, width - LEFT - RIGHT + 3, 1);
      context.fillStyle = palette.faint;
      context.fillText(String(each), LEFT - 7, y);
    }
  }

  /** The position of the section in the game. */
  drawOverview(context, width, height) {
    if (!this.span.zoomed) return;
    const [first_s, last_s] = this.span.whole;
    const x = (t_s) => LEFT + ((t_s - first_s) / (last_s - first_s)) * (width - LEFT - RIGHT);
    context.fillStyle = palette.grid;
    context.fillRect(LEFT, height - 3, width - LEFT - RIGHT, 3);
    context.fillStyle = palette.accent;
    context.fillRect(x(this.span.from_s), height - 3, Math.max(4, x(this.span.to_s) - x(this.span.from_s)), 3);
  }

  /** Takes the score over the game. */
  takeScore({ t_s, score }) {
    if (this.score) return;
    this.score = { t_s, score, most: Math.max(1, ...score.map((points) => points.at(-1) ?? 0)) };
    this.kept = '';
  }

  get scoreTop() {
    return LANE_TOP + KINDS.length * this.lane + 2;
  }

  scoreY(points, base) {
    const low = base - 9;
    return low - (points / this.score.most) * (low - this.scoreTop);
  }

  /** Draws the chance of winning: the first team's share of the height from below, with its turning points. */
  drawChances(context, base) {
    if (!this.chances) return;
    const { t_s, chance, turns_s } = this.chances;
    const [top, low] = [this.scoreTop, base - 9];
    const y = (share) => low - share * (low - top);
    const line = () => {
      context.beginPath();
      t_s.forEach((at_s, i) => context.lineTo(this.xOf(at_s), y(chance[i])));
    };
    const [first, last] = [this.xOf(t_s[0]), this.xOf(t_s.at(-1))];
    context.globalAlpha = 0.18;
    [low, top].forEach((side, team) => {
      line();
      context.lineTo(last, side);
      context.lineTo(first, side);
      context.fillStyle = palette.teams[team] ?? palette.faint;
      context.fill();
    });
    context.globalAlpha = 1;
    line();
    context.strokeStyle = palette.ink;
    context.lineWidth = 1;
    context.stroke();
    context.fillStyle = palette.ink;
    for (const at_s of turns_s) {
      context.beginPath();
      context.arc(this.xOf(at_s), y(chance[sampleAt(t_s, at_s)]), 3, 0, 2 * Math.PI);
      context.fill();
    }
  }

  /** Draws the score as steps, below the marks. */
  drawScore(context, base) {
    if (!this.score) return;
    const { t_s, score } = this.score;
    score.forEach((points, team) => {
      // Equal scores stay visible beside each other.
      const y = (value) => this.scoreY(value, base) - team * 2;
      context.beginPath();
      for (let i = 0; i < t_s.length; i++) {
        const steps = i > 0 && points[i] !== points[i - 1];
        if (steps) context.lineTo(this.xOf(t_s[i]), y(points[i - 1]));
        if (steps || i === 0 || i === t_s.length - 1) context.lineTo(this.xOf(t_s[i]), y(points[i]));
      }
      context.strokeStyle = palette.teams[team] ?? palette.ink;
      context.lineWidth = 2;
      context.stroke();
    });
  }

  /** The part played, and the handle at the moment if that is in the section. */
  drawHandle(context, at, base, width) {
    context.fillStyle = palette.accent;
    context.fillRect(LEFT, base - 3, Math.min(width - RIGHT, Math.max(LEFT, at)) - LEFT, 6);
    if (at < LEFT - 1 || at > width - RIGHT + 1) return;
    context.fillStyle = palette.ink;
    context.fillRect(at - 1, 2, 2, base);
    context.beginPath();
    context.arc(at, base, 7, 0, 2 * Math.PI);
    context.fillStyle = palette.accent;
    context.fill();
    context.lineWidth = 2;
    context.strokeStyle = palette.paper;
    context.stroke();
  }
}
