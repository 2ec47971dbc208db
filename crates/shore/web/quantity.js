// The quantities that plots show, and the samples of a section at the resolution of a screen.

import { sampleAt } from './diagram.js';
import { bearing, number } from './words.js';

const unitOf = (places, unit) => (value) => number(value, places, unit);
const course = (value) => bearing(value);

/** Key, title, unit, format of values, minimum range (so that noise does not fill the plot), and: `from0`, whether the axis starts at
 * zero; `round`, whether values are compass courses; `beside`, a second curve of the same boat, dashed; `to`, whether it is measured to another boat. */
export const QUANTITIES = [
  { key: 'speed_m_s', title: 'Speed', unit: 'm/s', words: unitOf(2, 'm/s'), least: 1, from0: true, beside: ['ordered', 'ordered_speed_m_s'] },
  { key: 'heading_deg', title: 'Heading', unit: '°', words: course, round: true, beside: ['ordered', 'ordered_heading_deg'] },
  { key: 'course_deg', title: 'Course over ground', unit: '°', words: course, round: true },
  { key: 'flag_m', title: 'To the enemy flag', unit: 'm', words: unitOf(1, 'm'), least: 10, from0: true },
  { key: 'range_m', title: 'Range to', unit: 'm', words: unitOf(1, 'm'), least: 10, from0: true, to: true },
  { key: 'error_m', title: 'Navigation error', unit: 'm', words: unitOf(2, 'm'), least: 1, from0: true },
  { key: 'sway_m_s', title: 'Sway', unit: 'm/s', words: unitOf(2, 'm/s'), least: 0.5 },
  { key: 'yaw_rate_deg_s', title: 'Yaw rate', unit: '°/s', words: unitOf(1, '°/s'), least: 10 },
  { key: 'port_newton', title: 'Thrust', unit: 'N', words: unitOf(0, 'N'), least: 20, names: 'port', beside: ['starboard', 'starboard_newton'] },
  { key: 'x_m', title: 'East', unit: 'm', words: unitOf(1, 'm'), least: 10 },
  { key: 'y_m', title: 'North', unit: 'm', words: unitOf(1, 'm'), least: 10 },
  { key: 'score', title: 'Score', unit: 'points', words: unitOf(0), least: 4, from0: true, teams: true },
];

export const quantityOf = (key) => QUANTITIES.find((each) => each.key === key) ?? QUANTITIES[0];

/** The range between two boats by sample. */
export function rangeOf(source, boat, other) {
  const [x, y, otherX, otherY] = [[boat, 'x_m'], [boat, 'y_m'], [other, 'x_m'], [other, 'y_m']].map(([of, key]) => source.list(of, key));
  return x && y && otherX && otherY ? x.map((each, i) => Math.hypot(each - otherX[i], y[i] - otherY[i])) : null;
}

/**
 * The samples from `from_s` to `to_s`, and one on either side, as `[times, ...lists]`; null where unknown. More than `most` are joined
 * into the minimum and the maximum of each group, so that peaks remain; courses keep every nth sample.
 */
export function sectionOf(times, lists, from_s, to_s, most, round) {
  const first = Math.max(0, sampleAt(times, from_s));
  const last = Math.min(times.length - 1, sampleAt(times, to_s) + 1);
  const count = Math.max(0, last - first + 1);
  const known = (value) => (Number.isFinite(value) ? value : null);
  if (count <= most || times.length === 0) {
    const cut = (list) => Array.from({ length: count }, (_, i) => known(list?.[first + i]));
    return [Array.from({ length: count }, (_, i) => times[first + i]), ...lists.map(cut)];
  }
  // Groups begin at multiples of their size, so that they stay the same while the section moves.
  const size = 2 ** Math.ceil(Math.log2((count / most) * (round ? 1 : 2)));
  const starts = [];
  for (let start = Math.floor(first / size) * size; start <= last; start += size) starts.push(start);
  if (round) return [[...starts.map((at) => times[at]), times[last]], ...lists.map((list) => [...starts, last].map((at) => known(list?.[at])))];
  const ends = (list, row) => {
    for (const start of starts) row.push(...extremes(list, start, Math.min(start + size, times.length)));
    return row;
  };
  const xs = starts.flatMap((start) => [times[start], times[Math.min(start + size / 2, times.length - 1)]]);
  return [xs, ...lists.map((list) => ends(list, []))];
}

/** The minimum and the maximum value in a group, in their order; null where unknown. */
function extremes(list, from, to) {
  let [low, high] = [-1, -1];
  for (let i = from; list && i < to; i++) {
    if (!Number.isFinite(list[i])) continue;
    if (low < 0 || list[i] < list[low]) low = i;
    if (high < 0 || list[i] > list[high]) high = i;
  }
  if (low < 0) return [null, null];
  return low < high ? [list[low], list[high]] : [list[high], list[low]];
}
