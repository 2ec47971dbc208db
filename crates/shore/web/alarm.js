// Alarms of real boats: visible and audible until someone acknowledges them.

import { keep, recall } from './storage.js';
import { fill, make, plain, show, write } from './words.js';

const MUTED_KEY = 'squall.muted';
/** Interval between sounds of an alarm, ms. */
const AGAIN_MS = 1500;
/** Tones of an alarm: frequency, Hz, and start, s. */
const TONES = [[880, 0], [660, 0.22], [880, 0.44]];
const TONE_S = 0.18;
const LOUDNESS = 0.25;
/** Maximum number of alarms shown one by one. */
const SHOWN_MAX = 4;

/** The sound of alarms. Browsers allow sound only after the first press on the page. */
class Sound {
  constructor() {
    this.context = null;
    this.muted = recall(MUTED_KEY) === 'yes';
    /** Tones played so far, for tests. */
    this.played = 0;
    this.last_ms = -Infinity;
    for (const kind of ['pointerdown', 'keydown']) addEventListener(kind, () => this.allow(), { capture: true });
  }

  get allowed() {
    return this.context?.state === 'running';
  }

  allow() {
    this.context ??= new AudioContext();
    // If the browser refuses, the state does not change, and the page shows this.
    if (this.context.state === 'suspended') this.context.resume().catch(() => {});
  }

  setMuted(muted) {
    this.muted = muted;
    keep(MUTED_KEY, muted ? 'yes' : 'no');
  }

  /** Plays the tones unless they have just been played. */
  play(now_ms) {
    if (this.muted || !this.allowed || now_ms - this.last_ms < AGAIN_MS) return;
    this.last_ms = now_ms;
    const { context } = this;
    for (const [frequency, at_s] of TONES) {
      const [tone, gain] = [context.createOscillator(), context.createGain()];
      const [from, to] = [context.currentTime + at_s, context.currentTime + at_s + TONE_S];
      tone.type = 'square';
      tone.frequency.value = frequency;
      // Soft edges prevent clicks.
      gain.gain.setValueAtTime(0, from);
      gain.gain.linearRampToValueAtTime(LOUDNESS, from + 0.02);
      gain.gain.setValueAtTime(LOUDNESS, to - 0.02);
      gain.gain.linearRampToValueAtTime(0, to);
      tone.connect(gain).connect(context.destination);
      tone.start(from);
      tone.stop(to);
      this.played += 1;
    }
  }
}

export class Alarms {
  /** `on` has `choose(name)`, called when someone presses the boat of an alarm. */
  constructor(on) {
    this.on = on;
    this.place = document.getElementById('alarms');
    this.list = document.getElementById('alarm-list');
    this.button = document.getElementById('mute');
    this.more = document.getElementById('alarms-more');
    this.all = document.getElementById('acknowledge-all');
    this.sound = new Sound();
    this.button.addEventListener('click', () => this.toggleMuted());
    this.all.addEventListener('click', () => this.acknowledge(() => true));
    this.forget();
  }

  /** Forgets alarms of another game; those of the same game, found again after a loss, stay. */
  greet({ game }) {
    if (game !== this.game) this.forget();
    this.game = game;
  }

  forget() {
    /** By boat and kind: `{ boat, text, at, active, acknowledged }`. */
    this.alarms = new Map();
    /** By boat: the number of failsafes of its gateway, and whether its link was up. */
    this.known = new Map();
  }

  get waiting() {
    return [...this.alarms.values()].filter((alarm) => !alarm.acknowledged);
  }

  toggleMuted() {
    // The press that first allows the sound must not mute it.
    if (!this.sound.muted && !this.heard) return;
    this.sound.setMuted(!this.sound.muted);
    this.tellMute();
  }

  acknowledge(which) {
    for (const [key, alarm] of this.alarms) {
      if (!which(alarm)) continue;
      alarm.acknowledged = true;
      if (!alarm.active) this.alarms.delete(key);
    }
    this.show();
  }

  /** Updates the alarms with the states of real boats, and whether the server is connected. */
  tell(readings, { live, connected }, now_ms) {
    show(this.button, live && readings.length > 0);
    if (live) {
      for (const reading of readings) this.look(reading, connected);
      const driven = readings.some(({ said }) => said === 'armed' || said === 'delegated');
      this.set('', 'connection', !connected && driven, 'Connection to the server lost. Boats may be moving.');
    }
    this.show();
    this.tellMute();
    if (this.waiting.length > 0) this.sound.play(now_ms);
  }

