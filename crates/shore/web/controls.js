// The buttons: pause, step, speed, halt, E-stop, and what the chart shows.

import { Ask, closeAsk } from './ask.js';
import { keep, recallObject } from './storage.js';
import { options, show, write } from './words.js';

const SPEEDS = [0.5, 1, 2, 5, 10, 50];
const FASTEST = 'max';
const SHOWN_KEY = 'squall.shown';
const WATCHING = 'This page may only watch. To control the game, open it with the token.';
const REAL = 'The game has real boats, so its speed is fixed.';

const byId = (id) => document.getElementById(id);

/** What the chart shows unless another choice is stored. */
const SHOWN = { names: true, trails: true, circles: true, waves: true, chart: true, legend: false };

export class Controls {
  /** `send(message)` goes to the server. */
  constructor(send) {
    this.send = send;
    this.shown = { ...SHOWN, ...recallObject(SHOWN_KEY) };
    this.shownVersion = 0;
    this.mode = null;
    this.rights = false;
    this.paused = false;
    this.stopped = false;
    this.eStopped = false;
    this.asks = { estop: new Ask('estop'), halt: new Ask('halt'), stop: new Ask('stop') };
    byId('pause').addEventListener('click', () => this.pause());
    byId('step').addEventListener('click', () => this.step(1));
    byId('step-back').addEventListener('click', () => this.step(-1));
    byId('halt').addEventListener('click', () => this.halt());
    byId('estop').addEventListener('click', () => this.eStop());
    byId('stop').addEventListener('click', () => this.stop());
    this.bindSpeed();
    for (const what of Object.keys(this.shown)) this.bindShown(what);
  }

  bindSpeed() {
    const select = byId('speed');
    let byHand = false;
    select.addEventListener('pointerdown', () => { byHand = true; });
    select.addEventListener('keydown', () => { byHand = false; });
    select.addEventListener('change', () => {
      this.setSpeed(select.value);
      // Return arrow keys to steering and the chart, unless the list is used by keyboard.
      if (byHand) byId(document.body.classList.contains('driving') ? 'steering' : 'sheet').focus({ preventScroll: true });
    });
  }

  bindShown(what) {
    const button = byId(`show-${what}`);
    if (!button) return;
    button.setAttribute('aria-pressed', String(this.shown[what]));
    button.addEventListener('click', () => this.toggleShown(what));
  }

  toggleShown(what) {
    this.shown[what] = !this.shown[what];
    this.shownVersion += 1;
    byId(`show-${what}`).setAttribute('aria-pressed', String(this.shown[what]));
    keep(SHOWN_KEY, JSON.stringify(this.shown));
  }

  control(what) {
    this.send({ do: 'control', what });
  }

  get mayAct() {
    return this.mode === 'replay' || (this.mode === 'live' && this.rights);
  }

  /** Whether a button is enabled; keys do no more than buttons. */
  may(id) {
    return this.mayAct && !byId(id).disabled;
  }

  pause() {
    if (this.may('pause')) this.control(this.paused ? 'resume' : 'pause');
  }

  /** Steps one decision forward or back, and pauses. */
  step(by) {
    if (!this.may('step')) return;
    if (this.mode === 'replay') this.send({ do: 'step', by });
    else if (by > 0) this.stepGame();
  }

  stepGame() {
    if (!this.paused) this.control('pause');
    // The pause is already requested; requesting it again would cancel steps still to come.
    this.paused = true;
    this.control('step');
  }

  setSpeed(value) {
    if (this.may('speed')) this.send({ do: 'speed', factor: value === FASTEST ? null : Number(value) });
  }

  /** Selects the next higher or lower speed. */
  shiftSpeed(by) {
    const select = byId('speed');
    const at = select.selectedIndex + by;
    if (select.disabled || at < 0 || at >= select.options.length) return;
    this.setSpeed(select.options[at].value);
  }

  halt() {
    if (this.mode !== 'live' || !this.may('halt')) return;
    if (this.stopped) this.asks.halt.ask('End the halt and let all boats move?', 'Yes, end halt', () => this.control('go_on'));
    else this.asks.halt.ask('Make all boats hold?', 'Yes, halt all', () => this.control('halt'));
  }

