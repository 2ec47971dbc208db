// Driving: steers a boat by keys, by a point dragged on a dial, or by a gamepad's stick.

import { notice } from './status.js';
import { palette } from './palette.js';
import { Stick } from './stick.js';
import { bearing, number, plain, show, wrapDeg, write } from './words.js';

/** A set-point is sent twice per simulated second: the helm uses each for 1.5 simulated seconds. */
const SEND_SIMULATED_MS = 500;
/** Limits of the interval, at any game speed, ms. */
const SEND_MIN_MS = 20;
const SEND_MAX_MS = 200;
/** Above this multiple of real time, a set-point expires before the next one can arrive. */
const STEERED_MAX = 50;
const TURN_DEG = 5;
const SPEED_STEP_M_S = 0.25;
const RIM = 16;

const KEYS = {
  arrowleft: [-TURN_DEG, 0], a: [-TURN_DEG, 0], arrowright: [TURN_DEG, 0], d: [TURN_DEG, 0],
  arrowup: [0, SPEED_STEP_M_S], w: [0, SPEED_STEP_M_S], arrowdown: [0, -SPEED_STEP_M_S], s: [0, -SPEED_STEP_M_S],
};

export class Drive {
  constructor(send) {
    this.send = send;
    this.place = document.getElementById('steering-place');
    this.canvas = document.getElementById('steering');
    this.text = document.getElementById('steering-text');
    this.note = document.getElementById('steering-note');
    this.context = this.canvas.getContext('2d');
    this.vehicle = null;
    /** The bearing that is up on the chart, and so on the dial. */
    this.up_deg = 0;
    this.timer = 0;
    this.wait_ms = SEND_MAX_MS;
    this.canvas.addEventListener('pointerdown', (event) => {
      event.preventDefault();
      this.canvas.focus();
      this.canvas.setPointerCapture(event.pointerId);
      this.drag(event);
    });
    this.canvas.addEventListener('pointermove', (event) => event.buttons > 0 && this.drag(event));
    document.getElementById('let-go').addEventListener('click', () => this.letGo());
    addEventListener('blur', () => this.letGo());
    addEventListener('pagehide', () => this.letGo());
    document.addEventListener('visibilitychange', () => document.hidden && this.letGo());
  }

  get driving() {
    return this.vehicle !== null;
  }

  /** Starts to drive a boat, with its heading as the course and a speed of zero. */
  take(vehicle, heading_deg) {
    this.letGo();
    this.vehicle = vehicle.name;
    this.speedMax = vehicle.speed_max_m_s > 0 ? vehicle.speed_max_m_s : 1;
    this.course_deg = wrapDeg(Math.round(heading_deg));
    this.speed_m_s = 0;
    this.had = false;
    this.stick = new Stick();
    show(this.place, true);
    document.body.classList.add('driving');
    this.canvas.focus();
    this.tick();
  }

  letGo() {
    if (!this.driving) return;
    clearTimeout(this.timer);
    this.send({ do: 'let_go', vehicle: this.vehicle });
    this.vehicle = null;
    show(this.place, false);
    document.body.classList.remove('driving');
  }

  /** The server reports who drives a boat. */
  hear({ vehicle, by }) {
    if (vehicle !== this.vehicle) return;
    if (by === 'you') this.had = true;
    else if (by === 'other' || this.had) {
      this.letGo();
      notice(by === 'other' ? `Another page is driving ${plain(vehicle)}.` : `You are no longer driving ${plain(vehicle)}.`);
    }
  }

  /** Sets the speed of the game: the faster it is, the more often the boat needs set-points. */
  hearState(state) {
    const rates = [state?.speed, state?.rate].filter((each) => each > 0);
    this.wait_ms = Math.min(SEND_MAX_MS, Math.max(SEND_MIN_MS, SEND_SIMULATED_MS / Math.max(1, ...rates)));
    const wild = Boolean(state) && (state.speed ?? Infinity) > STEERED_MAX;
    write(this.note, wild ? 'Too fast to drive by hand. Choose 1×.' : '');
    show(this.note, wild);
  }

