// Draws a geofence on the chart corner by corner, and writes it as a table of a gateway file.

import { latLonOf } from './datum.js';
import { traceCorners } from './fence.js';
import { palette } from './palette.js';
import { notice } from './status.js';
import { make, options, show, write } from './words.js';

/** The maximum that a gateway file allows. */
const CORNERS_MAX = 100;
const KEEP_OUTS_MAX = 50;
const CORNER_PX = 5;
const OUTLINE = '0';

/** The side of the line from a to b on which a point lies. */
const side = (a, b, at) => Math.sign((b[0] - a[0]) * (at[1] - a[1]) - (b[1] - a[1]) * (at[0] - a[0]));

/** Whether two sides of a polygon cross, other than neighbours at their common corner. */
export function crosses(corners) {
  const count = corners.length;
  for (let i = 0; i < count; i++) {
    for (let j = i + 2; j < count; j++) {
      if (i === 0 && j === count - 1) continue;
      const [a, b, c, d] = [corners[i], corners[i + 1], corners[j], corners[(j + 1) % count]];
      if (side(a, b, c) !== side(a, b, d) && side(c, d, a) !== side(c, d, b)) return true;
    }
  }
  return false;
}

const pair = (datum, [x, y]) => `[${latLonOf(datum, x, y).map((deg) => deg.toFixed(7)).join(', ')}]`;
const list = (datum, corners, indent) => `[\n${corners.map((corner) => `${indent}  ${pair(datum, corner)},\n`).join('')}${indent}]`;

/** The table of a gateway file; corners are latitude and longitude, degrees. */
export function toml(datum, [outline, ...keepOuts]) {
  const whole = keepOuts.filter((corners) => corners.length >= 3);
  const fence = outline.length >= 3 ? `polygon = ${list(datum, outline, '')}\n` : '';
  const out = whole.length > 0 ? `keep_out = [\n${whole.map((corners) => `  ${list(datum, corners, '  ')},\n`).join('')}]\n` : '';
  return fence || out ? `[geofence]\n${fence}${out}` : '';
}

export class FenceEditor {
  /** `on` has `changed()`, called when the polygons must be redrawn. */
  constructor(on) {
    this.on = on;
    this.button = document.getElementById('draw-fence');
    this.place = document.getElementById('fence-editor');
    this.sheet = document.getElementById('sheet');
    this.active = false;
    /** The outline, then the keep-outs: corners `[x, y]`, m. */
    this.polygons = [[]];
    this.at = 0;
    this.datum = null;
    this.fences = [];
    this.build();
    this.button.addEventListener('click', () => this.toggle());
  }

  build() {
    this.chooser = make('select');
    this.chooser.id = 'fence-part';
    this.chooser.setAttribute('aria-label', 'Part to draw');
    this.chooser.addEventListener('change', () => this.choose(Number(this.chooser.value)));
    this.words = make('p', 'fence-words');
    this.words.setAttribute('role', 'status');
    this.text = make('textarea');
    Object.assign(this.text, { id: 'fence-toml', readOnly: true, rows: 4, spellcheck: false });
    this.text.setAttribute('aria-label', 'Geofence for the gateway file');
    this.present = this.action('fence-present', 'Start from the current one', () => this.takePresent());
    this.place.replaceChildren(
      make('div', 'fence-row', '', this.chooser, this.action('fence-undo', 'Undo', () => this.undo()), this.action('fence-clear', 'Clear', () => this.clear())),
      this.words, this.present, this.text,
      make('div', 'fence-row', '', this.action('fence-copy', 'Copy', () => this.copy()), this.action('fence-close', 'Close', () => this.toggle())));
  }

  action(id, text, press) {
    const button = make('button', '', text);
    Object.assign(button, { id, type: 'button' });
    button.addEventListener('click', press);
    return button;
  }

  /** Switches to another game; keeps the drawing if the field has not moved. */
  greet(chart) {
    const datum = chart.field?.datum ?? null;
    if (JSON.stringify(datum) !== JSON.stringify(this.datum)) this.clear();
    this.datum = datum;
    show(this.button, datum !== null && chart.vehicles.some(({ external }) => external));
    if (this.active && this.button.hidden) this.toggle();
  }