  look(reading, connected) {
    const { name, kind, detail, failsafes, link } = reading;
    const before = this.known.get(name);
    if (kind === 'unknown') return;
    const failed = kind === 'failsafe';
    this.set(name, 'failsafe', failed, `Failsafe: ${detail}`);
    // A failsafe that began and ended between two reports.
    if (before && failsafes > before.failsafes && !failed) {
      this.set(name, 'failsafe', true, `Failsafe: ${reading.facts.at(-1)?.words ?? ''}`);
      this.set(name, 'failsafe', false, '');
    }
    // Without the server, no gateway reports arrive.
    this.set(name, 'silent', kind === 'silent' && connected, 'The gateway is silent.');
    this.set(name, 'link', kind !== 'silent' && !link && (before?.link ?? false), 'The link to the boat is lost.', !link && kind !== 'silent');
    // The current in the text changes; the text before it names the fault.
    const wrong = new Map(reading.alarms.map((words) => [`boat: ${words.split(',')[0]}`, words]));
    for (const [kind, words] of wrong) this.set(name, kind, true, words);
    for (const key of this.alarms.keys()) {
      const kind = key.slice(name.length + 1);
      if (key.startsWith(`${name} boat: `) && !wrong.has(kind)) this.set(name, kind, false, '');
    }
    this.known.set(name, { failsafes, link: link || (before?.link ?? false) });
  }

  /** An alarm begins, continues or ends. It stays until acknowledged. */
  set(boat, kind, begins, text, goesOn = begins) {
    const key = `${boat} ${kind}`;
    const alarm = this.alarms.get(key);
    if (alarm?.active && goesOn) {
      if (text) alarm.text = text;
    } else if (begins) {
      this.alarms.set(key, { boat, text, at: new Date(), active: true, acknowledged: false });
    } else if (alarm) {
      alarm.active = false;
      if (alarm.acknowledged) this.alarms.delete(key);
    }
  }

  show() {
    const waiting = this.waiting.reverse();
    show(this.place, waiting.length > 0);
    show(this.all, waiting.length > 1);
    write(this.more, waiting.length > SHOWN_MAX ? `and ${waiting.length - SHOWN_MAX} more` : '');
    fill(this.list, waiting.slice(0, SHOWN_MAX), () => this.row(), (row, alarm) => {
      row.alarm = alarm;
      const [words, acknowledge] = row.children;
      write(words.firstElementChild, alarm.boat ? plain(alarm.boat) : 'Page');
      const over = alarm.active ? '' : ' Over.';
      write(words.lastElementChild, `${alarm.text}${over} · ${alarm.at.toTimeString().slice(0, 8)}`);
      const label = `Acknowledge: ${alarm.boat ? `${plain(alarm.boat)}, ` : ''}${alarm.text}`;
      if (acknowledge.getAttribute('aria-label') !== label) acknowledge.setAttribute('aria-label', label);
    });
  }

  row() {
    const words = make('button', 'alarm-words', '', make('strong'), make('span'));
    const acknowledge = make('button', '', 'Acknowledge');
    for (const button of [words, acknowledge]) button.type = 'button';
    const row = make('li', '', '', words, acknowledge);
    words.addEventListener('click', () => row.alarm.boat && this.on.choose(row.alarm.boat));
    acknowledge.addEventListener('click', () => this.acknowledge((alarm) => alarm === row.alarm));
    return row;
  }

  /** Shows whether alarms are audible. */
  tellMute() {
    const { muted, allowed } = this.sound;
    this.heard = allowed && !muted;
    write(this.button, muted ? 'Alarms muted' : allowed ? 'Alarms on' : 'Enable sound');
    const title = muted ? 'Alarms are silent. Click to unmute them.'
      : allowed ? 'Alarms are audible. Click to mute them.' : 'Browsers play no sound before the first click on the page.';
    if (this.button.title !== title) this.button.title = title;
    this.button.setAttribute('aria-pressed', String(muted));
    this.button.dataset.heard = String(this.heard);
  }
}
