// The roster's tools: counts of boats by state, search, order and filter. For fleets too long to read.

import { AGENT_LOST, DISABLED, NAV_LOST, OUTSIDE, QUARANTINED, TAGGED } from './game.js';
import { make, plain, show, write } from './words.js';

/** A list of at most this many boats needs no tools. */
const FEW = 8;
const FAULTS = OUTSIDE | AGENT_LOST | QUARANTINED | NAV_LOST;

/** The states of simulated boats: name, and whether a boat is in it. */
const STATES = [
  ['in play', (game, at) => (game.marks[at] & (TAGGED | DISABLED)) === 0],
  ['tagged', (game, at) => (game.marks[at] & TAGGED) !== 0],
  ['out of action', (game, at) => (game.marks[at] & DISABLED) !== 0],
  ['with a flag', (game, at) => game.carrying[at] >= 0],
  ['faults', (game, at) => (game.marks[at] & FAULTS) !== 0],
];

/** Orders: name, and comparison of two boats. Without one, the game's order. */
const ORDERS = {
  number: () => 0,
  name: (game, a, b) => game.vehicles[a].name.localeCompare(game.vehicles[b].name, 'en', { numeric: true }),
  speed: (game, a, b) => game.speed[b] - game.speed[a],
  state: (game, a, b) => rank(game, a) - rank(game, b),
};

/** Faults first, then carriers, then boats in play. */
function rank(game, at) {
  if (game.marks[at] & FAULTS) return 0;
  if (game.carrying[at] >= 0) return 1;
  return game.marks[at] & (TAGGED | DISABLED) ? 3 : 2;
}

export class Roster {
  /** `changed()` is called when a different part of the fleet is to be shown. */
  constructor(changed) {
    this.changed = changed;
    this.state = '';
    this.search = make('input');
    Object.assign(this.search, { type: 'search', id: 'boat-search', placeholder: 'Find boat or mode', autocomplete: 'off' });
    this.search.setAttribute('aria-label', 'Find boat or mode');
    this.search.setAttribute('aria-keyshortcuts', '/');
    this.search.addEventListener('input', changed);
    this.search.addEventListener('keydown', (event) => this.key(event));
    this.order = make('select');
    this.order.id = 'boat-order';
    this.order.setAttribute('aria-label', 'Order of boats');
    this.order.append(...Object.keys(ORDERS).map((name) => Object.assign(make('option', '', `by ${name}`), { value: name })));
    this.order.addEventListener('change', changed);
    this.chips = make('div', 'chips');
    this.chips.id = 'boat-states';
    this.chips.setAttribute('role', 'group');
    this.chips.setAttribute('aria-label', 'Boats by state');
    this.chips.addEventListener('click', (event) => this.choose(event.target.closest('button')?.dataset.state));
    this.none = make('p', 'faint', 'No boat matches.');
    this.element = make('div', 'roster', '', make('div', 'roster-row', '', this.search, this.order), this.chips, this.none);
  }

  key(event) {
    if (event.key !== 'Escape' || this.search.value === '') return;
    this.search.value = '';
    this.changed();
    event.preventDefault();
    event.stopPropagation();
  }

  choose(state) {
    if (state === undefined) return;
    this.state = this.state === state ? '' : state;
    this.changed();
  }

  /** Focuses the search field, if it is shown. */
  find() {
    if (this.element.hidden) return;
    this.search.focus();
    this.search.select();
  }

  greet(game) {
    this.search.value = '';
    this.state = '';
    this.chips.replaceChildren();
    this.shown = undefined;
    show(this.element, game.count > FEW);
  }

  /** Counts the boats, and returns a function that checks whether a boat is to be shown. `readings` are those of real boats. */
  tell(game, readings) {
    const real = new Map(readings.map(({ index, label }) => [index, label]));
    const states = [...STATES, ...[...new Set(real.values())].sort().map((label) => [label, (_, at) => real.get(at) === label])];
    const all = game.vehicles.map((_, at) => at);
    const counts = states.map(([name, isIn]) => [name, all.filter((at) => isIn(game, at)).length]);
    this.tellChips([['', game.count], ...counts.filter(([name, count]) => count > 0 || name === this.state)]);
    const isIn = states.find(([name]) => name === this.state)?.[1] ?? (() => true);
    const words = this.element.hidden ? [] : this.search.value.toLowerCase().split(/\s+/).filter(Boolean);
    return (at) => {
      const { name, team, strategy } = game.vehicles[at];
      const text = `${plain(name)} ${name} ${game.chart.teams[team]?.name ?? ''} ${plain(strategy ?? '')} ${plain(game.modes?.[at] ?? '')}`.toLowerCase();
      return isIn(game, at) && words.every((word) => text.includes(word));
    };
  }

  tellChips(counts) {
    const key = counts.map(([name]) => name).join();
    if (key !== this.shown) {
      this.shown = key;
      this.chips.replaceChildren(...counts.map(([name]) => {
        const chip = make('button', 'state-chip', '', make('strong'), make('span', '', name || 'all'));
        Object.assign(chip, { type: 'button' });
        chip.dataset.state = name;
        return chip;
      }));
    }
    counts.forEach(([name, count], i) => {
      const chip = this.chips.children[i];
      write(chip.firstElementChild, String(count));
      chip.setAttribute('aria-pressed', String(name === this.state));
    });
  }

  /** Sorts rows with `at`. */
  sorted(game, rows) {
    const compare = ORDERS[this.order.value];
    return [...rows].sort((a, b) => compare(game, a.at, b.at) || a.at - b.at);
  }
}