  toggle() {
    this.active = !this.active;
    this.button.setAttribute('aria-pressed', String(this.active));
    this.sheet.classList.toggle('drawing', this.active);
    show(this.place, this.active);
    this.changed();
    this.sheet.focus({ preventScroll: true });
  }

  choose(at) {
    if (at === this.polygons.length) this.polygons.push([]);
    this.at = at;
    this.changed();
    this.sheet.focus({ preventScroll: true });
  }

  /** Adds a corner, m. */
  take(x, y) {
    const corners = this.polygons[this.at];
    if (corners.length >= CORNERS_MAX) return notice(`A geofence has at most ${CORNERS_MAX} corners.`);
    corners.push([x, y]);
    return this.changed();
  }

  undo() {
    this.polygons[this.at].pop();
    this.changed();
  }

  clear() {
    this.polygons = [[]];
    this.at = 0;
    this.changed();
  }

  /** Starts from the gateway's current fence. */
  takePresent() {
    const [{ outline, keepOuts }] = this.fences;
    this.polygons = [outline, ...keepOuts].map((corners) => corners.map((corner) => [...corner]));
    this.at = 0;
    this.changed();
  }

  async copy() {
    try {
      await navigator.clipboard.writeText(this.text.value);
      notice('Geofence copied. Paste it into the gateway file.');
    } catch {
      this.text.focus();
      this.text.select();
      notice('Copy the selected text.');
    }
  }

  changed() {
    const corners = this.polygons[this.at];
    const parts = this.polygons.map((_, i) => [String(i), i === 0 ? 'Outline' : `Keep-out ${i}`]);
    if (this.polygons.length <= KEEP_OUTS_MAX) parts.push([String(this.polygons.length), 'Another keep-out']);
    options(this.chooser, parts);
    this.chooser.value = this.at === 0 ? OUTLINE : String(this.at);
    write(this.words, this.said(corners));
    this.words.classList.toggle('trouble', crosses(corners));
    if (this.datum) this.text.value = toml(this.datum, this.polygons);
    this.on.changed();
  }

  said(corners) {
    if (crosses(corners)) return 'Two sides cross: undo or clear.';
    const more = Math.max(0, 3 - corners.length);
    const how = 'Click the chart, or press Enter for its centre. Backspace removes a corner.';
    return more > 0 ? `${corners.length} corners; at least ${more} more needed. ${how}` : `${corners.length} corners.`;
  }

  tell(fences) {
    this.fences = fences;
    show(this.present, fences.length > 0);
  }

  /** Draws the polygons above the boats. */
  draw(context, view) {
    if (!this.active) return;
    this.polygons.forEach((corners, at) => {
      if (corners.length === 0) return;
      const bad = crosses(corners);
      traceCorners(context, view, corners);
      context.globalAlpha = 0.14;
      context.fillStyle = at === 0 ? palette.accent : palette.danger;
      context.fill();
      context.globalAlpha = 1;
      context.lineWidth = at === this.at ? 3 : 1.75;
      context.strokeStyle = bad || at > 0 ? palette.danger : palette.accent;
      context.stroke();
      context.fillStyle = context.strokeStyle;
      for (const [x, y] of corners) context.fillRect(view.xOf(x, y) - CORNER_PX, view.yOf(x, y) - CORNER_PX, 2 * CORNER_PX, 2 * CORNER_PX);
    });
    if (document.activeElement === this.sheet && this.sheet.matches(':focus-visible')) this.cross(context, view.width / 2, view.height / 2);
  }

  /** Where Enter adds a corner. */
  cross(context, x, y) {
    context.beginPath();
    context.moveTo(x - 9, y);
    context.lineTo(x + 9, y);
    context.moveTo(x, y - 9);
    context.lineTo(x, y + 9);
    context.lineWidth = 2;
    context.strokeStyle = palette.accent;
    context.stroke();
  }
}
