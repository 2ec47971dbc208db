// The keyboard: the action of each key, and the help that lists them.

import { closeAsk } from './ask.js';
import { MARKS } from './game.js';
import { KINDS } from './timeline.js';
import { make } from './words.js';

const PAN_PX = 60;
const ZOOM = 1.3;

const PAD = `left stick, after you press one of its buttons${isSecureContext ? '' : '. Unavailable here: browsers allow gamepads only on this machine or over TLS'}`;

const HELP = [
  ['The chart', [['+  −', 'zoom'], ['arrows', 'move the chart'], ['f  0', 'fit the field'], ['[  ]', 'select the previous or next boat'],
    ['o', 'follow the boat'], ['m', 'measure; Enter chooses the selected boat or the centre of the chart'], ['l', 'legend'], ['j', 'plots'], ['k', 'hide or show the panel'], ['Geofence', 'draw a geofence: Enter adds a corner, Backspace removes it'], ['Escape', 'close, stop driving, or deselect the boat'], ['/', 'find a boat in a large fleet'], ['1 to 4', 'boats, details, events, game']]],
  ['The game', [['space', 'pause or resume'], ['s', 'pause and step one decision'], [',  .', 'slower, faster'], ['h', 'halt all boats, or end the halt'],
    ['Shift+E', 'E-stop without confirmation, or release it; with real boats also e alone']]],
  ['Driving', [['d', 'drive the selected boat, if possible'], ['arrows, w a s d', 'course and speed'], ['Escape', 'stop driving'],
    ['gamepad', PAD]]],
  ['A replay', [['n  p', 'next or previous event'], [KINDS.map(([, key]) => key).join('  '),
    `next among ${KINDS.map(([name]) => name.toLowerCase()).join(', ')}; with Shift: previous`],
    ['Shift+s', 'step one decision back'], ['left, right', 'one second back or forward (with Shift: ten)'], ['wheel', 'zoom the timeline or the plots; on the timeline also + and −, 0 for the whole game']]],
];

/** Whether the element handles keys itself: fields and lists. */
const takesKeys = (element) => element.closest('input, select, textarea') !== null;

/** Whether space and Enter press the element. */
const isPressed = (element) => element.closest('button, summary, a, label') !== null;

export class Keys {
  /** `page` has the parts (view, controls, drive, timeline) and their joint actions. */
  constructor(page) {
    this.page = page;
    this.help = document.getElementById('help-box');
    this.buildHelp();
    document.getElementById('help').addEventListener('click', () => this.toggleHelp());
    document.addEventListener('keydown', (event) => this.key(event));
    this.plain = {
      '+': () => page.zoom(ZOOM), '=': () => page.zoom(ZOOM), '-': () => page.zoom(1 / ZOOM), '_': () => page.zoom(1 / ZOOM),
      f: () => page.fit(), 0: () => page.fit(), '[': () => page.selectNext(-1), ']': () => page.selectNext(1),
      o: () => page.toggleFollow(), m: () => page.measure.toggle(), l: () => page.controls.toggleShown('legend'), j: () => page.plots.toggle(), k: () => page.panels.toggleSide(), d: () => page.toggleDrive(), '?': () => this.toggleHelp(),
      s: () => page.controls.step(1), S: () => page.controls.step(-1), ',': () => page.controls.shiftSpeed(-1),
      '.': () => page.controls.shiftSpeed(1), h: () => page.controls.halt(),
      // A slip of the finger must not stop a simulation; with real boats every second counts.
      e: () => page.controls.real && page.controls.eStop(), E: () => page.controls.eStop(), '/': () => page.find(),
      1: () => page.tab('boats'), 2: () => page.tab('boat'), 3: () => page.tab('events'), 4: () => page.tab('game'),
    };
  }

  key(event) {
    if (event.ctrlKey || event.metaKey || event.altKey || event.defaultPrevented) return;
    if (event.key === 'Escape') this.escape();
    // While driving, keys steer regardless of the focus: arrow keys would also change lists.
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
      // A held key zooms, but does not repeat confirmations.
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
      // Not modal: the E-stop stays reachable.
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
    const hulls = group('Boats', [['solid hull', 'the first team'], ['hull with a stripe', 'the second team'],
      ['hollow hull', 'tagged or out of action'], ['flag on a hull', 'carries that flag'], ['dotted circle', 'tag range'],
      ['line at the bow', 'its path in the next 3 s'], ['dashed hull', 'the boat’s own estimated position']]);
    this.help.replaceChildren(make('div', 'help-head', '', title, close), make('div', 'help-groups', '', ...groups, hulls, marks));
  }
}

function group(name, keys) {
  const list = make('dl', 'keys', '', ...keys.map(([key, text]) => make('div', '', '', make('dt', '', key), make('dd', '', text))));
  return make('section', '', '', make('h3', '', name), list);
}
