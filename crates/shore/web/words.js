// Formats numbers and positions, and writes text to the page only when it changes.

const said = new WeakMap();

/** Writes the text into the element if it differs. */
export function write(element, text) {
  if (said.get(element) === text) return;
  said.set(element, text);
  element.textContent = text;
}

/** Shows or hides the element. */
export function show(element, visible) {
  if (element.hidden === visible) element.hidden = !visible;
}

/** Sets an element's attributes and children: missing ones are omitted, and lists may be nested. */
function furnish(element, attributes, children) {
  for (const [name, value] of Object.entries(attributes)) {
    if (value === null || value === undefined || value === false) continue;
    if (name.startsWith('on')) element.addEventListener(name.slice(2), value);
    else if (name === 'style') element.style.cssText = value;
    else element.setAttribute(name, value === true ? '' : value);
  }
  element.append(...children.flat().filter((child) => child !== null && child !== undefined));
  return element;
}

/** Creates an element with classes or attributes, text and children. */
export function make(tag, of = '', text = '', ...children) {
  const element = document.createElement(tag);
  if (text !== '') write(element, text);
  return furnish(element, typeof of === 'string' ? { class: of || null } : of, children);
}

/** Creates an element of a drawing. */
export const svg = (tag, attributes = {}, ...children) => furnish(document.createElementNS('http://www.w3.org/2000/svg', tag), attributes, children);

/** `mm:ss.t` */
export function clock(t_s) {
  if (!Number.isFinite(t_s)) return '–';
  const tenths = Math.floor(Math.max(0, t_s) * 10 + 1e-6);
  const minutes = String(Math.floor(tenths / 600)).padStart(2, '0');
  const seconds = String(Math.floor(tenths / 10) % 60).padStart(2, '0');
  return `${minutes}:${seconds}.${tenths % 10}`;
}

/** `mm:ss` */
export const clockShort = (t_s) => clock(t_s).slice(0, -2);

/** A compass course with three digits. */
export function bearing(deg) {
  return Number.isFinite(deg) ? `${String(Math.round(wrapDeg(deg)) % 360).padStart(3, '0')}°` : '–';
}

export function wrapDeg(deg) {
  return ((deg % 360) + 360) % 360;
}

/** A number to this many decimal places, or a dash. */
export function number(value, places = 1, unit = '') {
  if (typeof value !== 'number' || !Number.isFinite(value)) return '–';
  const text = value.toFixed(places).replace('-', '−');
  return unit ? `${text}\u00a0${unit}` : text;
}

/** A number with this many significant digits, whole if it has more, or a dash. */
export function significant(value, digits = 3) {
  if (typeof value !== 'number' || !Number.isFinite(value)) return '–';
  const size = Math.abs(value);
  if (size >= 10 ** (digits - 1) && size < 1e9) return number(value, 0);
  const text = size !== 0 && (size >= 1e9 || size < 1e-4) ? value.toExponential(digits - 1) : String(Number(value.toPrecision(digits)));
  return text.replaceAll('-', '−');
}

/** A size in bytes, readable. */
export function bytes(count) {
  if (!Number.isFinite(count)) return '–';
  if (count < 1e6) return `${Math.round(count / 1e3)} kB`;
  return count < 1e9 ? `${(count / 1e6).toFixed(1)} MB` : `${(count / 1e9).toFixed(2)} GB`;
}

/** A scenario file by its name. */
export const stem = (path) => path.split('/').at(-1).replace(/\.toml$/, '');

/** `blue_one` as shown to people. */
export const plain = (name) => String(name).replaceAll('_', ' ');

/** Makes the children of `parent` match `items`: creates missing rows, updates all, and removes surplus ones. */
export function fill(parent, items, makeRow, tellRow) {
  while (parent.children.length > items.length) parent.lastElementChild.remove();
  for (let i = 0; i < items.length; i++) {
    if (i === parent.children.length) parent.append(makeRow(i));
    tellRow(parent.children[i], items[i], i);
  }
}

/** Sets the options `[value, text]` of a select if they differ. */
export function options(select, wanted) {
  const key = JSON.stringify(wanted);
  if (said.get(select) === key) return;
  said.set(select, key);
  const value = select.value;
  select.replaceChildren(...wanted.map(([each, text]) => {
    const option = make('option', '', text);
    option.value = each;
    return option;
  }));
  if (wanted.some(([each]) => each === value)) select.value = value;
}
