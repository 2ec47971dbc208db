// Who beats whom: the entries on a circle, clockwise by rating, and an arrow for each pairing that has a significant winner.

import { make, plain, svg } from './words.js';

const [WIDTH, HEIGHT, RADIUS] = [860, 520, 205];
/** Number of listed cycles. */
const LISTED = 12;
const KINDS = ['rule_based', 'learned', 'planner', 'public'];

/** The class that gives an element the colour of a kind of entry. */
export const kindClass = (kind) => `team-${Math.max(0, KINDS.indexOf(kind))}`;

export class Dominance {
  /** `linkOf` returns the address of an entry's results. */
  constructor(linkOf) {
    this.linkOf = linkOf;
    this.box = make('section');
    this.box.id = 'beats';
  }

  /** Shows a table of results. Entries of other kinds than `kind` are dimmed, unless it is empty. */
  take({ entries, matrix, cycles = [] }, kind) {
    Object.assign(this, { entries, cycles, kind, chosen: null });
    this.arrows = matrix.filter(({ row, column, share }) => row !== column && share?.low > 0.5).map(({ row, column }) => [row, column]);
    const place = new Map(entries.map(({ name }, i) => [name, i]));
    this.place = (name) => place.get(name) ?? 0;
    this.draw();
  }

  /** Whether the loser has the higher rating. */
  isUpset([winner, loser]) {
    return this.place(winner) > this.place(loser);
  }

  draw() {
    const { entries, arrows, cycles } = this;
    const pairs = (entries.length * (entries.length - 1)) / 2;
    const facts = `An arrow leads from the winner to the loser of a pairing if the 95 % interval of the winner’s win rate is above 50 %: ${arrows.length} of ${pairs} pairings. `
      + 'Entries are ordered clockwise by Elo rating, from the top; bold arrows contradict it. A circle’s area is the entry’s Nash share. Point at an entry for its arrows, or click it for its results.';
    const kinds = KINDS.filter((kind) => entries.some((entry) => entry.kind === kind));
    const legend = make('ul', 'legend', '', ...(kinds.length > 1 ? kinds : []).map((kind) => make('li', kindClass(kind), '', make('i', 'kind-dot'), make('span', '', plain(kind)))));
    this.sketch = this.picture();
    this.box.replaceChildren(make('h2', '', 'Who beats whom'), make('p', 'faint', facts), legend, this.sketch, this.cycleList(cycles));
    this.light(null);
  }

  cycleList(cycles) {
    if (cycles.length === 0) return make('p', '', 'These arrows form no cycle.');
    const button = (cycle) => {
      const one = make('button', '', [...cycle, cycle[0]].map(plain).join(' → '));
      Object.assign(one, { type: 'button' });
      one.setAttribute('aria-pressed', 'false');
      one.addEventListener('click', () => {
        this.chosen = this.chosen === cycle ? null : cycle;
        for (const each of one.parentElement.children) each.setAttribute('aria-pressed', String(each === one && this.chosen !== null));
        this.light(null);
      });
      return one;
    };
    const more = cycles.length > LISTED ? `, the shortest ${LISTED} of ${cycles.length}` : '';
    return make('div', '', '', make('p', 'faint', `Cycles${more}: each entry beats the next. Press one to see it in the picture.`), make('div', 'cycles', '', ...cycles.slice(0, LISTED).map(button)));
  }

  at(name) {
    const turn = (2 * Math.PI * this.place(name)) / this.entries.length;
    return { x: WIDTH / 2 + RADIUS * Math.sin(turn), y: HEIGHT / 2 - RADIUS * Math.cos(turn) };
  }

  size(name) {
    return 7 + 17 * Math.sqrt(this.entries[this.place(name)].nash?.share.mean ?? 0);
  }

  isDimmed(name) {
    return this.kind !== '' && this.entries[this.place(name)].kind !== this.kind;
  }

