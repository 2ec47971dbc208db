// The boats: hulls, marks, names, carried flags, and tag circles.

import { DISABLED, MARKS, NAV_LOST, TAGGED } from './game.js';
import { drawBadge } from './badge.js';
import { drawFences, drawStops } from './fence.js';
import { Labels } from './label.js';
import { palette, teamColour } from './palette.js';

/** A hull of length 1, bow first: forward, starboard. */
const HULL = [[0.5, 0], [0.22, 0.42], [-0.15, 0.5], [-0.5, 0.4], [-0.5, -0.4], [-0.15, -0.5], [0.22, -0.42]];
/** The second team's stripe across the hull. */
const STRIPE = [[0.12, 0.62], [-0.12, 0.62], [-0.12, -0.62], [0.12, -0.62]];
/** Minimum length of a hull: as a fraction of the field's space for each boat, within limits in px. */
const LENGTH_SHARE = 0.3;
const LENGTH_MIN_PX = 10;
const LENGTH_FEW_PX = 20;
/** Length of the line at the bow, s. */
const AHEAD_S = 3;
/** Size of a carried flag, px. */
const FLAG_ROOM_PX = 24;
/** With more boats than this, boats out of play fade, and only boats that are selected or pointed at show circles and all letters. */
const CROWD = 24;
/** Opacity of boats that are out of play, in a crowd. */
const FADED = 0.4;

/** Traces `shape` at a position; length and width are in pixels. */
function trace(context, shape, x, y, heading, length, width) {
  const ahead = Math.sin(heading);
  const up = -Math.cos(heading);
  for (let i = 0; i < shape.length; i++) {
    const along = shape[i][0] * length;
    const across = shape[i][1] * width;
    const px = x + along * ahead - across * up;
    const py = y + along * up + across * ahead;
    if (i === 0) context.moveTo(px, py);
    else context.lineTo(px, py);
  }
  context.closePath();
}

/** Draws a hull, size in px. `look` has `team`, `idle` (out of play), `disabled`, or `ghost`: the boat's own estimated position. */
export function drawHullAt(context, x, y, heading, length, width, { team, idle = false, disabled = false, ghost = false }) {
  context.beginPath();
  trace(context, HULL, x, y, heading, length, width);
  if (ghost) {
    context.setLineDash([3, 3]);
    context.lineWidth = 1.5;
    context.strokeStyle = palette.ink;
    context.stroke();
    context.setLineDash([]);
    return;
  }
  const colour = teamColour(team);
  context.fillStyle = idle ? palette.halo : colour;
  context.fill();
  context.lineWidth = idle ? 2.25 : 1.25;
  context.strokeStyle = idle ? colour : palette.halo;
  context.stroke();
  if (team === 1) {
    context.beginPath();
    trace(context, STRIPE, x, y, heading, length, width * 0.8);
    context.fillStyle = idle ? colour : palette.halo;
    context.fill();
  }
  if (disabled) drawCross(context, x, y, length * 0.42);
}

function drawCross(context, x, y, half) {
  context.beginPath();
  context.moveTo(x - half, y - half);
  context.lineTo(x + half, y + half);
  context.moveTo(x + half, y - half);
  context.lineTo(x - half, y + half);
  context.lineWidth = 2;
  context.strokeStyle = palette.ink;
  context.stroke();
}

/** A flag on its pole, with the foot at the position. The second team's has a stripe. */
export function drawFlag(context, x, y, team, size) {
  context.beginPath();
  context.moveTo(x, y);
  context.lineTo(x, y - size * 1.7);
  context.lineWidth = 2;
  context.strokeStyle = palette.ink;
  context.stroke();
  context.beginPath();
  context.moveTo(x + 1, y - size * 1.7);
  context.lineTo(x + size * 1.35, y - size * 1.22);
  context.lineTo(x + 1, y - size * 0.74);
  context.closePath();
  context.fillStyle = teamColour(team);
  context.fill();
  context.lineWidth = 1.25;
  context.strokeStyle = palette.halo;
  context.stroke();
  if (team !== 1) return;
  context.beginPath();
  context.moveTo(x + size * 0.4, y - size * 1.5);
  context.lineTo(x + size * 0.4, y - size * 0.92);
  context.lineWidth = Math.max(1.5, size * 0.16);
  context.stroke();
}

/** Whether a position is within these corners. */
export function inside(corners, x, y) {
  let odd = false;
  for (let i = 0, j = corners.length - 1; i < corners.length; j = i++) {
    const [xi, yi] = corners[i];
    const [xj, yj] = corners[j];
    if (yi > y !== yj > y && x < ((xj - xi) * (y - yi)) / (yj - yi) + xi) odd = !odd;
  }
  return odd;
}

