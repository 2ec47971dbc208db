// The list of boats by team, one line each: mode, flag, heading, speed with its curve, and faults.

import { BadgeLine } from './badge.js';
import { MARKS } from './game.js';
import { palette, teamColour } from './palette.js';
import { Roster } from './roster.js';
import { bearing, fill, make, number, plain, show, svg, write } from './words.js';

const ARROW = 'M0-9 6 8 0 4-6 8z';
const FLAG = 'M-6 9V-9L7-4-4 1V9z';

/** A small drawing with a single path. */
const glyph = (classes, path) => svg('svg', { viewBox: '-10 -10 20 20', class: classes, 'aria-hidden': 'true' }, svg('path', { d: path }));

export class BoatList {
  /** `on` has `choose(name)`, for a pressed boat, and `hover(index)`, for the boat pointed at; -1 is none. */
  constructor(on) {
    this.place = document.getElementById('boat-list');
    this.roster = new Roster(() => this.arrange());
    this.place.before(this.roster.element);
    this.on = on;
    this.rows = [];
    /** The visible rows; others' curves are not drawn. */
    this.seen = new Set();
    this.watch = new IntersectionObserver((entries) => {
      for (const { target, isIntersecting } of entries) {
        if (isIntersecting) this.seen.add(target);
        else this.seen.delete(target);
      }
    });
    this.place.addEventListener('click', (event) => {
      const row = event.target.closest('[data-vehicle]');
      if (row) this.on.choose(row.dataset.vehicle);
    });
    this.place.addEventListener('pointerover', (event) => this.pointAt(event.target));
    this.place.addEventListener('pointerleave', () => this.pointAt(null));
    this.place.addEventListener('focusin', (event) => this.pointAt(event.target));
    this.place.addEventListener('focusout', () => this.pointAt(null));
    this.place.addEventListener('keydown', (event) => this.key(event));
  }

  pointAt(target) {
    const button = target?.closest('[data-vehicle]');
    this.on.hover(this.rows.find((row) => row.button === button)?.at ?? -1);
  }

  /** Up and down move through the list. */
  key(event) {
    const step = { ArrowDown: 1, ArrowUp: -1 }[event.key];
    const shown = [...this.place.querySelectorAll('[data-vehicle]:not([hidden])')];
    const at = shown.indexOf(document.activeElement);
    if (!step || at < 0) return;
    event.preventDefault();
    event.stopPropagation();
    shown[Math.min(shown.length - 1, Math.max(0, at + step))].focus();
  }

  /** Whether it is visible, so that modes are needed. */
  get visible() {
    return this.place.offsetParent !== null;
  }

  greet(game) {
    this.rows = [];
    this.groups = [];
    this.game = game;
    this.readings = [];
    this.roster.greet(game);
    this.seen.clear();
    this.watch.disconnect();
    this.place.replaceChildren();
    const teams = game.chart.teams;
    teams.forEach((team, index) => {
      const members = game.vehicles.map((vehicle, at) => at).filter((at) => game.vehicles[at].team === index);
      if (members.length === 0) return;
      const head = make('h3', `team-${index}`, '', make('span', 'swatch'), plain(team.name), make('small'));
      this.place.append(head);
      const box = make('div', 'boat-rows');
      this.place.append(box);
      const first = this.rows.length;
      fill(box, members, () => this.row(), (button, at) => this.begin(button, at, game.vehicles[at]));
      this.groups.push({ head, box, rows: this.rows.slice(first), order: members.join() });
    });
    this.arrange();
  }

  /** Shows the filtered boats of each team in the chosen order. */
  arrange() {
    const { game, place } = this;
    const wanted = this.roster.tell(game, this.readings);
    let none = true;
    for (const group of this.groups) {
      const { length } = group.rows;
      let count = 0;
      for (const { at, button } of group.rows) {
        const isWanted = wanted(at);
        count += isWanted;
        show(button, isWanted);
      }
      write(group.head.lastElementChild, count === length ? ` ${length}` : ` ${count} of ${length}`);
      show(group.head, count > 0);
      none &&= count === 0;
      // A row must not move away from the pointer or the focus.
      if (group.order !== '' && place.matches(':hover, :focus-within')) continue;
      const sorted = this.roster.sorted(game, group.rows);
      const order = sorted.map(({ at }) => at).join();
      if (order !== group.order) group.box.append(...sorted.map(({ button }) => button));
      group.order = order;
    }
    show(this.roster.none, none);
  }