  picture() {
    const ordered = [...this.arrows].sort((a, b) => this.isUpset(a) - this.isUpset(b));
    const beaten = (name) => this.arrows.filter(([winner]) => winner === name).map(([, loser]) => plain(loser));
    const words = this.entries.map(({ name }) => `${plain(name)} beats ${beaten(name).join(', ') || 'none'}`).join('; ');
    return svg('svg', { viewBox: `0 0 ${WIDTH} ${HEIGHT}`, class: 'beats', role: 'group', 'aria-label': `Who beats whom: ${words}.` },
      ...ordered.map((arrow) => this.arrow(arrow)), ...this.entries.map((entry) => this.node(entry)));
  }

  /** An arrow, bent to the right so that it misses other entries. */
  arrow([winner, loser]) {
    const [from, to] = [this.at(winner), this.at(loser)];
    const length = Math.hypot(to.x - from.x, to.y - from.y);
    const [along, across] = [{ x: (to.x - from.x) / length, y: (to.y - from.y) / length }, 0.06 * length];
    const [begin, end] = [this.size(winner), length - this.size(loser)].map((far) => ({ x: from.x + along.x * far, y: from.y + along.y * far }));
    const bend = { x: (from.x + to.x) / 2 - along.y * across, y: (from.y + to.y) / 2 + along.x * across };
    // The head is past the middle, because the ends of arrows meet at their entries.
    const at = (axis) => 0.16 * begin[axis] + 0.48 * bend[axis] + 0.36 * end[axis];
    const slope = { x: 0.4 * (bend.x - begin.x) + 0.6 * (end.x - bend.x), y: 0.4 * (bend.y - begin.y) + 0.6 * (end.y - bend.y) };
    const steep = Math.hypot(slope.x, slope.y);
    const point = (forward, side) => `${at('x') + (forward * slope.x - side * slope.y) / steep} ${at('y') + (forward * slope.y + side * slope.x) / steep}`;
    const dimmed = this.kind !== '' && this.isDimmed(winner) && this.isDimmed(loser);
    return svg('g', { class: `arrow${this.isUpset([winner, loser]) ? ' upset' : ''}${dimmed ? ' dimmed' : ''}`, 'data-from': winner, 'data-to': loser },
      svg('path', { class: 'line', d: `M${begin.x} ${begin.y}Q${bend.x} ${bend.y} ${end.x} ${end.y}` }),
      svg('path', { class: 'head', d: `M${point(8, 0)}L${point(-5, 5)}L${point(-5, -5)}Z` }));
  }

  node({ name, kind, rating }) {
    const { x, y } = this.at(name);
    const side = Math.abs(x - WIDTH / 2) < 40 ? 0 : Math.sign(x - WIDTH / 2);
    const gap = this.size(name) + 7;
    const below = Math.sign(y - HEIGHT / 2);
    const label = svg('text', { x: x + side * gap, y: side === 0 ? y + below * gap + (below > 0 ? 13 : -3) : y + 5, 'text-anchor': ['end', 'middle', 'start'][side + 1] });
    label.textContent = plain(name);
    const elo = svg('tspan', { class: 'elo', dx: 6 });
    elo.textContent = rating.elo.toFixed(0);
    label.append(elo);
    const lit = () => this.light(name);
    const dark = () => this.light(null);
    return svg('a', { href: this.linkOf(name), class: `node ${kindClass(kind)}${this.isDimmed(name) ? ' dimmed' : ''}`, onmouseenter: lit, onmouseleave: dark, onfocus: lit, onblur: dark },
      svg('circle', { cx: x, cy: y, r: this.size(name) }), label);
  }

  /** Highlights the arrows of an entry, or of the chosen cycle. */
  light(name) {
    const cycle = name === null ? this.chosen : null;
    const isNext = (from, to) => cycle?.some((each, i) => each === from && cycle[(i + 1) % cycle.length] === to) ?? false;
    this.sketch.classList.toggle('focused', name !== null || cycle !== null);
    for (const arrow of this.sketch.querySelectorAll('.arrow')) {
      const { from, to } = arrow.dataset;
      arrow.classList.toggle('won', name !== null && from === name);
      arrow.classList.toggle('lost', name !== null && to === name);
      arrow.classList.toggle('cycle', isNext(from, to));
    }
  }
}
