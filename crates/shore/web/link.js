// The websocket to the server: it comes back by itself, and tells the server when a frame is drawn.

import { gameOfReport } from './address.js';

/** Waits between two tries, s. */
const WAITS_S = [0.3, 0.6, 1, 2, 3, 5];
/** While nobody looks at the page frames are acknowledged this often, s. */
const HIDDEN_ACK_S = 1;
/** The server has closed the connection with this code, since it needed the room for another page. */
const DISPLACED = 1013;
/** A page that was displaced comes back after so long, and takes the room of another, s. */
const DISPLACED_WAIT_S = 30;
/** A connection that has not opened after this time is given up, s. */
const OPEN_S = 8;
/** One on which nothing comes for so long, though something should, is dead, s. NoRecorder else says so for minutes. */
const SILENCE_S = 4;
/** How often to look whether it is, s. */
const WATCH_S = 1;

/** What the server answers, with how the game or the replay stands or what came of it. */
const ANSWERED = ['control', 'operate', 'mission'];

/** The token in the page's address, kept over a reload since it stays in the address. */
function token() {
  return new URLSearchParams(location.hash.slice(1)).get('token');
}

/** What the server is to show: the game of a report that the page's address names, else what it shows to all. */
function query(secret) {
  const words = new URLSearchParams();
  const game = gameOfReport();
  if (game !== null) words.set('game', game);
  if (secret) words.set('token', secret);
  return words.size > 0 ? `?${words}` : '';
}

export class Link {
  /** `on` has `lost(unheard, displaced)`: whether something asked for may not have arrived, and whether another page has the room; `message(object)` and `frame(kind, buffer)`. */
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
    // An address that is pasted into the open page, with another token, loads nothing.
    addEventListener('hashchange', () => token() !== this.secret && this.restart());
  }

  /** Nothing is known yet of what the server will say. */
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

  /** Heeds the socket no longer, whatever comes of it. */
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

  /** Tries again, after ever longer waits. */
  again(displaced = false) {
    const { unheard } = this;
    this.drop();
    const wait_s = displaced ? DISPLACED_WAIT_S : WAITS_S[Math.min(this.tries, WAITS_S.length - 1)];
    this.tries += 1;
    this.retry = setTimeout(() => this.start(), wait_s * 1000);
    this.on.lost(unheard, displaced);
  }

  /** Connects anew at once. */
  restart() {
    this.drop();
    this.tries = 0;
    this.start();
  }

  /** Gives up a connection that is silent when it should not be. */
  watch(now_ms) {
    // A page that slept, or was busy for long, heard nothing either.
    const slept = now_ms - this.watched_ms > 2 * WATCH_S * 1000;
    this.watched_ms = now_ms;
    if (slept) this.heard_ms = now_ms;
    if (this.connected && this.expects && now_ms - this.heard_ms > SILENCE_S * 1000) this.again();
  }

  /** Whether the server has something to say at least five times a second. A replay that stands says nothing, until it is told to play. */
  get expects() {
    return this.mode === 'live' || this.playing || this.unheard;
  }

  /** Lets a hidden page have a frame now and then. */
  drawnUnseen() {
    if (!document.hidden || performance.now() - this.acked_ms < HIDDEN_ACK_S * 900) return;
    this.drawn();
  }

  take(data) {
    // Browsers let the timers of hidden pages sleep for a minute; messages wake us.
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
    // Only a server that speaks is one: others may open and close at once.
    if (message.kind === 'hello') {
      this.tries = 0;
      this.mode = message.mode;
      this.playing = false;
    }
    if (message.kind === 'player') this.playing = Boolean(message.playing);
    this.on.message(message);
  }

  /** To be called once what has come is on the screen. */
  drawn() {
    if (this.owed > 0) this.acked_ms = performance.now();
    for (; this.owed > 0; this.owed--) this.send({ do: 'ack' });
  }

  /** Whether it went out; not whether it arrived. */
  send(message) {
    if (!this.connected || this.socket.readyState !== WebSocket.OPEN) return false;
    this.socket.send(JSON.stringify(message));
    if (!ANSWERED.includes(message.do) || this.unheard) return true;
    // A replay that stands was silent until now: the time counts from the question.
    if (!this.expects) this.heard_ms = performance.now();
    this.unheard = true;
    return true;
  }
}
