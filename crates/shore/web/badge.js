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

/** Draws the badge below a boat, within the chart. Returns the area taken: left, top, right, bottom, px. */
export function drawBadge(context, view, reading, x, y, room) {
  context.font = FONT;
  const text = view.width < NARROW ? reading.label : fitted(context, said(reading));
  const width = context.measureText(text).width + 2 * PAD;
  const left = Math.round(Math.min(view.width - width - 2, Math.max(2, x - width / 2)));
  const below = y + room;
  const top = Math.round(below + HEIGHT > view.height - 2 ? y - room - HEIGHT : below);
  const [fill, ink, rim] = (LOOKS[reading.tone] ?? LOOKS.plain)();
  context.beginPath();
  context.roundRect(left, top, width, HEIGHT, 4);
  context.fillStyle = fill;
  context.fill();
  context.lineWidth = 1.5;
  context.strokeStyle = rim;
  context.stroke();
  context.fillStyle = ink;
  context.textAlign = 'left';
  context.textBaseline = 'middle';
  context.fillText(text, left + PAD, top + HEIGHT / 2 + 0.5);
  return [left, top, left + width, top + HEIGHT];
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
