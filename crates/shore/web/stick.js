// The stick of a gamepad. It is heeded once it was seen at rest: one that leans from the start, or lies under a book, steers nothing.

/** Nearer to its middle than this a stick is at rest. */
const DEAD_ZONE = 0.18;

/** Some devices give numbers that are none. */
const axis = (value) => (Number.isFinite(value) ? value : 0);

/** All that may have a stick. Where there is a gamepad as browsers know them, pedals and tilt sensors are none. */
function pads() {
  const all = [...(navigator.getGamepads?.() ?? [])].filter((pad) => pad?.connected && pad.axes.length >= 2);
  const standard = all.filter((pad) => pad.mapping === 'standard');
  return (standard.length > 0 ? standard : all).map((pad) => {
    const [right, down] = pad.axes.map(axis);
    return { name: `${pad.index} ${pad.id}`, right, up: -down, out: Math.hypot(right, down) };
  });
}

export class Stick {
  constructor() {
    /** Those that were seen at rest. */
    this.rested = new Set();
    /** Whose stick is out. */
    this.held = null;
  }

  /** What the stick wants now: `{ course_deg, out }`; when it is let go `{ out: 0, gone }`, once; null if nothing. */
  read() {
    const all = pads();
    const names = all.map((pad) => pad.name);
    // Whoever comes back must be seen at rest again.
    this.rested = new Set(names.filter((name) => this.rested.has(name)));
    for (const pad of all) if (pad.out <= DEAD_ZONE) this.rested.add(pad.name);
    const out = all.filter((pad) => pad.out > DEAD_ZONE && this.rested.has(pad.name));
    const pad = out.find((each) => each.name === this.held) ?? out[0];
    const before = this.held;
    this.held = pad?.name ?? null;
    if (pad) return { course_deg: Math.round((Math.atan2(pad.right, pad.up) * 180) / Math.PI), out: Math.min(1, pad.out) };
    return before === null ? null : { out: 0, gone: !names.includes(before) };
  }
}
