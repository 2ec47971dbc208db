// Tables of a report.

import { make } from './words.js';

export const cell = (text, classes = '') => make('td', classes, text);

/** The header of a row or a column. */
export const head = (scope, text, classes = '', ...children) => make('th', { scope, class: classes || null }, text, ...children);

/** A link to a game. */
export function watch(address, label) {
  return make('td', '', '', make('a', { class: 'watch', href: address, 'aria-label': label }, 'Watch'));
}

/** A container that scrolls horizontally, also by keyboard. */
export const scrolled = (label, table) => make('div', { class: 'scroll', tabindex: 0, role: 'region', 'aria-label': label }, '', table);

/** A table with column headers, each `[text, classes]` or an element. */
export function tableOf(label, heads, rows, classes = 'list') {
  const columns = heads.map((each) => (Array.isArray(each) ? head('col', ...each) : each));
  return scrolled(label, make('table', classes, '', make('thead', '', '', make('tr', '', '', columns)), make('tbody', '', '', rows)));
}

/**
 * A table whose headers sort it. `columns` are `{ text, classes, key, cell }`: the key of an item to sort by, if any, and its cell. `order` is
 * `{ column, down }`, kept by the caller; `changed` is called when the user changes it.
 */
export function sortedTable(label, columns, items, order, changed, classes = 'list') {
  const column = columns[order.column];
  const compare = (a, b) => (typeof a === 'string' ? a.localeCompare(b) : a - b);
  const sorted = column?.key ? [...items].sort((a, b) => (order.down ? -1 : 1) * compare(column.key(a), column.key(b))) : items;
  const box = tableOf(label, columns.map(({ text, classes: of }) => [text, of]), sorted.map((item) => make('tr', '', '', ...columns.map(({ cell: of }) => of(item)))), classes);
  [...box.querySelectorAll('thead th')].forEach((th, i) => {
    if (!columns[i].key) return;
    const is = order.column === i;
    if (is) th.setAttribute('aria-sort', order.down ? 'descending' : 'ascending');
    const button = make('button', 'sort', `${columns[i].text}${is ? (order.down ? '\u00a0▼' : '\u00a0▲') : ''}`);
    Object.assign(button, { type: 'button', title: 'Sort by this column' });
    button.addEventListener('click', () => {
      // Numbers begin with the largest, names with A.
      const down = is ? !order.down : typeof columns[i].key(items[0]) !== 'string' && !columns[i].rises;
      Object.assign(order, { column: i, down });
      changed();
      document.querySelectorAll(`[aria-label="${label}"] thead th`)[i].querySelector('button').focus();
    });
    th.replaceChildren(button);
  });
  return box;
}
