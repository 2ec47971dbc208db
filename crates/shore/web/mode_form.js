// Other modes of a real boat's own controller: a choice, with numbers for a heading.

import { make, show } from './words.js';

/** The modes: protocol word, label, and action in the question. The first takes a heading and a thrust. */
const MODES = [
  ['heading', 'Hold a heading', 'hold this heading'],
  ['river_nav', 'River navigation', 'start river navigation'],
  ['autopilot', 'Autopilot', 'start its autopilot'],
  ['compass_calibration', 'Calibrate compass', 'calibrate its compass'],
  ['depth', 'Depth', 'start its depth mode'],
  ['gravity_vector', 'Gravity vector', 'start its gravity vector mode'],
];

export class ModeForm {
  /** `ask(what, command)` receives the action in the question, and the command. */
  constructor(ask) {
    this.choice = make('select');
    this.choice.id = 'mode';
    this.choice.setAttribute('aria-label', 'Other mode');
    this.choice.append(...MODES.map(([word, name]) => Object.assign(make('option', '', name), { value: word })));
    this.heading = this.number('mode-heading', 'True heading, degrees', 360, 0);
    this.thrust = this.number('mode-thrust', 'Thrust, per cent', 100, 20);
    this.numbers = make('span', 'mode-numbers', '', this.heading, make('span', '', '° at'), this.thrust, make('span', '', '%'));
    this.set = make('button', '', 'Set …');
    Object.assign(this.set, { type: 'submit', id: 'mode-set' });
    this.form = make('form', 'mode-form', '', this.choice, this.numbers, this.set);
    this.choice.addEventListener('change', () => show(this.numbers, this.choice.value === 'heading'));
    this.form.addEventListener('submit', (event) => {
      event.preventDefault();
      ask(...this.command());
    });
    this.element = make('details', 'modes', '', make('summary', '', 'Other modes of a Surveyor'), this.form);
    this.element.id = 'modes';
  }

  number(id, label, max, value) {
    const field = make('input');
    Object.assign(field, { type: 'number', id, min: 0, max, step: 1, value, required: true });
    field.setAttribute('aria-label', label);
    return field;
  }

  command() {
    const [word, , what] = MODES.find(([each]) => each === this.choice.value);
    if (word !== 'heading') return [what, { mode: word }];
    const [heading_deg, thrust_pct] = [this.heading.valueAsNumber, this.thrust.valueAsNumber];
    return [`hold heading ${heading_deg}° at ${thrust_pct} %`, { mode: { heading: { heading_deg, thrust_pct } } }];
  }

  enable(enabled) {
    this.set.disabled = !enabled;
  }
}
