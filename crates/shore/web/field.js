// The chart itself: grid, field, zones, scrimmage line, home flags, obstacles, circles, scale and north arrow.

import { inside } from './boats.js';
import { palette, teamColour } from './palette.js';
import { number, plain } from './words.js';

const FONT = '12px system-ui, sans-serif';
/** Circles around a flag: key of the radius, label, dash. */
const CIRCLES = [
  ['grab_m', 'grab', []], ['capture_m', 'capture', [7, 4]], ['untag_m', 'untag', [7, 4]], ['keepout_m', 'keep out', [2, 4]],
];

/** With more boats than this, circles have no labels. */
const WORDS_MAX = 12;
/** Width of the buttons on the chart, px. */
const BUTTONS_PX = 250;

/** The smallest step of 1, 2 or 5 times a power of ten that is at least `least`. */
function niceStep(least) {
  const power = 10 ** Math.floor(Math.log10(least));
  return [1, 2, 5, 10].map((times) => times * power).find((step) => step >= least * 0.999);
}

function trace(context, view, points, closed) {
  context.beginPath();
  points.forEach(([x, y], index) => {
    if (index === 0) context.moveTo(view.xOf(x, y), view.yOf(x, y));
    else context.lineTo(view.xOf(x, y), view.yOf(x, y));
  });
  if (closed) context.closePath();
}

/** Text with an outline in the colour of water, readable on any background. */
export function haloText(context, text, x, y, colour = palette.ink) {
  context.lineJoin = 'round';
  context.lineWidth = 3;
  context.strokeStyle = palette.halo;
  context.strokeText(text, x, y);
  context.fillStyle = colour;
  context.fillText(text, x, y);
}

/** Draws everything static, above the background. */
export function drawField(context, view, chart, shown, background) {
  context.clearRect(0, 0, view.width, view.height);
  context.font = FONT;
  if (shown.chart) background.draw(context, view);
  const field = chart.field;
  if (field) {
    drawZones(context, view, field);
    drawGrid(context, view);
    if (shown.circles) drawCircles(context, view, chart);
    drawEdge(context, view, field);
    field.obstacles?.forEach((obstacle) => drawObstacle(context, view, obstacle));
    field.flags?.forEach((flag) => drawHome(context, view, flag));
    drawZoneNames(context, view, chart);
  }
  drawScale(context, view);
  drawNorth(context, view);
}

function drawZones(context, view, field) {
  for (const zone of field.zones ?? []) {
    trace(context, view, zone.corners, true);
    context.globalAlpha = 0.13;
    context.fillStyle = teamColour(zone.team);
    context.fill();
    context.globalAlpha = 1;
  }
}

/** The grid's lines: positions on the screen, px, and coordinates, m. On a turned chart, columns are lines of constant north coordinate. */
function gridOf(view, step) {
  const corners = [view.placeOf(0, 0), view.placeOf(view.width, view.height)];
  const [xs, ys] = [0, 1].map((axis) => {
    const [low, high] = corners.map((corner) => corner[axis]).sort((a, b) => a - b);
    return Array.from({ length: Math.max(0, Math.floor(high / step) - Math.ceil(low / step) + 1) }, (_, i) => (Math.ceil(low / step) + i) * step);
  });
  const [columns, rows] = view.turned ? [ys, xs] : [xs, ys];
  return {
    columns: columns.map((value) => [view.turned ? view.xOf(0, value) : view.xOf(value, 0), value]),
    rows: rows.map((value) => [view.turned ? view.yOf(value, 0) : view.yOf(0, value), value]),
  };
}

function drawGrid(context, view) {
  const step = niceStep(80 / view.scale);
  const grid = gridOf(view, step);
  context.strokeStyle = palette.grid;
  context.lineWidth = 1;
  context.beginPath();
  for (const [at] of grid.columns) {
    context.moveTo(Math.round(at) + 0.5, 0);
    context.lineTo(Math.round(at) + 0.5, view.height);
  }
  for (const [at] of grid.rows) {
    context.moveTo(0, Math.round(at) + 0.5);
    context.lineTo(view.width, Math.round(at) + 0.5);
  }
  context.stroke();
  drawGridNumbers(context, view, grid, step < 1 ? 1 : 0);
}

function drawGridNumbers(context, view, { columns, rows }, places) {
  context.font = '11px system-ui, sans-serif';
  context.textAlign = 'center';
  context.textBaseline = 'bottom';
  for (const [at, value] of columns) {
    // The corners are reserved for the scale and the buttons.
    if (at > 150 && at < view.width - BUTTONS_PX) haloText(context, number(value, places), at, view.height - 3, palette.faint);
  }
  context.textAlign = 'left';
  context.textBaseline = 'middle';
  for (const [at, value] of rows) {
    if (at > 110 && at < view.height - 60) haloText(context, number(value, places), 4, at, palette.faint);
  }
  context.font = FONT;
}

function drawEdge(context, view, field) {
  trace(context, view, field.corners, true);
  context.strokeStyle = field.walls ? palette.wall : palette.edge;
  context.lineWidth = field.walls ? 6 : 1.75;
  context.stroke();
  if (field.walls) {
    context.strokeStyle = palette.land;
    context.lineWidth = 2;
    context.stroke();
  }
  if (!field.scrimmage) return;
  trace(context, view, field.scrimmage, false);
  context.strokeStyle = palette.edge;
  context.lineWidth = 1.75;
  context.setLineDash([12, 5, 2, 5]);
  context.stroke();
  context.setLineDash([]);
}

