// The badge of a real boat: its state according to the gateway, on the chart and in the list.

import { palette } from './palette.js';
import { make, show, write } from './words.js';

const FONT = '700 11px system-ui, sans-serif';
const HEIGHT = 17;
const PAD = 6;
/** Maximum length of text on the chart, px; the list shows causes in full. */
const WIDTH_MAX = 220;
/** On a chart narrower than this, causes would cover other boats, px. */
const NARROW = 600;

/** Fill, text and border of each tone. */
const LOOKS = {
  good: () => [palette.good, palette.paper, palette.paper],
  bad: () => [palette.danger, palette['on-danger'], palette.halo],
  warn: () => [palette.paper, palette.warn, palette.warn],
  task: () => [palette.accent, palette['on-accent'], palette.halo],
  plain: () => [palette.paper, palette.ink, palette.ink],
};

const said = ({ kind, label, detail }) => (detail && kind !== 'stopped' && kind !== 'silent' ? `${label}: ${detail}` : label);

function fitted(context, text) {
  if (context.measureText(text).width <= WIDTH_MAX) return text;
  let length = text.length;
  while (length > 1 && context.measureText(`${text.slice(0, length)}…`).width > WIDTH_MAX) length -= 1;
  return `${text.slice(0, length)}…`;
}

/** The last position of each boat's badge around it, so that badges do not jump. */
const places = new Map();
const BELOW = 2;

/** Draws a boat's badge where it covers no boat and no other badge, with a line to the boat if it is far away. Returns the area taken: left,
 * top, right, bottom, px; null if there is no space. */
export function drawBadge(context, view, labels, reading, x, y, room) {
  context.font = FONT;
  const text = view.width < NARROW ? reading.label : fitted(context, said(reading));
  const width = Math.ceil(context.measureText(text).width + 2 * PAD);
  const box = labels.fit(width, HEIGHT, x, y, room, places.get(reading.name) ?? BELOW);
  if (box === null) return null;
  const { left, top, place, out } = box;
  if (out === room) places.set(reading.name, place);
  const [fill, ink, rim] = (LOOKS[reading.tone] ?? LOOKS.plain)();
  context.lineWidth = 1.5;
  if (out > room) drawLead(context, [x, y], [left + width / 2, top + HEIGHT / 2], room);
  context.beginPath();
  context.roundRect(left, top, width, HEIGHT, 4);
  context.fillStyle = fill;
  context.fill();
  context.strokeStyle = rim;
  context.stroke();
  context.fillStyle = ink;
  context.textAlign = 'left';
  context.textBaseline = 'middle';
  context.fillText(text, left + PAD, top + HEIGHT / 2 + 0.5);
  return [left, top, left + width, top + HEIGHT];
}

/** A line to a distant badge, clear of the hull. */
function drawLead(context, [x, y], [toX, toY], room) {
  const part = Math.min(1, room / Math.hypot(toX - x, toY - y));
  context.beginPath();
  context.moveTo(x + (toX - x) * part, y + (toY - y) * part);
  context.lineTo(toX, toY);
  context.strokeStyle = palette.ink;
  context.stroke();
}

/** Creates an element for a badge. */
export const makeBadge = () => make('span', 'badge');

/** Writes a badge with its cause or task. */
export function tellBadge(element, reading) {
  write(element, reading.label);
  if (element.dataset.tone !== reading.tone) element.dataset.tone = reading.tone;
}

/** The line below a boat's name in the list: badge, cause, link, fix and battery, with their ages. */
export class BadgeLine {
  constructor() {
    this.badge = makeBadge();
    this.cause = make('span', 'cause');
    this.facts = make('span', 'facts-short');
    this.element = make('span', 'badge-line', '', this.badge, this.cause, this.facts);
  }

  tell(reading) {
    tellBadge(this.badge, reading);
    write(this.cause, reading.detail);
    show(this.cause, reading.detail !== '');
    const shorts = reading.facts.filter((fact) => fact.short);
    while (this.facts.children.length > shorts.length) this.facts.lastElementChild.remove();
    shorts.forEach((fact, i) => {
      if (i === this.facts.children.length) this.facts.append(make('span'));
      const line = this.facts.children[i];
      write(line, fact.short);
      line.classList.toggle('old', fact.bad);
    });
  }
}