export class Boats {
  constructor(canvas) {
    this.canvas = canvas;
    this.context = canvas.getContext('2d');
    this.labels = new Labels();
    this.lengths = new Float32Array(0);
    this.hovered = -1;
    /** The gateways' reports on real boats. */
    this.readings = [];
    /** Their geofences. */
    this.fences = [];
    /** Their badges on the chart: index, and area: left, top, right, bottom, px. */
    this.badges = [];
    /** The letters in the last picture, for tests: index, letter. */
    this.letters = [];
  }

  /** Draws all boats at their current poses. */
  draw(game, view, shown, ratio) {
    const { context } = this;
    const selected = game.indexOf.get(game.selected) ?? -1;
    this.selected = selected;
    context.clearRect(0, 0, view.width, view.height);
    this.measure(game, view);
    drawFences(context, view, this.fences);
    this.drawFlagsAtHome(game, view);
    drawStops(context, view, this.readings, game);
    if (shown.circles) this.drawCircles(game, view);
    this.drawLeads(game, view);
    for (let i = 0; i < game.count; i++) if (i !== selected) this.drawHull(game, view, i);
    if (selected >= 0) {
      this.drawGhost(game, view, selected);
      this.drawHull(game, view, selected);
      this.drawRing(game, view, selected);
    }
    this.labels.begin(game.vehicles, view, ratio);
    this.blockHulls(game, view);
    this.drawMarks(game, view);
    this.drawBadges(game, view);
    this.drawNames(game, view, shown, selected);
  }

  /** Lengths on the chart, px. */
  measure(game, view) {
    if (this.lengths.length !== game.count) this.lengths = new Float32Array(game.count);
    const { left, right, bottom, top } = view.bounds;
    const room = view.scale * Math.sqrt(((right - left) * (top - bottom)) / Math.max(1, game.count));
    const least = Math.min(LENGTH_FEW_PX, Math.max(LENGTH_MIN_PX, LENGTH_SHARE * room));
    for (let i = 0; i < game.count; i++) this.lengths[i] = Math.max(least, game.vehicles[i].length_m * view.scale);
  }

  width(game, index) {
    const { beam_m, length_m } = game.vehicles[index];
    return this.lengths[index] * Math.min(0.62, Math.max(0.42, beam_m / length_m || 0.5));
  }

  /** Whether a boat is out of play in a crowd. */
  isFaded(game, index) {
    return game.count > CROWD && index !== this.selected && index !== this.hovered && (game.marks[index] & (TAGGED | DISABLED)) !== 0;
  }

  drawHull(game, view, index) {
    this.context.globalAlpha = this.isFaded(game, index) ? FADED : 1;
    this.drawSolid(game, view, index);
    this.context.globalAlpha = 1;
  }

  drawSolid(game, view, index) {
    const { context } = this;
    const x = view.xOf(game.x[index], game.y[index]);
    const y = view.yOf(game.x[index], game.y[index]);
    const length = this.lengths[index];
    if (x < -length || y < -length || x > view.width + length || y > view.height + length) return;
    const { team } = game.vehicles[index];
    const idle = (game.marks[index] & (TAGGED | DISABLED)) !== 0;
    const disabled = (game.marks[index] & DISABLED) !== 0;
    drawHullAt(context, x, y, game.heading[index] - view.up_rad, length, this.width(game, index), { team, idle, disabled });
    if (game.carrying[index] >= 0) {
      const flag = game.chart.field?.flags?.[game.carrying[index]];
      drawFlag(context, x, y, flag ? flag.team : 0, Math.max(11, length * 0.55));
    }
  }

  /** Lines from the bows along the course over the ground, a few seconds long. */
  drawLeads(game, view) {
    const { context } = this;
    for (let team = 0; team < palette.teams.length; team++) {
      context.beginPath();
      for (let i = 0; i < game.count; i++) {
        if (game.vehicles[i].team !== team || game.speed[i] < 0.05 || this.isFaded(game, i)) continue;
        const reach = this.lengths[i] / 2 + game.speed[i] * AHEAD_S * view.scale;
        const x = view.xOf(game.x[i], game.y[i]);
        const y = view.yOf(game.x[i], game.y[i]);
        context.moveTo(x, y);
        context.lineTo(x + Math.sin(game.course[i] - view.up_rad) * reach, y - Math.cos(game.course[i] - view.up_rad) * reach);
      }
      context.lineWidth = 1.25;
      context.strokeStyle = teamColour(team);
      context.stroke();
    }
  }