  eStop() {
    if (this.mode !== 'live' || !this.may('estop')) return;
    if (this.eStopped) {
      this.asks.estop.ask('Release the E-stop? Real boats must then be armed again.', 'Yes, release', () => this.control('release'), true);
    } else {
      // Stop at once: a confirmation could cost the decisive second, and a stop can always be released.
      closeAsk();
      this.control('e_stop');
    }
  }

  stop() {
    if (this.mode !== 'live' || !this.may('stop')) return;
    this.asks.stop.ask('End this game? It cannot be resumed.', 'Yes, end it', () => this.control('stop'), true);
  }

  greet(hello) {
    closeAsk();
    this.mode = hello.mode;
    this.rights = Boolean(hello.rights);
    this.real = hello.chart.vehicles.some(({ external }) => external);
    /** Whether the page may release boats: for real boats it needs the operator's token. */
    this.releases = this.rights && (hello.operates || !this.real);
    this.stopped = false;
    this.eStopped = false;
    byId('estop').setAttribute('aria-keyshortcuts', this.real ? 'e' : 'Shift+E');
    const live = hello.mode === 'live';
    show(byId('estop-place'), live);
    show(byId('halt-place'), live);
    show(byId('stop-place'), live);
    show(byId('step-back'), !live);
    show(byId('rights'), live && !this.rights);
    byId('rights').title = WATCHING;
  }

  /** Reads halts and E-stops from events; the newest event counts. */
  tellEvents(events, reset) {
    if (reset) this.eStopped = false;
    for (const { event } of events) {
      if (event === 'e_stopped') this.eStopped = true;
      if (event === 'released') this.eStopped = false;
    }
  }

  /** Shows the state of the game. */
  tell(game) {
    const { state, player } = game;
    const live = this.mode === 'live';
    const phase = state?.phase;
    this.paused = live ? phase === 'paused' : player ? !player.playing : false;
    // An E-stop also makes all boats hold; ending a halt does not release it.
    this.stopped = live && game.stopped && !this.eStopped;
    const act = live ? this.rights : this.mode === 'replay';
    const going = !live || phase === 'playing' || phase === 'paused' || phase === undefined;
    this.button('pause', live ? (this.paused ? 'Resume' : 'Pause') : this.paused ? 'Play' : 'Pause', act && going, 'Pause or resume (space)');
    this.button('step', live ? 'Step' : 'Step +', act && going, 'One decision, then pause (s)');
    this.button('halt', this.stopped ? 'End halt' : 'Halt all', act && !this.eStopped && phase !== 'over' && phase !== 'gone', 'Make all boats hold, or end the halt (h)');
    const key = this.real ? 'e' : 'Shift+E';
    const release = this.releases ? `Release the E-stop (${key})` : 'Only a page with the operator’s token can release real boats.';
    this.button('estop', this.eStopped ? 'Release E-stop' : 'E-stop', act && (!this.eStopped || this.releases), this.eStopped ? release : `Stop every boat now (${key})`);
    this.button('stop', 'End game', act && phase !== 'over' && phase !== 'gone', 'End the game now');
    byId('estop').classList.toggle('released', this.eStopped);
    this.tellSpeed(live ? state?.speed : player?.speed, act, live && state?.can_speed === false, !live || state?.pace === 'lockstep');
  }

  button(id, text, enabled, title) {
    const button = byId(id);
    write(button, text);
    if (button.disabled === enabled) button.disabled = !enabled;
    const said = this.mode === 'live' && !this.rights ? WATCHING : title;
    if (button.title !== said) button.title = said;
  }

  tellSpeed(speed, act, real, fastest) {
    const select = byId('speed');
    const value = speed === null ? FASTEST : Number.isFinite(speed) ? String(speed) : '1';
    const speeds = speed !== null && Number.isFinite(speed) && !SPEEDS.includes(speed) ? [...SPEEDS, speed].sort((a, b) => a - b) : SPEEDS;
    options(select, [...speeds.map((each) => [String(each), `${each}×`]), ...(fastest ? [[FASTEST, 'max']] : [])]);
    if (document.activeElement !== select && select.value !== value) select.value = value;
    if (select.disabled === (act && !real)) select.disabled = !act || real;
    const title = real ? REAL : act ? 'Speed of the game (, and .)' : WATCHING;
    if (select.title !== title) select.title = title;
  }
}
