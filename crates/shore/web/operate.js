// Operator controls of a real boat: its state, what is missing before it can be armed, and its gateway's commands.

import { Ask } from './ask.js';
import { makeBadge, tellBadge } from './badge.js';
import { ModeForm } from './mode_form.js';
import { notice } from './status.js';
import { fill, make, plain, show, write } from './words.js';

/** Maximum size of a message to the server, bytes. */
const MESSAGE_MAX = 16 * 1024;

/** Commands: protocol word, label, question (null: none), and the states without this command. */
const COMMANDS = [
  ['arm', 'Arm', 'Arm NAME? It will then follow its agent’s orders.', ['armed', 'stopped']],
  ['disarm', 'Disarm', null, ['disarmed', 'stopped']],
  ['station_keep', 'Keep station', 'Let NAME’s own controller keep station?', ['stopped']],
  ['go_to_erp', 'To recovery point', 'Let NAME’s own controller drive it to its recovery point?', ['stopped']],
  ['release', 'Release', 'Release NAME’s E-stop? It must then be armed again.', ['disarmed', 'armed', 'failsafe', 'delegated']],
];
/** The commands that stop a boat: a page that may stop all boats may stop one. */
const STOPS = ['disarm'];
const DONE = {
  arm: 'is armed', disarm: 'is disarmed', station_keep: 'keeps its station', go_to_erp: 'goes to its recovery point',
  release: 'is released', mission: 'has accepted its mission', mode: 'has changed its mode',
};

export class Operate {
  /** `on` has `send(message)`, and `acknowledge(name)` for the alarms of a boat whose failsafe is reset. */
  constructor(on) {
    this.on = on;
    this.name = null;
    this.build();
  }

  /** Call once the element is on the page. */
  bind() {
    this.asked = new Ask('operate');
  }

  build() {
    this.badge = makeBadge();
    this.badge.id = 'boat-badge';
    this.cause = make('span', 'cause');
    this.buttons = Object.fromEntries(COMMANDS.map((command) => [command[0], this.button(command)]));
    this.file = make('input', 'hidden-text');
    Object.assign(this.file, { type: 'file', accept: '.sea,text/plain', id: 'mission-file', tabIndex: -1 });
    this.file.setAttribute('aria-label', 'Mission file');
    this.file.addEventListener('change', () => this.mission());
    this.missionButton = make('button', '', 'Mission …');
    Object.assign(this.missionButton, { type: 'button', id: 'mission', title: 'Upload a .sea file for the boat’s own controller to follow' });
    this.missionButton.addEventListener('click', () => this.file.click());
    this.modes = new ModeForm((what, command) => this.mode(what, command));
    const { arm, ...others } = this.buttons;
    const row = make('div', 'operate-row asking', '', ...Object.values(others), this.missionButton, this.file, this.modes.element, this.box());
    this.answer = make('p', 'note');
    this.answer.id = 'operated';
    this.answer.setAttribute('role', 'status');
    this.checks = make('ul', 'checks');
    this.checks.id = 'checks';
    this.checkHead = make('p', '');
    this.arming = make('div', 'arming', '', arm, make('div', '', '', this.checkHead, this.checks));
    this.facts = make('dl', 'facts');
    this.facts.id = 'gateway';
    this.row = row;
    this.element = make('section', 'operate', '', make('h3', '', 'Gateway'), make('p', 'badge-row', '', this.badge, this.cause),
      this.arming, row, this.answer, this.tokenForm(), this.facts);
    this.element.setAttribute('aria-label', 'Real boat');
  }

  button([word, text]) {
    const button = make('button', '', text);
    Object.assign(button, { type: 'button', id: word === 'arm' ? 'operate' : `operate-${word}` });
    button.addEventListener('click', () => this.press(word));
    return button;
  }

  /** The question, with element ids as `Ask` expects. */
  box() {
    const [question, confirm, cancel] = [make('p'), make('button', 'danger'), make('button', '', 'Cancel')];
    question.id = 'operate-question';
    Object.assign(confirm, { type: 'button', id: 'operate-confirm' });
    Object.assign(cancel, { type: 'button', id: 'operate-cancel' });
    const box = make('div', 'ask', '', question, confirm, cancel);
    Object.assign(box, { id: 'operate-ask', hidden: true });
    box.setAttribute('role', 'alertdialog');
    box.setAttribute('aria-labelledby', 'operate-question');
    return box;
  }

  /** Enters the operator's token. It goes into the page's address, where it survives a reload. */
  tokenForm() {
    const field = make('input');
    Object.assign(field, { type: 'password', id: 'operator-token', autocomplete: 'off' });
    const label = make('label', '', 'Operator’s token');
    label.htmlFor = field.id;
    const use = make('button', '', 'Use');
    use.type = 'submit';
    this.token = make('form', 'token-form', '', label, field, use);
    this.token.addEventListener('submit', (event) => {
      event.preventDefault();
      const words = new URLSearchParams(location.hash.slice(1));
      words.set('token', field.value.trim());
      field.value = '';
      location.hash = words;
    });
    return this.token;
  }

