// The stick of a gamepad. It is used only after it has been at rest: a stick that is deflected from the start steers
// nothing.

/** A stick closer to its centre than this is at rest. */
const DEAD_ZONE = 0.18;

/** Some devices report non-finite numbers. */
const axis = (value) => (Number.isFinite(value) ? value : 0);

/** All devices that may have a stick. If there is a standard gamepad, pedals and tilt sensors are ignored. */
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
    /** Devices that have been at rest. */
    this.rested = new Set();
    /** The device whose stick is deflected. */
    this.held = null;
  }

  /** The stick's current command: `{ course_deg, out }`; `{ out: 0, gone }` once when it is released; null if there is none. */
  read() {
    const all = pads();
    const names = all.map((pad) => pad.name);
    // A reconnected device must be at rest first.
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
