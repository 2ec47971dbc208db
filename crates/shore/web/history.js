// What a live game has shown since the page was opened, as curves. A long game is thinned to every second sample, as often as necessary.

const SAMPLES = 1200;
/** Sampling interval at first, s. */
const STEP_S = 0.2;

const degrees = (rad) => (((rad * 180) / Math.PI) % 360 + 360) % 360;
/** Values by boat, in the units of `curves`. The last three are known for the selected boat only. */
const KEYS = ['x_m', 'y_m', 'speed_m_s', 'heading_deg', 'course_deg', 'sway_m_s', 'yaw_rate_deg_s', 'port_newton', 'starboard_newton', 'flag_m',
  'ordered_speed_m_s', 'ordered_heading_deg', 'error_m'];

export class History {
  greet(game) {
    this.count = game.count;
    this.kept = 0;
    this.step_s = STEP_S;
    this.version = 0;
    this.all = new Float64Array(SAMPLES);
    this.values = Object.fromEntries(KEYS.map((key) => [key, new Float32Array(SAMPLES * game.count)]));
    this.points = game.chart.teams.map(() => new Float32Array(SAMPLES));
  }

  /** The sampled times. */
  get times() {
    return this.all.subarray(0, this.kept);
  }

  want() {}

  list(boat, key) {
    return this.values[key].subarray(boat * SAMPLES, boat * SAMPLES + this.kept);
  }

  score(team) {
    return this.points[team].subarray(0, this.kept);
  }

  /** Samples a frame if the next sample is due. */
  take(game) {
    if (this.kept > 0 && game.t_s < this.all[this.kept - 1]) this.greet(game);
    if (this.kept > 0 && game.t_s - this.all[this.kept - 1] < this.step_s - 1e-6) return;
    if (this.kept === SAMPLES) this.thin();
    const at = this.kept;
    this.kept += 1;
    this.version += 1;
    this.all[at] = game.t_s;
    this.points.forEach((points, team) => { points[at] = game.score[team] ?? 0; });
    const flags = this.flagsOf(game);
    for (let boat = 0; boat < Math.min(this.count, game.raw.vehicles.length); boat++) this.put(game, boat, boat * SAMPLES + at, flags);
  }

  put(game, boat, to, flags) {
    const { values } = this;
    const { nav } = game.raw.vehicles[boat];
    values.x_m[to] = nav.east_m;
    values.y_m[to] = nav.north_m;
    values.speed_m_s[to] = game.speed[boat];
    values.heading_deg[to] = degrees(nav.psi_rad);
    values.course_deg[to] = degrees(game.course[boat]);
    values.sway_m_s[to] = nav.sway_m_s;
    values.yaw_rate_deg_s[to] = (nav.yaw_rate_rad_s * 180) / Math.PI;
    values.port_newton[to] = game.port[boat];
    values.starboard_newton[to] = game.starboard[boat];
    values.flag_m[to] = flags.reduce((least, { team, x, y }) => (team === game.teams[boat] ? least
      : Math.min(least, Math.hypot(x - nav.east_m, y - nav.north_m))), Infinity);
    const report = game.vehicles[boat].name === game.selected ? game.helm?.report : null;
    values.ordered_speed_m_s[to] = report ? (report.hold ? 0 : report.speed_m_s ?? NaN) : NaN;
    values.ordered_heading_deg[to] = report && !report.hold ? report.course_deg ?? NaN : NaN;
    values.error_m[to] = game.vehicles[boat].name === game.selected ? game.estimateError() ?? NaN : NaN;
  }

  /** Each flag's position: its carrier's, or its home. */
  flagsOf(game) {
    return (game.chart.field?.flags ?? []).map(({ team, x, y }, flag) => {
      const carrier = game.carrierOf(flag);
      return carrier < 0 ? { team, x, y } : { team, x: game.toX[carrier], y: game.toY[carrier] };
    });
  }

  /** Keeps every second sample. */
  thin() {
    const half = SAMPLES / 2;
    const halve = (list, from) => {
      for (let i = 0; i < half; i++) list[from + i] = list[from + 2 * i];
    };
    halve(this.all, 0);
    for (const points of this.points) halve(points, 0);
    for (const list of Object.values(this.values)) for (let boat = 0; boat < this.count; boat++) halve(list, boat * SAMPLES);
    this.kept = half;
    this.step_s *= 2;
  }
}
