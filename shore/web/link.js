// The websocket to the server: it comes back by itself, and tells the server when a frame is drawn.

/** Waits between two tries, s. */
const WAITS_S = [0.3, 0.6, 1, 2, 3, 5];
/** While nobody looks at the page frames are acknowledged this often, s. */
const HIDDEN_ACK_S = 1;
/** A connection that has not opened after this time is given up, s. */
const OPEN_S = 8;

/** The token in the page's address, kept over a reload since it stays in the address. */
function token() {
  return new URLSearchParams(location.hash.slice(1)).get('token');
}

export class Link {
  /** `on` has `open()`, `lost(wait_s)`, `message(object)` and `frame(kind, buffer)`. */
  constructor(on) {
    this.on = on;
    this.connected = false;
    this.tries = 0;
    this.owed = 0;
    this.socket = null;
    this.acked_ms = 0;
    setInterval(() => this.drawnUnseen(), HIDDEN_ACK_S * 1000);
  }

  start() {
    const secret = token();
    const scheme = location.protocol === 'https:' ? 'wss:' : 'ws:';
    const query = secret ? `?token=${encodeURIComponent(secret)}` : '';
    const socket = new WebSocket(`${scheme}//${location.host}/ws${query}`);
    socket.binaryType = 'arraybuffer';
    this.socket = socket;
    this.owed = 0;
    const late = setTimeout(() => socket.readyState === WebSocket.CONNECTING && socket.close(), OPEN_S * 1000);
    socket.onopen = () => {
      this.connected = true;
      this.on.open();
    };
    socket.onmessage = (event) => this.take(event.data);
    socket.onclose = () => {
      clearTimeout(late);
      this.again();
    };
  }

  /** Tries again, after ever longer waits. */
  again() {
    this.connected = false;
    const wait_s = WAITS_S[Math.min(this.tries, WAITS_S.length - 1)];
    this.tries += 1;
    this.on.lost(wait_s);
    setTimeout(() => this.start(), wait_s * 1000);
  }

  /** Lets a hidden page have a frame now and then. */
  drawnUnseen() {
    if (!document.hidden || performance.now() - this.acked_ms < HIDDEN_ACK_S * 900) return;
    this.drawn();
  }

  take(data) {
    // Browsers let the timers of hidden pages sleep for a minute; messages wake us.
    this.drawnUnseen();
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
    if (message.kind === 'hello') this.tries = 0;
    this.on.message(message);
  }

  /** To be called once what has come is on the screen. */
  drawn() {
    if (this.owed > 0) this.acked_ms = performance.now();
    for (; this.owed > 0; this.owed--) this.send({ do: 'ack' });
  }

  /** Whether it went out. */
  send(message) {
    if (!this.connected || this.socket.readyState !== WebSocket.OPEN) return false;
    this.socket.send(JSON.stringify(message));
    return true;
  }
}