  press(word) {
    const [, text, question] = COMMANDS.find(([each]) => each === word);
    const { name } = this;
    if (word === 'arm' && this.unready) {
      this.tellAnswer(`${plain(name)} cannot be armed yet. ${this.unready}`);
      return;
    }
    const send = () => this.command(name, word);
    if (question === null) send();
    else this.asked.ask(question.replace('NAME', plain(name)), `Yes, ${text.toLowerCase()}`, send, word === 'release');
  }

  mode(what, command) {
    const { name } = this;
    this.asked.ask(`Let ${plain(name)}’s own controller ${what}?`, 'Yes', () => this.command(name, command));
  }

  command(vehicle, command) {
    this.tellAnswer('…');
    this.on.send({ do: 'operate', vehicle, command });
    if (command === 'disarm') this.on.acknowledge(vehicle);
  }

  async mission() {
    const [file] = this.file.files;
    const { name } = this;
    if (!file) return;
    const message = { do: 'mission', vehicle: name, lines: file.size > MESSAGE_MAX ? '' : await file.text() };
    this.file.value = '';
    if (file.size > MESSAGE_MAX || new Blob([JSON.stringify(message)]).size > MESSAGE_MAX) {
      notice(`${file.name} is too long: a mission may have at most ${MESSAGE_MAX / 1024} kB.`);
      return;
    }
    this.asked.ask(`Upload ${file.name} and let ${plain(name)}’s own controller follow it?`, 'Yes, start it', () => {
      this.tellAnswer('…');
      this.on.send(message);
    });
  }

  /** Shows the result of a command. */
  hear({ vehicle, command, refused }) {
    const words = refused === null ? `${plain(vehicle)} ${DONE[command] ?? `did ${plain(command)}`}.` : `Refused by ${plain(vehicle)}: ${refused}`;
    if (vehicle === this.name) this.tellAnswer(words);
    else notice(words);
  }

  /** Shows why a message about a boat never reached its gateway. */
  refuse(reason) {
    this.tellAnswer(`Not done: ${reason}`);
  }

  tellAnswer(words) {
    write(this.answer, words);
    show(this.answer, words !== '');
  }

  /** Shows a real boat, or nothing for null. */
  tell(game, reading) {
    show(this.element, reading !== null);
    if (reading?.name !== this.name) {
      this.name = reading?.name ?? null;
      this.asked.close(false);
      this.tellAnswer('');
    }
    if (!reading) return;
    tellBadge(this.badge, reading);
    write(this.cause, reading.detail);
    // After the end of the game its server does not forward commands.
    const live = game.mode === 'live' && reading.kind !== 'ended';
    const { operates, rights } = game.hello;
    show(this.row, live);
    show(this.token, live && !operates);
    for (const [word, text, , never] of COMMANDS) {
      const button = this.buttons[word];
      const wanted = word === 'release' ? reading.kind === 'stopped' && /this boat/.test(reading.detail) : !never.includes(reading.said);
      show(button, wanted);
      button.disabled = !(operates || (rights && STOPS.includes(word)));
      // Disarming after a failsafe resets it.
      write(button, word === 'disarm' && reading.said === 'failsafe' ? 'Reset failsafe' : text);
    }
    show(this.missionButton, reading.said !== 'stopped');
    this.missionButton.disabled = !operates;
    show(this.modes.element, reading.said !== 'stopped');
    this.modes.enable(operates);
    this.tellChecks(live, reading);
    fill(this.facts, reading.facts, () => make('div', '', '', make('dt'), make('dd')), (line, fact) => {
      write(line.firstElementChild, fact.name);
      write(line.lastElementChild, fact.words);
      line.classList.toggle('old', fact.bad);
    });
  }

  /** What is missing before the boat can be armed, according to its gateway, beside a button that looks disabled meanwhile. */
  tellChecks(live, { missing, kind }) {
    const { arm } = this.buttons;
    show(this.arming, live && !arm.hidden);
    const known = kind !== 'silent' && kind !== 'unknown';
    const lines = !known ? ['a report from its gateway'] : missing.length > 0 ? missing : ['Ready to arm.'];
    const good = known && missing.length === 0;
    this.unready = good ? '' : `Missing: ${lines.join('; ')}.`;
    arm.setAttribute('aria-disabled', String(!good));
    arm.title = this.unready;
    write(this.checkHead, good ? '' : 'Missing before arming:');
    show(this.checkHead, !good);
    fill(this.checks, lines, () => make('li', '', '', make('span', 'mark'), make('span')), (line, words) => {
      line.className = good ? 'good' : 'missing';
      write(line.firstElementChild, good ? '✓' : '✗');
      write(line.lastElementChild, words);
    });
  }
}