  tick() {
    // Set the timer first, so that an error in drawing does not end the driving.
    this.timer = setTimeout(() => this.tick(), this.wait_ms);
    this.readStick();
    this.send({ do: 'drive', vehicle: this.vehicle, course_deg: this.course_deg, speed_m_s: this.speed_m_s });
    this.draw();
  }

  /** Whether the key is used for driving. */
  key(event) {
    const change = KEYS[event.key.toLowerCase()];
    if (!this.driving || !change || event.ctrlKey || event.metaKey || event.altKey) return false;
    this.set(this.course_deg + change[0], this.speed_m_s + change[1]);
    return true;
  }

  set(course_deg, speed_m_s) {
    this.course_deg = wrapDeg(course_deg);
    this.speed_m_s = Math.min(this.speedMax, Math.max(0, speed_m_s));
    this.draw();
  }

  drag(event) {
    if (!this.driving) return;
    const box = this.canvas.getBoundingClientRect();
    const right = event.clientX - box.left - box.width / 2;
    const up = box.height / 2 - (event.clientY - box.top);
    const out = Math.min(1, Math.hypot(right, up) / (box.width / 2 - RIM));
    // Near the centre, a trembling finger would turn the boat around.
    if (out < 0.08) this.set(this.course_deg, 0);
    else this.set(Math.round((Math.atan2(right, up) * 180) / Math.PI) + this.up_deg, out * this.speedMax);
  }

  readStick() {
    const wish = this.stick.read();
    if (!wish) return;
    this.set(wish.course_deg === undefined ? this.course_deg : wish.course_deg + this.up_deg, wish.out * this.speedMax);
    if (wish.gone) notice(`The gamepad is disconnected. Stopping ${plain(this.vehicle)}.`);
  }

  draw() {
    const side = this.canvas.clientWidth;
    if (side === 0) return;
    const ratio = Math.min(2, devicePixelRatio);
    if (this.canvas.width !== side * ratio || this.canvas.height !== side * ratio) {
      this.canvas.width = side * ratio;
      this.canvas.height = side * ratio;
    }
    const { context } = this;
    const middle = side / 2;
    const radius = middle - RIM;
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.clearRect(0, 0, side, side);
    this.drawRim(context, middle, radius);
    const angle = ((this.course_deg - this.up_deg) * Math.PI) / 180;
    const far = (this.speed_m_s / this.speedMax) * radius;
    const x = middle + Math.sin(angle) * far;
    const y = middle - Math.cos(angle) * far;
    context.beginPath();
    context.moveTo(middle, middle);
    context.lineTo(x, y);
    context.strokeStyle = palette.accent;
    context.lineWidth = 3;
    context.stroke();
    context.beginPath();
    context.arc(x, y, 11, 0, 2 * Math.PI);
    context.fillStyle = palette.accent;
    context.fill();
    // The commanded heading stays visible at rest.
    context.beginPath();
    context.arc(middle + Math.sin(angle) * radius, middle - Math.cos(angle) * radius, 4, 0, 2 * Math.PI);
    context.fill();
    write(this.text, `${bearing(this.course_deg)}  ${number(this.speed_m_s, 2, 'm/s')}`);
  }

  drawRim(context, middle, radius) {
    context.beginPath();
    context.arc(middle, middle, radius, 0, 2 * Math.PI);
    context.fillStyle = palette.paper;
    context.globalAlpha = 0.88;
    context.fill();
    context.globalAlpha = 1;
    context.strokeStyle = palette.edge;
    context.lineWidth = 1.5;
    context.stroke();
    context.beginPath();
    context.arc(middle, middle, radius / 2, 0, 2 * Math.PI);
    context.globalAlpha = 0.4;
    context.stroke();
    context.globalAlpha = 1;
    context.font = '600 12px system-ui, sans-serif';
    context.fillStyle = palette.ink;
    context.textAlign = 'center';
    context.textBaseline = 'middle';
    ['N', 'E', 'S', 'W'].forEach((letter, quarter) => {
      const angle = ((quarter * 90 - this.up_deg) * Math.PI) / 180;
      context.fillText(letter, middle + Math.sin(angle) * (radius - 12), middle - Math.cos(angle) * (radius - 12));
    });
  }
}
