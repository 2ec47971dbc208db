// The game as shown: boats as arrays of numbers, events, and the server's reports.

import { readerOf } from './cdr.js';
import { moveFlags } from './flag.js';
import { Trails } from './trail.js';
import { plain } from './words.js';

/** Marks of a boat, as bit flags. */
export const TAGGED = 1;
export const DISABLED = 2;
export const OUTSIDE = 4;
export const AGENT_LOST = 8;
export const QUARANTINED = 16;
export const NAV_LOST = 32;

/** Bit, letter and meaning of each mark. */
export const MARKS = [
  [TAGGED, 'T', 'tagged'],
  [DISABLED, 'X', 'out of action'],
  [OUTSIDE, 'O', 'outside the field'],
  [AGENT_LOST, 'A', 'agent lost'],
  [QUARANTINED, 'Q', 'quarantined'],
  [NAV_LOST, 'N', 'navigation lost'],
];

/** Frames farther apart than this are not interpolated, ms. */
const GAP_MAX_MS = 600;
/** Interpolation lasts this many intervals between frames, so that a slightly late frame finds the boats still moving. */
const STRETCH = 1.15;
/** Frames closer together than this are not interpolated, ms. */
const GAP_MIN_MS = 22;
/** A boat that moves this much farther than its speed allows has jumped, m. */
const JUMP_M = 4;
/** Number of past positions of the selected boat kept for comparison with estimates. */
const WAKE = 64;

/** Number of newest events kept; some games run for days. */
const EVENTS_MAX = 20_000;

const floats = (count) => new Float64Array(count);

export class Game {
  constructor() {
    this.hello = null;
    /** The number of games shown so far. */
    this.greeted = 0;
    this.clear({ vehicles: [], teams: [], field: null });
  }

  /** Starts over with another game. */
  greet(hello) {
    this.hello = hello;
    this.greeted += 1;
    this.clear(hello.chart);
    this.read = readerOf(hello.definitions, 'Frame');
  }

  clear(chart) {
    const count = chart.vehicles.length;
    this.chart = chart;
    this.vehicles = chart.vehicles;
    this.indexOf = new Map(chart.vehicles.map((vehicle, index) => [vehicle.name, index]));
    this.count = count;
    this.teams = chart.vehicles.map((vehicle) => vehicle.team);
    /** Each team's strategies. */
    this.players = chart.teams.map((_, team) => this.playersOf(team));
    Object.assign(this, {
      fromX: floats(count), fromY: floats(count), fromH: floats(count),
      toX: floats(count), toY: floats(count), toH: floats(count),
      x: floats(count), y: floats(count), heading: floats(count),
      speed: floats(count), course: floats(count), port: floats(count), starboard: floats(count),
      marks: new Uint8Array(count), carrying: new Int16Array(count).fill(-1),
    });
    this.read = null;
    this.raw = undefined;
    this.pastRaw = undefined;
    this.t_s = NaN;
    this.tick = 0;
    this.frames = 0;
    this.unread = 0;
    this.arrival_ms = 0;
    this.gap_ms = 0;
    this.posed_ms = 0;
    this.begun_ms = 0;
    this.posedFrames = 0;
    this.past = false;
    this.smooth = true;
    this.trails = new Trails(count);
    this.score = [];
    this.flags = [];
    this.sea = null;
    this.stopped = false;
    this.over = false;
    this.events = [];
    this.eventVersion = 0;
    this.state = null;
    this.player = null;
    this.statuses = new Map();
    this.heard_ms = new Map();
    this.modes = null;
    this.drivers = new Map();
    this.select(null);
  }

  get mode() {
    return this.hello?.mode ?? null;
  }

  /** Whether a running game has ended, even after its server has gone. */
  get isOver() {
    return this.over || this.state?.phase === 'over';
  }

  /** Selects a boat, and forgets data of the previously selected one. */
  select(name) {
    this.selected = name;
    this.helm = null;
    this.estimate = null;
    this.wake = { t: floats(WAKE), x: floats(WAKE), y: floats(WAKE), at: 0, count: 0 };
    // A paused replay has no other frame to compare an estimate with.
    if (this.frames > 0) this.keepWake();
  }

  /** Adds a frame: `kind` is 1 for a frame to show and 2 for a past frame. */
  takeFrame(kind, buffer, now_ms) {
    if (!this.read) return;
    try {
      if (kind === 2) this.takePast(buffer);
      else this.takePresent(buffer, now_ms);
    } catch {
      this.unread += 1;
    }
  }

  takePast(buffer) {
    if (!this.past) {
      this.trails.clear();
      this.past = true;
    }
    this.pastRaw = this.read(buffer, 1, this.pastRaw);
    const { vehicles, stamp } = this.pastRaw;
    const count = Math.min(this.count, vehicles.length);
    this.trails.begin(stamp.valid_ns / 1e9);
    for (let i = 0; i < count; i++) {
      const { east_m, north_m, surge_m_s, sway_m_s } = vehicles[i].nav;
      this.trails.put(i, east_m, north_m, Math.hypot(surge_m_s, sway_m_s));
    }
  }

  takePresent(buffer, now_ms) {
    const raw = this.read(buffer, 1, this.raw);
    this.raw = raw;
    const t_s = raw.stamp.valid_ns / 1e9;
    const step_s = t_s - this.t_s;
    const back = step_s < 0;
    const fresh = this.frames === 0 || this.past || back;
    if (back && !this.past) this.trails.clear();
    this.past = false;
    const gap_ms = now_ms - this.arrival_ms;
    this.gap_ms = fresh || gap_ms > GAP_MAX_MS ? 0 : this.gap_ms * 0.7 + gap_ms * 0.3;
    this.arrival_ms = now_ms;
    this.t_s = t_s;
    moveFlags(this.chart.field?.flags ?? [], t_s);
    this.tick = raw.stamp.seq;
    this.frames += 1;
    const still = fresh || !this.smooth || this.gap_ms < GAP_MIN_MS;
    this.takeBoats(raw.vehicles, still, Number.isFinite(step_s) ? Math.abs(step_s) : 0);
    this.score = raw.score;
    this.flags = raw.flags;
    this.sea = raw.sea;
    this.stopped = raw.stopped;
    this.over = raw.over;
    this.keepWake();
  }

