// Tables of a report.

import { make } from './words.js';

export const cell = (text, classes = '') => make('td', classes, text);

/** The header of a row or a column. */
export function head(scope, text, classes = '') {
  const th = make('th', classes, text);
  th.scope = scope;
  return th;
}

/** A link to a game. */
export function watch(address, label) {
  const link = make('a', 'watch', 'Watch');
  link.href = address;
  link.setAttribute('aria-label', label);
  return make('td', '', '', link);
}

/** A table with column headers `[text, classes]`. It scrolls sideways, also by keys. */
export function tableOf(label, heads, rows, classes = 'list') {
  const columns = heads.map(([text, of]) => head('col', text, of));
  const box = make('div', 'scroll', '', make('table', classes, '', make('thead', '', '', make('tr', '', '', ...columns)), make('tbody', '', '', ...rows)));
  box.tabIndex = 0;
  box.setAttribute('role', 'region');
  box.setAttribute('aria-label', label);
  return box;
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
