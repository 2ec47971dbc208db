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

/** The smallest step of 1, 2 or 5 times a power of ten that is at least `least`. */
function niceStep(least) {
  const power = 10 ** Math.floor(Math.log10(least));
  return [1, 2, 5, 10].map((times) => times * power).find((step) => step >= least * 0.999);
}

function trace(context, view, points, closed) {
  context.beginPath();
  points.forEach(([x, y], index) => {
    if (index === 0) context.moveTo(view.xOf(x), view.yOf(y));
    else context.lineTo(view.xOf(x), view.yOf(y));
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

function drawGrid(context, view) {
  const step = niceStep(80 / view.scale);
  context.strokeStyle = palette.grid;
  context.lineWidth = 1;
  context.beginPath();
  const left = Math.ceil(view.eastOf(0) / step) * step;
  const bottom = Math.ceil(view.northOf(view.height) / step) * step;
  for (let x = left; x <= view.eastOf(view.width); x += step) {
    const at = Math.round(view.xOf(x)) + 0.5;
    context.moveTo(at, 0);
    context.lineTo(at, view.height);
  }
  for (let y = bottom; y <= view.northOf(0); y += step) {
    const at = Math.round(view.yOf(y)) + 0.5;
    context.moveTo(0, at);
    context.lineTo(view.width, at);
  }
  context.stroke();
  drawGridNumbers(context, view, step, left, bottom);
}

function drawGridNumbers(context, view, step, left, bottom) {
  context.font = '11px system-ui, sans-serif';
  context.fillStyle = palette.faint;
  const places = step < 1 ? 1 : 0;
  context.textAlign = 'center';
  context.textBaseline = 'bottom';
  for (let x = left; x <= view.eastOf(view.width); x += step) {
    const at = view.xOf(x);
    // The corners are reserved for the scale and the buttons.
    if (at > 150 && at < view.width - 170) haloText(context, number(x, places), at, view.height - 3, palette.faint);
  }
  context.textAlign = 'left';
  context.textBaseline = 'middle';
  for (let y = bottom; y <= view.northOf(0); y += step) {
    const at = view.yOf(y);
    if (at > 110 && at < view.height - 60) haloText(context, number(y, places), 4, at, palette.faint);
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
  const rings = ringsOf(chart.radii ?? {});
  context.textAlign = 'center';
  context.textBaseline = 'bottom';
  for (const flag of chart.field.flags ?? []) {
    for (const [metres, word, dash] of rings) {
      const px = metres * view.scale;
      if (px < 5) continue;
      context.beginPath();
      context.arc(view.xOf(flag.x), view.yOf(flag.y), px, 0, 2 * Math.PI);
      context.strokeStyle = teamColour(flag.team);
      context.globalAlpha = 0.75;
      context.lineWidth = 1.25;
      context.setLineDash(dash);
      context.stroke();
      context.setLineDash([]);
      context.globalAlpha = 1;
      // With many boats they would clutter the chart.
      if (px < 55 || chart.vehicles.length > WORDS_MAX) continue;
      context.font = '11px system-ui, sans-serif';
      haloText(context, `${word} ${number(metres, metres % 1 ? 1 : 0)} m`, view.xOf(flag.x), view.yOf(flag.y) - px - 2, palette.faint);
      context.font = FONT;
    }
  }
}

function drawObstacle(context, view, obstacle) {
  if (obstacle.circle) {
    const [x, y, radius] = obstacle.circle;
    context.beginPath();
    context.arc(view.xOf(x), view.yOf(y), Math.max(2, radius * view.scale), 0, 2 * Math.PI);
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
  const x = view.xOf(flag.x);
  const y = view.yOf(flag.y);
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
    const xs = zone.corners.map((corner) => corner[0]);
    const ys = zone.corners.map((corner) => corner[1]);
    const middle = ys.reduce((sum, each) => sum + each, 0) / ys.length;
    const east = (Math.min(...xs) + Math.max(...xs)) / 2;
    // Near the upper edge, clear of the boats.
    const high = Math.max(...ys) - 26 / view.scale;
    const y = view.yOf(inside(zone.corners, east, high) ? high : middle);
    const across = (Math.max(...xs) - Math.min(...xs)) * view.scale;
    if (across < 70) continue;
    context.globalAlpha = 0.7;
    haloText(context, plain(name), view.xOf(east), y - 18, teamColour(zone.team));
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
  const x = view.width - 33;
  const y = 34;
  context.beginPath();
  context.moveTo(x, y - 18);
  context.lineTo(x + 7, y + 12);
  context.lineTo(x, y + 7);
  context.closePath();
  context.fillStyle = palette.ink;
  context.fill();
  context.beginPath();
  context.moveTo(x, y - 18);
  context.lineTo(x - 7, y + 12);
  context.lineTo(x, y + 7);
  context.closePath();
  context.strokeStyle = palette.ink;
  context.lineWidth = 1.25;
  context.stroke();
  context.textAlign = 'center';
  context.textBaseline = 'top';
  context.font = '600 12px system-ui, sans-serif';
  haloText(context, 'N', x, y + 14);
  context.font = FONT;
}
