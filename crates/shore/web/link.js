// The WebSocket to the server: reconnects automatically and acknowledges drawn frames.

import { gameOfReport } from './address.js';

/** Waits between attempts, s. */
const WAITS_S = [0.3, 0.6, 1, 2, 3, 5];
/** Interval of acknowledgements while the page is hidden, s. */
const HIDDEN_ACK_S = 1;
/** Close code with which the server frees the slot of this page for another one. */
const DISPLACED = 1013;
/** Time after which a displaced page reconnects and displaces another one, s. */
const DISPLACED_WAIT_S = 30;
/** Timeout of opening a connection, s. */
const OPEN_S = 8;
/** A connection that has been silent for this long although messages are due is dead, s. Browsers notice only after minutes. */
const SILENCE_S = 4;
/** Interval of checks for this, s. */
const WATCH_S = 1;

/** Requests that the server answers, with the state of the game or replay, or with a result. */
const ANSWERED = ['control', 'operate', 'mission'];

/** The token in the page's address, where it survives a reload. */
function token() {
  return new URLSearchParams(location.hash.slice(1)).get('token');
}

/** What the server must show: the game of a report in the page's address, or else the default. */
function query(secret) {
  const words = new URLSearchParams();
  const game = gameOfReport();
  if (game !== null) words.set('game', game);
  if (secret) words.set('token', secret);
  return words.size > 0 ? `?${words}` : '';
}

export class Link {
  /** `on` has `lost(unheard, displaced)`: whether a command may be lost, and whether another page took the slot; `message(object)` and `frame(kind, buffer)`. */
  constructor(on) {
    this.on = on;
    this.connected = false;
    this.tries = 0;
    this.owed = 0;
    this.socket = null;
    this.acked_ms = 0;
    this.late = 0;
    this.retry = 0;
    this.heard_ms = 0;
    this.watched_ms = 0;
    this.forget();
    setInterval(() => this.drawnUnseen(), HIDDEN_ACK_S * 1000);
    setInterval(() => this.watch(performance.now()), WATCH_S * 1000);
    // Pasting an address with a different token into the open page reloads nothing.
    addEventListener('hashchange', () => token() !== this.secret && this.restart());
  }

  /** Resets the state: nothing has been received yet. */
  forget() {
    this.mode = null;
    this.playing = false;
    this.unheard = false;
  }

  start() {
    const secret = token();
    this.secret = secret;
    const scheme = location.protocol === 'https:' ? 'wss:' : 'ws:';
    const socket = new WebSocket(`${scheme}//${location.host}/ws${query(secret)}`);
    socket.binaryType = 'arraybuffer';
    this.socket = socket;
    this.owed = 0;
    this.late = setTimeout(() => socket.readyState === WebSocket.CONNECTING && socket.close(), OPEN_S * 1000);
    socket.onopen = () => {
      this.connected = true;
      this.heard_ms = performance.now();
    };
    socket.onmessage = (event) => this.take(event.data);
    socket.onclose = (event) => this.again(event.code === DISPLACED);
  }

  /** Ignores the socket from now on. */
  drop() {
    clearTimeout(this.late);
    clearTimeout(this.retry);
    const { socket } = this;
    if (!socket) return;
    Object.assign(socket, { onopen: null, onmessage: null, onclose: null });
    socket.close();
    this.socket = null;
    this.connected = false;
    this.forget();
  }

  /** Retries after increasing waits. */
  again(displaced = false) {
    const { unheard } = this;
    this.drop();
    const wait_s = displaced ? DISPLACED_WAIT_S : WAITS_S[Math.min(this.tries, WAITS_S.length - 1)];
    this.tries += 1;
    this.retry = setTimeout(() => this.start(), wait_s * 1000);
    this.on.lost(unheard, displaced);
  }

  /** Reconnects immediately. */
  restart() {
    this.drop();
    this.tries = 0;
    this.start();
  }

  /** Closes a connection that has been silent although messages are due. */
  watch(now_ms) {
    // A page that was asleep or busy has received nothing either.
    const slept = now_ms - this.watched_ms > 2 * WATCH_S * 1000;
    this.watched_ms = now_ms;
    if (slept) this.heard_ms = now_ms;
    if (this.connected && this.expects && now_ms - this.heard_ms > SILENCE_S * 1000) this.again();
  }

  /** Whether the server must send at least five times per second. A paused replay sends nothing until it is played. */
  get expects() {
    return this.mode === 'live' || this.playing || this.unheard;
  }

  /** Acknowledges a frame of a hidden page from time to time. */
  drawnUnseen() {
    if (!document.hidden || performance.now() - this.acked_ms < HIDDEN_ACK_S * 900) return;
    this.drawn();
  }

  take(data) {
    // Browsers may suspend timers of hidden pages for a minute; messages wake the page.
    this.drawnUnseen();
    this.heard_ms = performance.now();
    this.unheard = false;
    if (typeof data !== 'string') {
      const kind = data.byteLength > 4 ? new DataView(data).getUint8(0) : 0;
      if (kind === 1) this.owed += 1;
      if (kind === 1 || kind === 2) this.on.frame(kind, data);
      return;
    }
    let message;
    try {
      message = JSON.parse(data);
    } catch {
      return;
    }
    // Only a server that sends messages counts: others may open and close at once.
    if (message.kind === 'hello') {
      this.tries = 0;
      this.mode = message.mode;
      this.playing = false;
    }
    if (message.kind === 'player') this.playing = Boolean(message.playing);
    this.on.message(message);
  }

  /** Call once the received data has been drawn. */
  drawn() {
    if (this.owed > 0) this.acked_ms = performance.now();
    for (; this.owed > 0; this.owed--) this.send({ do: 'ack' });
  }

  /** Returns whether the message was sent, not whether it arrived. */
  send(message) {
    if (!this.connected || this.socket.readyState !== WebSocket.OPEN) return false;
    this.socket.send(JSON.stringify(message));
    if (!ANSWERED.includes(message.do) || this.unheard) return true;
    // A paused replay was silent until now: measure from the request.
    if (!this.expects) this.heard_ms = performance.now();
    this.unheard = true;
    return true;
  }
}
