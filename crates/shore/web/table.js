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
