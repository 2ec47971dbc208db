// The time line of a replay: the current moment, the events, and ways to reach them.

import { palette } from './palette.js';
import { clock, clockShort, make, options, show } from './words.js';

/** Kinds of marks: name, key, events, shape. */
export const KINDS = [
  ['Grabs', 'g', ['grabbed'], 'triangle'],
  ['Captures', 'c', ['captured'], 'diamond'],
  ['Tags', 't', ['tagged', 'tagged_by_boundary'], 'dot'],
  ['Collisions', 'b', ['collided'], 'cross'],
  ['Failsafes', 'i', ['failsafe'], 'square'],
];

const ANY = 'any';
/** Minimum time between two seeks while scrubbing, ms. */
const SEEK_MS = 50;
const SIDE = 14;
const LANE_TOP = 11;
const LANE = 9;
/** Jumping back skips an event that was just reached, s. */
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
  constructor(send) {
    this.send = send;
    this.box = document.getElementById('replay');
    this.canvas = document.getElementById('timeline');
    this.context = this.canvas.getContext('2d');
    this.kind = document.getElementById('event-kind');
    this.legend = document.getElementById('legend');
    this.marks = [];
    this.score = null;
    this.wanted_s = null;
    this.sent_ms = -1e9;
    this.timer = 0;
    this.drawn = '';
    options(this.kind, [[ANY, 'any event'], ...KINDS.map(([name], index) => [String(index), name.toLowerCase()])]);
    this.canvas.addEventListener('pointerdown', (event) => this.press(event));
    this.canvas.addEventListener('pointermove', (event) => event.buttons > 0 && this.scrubbing && this.scrub(event));
    const end = () => this.release();
    this.canvas.addEventListener('pointerup', end);
    this.canvas.addEventListener('pointercancel', end);
    this.canvas.addEventListener('keydown', (event) => this.key(event));
    document.getElementById('event-back').addEventListener('click', () => this.jump(this.kind.value, -1));
    document.getElementById('event-next').addEventListener('click', () => this.jump(this.kind.value, 1));
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
    if (game.mode === 'replay') this.send({ do: 'curves', vehicle: null, other: null });
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

  press(event) {
    if (event.button !== 0) return;
    this.canvas.setPointerCapture(event.pointerId);
    this.scrubbing = true;
    this.scrub(event);
  }

  scrub(event) {
    const box = this.canvas.getBoundingClientRect();
    const part = (event.clientX - box.left - SIDE) / Math.max(1, box.width - 2 * SIDE);
    this.seek(this.from_s + Math.min(1, Math.max(0, part)) * (this.to_s - this.from_s));
  }

  release() {
    this.scrubbing = false;
    this.settle();
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
    const span = this.to_s - this.from_s;
    const step = { ArrowLeft: -1, ArrowRight: 1, PageDown: -10, PageUp: 10, ArrowDown: -1, ArrowUp: 1 }[event.key];
    if (step) this.seek(this.at_s + step * (event.shiftKey ? 10 : 1));
    else if (event.key === 'Home') this.seek(this.from_s);
    else if (event.key === 'End') this.seek(this.from_s + span);
    else return;
    event.preventDefault();
    event.stopPropagation();
  }

  /** Goes to the next (1) or previous (-1) event of a kind: its index, or any. */
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
    this.canvas.setAttribute('aria-valuemin', this.from_s.toFixed(1));
    this.canvas.setAttribute('aria-valuemax', this.to_s.toFixed(1));
    this.canvas.setAttribute('aria-valuenow', at.toFixed(1));
    this.canvas.setAttribute('aria-valuetext', `${clock(at)} of ${clock(this.to_s)}`);
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
      this.marks.push({ at_s: event.at_s, kind, team });
    }
    this.marks.sort((a, b) => a.at_s - b.at_s);
    this.legend.replaceChildren(...KINDS.map(([name, , , shape], kind) => this.legendEntry(name, shape, counts[kind])));
    this.drawn = '';
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
    const width = this.canvas.clientWidth;
    const height = this.canvas.clientHeight;
    const ratio = Math.min(2, devicePixelRatio);
    const x = (t_s) => SIDE + ((t_s - this.from_s) / (this.to_s - this.from_s)) * (width - 2 * SIDE);
    const key = `${width} ${ratio} ${palette.version} ${x(this.at_s).toFixed(1)} ${this.to_s} ${this.marks.length} ${clock(this.at_s)}`;
    if (key === this.drawn || width === 0) return;
    const legendDue = this.drawn !== '' && !this.drawn.includes(` ${palette.version} `);
    this.drawn = key;
    if (legendDue) this.marksVersion = -1;
    this.canvas.width = width * ratio;
    this.canvas.height = height * ratio;
    const { context } = this;
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    const base = height - 17;
    this.drawScale(context, x, width, base);
    this.drawScore(context, x, base);
    const colours = palette.teams;
    for (const mark of this.marks) {
      context.fillStyle = colours[mark.team] ?? palette.ink;
      context.strokeStyle = context.fillStyle;
      drawShape(context, KINDS[mark.kind][3], x(mark.at_s), LANE_TOP - 3 + mark.kind * LANE, 4.5);
    }
    this.drawHandle(context, x(this.at_s), base);
  }

  drawScale(context, x, width, base) {
    context.fillStyle = palette.grid;
    context.fillRect(SIDE, base - 3, width - 2 * SIDE, 6);
    context.fillStyle = palette.accent;
    context.fillRect(SIDE, base - 3, Math.max(0, x(this.at_s) - SIDE), 6);
    const steps = [1, 5, 10, 30, 60, 120, 300, 600, 1200, 3600];
    const room = (this.to_s - this.from_s) / ((width - 2 * SIDE) / 70);
    const step = steps.find((each) => each >= room) ?? 7200;
    context.font = '11px system-ui, sans-serif';
    context.textAlign = 'center';
    context.textBaseline = 'bottom';
    context.fillStyle = palette.faint;
    for (let t_s = Math.ceil(this.from_s / step) * step; t_s <= this.to_s; t_s += step) {
      const at = Math.min(width - 18, Math.max(18, x(t_s)));
      context.fillText(clockShort(t_s), at, base + 17);
    }
  }

  /** Takes the score over the game. */
  takeScore({ t_s, score }) {
    this.score = { t_s, score, most: Math.max(1, ...score.map((points) => points.at(-1) ?? 0)) };
    this.drawn = `${this.drawn} `;
  }

  /** Draws the score as steps, behind the marks. */
  drawScore(context, x, base) {
    if (!this.score) return;
    const { t_s, score, most } = this.score;
    const low = base - 6;
    score.forEach((points, team) => {
      const y = (value) => low - (value / most) * (low - 5) - team * 2;
      context.beginPath();
      for (let i = 0; i < t_s.length; i++) {
        const steps = i > 0 && points[i] !== points[i - 1];
        if (steps) context.lineTo(x(t_s[i]), y(points[i - 1]));
        if (steps || i === 0 || i === t_s.length - 1) context.lineTo(x(t_s[i]), y(points[i]));
      }
      context.strokeStyle = palette.teams[team] ?? palette.ink;
      context.lineWidth = 2;
      context.globalAlpha = 0.55;
      context.stroke();
      context.globalAlpha = 1;
    });
  }

  drawHandle(context, at, base) {
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
