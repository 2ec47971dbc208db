// The section of the game that the timeline and the plots show, and the moment pointed at in either.

/** Minimum length of a section, s. */
const LEAST_S = 2;
/** Position of the moment in a section that has moved to follow it, as a fraction of the section's length. */
const ENTER = 0.1;

export class Span {
  constructor() {
    /** Grows with every change of the section. */
    this.version = 0;
    this.forget();
  }

  forget() {
    this.whole = [0, LEAST_S];
    this.shown = null;
    /** The moment pointed at, s; null if there is none. */
    this.pointed_s = null;
    this.version += 1;
  }

  get from_s() {
    return (this.shown ?? this.whole)[0];
  }

  get to_s() {
    return (this.shown ?? this.whole)[1];
  }

  get zoomed() {
    return this.shown !== null;
  }

  /** Sets the limits of the game. A section at its end moves along with it. */
  setWhole(from_s, to_s) {
    const [before_s, until_s] = this.whole;
    const end_s = Math.max(to_s, from_s + LEAST_S);
    if (before_s === from_s && until_s === end_s) return;
    this.whole = [from_s, end_s];
    this.version += 1;
    if (this.shown && this.to_s >= until_s - 1e-6) this.show(this.from_s + end_s - until_s, end_s);
    else if (this.shown) this.show(...this.shown);
  }

  /** Shows a section, within the game, or the whole game if the section is as long. */
  show(from_s, to_s) {
    const [first_s, last_s] = this.whole;
    const length_s = Math.max(LEAST_S, to_s - from_s);
    const start_s = Math.min(Math.max(first_s, from_s), Math.max(first_s, last_s - length_s));
    this.shown = length_s >= last_s - first_s - 1e-6 ? null : [start_s, start_s + length_s];
    this.version += 1;
  }

  showAll() {
    this.show(...this.whole);
  }

  /** Makes the section shorter by this factor, or longer if it is below 1. The moment stays where it is. */
  zoomAt(t_s, factor) {
    const part = (t_s - this.from_s) / (this.to_s - this.from_s);
    const length_s = Math.max(LEAST_S, (this.to_s - this.from_s) / factor);
    this.show(t_s - part * length_s, t_s + (1 - part) * length_s);
  }

  /** Zooms by a turn of the wheel at a moment. */
  wheel(event, t_s) {
    event.preventDefault();
    this.zoomAt(t_s, Math.exp(Math.max(-1, Math.min(1, -event.deltaY * (event.deltaMode === 1 ? 16 : 1) * 0.002))));
  }

  moveBy(by_s) {
    if (this.shown) this.show(this.from_s + by_s, this.to_s + by_s);
  }

  /** Moves the section so that it contains the moment. */
  follow(t_s) {
    if (!this.shown || (t_s >= this.from_s && t_s <= this.to_s)) return;
    this.moveBy(t_s - this.from_s - ENTER * (this.to_s - this.from_s));
  }

  point(t_s) {
    this.pointed_s = t_s;
  }
}