  row() {
    const canvas = make('canvas', 'curve');
    canvas.setAttribute('aria-hidden', 'true');
    const button = make('button', 'boat-row', '', make('span', 'what', '', make('span', 'name'), make('span', 'state')),
      make('span', 'carries', '', glyph('flag', FLAG), make('span', 'hidden-text')),
      make('span', 'heading', '', glyph('arrow', ARROW), make('span')), canvas, make('span', 'speed'));
    button.type = 'button';
    return button;
  }

  begin(button, at, vehicle) {
    button.dataset.vehicle = vehicle.name;
    const [what, carries, heading, canvas, speed] = button.children;
    write(what.firstElementChild, plain(vehicle.name));
    this.watch.observe(button);
    const line = vehicle.external ? new BadgeLine() : null;
    if (line) button.append(line.element);
    this.rows.push({ button, at, state: what.lastElementChild, carries, heading, canvas, speed, line });
  }

  /** `readings` are the gateways' reports on real boats. */
  tell(game, readings) {
    this.selected = game.selected;
    this.readings = readings;
    if (!this.visible) return;
    this.arrange();
    for (const row of this.rows) {
      const { button, at } = row;
      const chosen = game.vehicles[at].name === game.selected;
      if ((button.getAttribute('aria-pressed') === 'true') !== chosen) button.setAttribute('aria-pressed', String(chosen));
      this.tellState(row, game);
      this.tellFlag(row, game);
      if (row.line) row.line.tell(readings.find((reading) => reading.index === at));
      const known = game.frames > 0;
      const deg = (game.toH[at] * 180) / Math.PI;
      write(row.heading.lastElementChild, known ? bearing(deg) : '');
      row.heading.firstElementChild.style.transform = `rotate(${Math.round(deg)}deg)`;
      show(row.heading.firstElementChild, known);
      write(row.speed, known ? number(game.speed[at], 1, 'm/s') : '');
      if (known && this.seen.has(button)) this.drawCurve(row.canvas, game, at, chosen);
    }
  }

  /** A boat's faults, or else its mode. */
  tellState({ at, state }, game) {
    const matter = MARKS.filter(([bit]) => game.marks[at] & bit).map(([, , text]) => text);
    const mode = plain(game.modes?.[at] ?? '').replaceAll(':', ' › ');
    const words = matter.length > 0 ? matter.join(', ') : mode || (game.vehicles[at].external ? 'real boat' : '');
    write(state, words);
    if (state.title !== words) state.title = words;
    state.classList.toggle('trouble', matter.length > 0);
  }

  tellFlag({ at, carries }, game) {
    const flag = game.chart.field?.flags?.[game.carrying[at]];
    const team = flag ? `team-${flag.team}` : '';
    if (carries.dataset.of === team) return;
    carries.dataset.of = team;
    carries.className = `carries ${team}`;
    const words = flag ? `carries the ${plain(game.chart.teams[flag.team]?.name ?? '')} flag` : '';
    write(carries.lastElementChild, words);
    carries.title = words;
    carries.firstElementChild.style.visibility = flag ? 'visible' : 'hidden';
  }

  /** The speed over the last minute, from zero to the boat's maximum. */
  drawCurve(canvas, game, at, chosen) {
    const { clientWidth: width, clientHeight: height } = canvas;
    if (width === 0) return;
    const ratio = Math.min(2, devicePixelRatio);
    if (canvas.width !== width * ratio || canvas.height !== height * ratio) Object.assign(canvas, { width: width * ratio, height: height * ratio });
    const context = canvas.getContext('2d');
    const { team, speed_max_m_s } = game.vehicles[at];
    const most = speed_max_m_s > 0 ? speed_max_m_s : 1;
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.clearRect(0, 0, width, height);
    context.fillStyle = chosen ? palette.faint : palette.grid;
    context.fillRect(0, height - 1, width, 1);
    context.beginPath();
    game.trails.eachSpeed(at, game.t_s, (age, speed) =>
      context.lineTo((1 - age) * (width - 1), 1 + (height - 2) * (1 - Math.min(1, speed / most))));
    context.lineWidth = 1.5;
    context.lineJoin = 'round';
    context.strokeStyle = chosen ? palette.paper : teamColour(team);
    context.stroke();
  }
}
