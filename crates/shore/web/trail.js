// The boats' positions and speeds in the last minute: one ring buffer for all.

import { palette } from './palette.js';

/** Length of a trail, s. */
export const TRAIL_S = 60;
const SAMPLES = 256;
/** Sampling interval, s. */
const STEP_S = 0.25;
/** A boat that moves this much farther between two samples than a fast boat could has jumped, m/s and m. */
const LEAP_M_S = 12;
const LEAP_M = 6;
/** Maximum number of pieces drawn at a time. */
const PIECES_MAX = 9000;
/** Trails of up to this many boats are drawn at full opacity. */
const CLEAR = 30;
/** Ages at which a trail fades, as fractions of its length, and its opacities. */
const BANDS = [[0, 0.2, 0.8], [0.2, 0.5, 0.45], [0.5, 1, 0.2]];

export class Trails {
  constructor(count) {
    this.count = count;
    this.times = new Float64Array(SAMPLES);
    this.xs = new Float32Array(SAMPLES * count);
    this.ys = new Float32Array(SAMPLES * count);
    this.speeds = new Float32Array(SAMPLES * count);
    this.near = new Uint8Array(count);
    this.version = 0;
    /** Grows when all samples are dropped. */
    this.epoch = 0;
    this.clear();
  }

  clear() {
    this.head = -1;
    this.kept = 0;
    this.epoch += 1;
    this.version += 1;
  }

  /** Whether the next sample is due. */
  wants(t_s) {
    return this.kept === 0 || Math.abs(t_s - this.times[this.head]) >= STEP_S - 1e-6;
  }

  begin(t_s) {
    if (!this.wants(t_s)) return;
    this.head = (this.head + 1) % SAMPLES;
    this.kept = Math.min(SAMPLES, this.kept + 1);
    this.times[this.head] = t_s;
    this.version += 1;
  }

  put(boat, x, y, speed) {
    this.xs[this.head * this.count + boat] = x;
    this.ys[this.head * this.count + boat] = y;
    this.speeds[this.head * this.count + boat] = speed;
  }

  /** Calls `visit(age, speed)` for the samples of a boat, newest first; ages are fractions of a trail's length. */
  eachSpeed(boat, now_s, visit) {
    for (let back = 0; back < this.kept; back++) {
      const row = this.row(back);
      const age = (now_s - this.times[row]) / TRAIL_S;
      if (age > 1) break;
      visit(Math.max(0, age), this.speeds[row * this.count + boat]);
    }
  }

  /** The row of the sample `back` before the newest. */
  row(back) {
    return (this.head - back + SAMPLES) % SAMPLES;
  }

  /** Draws the trails of all boats for which `colourOf` returns a colour, with the selected one highlighted. */
  draw(context, view, teams, colours, now_s, selected) {
    if (this.kept < 2) return;
    // A power of two, so that the skipped rows stay the same as the ring turns.
    const near = this.nearby(view);
    const stride = 2 ** Math.max(0, Math.ceil(Math.log2((near * this.kept) / PIECES_MAX)));
    context.lineJoin = 'round';
    // The more trails, the fainter they are; otherwise they would hide the boats.
    const fade = Math.min(1, Math.sqrt(CLEAR / near));
    for (const [young, old, strength] of BANDS) {
      for (let team = 0; team < colours.length; team++) {
        context.beginPath();
        for (let boat = 0; boat < this.count; boat++) {
          if (teams[boat] === team && boat !== selected && this.near[boat]) this.path(context, view, boat, stride, now_s, young, old);
        }
        context.globalAlpha = strength * fade;
        context.strokeStyle = colours[team];
        context.lineWidth = 1.25;
        context.stroke();
        if (teams[selected] !== team) continue;
        context.beginPath();
        this.path(context, view, selected, 1, now_s, young, old);
        context.globalAlpha = Math.min(1, strength + 0.2);
        context.lineWidth = 2.25;
        context.stroke();
      }
    }
    context.globalAlpha = 1;
  }

  /** Marks and counts the boats on the chart or near it. */
  nearby(view) {
    const row = this.head * this.count;
    const [reachX, reachY] = [view.width, view.height].map((side) => (view.turned ? Math.max(view.width, view.height) : side) / view.scale);
    let count = 0;
    for (let boat = 0; boat < this.count; boat++) {
      const near = Math.abs(this.xs[row + boat] - view.centreX) < reachX && Math.abs(this.ys[row + boat] - view.centreY) < reachY;
      this.near[boat] = near ? 1 : 0;
      count += this.near[boat];
    }
    return Math.max(1, count);
  }

  path(context, view, boat, stride, now_s, young, old) {
    let drawn = false;
    let lastX = 0;
    let lastY = 0;
    let last_s = 0;
    for (let back = 0; back < this.kept; back += back === 0 ? this.head % stride || stride : stride) {
      const row = this.row(back);
      const age = (now_s - this.times[row]) / TRAIL_S;
      if (age > old + 0.01) break;
      const x = this.xs[row * this.count + boat];
      const y = this.ys[row * this.count + boat];
      if (age >= young - 0.01) {
        const leap = drawn && Math.abs(x - lastX) + Math.abs(y - lastY) > LEAP_M + LEAP_M_S * Math.abs(this.times[row] - last_s);
        if (drawn && !leap) context.lineTo(view.xOf(x, y), view.yOf(x, y));
        else context.moveTo(view.xOf(x, y), view.yOf(x, y));
        drawn = true;
      }
      lastX = x;
      lastY = y;
      last_s = this.times[row];
    }
  }
}

/** Minimum interval between redraws while only trails or the position of the chart change, ms. */
const AGAIN_MS = 150;

/** The canvas of the trails. It is redrawn occasionally and otherwise moves with the chart, which costs almost nothing. */
export class TrailLayer {
  constructor(canvas) {
    this.canvas = canvas;
    this.context = canvas.getContext('2d');
    this.drawn = { look: '', soft: '', at_ms: 0, x: 0, y: 0 };
  }

  /** Marks the canvas as empty, so that it is redrawn. */
  forget() {
    this.drawn.look = '';
  }

  /** `key` covers everything else that affects it; `index` is the selected boat. */
  draw(game, view, shown, key, index, now_ms) {
    const { drawn } = this;
    const look = `${view.scale} ${view.turned} ${view.width} ${view.height} ${palette.version} ${key} ${game.trails.epoch}`;
    const soft = `${view.version} ${game.trails.version}`;
    if (look === drawn.look && soft === drawn.soft) return;
    if (look === drawn.look && now_ms - drawn.at_ms < AGAIN_MS) {
      const right = view.xOf(drawn.x, drawn.y) - view.width / 2;
      const down = view.yOf(drawn.x, drawn.y) - view.height / 2;
      this.canvas.style.transform = `translate(${right}px, ${down}px)`;
      return;
    }
    this.drawn = { look, soft, at_ms: now_ms, x: view.centreX, y: view.centreY };
    this.canvas.style.transform = '';
    this.context.clearRect(0, 0, view.width, view.height);
    if (!shown.trails || !Number.isFinite(game.t_s)) return;
    game.trails.draw(this.context, view, game.teams, palette.teams, game.t_s, index);
  }
}