  /** Tag circles of boats in play in their own zone. */
  drawCircles(game, view) {
    const radius = game.chart.radii?.tag_m * view.scale;
    const zones = game.chart.field?.zones;
    if (!(radius > 3) || !zones) return;
    const { context } = this;
    const crowded = game.count > CROWD;
    context.lineWidth = 1;
    context.setLineDash([3, 4]);
    context.globalAlpha = 0.8;
    for (let team = 0; team < palette.teams.length; team++) {
      context.beginPath();
      for (let i = 0; i < game.count; i++) {
        if (game.vehicles[i].team !== team || game.marks[i] & (TAGGED | DISABLED)) continue;
        if (crowded && i !== this.selected && i !== this.hovered) continue;
        if (!zones.some((zone) => zone.team === team && inside(zone.corners, game.x[i], game.y[i]))) continue;
        const x = view.xOf(game.x[i], game.y[i]);
        const y = view.yOf(game.x[i], game.y[i]);
        context.moveTo(x + radius, y);
        context.arc(x, y, radius, 0, 2 * Math.PI);
      }
      context.strokeStyle = teamColour(team);
      context.stroke();
    }
    context.globalAlpha = 1;
    context.setLineDash([]);
  }

  drawFlagsAtHome(game, view) {
    const flags = game.chart.field?.flags ?? [];
    for (let i = 0; i < flags.length; i++) {
      if (game.carrierOf(i) < 0) drawFlag(this.context, view.xOf(flags[i].x, flags[i].y), view.yOf(flags[i].x, flags[i].y), flags[i].team, 14);
    }
  }

  /** The selected boat's own estimated position. */
  drawGhost(game, view, index) {
    const { context } = this;
    const ghost = game.estimate;
    if (!ghost) return;
    const x = view.xOf(ghost.x, ghost.y);
    const y = view.yOf(ghost.x, ghost.y);
    const heading = (ghost.heading_deg * Math.PI) / 180 - view.up_rad;
    drawHullAt(context, x, y, heading, this.lengths[index], this.width(game, index), { ghost: true });
  }

  drawRing(game, view, index) {
    const { context } = this;
    const radius = this.lengths[index] * 0.5 + 9;
    const x = view.xOf(game.x[index], game.y[index]);
    const y = view.yOf(game.x[index], game.y[index]);
    context.lineWidth = 2.25;
    context.strokeStyle = palette.accent;
    for (let quarter = 0; quarter < 4; quarter++) {
      const middle = Math.PI / 4 + (quarter * Math.PI) / 2;
      context.beginPath();
      context.arc(x, y, radius, middle - 0.45, middle + 0.45);
      context.stroke();
    }
  }

  /** The marks shown as letters. In a crowd, only the hull shows that a boat is out of play. */
  lettersOf(game, index) {
    const plain = game.count > CROWD && index !== this.selected && index !== this.hovered;
    return plain ? game.marks[index] & ~(TAGGED | DISABLED) : game.marks[index];
  }

  /** Letters above boats with a fault or penalty. In a crowd, those that would cover boats or other letters are omitted. */
  drawMarks(game, view) {
    const { context } = this;
    context.font = '700 11px system-ui, sans-serif';
    context.textAlign = 'center';
    context.textBaseline = 'middle';
    this.letters = [];
    for (let i = 0; i < game.count; i++) {
      const letters = this.lettersOf(game, i);
      if (letters === 0) continue;
      context.globalAlpha = this.isFaded(game, i) ? FADED : 1;
      let x = view.xOf(game.x[i], game.y[i]) + this.lengths[i] * 0.35 + 5;
      const y = view.yOf(game.x[i], game.y[i]) - this.lengths[i] * 0.35 - 7;
      for (let mark = 0; mark < MARKS.length; mark++) {
        if ((letters & MARKS[mark][0]) === 0) continue;
        const isChosen = i === this.selected || i === this.hovered;
        if (game.count > CROWD && !this.labels.claim(x - 6.5, y - 6.5, x + 6.5, y + 6.5) && !isChosen) break;
        this.labels.block(x - 6.5, y - 6.5, x + 6.5, y + 6.5);
        context.fillStyle = palette.ink;
        context.fillRect(x - 6.5, y - 6.5, 13, 13);
        context.fillStyle = palette.paper;
        context.fillText(MARKS[mark][1], x, y + 0.5);
        this.letters.push([i, MARKS[mark][1]]);
        x += 14;
      }
      if (game.marks[i] & NAV_LOST) this.drawLostRing(view.xOf(game.x[i], game.y[i]), view.yOf(game.x[i], game.y[i]), this.lengths[i]);
    }
    context.globalAlpha = 1;
  }