/** Radii around a home flag, equal ones drawn once: `[metres, label, dash]`. */
function ringsOf(radii) {
  const rings = [];
  for (const [key, word, dash] of CIRCLES) {
    const metres = radii[key];
    if (!(metres > 0)) continue;
    const same = rings.find((ring) => ring[0] === metres);
    if (same) same[1] += `, ${word}`;
    else rings.push([metres, word, dash]);
  }
  return rings;
}

function drawCircles(context, view, chart) {
  context.textAlign = 'center';
  context.textBaseline = 'bottom';
  for (const flag of chart.field.flags ?? []) {
    for (const [metres, word, dash] of ringsOf(flag.radii ?? chart.radii ?? {})) {
      const px = metres * view.scale;
      if (px < 5) continue;
      context.beginPath();
      context.arc(view.xOf(flag.x, flag.y), view.yOf(flag.x, flag.y), px, 0, 2 * Math.PI);
      context.strokeStyle = teamColour(flag.team);
      context.globalAlpha = 0.75;
      context.lineWidth = 1.25;
      context.setLineDash(dash);
      context.stroke();
      context.setLineDash([]);
      context.globalAlpha = 1;
      // With many boats, labels would clutter the chart.
      if (px < 55 || chart.vehicles.length > WORDS_MAX) continue;
      context.font = '11px system-ui, sans-serif';
      haloText(context, `${word} ${number(metres, metres % 1 ? 1 : 0)} m`, view.xOf(flag.x, flag.y), view.yOf(flag.x, flag.y) - px - 2, palette.faint);
      context.font = FONT;
    }
  }
}

function drawObstacle(context, view, obstacle) {
  if (obstacle.circle) {
    const [x, y, radius] = obstacle.circle;
    context.beginPath();
    context.arc(view.xOf(x, y), view.yOf(x, y), Math.max(2, radius * view.scale), 0, 2 * Math.PI);
  } else if (obstacle.polygon) {
    trace(context, view, obstacle.polygon, true);
  } else {
    return;
  }
  context.fillStyle = palette.land;
  context.fill();
  context.strokeStyle = palette.wall;
  context.lineWidth = 1.5;
  context.stroke();
}

/** A flag's home: the foot stays when the flag is taken. */
function drawHome(context, view, flag) {
  const x = view.xOf(flag.x, flag.y);
  const y = view.yOf(flag.x, flag.y);
  context.beginPath();
  context.arc(x, y, 4, 0, 2 * Math.PI);
  context.fillStyle = palette.halo;
  context.fill();
  context.strokeStyle = teamColour(flag.team);
  context.lineWidth = 2;
  context.stroke();
}

function drawZoneNames(context, view, chart) {
  const named = new Set();
  context.font = '600 13px system-ui, sans-serif';
  context.textAlign = 'center';
  context.textBaseline = 'top';
  for (const zone of chart.field.zones ?? []) {
    const name = chart.teams[zone.team]?.name;
    if (!name || named.has(zone.team)) continue;
    named.add(zone.team);
    const corners = zone.corners.map(([x, y]) => [view.xOf(x, y), view.yOf(x, y)]);
    const [xs, ys] = [0, 1].map((axis) => corners.map((corner) => corner[axis]));
    const middle = ys.reduce((sum, each) => sum + each, 0) / ys.length;
    const across = Math.max(...xs) - Math.min(...xs);
    const centre = Math.min(...xs) + across / 2;
    // Near the upper edge, clear of the boats.
    const high = Math.min(...ys) + 26;
    const y = inside(corners, centre, high) ? high : middle;
    if (across < 70) continue;
    context.globalAlpha = 0.7;
    haloText(context, plain(name), centre, y - 18, teamColour(zone.team));
    context.globalAlpha = 1;
  }
  context.font = FONT;
}

function drawScale(context, view) {
  const metres = niceStep(44 / view.scale);
  const px = metres * view.scale;
  const left = 14;
  const base = view.height - 14;
  context.fillStyle = palette.halo;
  context.fillRect(left - 6, base - 25, px + 12, 33);
  context.strokeStyle = palette.ink;
  context.lineWidth = 1.5;
  context.beginPath();
  context.moveTo(left, base - 5);
  context.lineTo(left, base);
  context.lineTo(left + px, base);
  context.lineTo(left + px, base - 5);
  context.moveTo(left + px / 2, base - 3);
  context.lineTo(left + px / 2, base);
  context.stroke();
  context.textAlign = 'center';
  context.textBaseline = 'bottom';
  context.fillStyle = palette.ink;
  context.fillText(metres >= 1000 ? `${metres / 1000} km` : `${number(metres, metres < 1 ? 1 : 0)} m`, left + px / 2, base - 6);
}

function drawNorth(context, view) {
  context.save();
  context.translate(view.width - 33, 34);
  context.rotate(-view.up_rad);
  for (const way of [1, -1]) {
    context.beginPath();
    context.moveTo(0, -18);
    context.lineTo(7 * way, 12);
    context.lineTo(0, 7);
    context.closePath();
    context.fillStyle = palette.ink;
    if (way > 0) context.fill();
    context.strokeStyle = palette.ink;
    context.lineWidth = 1.25;
    if (way < 0) context.stroke();
  }
  context.restore();
  context.textAlign = 'center';
  context.textBaseline = 'middle';
  context.font = '600 12px system-ui, sans-serif';
  // Behind the arrow's tail.
  haloText(context, 'N', view.width - 33 + 21 * Math.sin(view.up_rad), 34 + 21 * Math.cos(view.up_rad));
  context.font = FONT;
}
