// The keyboard: what each key does, and the help that says so.

import { closeAsk } from './ask.js';
import { MARKS } from './game.js';
import { KINDS } from './timeline.js';
import { make } from './words.js';

const PAN_PX = 60;
const ZOOM = 1.3;

const PAD = `its left stick, once you have pressed one of its buttons${isSecureContext ? '' : '. Not here: browsers give gamepads only to pages of this machine or with TLS'}`;

const HELP = [
  ['The chart', [['+  −', 'zoom'], ['arrows', 'move the chart'], ['f  0', 'fit the field'], ['[  ]', 'choose the boat before or after'],
    ['o', 'follow the boat'], ['m', 'measure; then Enter takes the selected boat, or the middle of the chart'], ['l', 'legend'], ['Geofence', 'draws one: Enter takes a corner, Backspace takes it back'], ['Escape', 'close, let go, or select no boat'], ['1 to 4', 'boats, details, events, game']]],
  ['The game', [['space', 'pause or go on'], ['s', 'pause, and one decision'], [',  .', 'slower, faster'], ['h', 'halt all boats, or let them go on'],
    ['e', 'E-stop at once, or ask to release it']]],
  ['Driving', [['d', 'steer a boat that can be steered'], ['arrows, w a s d', 'course and speed'], ['Escape', 'let go'],
    ['gamepad', PAD]]],
  ['A replay', [['n  p', 'next event, event before'], [KINDS.map(([, key]) => key).join('  '),
    `next of the ${KINDS.map(([name]) => name.toLowerCase()).join(', ')}; with Shift before`],
    ['Shift+s', 'one decision back'], ['left, right', 'a second back or on (with Shift: ten)']]],
];

/** Whether the keyboard belongs to the element: fields and lists to choose from. */
const takesKeys = (element) => element.closest('input, select, textarea') !== null;

/** Whether the element is pressed by space and Enter. */
const isPressed = (element) => element.closest('button, summary, a, label') !== null;

export class Keys {
  /** `page` has the parts: view, controls, drive, timeline, and what they do together. */
  constructor(page) {
    this.page = page;
    this.help = document.getElementById('help-box');
    this.buildHelp();
    document.getElementById('help').addEventListener('click', () => this.toggleHelp());
    document.addEventListener('keydown', (event) => this.key(event));
    this.plain = {
      '+': () => page.zoom(ZOOM), '=': () => page.zoom(ZOOM), '-': () => page.zoom(1 / ZOOM), '_': () => page.zoom(1 / ZOOM),
      f: () => page.fit(), 0: () => page.fit(), '[': () => page.selectNext(-1), ']': () => page.selectNext(1),
      o: () => page.toggleFollow(), m: () => page.measure.toggle(), l: () => page.controls.toggleShown('legend'), d: () => page.toggleDrive(), '?': () => this.toggleHelp(),
      s: () => page.controls.step(1), S: () => page.controls.step(-1), ',': () => page.controls.shiftSpeed(-1),
      '.': () => page.controls.shiftSpeed(1), h: () => page.controls.halt(), e: () => page.controls.eStop(),
      1: () => page.tab('boats'), 2: () => page.tab('boat'), 3: () => page.tab('events'), 4: () => page.tab('game'),
    };
  }

  key(event) {
    if (event.ctrlKey || event.metaKey || event.altKey || event.defaultPrevented) return;
    if (event.key === 'Escape') this.escape();
    // Whoever steers does so wherever the focus was left: lists are changed by arrow keys, too.
    else if (this.page.drive.key(event)) event.preventDefault();
    else if (takesKeys(event.target) || event.key === 'Tab') return;
    else if (event.key === ' ' && !isPressed(event.target)) {
      event.preventDefault();
      this.page.controls.pause();
    } else if (event.key === 'Backspace' && this.page.fenceEditor.active) {
      event.preventDefault();
      this.page.fenceEditor.undo();
    } else if (event.key === 'Enter' && event.target.id === 'sheet' && this.page.takeHere()) event.preventDefault();
    else if (this.arrow(event) || this.replay(event)) event.preventDefault();
    else if (this.plain[event.key]) {
      // Held keys zoom, but they ask nothing twice.
      if (!event.repeat || '+=-_[]s'.includes(event.key)) this.plain[event.key]();
      event.preventDefault();
    }
  }

  escape() {
    if (closeAsk()) return;
    if (this.help.open) this.toggleHelp();
    else if (this.page.drive.driving) this.page.drive.letGo();
    else if (this.page.fenceEditor.active) this.page.fenceEditor.toggle();
    else if (this.page.measure.active) this.page.measure.toggle();
    else this.page.select(null);
  }

  arrow(event) {
    const way = { ArrowLeft: [1, 0], ArrowRight: [-1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[event.key];
    const onSheet = event.target.id === 'sheet';
    if (!way || !(onSheet || event.target === document.body)) return false;
    if (!onSheet && this.page.game.mode === 'replay') {
      this.page.timeline.key(event);
      return true;
    }
    this.page.pan(way[0] * PAN_PX, way[1] * PAN_PX);
    return true;
  }

  replay(event) {
    if (this.page.game.mode !== 'replay') return false;
    const { timeline } = this.page;
    const key = event.key.toLowerCase();
    if (key === 'n' || key === 'p') {
      timeline.jump(timeline.kind.value, key === 'n' ? 1 : -1);
      return true;
    }
    const kind = KINDS.findIndex(([, each]) => each === key);
    if (kind >= 0) timeline.jump(kind, event.shiftKey ? -1 : 1);
    return kind >= 0;
  }

  toggleHelp() {
    if (this.help.open) this.help.close();
    else {
      // Not modal: the E-stop stays in reach.
      this.help.show();
      this.help.querySelector('button').focus();
    }
  }

  buildHelp() {
    const close = make('button', '', 'Close');
    close.type = 'button';
    close.addEventListener('click', () => this.toggleHelp());
    const title = make('h2', '', 'Keys and marks');
    title.id = 'help-title';
    const groups = HELP.map(([name, keys]) => group(name, keys));
    const marks = group('Letters on boats', [...MARKS.map(([, letter, text]) => [letter, text])]);
    const hulls = group('Boats', [['solid hull', 'the first team'], ['hull with a band', 'the second team'],
      ['hollow hull', 'tagged or out of action'], ['flag on a boat', 'it carries that flag'], ['dotted circle', 'where a boat may tag'],
      ['line at the bow', 'its way in 3 s'], ['dashed hull', 'where the boat takes itself to be']]);
    this.help.replaceChildren(make('div', 'help-head', '', title, close), make('div', 'help-groups', '', ...groups, hulls, marks));
  }
}

function group(name, keys) {
  const list = make('dl', 'keys', '', ...keys.map(([key, text]) => make('div', '', '', make('dt', '', key), make('dd', '', text))));
  return make('section', '', '', make('h3', '', name), list);
}