  takeBoats(vehicles, still, step_s) {
    const count = Math.min(this.count, vehicles.length);
    const sampled = this.trails.wants(this.t_s);
    if (sampled) this.trails.begin(this.t_s);
    for (let i = 0; i < count; i++) {
      const truth = vehicles[i];
      const nav = truth.nav;
      const speed = Math.hypot(nav.surge_m_s, nav.sway_m_s);
      const far = Math.hypot(nav.east_m - this.toX[i], nav.north_m - this.toY[i]);
      const jump = still || far > JUMP_M + 2 * step_s * Math.max(speed, this.speed[i]);
      this.toX[i] = nav.east_m;
      this.toY[i] = nav.north_m;
      this.toH[i] = nav.psi_rad;
      this.fromX[i] = jump ? nav.east_m : this.x[i];
      this.fromY[i] = jump ? nav.north_m : this.y[i];
      this.fromH[i] = jump ? nav.psi_rad : this.heading[i];
      this.speed[i] = speed;
      this.course[i] = nav.psi_rad + Math.atan2(nav.sway_m_s, nav.surge_m_s);
      this.port[i] = truth.port_newton;
      this.starboard[i] = truth.starboard_newton;
      this.carrying[i] = truth.carrying;
      this.marks[i] = (truth.tagged ? TAGGED : 0) | (truth.disabled ? DISABLED : 0) | (truth.outside ? OUTSIDE : 0)
        | (truth.agent_lost ? AGENT_LOST : 0) | (truth.quarantined ? QUARANTINED : 0) | (truth.nav_lost ? NAV_LOST : 0);
      if (sampled) this.trails.put(i, nav.east_m, nav.north_m, speed);
    }
  }

  keepWake() {
    const index = this.indexOf.get(this.selected);
    if (index === undefined) return;
    const wake = this.wake;
    wake.t[wake.at] = this.t_s;
    wake.x[wake.at] = this.toX[index];
    wake.y[wake.at] = this.toY[index];
    wake.at = (wake.at + 1) % WAKE;
    wake.count = Math.min(WAKE, wake.count + 1);
  }

  /** Distance of the estimate from the boat's true position at that time, m; null if either is missing. */
  estimateError() {
    const { estimate, wake } = this;
    if (!estimate || wake.count === 0) return null;
    let best = -1;
    for (let i = 0; i < wake.count; i++) {
      if (best < 0 || Math.abs(wake.t[i] - estimate.at_s) < Math.abs(wake.t[best] - estimate.at_s)) best = i;
    }
    if (Math.abs(wake.t[best] - estimate.at_s) > 2) return null;
    return Math.hypot(estimate.x - wake.x[best], estimate.y - wake.y[best]);
  }

  /** Moves the boats to their interpolated positions, one interval behind the newest frame. Returns whether they are still moving. */
  pose(now_ms) {
    // The interpolation starts from the picture shown before, not from the frame's arrival.
    if (this.posedFrames !== this.frames) this.begun_ms = this.posed_ms;
    this.posedFrames = this.frames;
    this.posed_ms = now_ms;
    const done = this.gap_ms < GAP_MIN_MS ? 1 : Math.min(1, Math.max(0, (now_ms - this.begun_ms) / (this.gap_ms * STRETCH)));
    for (let i = 0; i < this.count; i++) {
      let turn = this.toH[i] - this.fromH[i];
      turn -= 2 * Math.PI * Math.round(turn / (2 * Math.PI));
      this.x[i] = this.fromX[i] + (this.toX[i] - this.fromX[i]) * done;
      this.y[i] = this.fromY[i] + (this.toY[i] - this.fromY[i]) * done;
      this.heading[i] = this.fromH[i] + turn * done;
    }
    return done < 1;
  }

  /** Stores a gateway's status. */
  takeStatus({ vehicle, status }, now_ms) {
    this.statuses.set(vehicle, status);
    this.heard_ms.set(vehicle, now_ms);
  }

  takeEvents(message) {
    if (message.reset) this.events = [];
    for (const event of message.events ?? []) this.events.push(event);
    // The timeline of a replay needs all of them, and gets them only once.
    if (this.mode === 'live' && this.events.length > EVENTS_MAX) this.events.splice(0, this.events.length - EVENTS_MAX);
    this.eventVersion += 1;
  }

  /** A team's strategies, or its name if it has none. */
  playersOf(team) {
    const strategies = this.vehicles.filter((vehicle) => vehicle.team === team && !vehicle.external).map(({ strategy }) => strategy);
    const different = [...new Set(strategies.filter(Boolean))];
    return different.length > 0 ? different.map(plain).join(' + ') : plain(this.chart.teams[team]?.name ?? '');
  }

  /** `learned 3 : 3 strategy 3` */
  get scoreWords() {
    const teams = this.chart.teams.map((_, team) => [this.players[team], this.score[team] ?? '–']);
    if (teams.length !== 2) return teams.map(([name, points]) => `${name} ${points}`).join(', ');
    const [[home, own], [other, theirs]] = teams;
    return `${home} ${own} : ${theirs} ${other}`;
  }

  /** The boat that carries the flag, or -1. */
  carrierOf(flag) {
    return this.flags[flag]?.carrier ?? -1;
  }
}
