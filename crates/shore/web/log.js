// The event list, newest first. Pressing an event selects its boat and, in a replay, its moment.

import { keep, recallObject } from './storage.js';
import { clock, clockShort, fill, make, plain, show, write } from './words.js';

/** Maximum number of lines; there may be thousands of events. */
const LINES_MAX = 300;

/** The events of each filter. */
const KINDS = {
  flags: ['grabbed', 'captured', 'flag_returned', 'ended'],
  tags: ['tagged', 'tagged_by_boundary', 'tagged_by_obstacle', 'untagged'],
  collisions: ['collided', 'entered_keepout'],
  trouble: ['collided', 'disabled', 'agent_lost', 'agent_back', 'quarantined', 'nav_lost', 'nav_back', 'e_stopped', 'released', 'halted',
    'went_on', 'failsafe', 'left_field'],
};

const FOLDED_KEY = 'squall.events-folded';

/** Highlighted events. */
const LOUD = ['captured', 'grabbed', 'ended', 'e_stopped', 'agent_lost', 'quarantined', 'nav_lost', 'failsafe', 'collided'];

export class Log {
  /** `go(event)` is called when an event is pressed. */
  constructor(go) {
    this.place = document.getElementById('events');
    this.none = document.getElementById('events-none');
    this.filter = document.getElementById('event-filter');
    this.go = go;
    this.lines = [];
    this.drawn = '';
    this.bindFold();
    this.filter.addEventListener('change', () => { this.drawn = ''; });
    this.place.addEventListener('click', (event) => {
      const at = [...this.place.children].indexOf(event.target.closest('li'));
      if (at >= 0) this.go(this.lines[at]);
    });
  }

  bindFold() {
    this.fold = document.getElementById('events-fold');
    this.newest = document.getElementById('events-newest');
    this.box = document.getElementById('events-box');
    /** Whether the events are folded, by tab. */
    this.chosen = recallObject(FOLDED_KEY) ?? {};
    this.tab = 'boats';
    // A short page has no space for both the events and a boat's helm.
    this.low = matchMedia('(max-height: 999px)');
    this.low.addEventListener('change', () => this.showFold());
    this.fold.addEventListener('click', () => {
      this.chosen[this.tab] = !this.folded;
      keep(FOLDED_KEY, JSON.stringify(this.chosen));
      this.showFold();
    });
  }

  /** Whether only the newest event is shown. */
  get folded() {
    return this.wide && (this.chosen[this.tab] ?? (this.tab === 'boat' && this.low.matches));
  }

  /** The tab above the events; on narrow pages the events have their own tab. */
  under(tab, wide) {
    this.tab = tab;
    this.wide = wide;
    this.showFold();
  }

  showFold() {
    const { folded } = this;
    document.body.classList.toggle('events-folded', folded);
    this.fold.setAttribute('aria-expanded', String(!folded));
    this.fold.disabled = !this.wide;
    show(this.box, !folded);
    show(this.newest, folded);
    show(this.filter.parentElement, !folded);
    this.drawn = '';
  }

  tell(game) {
    const replay = game.mode === 'replay';
    const kinds = KINDS[this.filter.value];
    const known = kinds ? game.events.filter((event) => kinds.includes(event.event)) : game.events;
    const t_s = replay ? game.t_s : Infinity;
    const past = replay ? upTo(known, t_s) : known.length;
    const key = `${game.eventVersion} ${this.filter.value} ${past}`;
    if (key === this.drawn) return;
    this.drawn = key;
    // In a replay, future events are above, as far as space permits.
    const last = replay ? Math.min(known.length, past + LINES_MAX / 2) : known.length;
    const first = Math.max(0, last - LINES_MAX);
    this.lines = known.slice(first, last).reverse();
    show(this.none, this.lines.length === 0);
    const newest = known[past - 1];
    write(this.newest, newest ? `${clockShort(newest.at_s)} ${plain(newest.text ?? newest.event)}` : 'none yet');
    fill(this.place, this.lines, () => this.row(), (row, event) => this.tellRow(row, event, game, event.at_s > t_s + 1e-6));
    if (replay) this.keepInSight(last - past);
  }

  row() {
    const button = make('button', 'event', '', make('time'), make('span', 'swatch'), make('span', 'text'));
    button.type = 'button';
    return make('li', '', '', button);
  }

  tellRow(row, event, game, ahead) {
    const button = row.firstElementChild;
    const team = game.vehicles[game.indexOf.get(event.vehicle)]?.team;
    const classes = `event${team === undefined ? '' : ` team-${team}`}${LOUD.includes(event.event) ? ' loud' : ''}${ahead ? ' ahead' : ''}`;
    if (button.className !== classes) button.className = classes;
    write(button.children[0], clock(event.at_s));
    write(button.children[2], plain(event.text ?? event.event));
  }

  /** Scrolls to the newest event of a replay, unless someone is reading the list. */
  keepInSight(at) {
    // Before the first event, scroll to the next one.
    const row = this.place.children[Math.min(this.lines.length - 1, Math.max(0, at))];
    if (!row || this.folded || this.place.matches(':hover, :focus-within')) return;
    const pane = this.place.closest('.pane');
    const box = row.getBoundingClientRect();
    const within = pane.getBoundingClientRect();
    if (box.top < within.top + 60 || box.bottom > within.bottom) pane.scrollTop += box.top - within.top - within.height / 3;
  }
}

/** The number of events up to a time; they are in order. */
export function upTo(events, t_s) {
  let low = 0;
  let high = events.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (events[middle].at_s <= t_s + 1e-6) low = middle + 1;
    else high = middle;
  }
  return low;
}