  /** Badges below real boats. */
  drawBadges(game, view) {
    this.badges = [];
    for (const reading of this.readings) {
      const [x, y] = [view.xOf(game.x[reading.index], game.y[reading.index]), view.yOf(game.x[reading.index], game.y[reading.index])];
      if (game.frames === 0 || x < 0 || y < 0 || x > view.width || y > view.height) continue;
      const room = this.lengths[reading.index] * 0.5 + (reading.index === this.selected ? 14 : 7);
      const area = drawBadge(this.context, view, this.labels, reading, x, y, room);
      if (area) this.badges.push({ index: reading.index, area });
    }
  }

  drawLostRing(x, y, length) {
    const { context } = this;
    context.beginPath();
    context.arc(x, y, length * 0.8, 0, 2 * Math.PI);
    context.setLineDash([2, 5]);
    context.lineWidth = 2;
    context.strokeStyle = palette.danger;
    context.stroke();
    context.setLineDash([]);
  }

  /** Opacity of names; falls as boats get crowded. */
  nameStrength(game, view) {
    const { left, right, bottom, top } = view.bounds;
    const room = Math.sqrt(((right - left) * (top - bottom)) / Math.max(1, game.count)) * view.scale;
    return Math.min(1, Math.max(0, (room - 56) / 24));
  }

  /** Half the extent of a hull on the chart, horizontally and vertically, px. */
  extent(game, view, index) {
    const heading = game.heading[index] - view.up_rad;
    const across = Math.abs(Math.sin(heading));
    const along = Math.abs(Math.cos(heading));
    const [length, width] = [this.lengths[index] / 2, this.width(game, index) / 2];
    return [across * length + along * width, along * length + across * width];
  }

  /** The areas of all hulls, for tests. */
  hulls(game, view) {
    return game.vehicles.map(({ name }, i) => {
      const [right, down] = this.extent(game, view, i);
      const [x, y] = [view.xOf(game.x[i], game.y[i]), view.yOf(game.x[i], game.y[i])];
      return { name, left: x - right, top: y - down, right: x + right, bottom: y + down };
    });
  }

  drawNames(game, view, shown, selected) {
    const { context, labels } = this;
    const strength = shown.names ? this.nameStrength(game, view) : 0;
    if (strength <= 0.02 && selected < 0 && this.hovered < 0) return;
    const single = (index, alpha, wanted) => {
      const x = view.xOf(game.x[index], game.y[index]);
      const y = view.yOf(game.x[index], game.y[index]);
      if (x < -60 || y < -20 || x > view.width + 60 || y > view.height + 20) return;
      context.globalAlpha = alpha;
      labels.draw(context, index, x, y, this.lengths[index] * 0.5 + 4 + (index === selected ? 8 : 0), wanted);
    };
    if (selected >= 0) single(selected, 1, true);
    if (this.hovered >= 0 && this.hovered !== selected && this.hovered < game.count) single(this.hovered, 1, true);
    for (let i = 0; i < game.count && strength > 0.02; i++) {
      if (i !== selected && i !== this.hovered && !this.isFaded(game, i)) single(i, strength, false);
    }
    context.globalAlpha = 1;
  }

  /** Keeps letters, badges and names clear of boats and carried flags. */
  blockHulls(game, view) {
    const { labels } = this;
    for (let i = 0; i < game.count; i++) {
      const x = view.xOf(game.x[i], game.y[i]);
      const y = view.yOf(game.x[i], game.y[i]);
      const [right, down] = this.extent(game, view, i);
      labels.block(x - right, y - down, x + right, y + down);
      if (game.carrying[i] >= 0) labels.block(x, y - FLAG_ROOM_PX, x + FLAG_ROOM_PX * 0.7, y);
    }
    (game.chart.field?.flags ?? []).forEach((flag, i) => {
      if (game.carrierOf(i) < 0) labels.block(view.xOf(flag.x, flag.y), view.yOf(flag.x, flag.y) - FLAG_ROOM_PX, view.xOf(flag.x, flag.y) + 19, view.yOf(flag.x, flag.y));
    });
  }

  /** The boat at a pixel, or -1. */
  at(game, view, px, py, reach) {
    let best = -1;
    let least = reach;
    for (let i = 0; i < game.count; i++) {
      const far = Math.hypot(view.xOf(game.x[i], game.y[i]) - px, view.yOf(game.x[i], game.y[i]) - py) - this.lengths[i] / 2;
      if (far < least) {
        least = far;
        best = i;
      }
    }
    return best;
  }
}
