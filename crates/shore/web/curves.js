// Curves of boats over a recorded game, requested from the server one after another. `History` has the same form in a live game.

/** A request without a reply is repeated after this, ms. */
const AGAIN_MS = 10_000;

const numbers = (list) => Float32Array.from(list, (value) => value ?? NaN);

export class Curves {
  /** `send(message)` returns whether it was sent. */
  constructor(send) {
    this.send = send;
    this.forget();
  }

  forget() {
    this.times = [];
    this.points = null;
    this.known = new Map();
    this.queue = [];
    this.waiting = null;
    /** Grows with every reply. */
    this.version = 0;
  }

  greet(game) {
    this.forget();
    this.vehicles = game.vehicles;
    // Request only the score.
    if (game.mode === 'replay') this.queue.push(null);
    this.next();
  }

  /** Requests the curves of these boats, by index. */
  want(boats) {
    for (const boat of boats) {
      const { name } = this.vehicles[boat];
      if (!this.known.has(name) && !this.queue.includes(name) && this.waiting?.name !== name) this.queue.push(name);
    }
    this.next();
  }

  /** Sends the next request once the previous one has been answered: the server keeps only the newest one. */
  next() {
    const now_ms = performance.now();
    if (this.waiting && now_ms - this.waiting.at_ms < AGAIN_MS) return;
    const name = this.waiting ? this.waiting.name : this.queue[0];
    if (name === undefined || !this.send({ do: 'curves', vehicle: name })) return;
    if (!this.waiting) this.queue.shift();
    this.waiting = { name, at_ms: now_ms };
  }

  take({ vehicle, t_s, score, boat }) {
    if (this.waiting?.name === vehicle) this.waiting = null;
    this.times = t_s;
    this.points = score;
    if (boat) this.known.set(vehicle, Object.fromEntries(Object.entries(boat).map(([key, list]) => [key, numbers(list)])));
    this.version += 1;
    this.next();
  }

  /** A boat's values by sample, NaN where unknown; null if they have not arrived. */
  list(boat, key) {
    return this.known.get(this.vehicles[boat].name)?.[key] ?? null;
  }

  /** A team's points by sample; null if they have not arrived. */
  score(team) {
    return this.points?.[team] ?? null;
  }
}
