// The geofences of real boats, their keep-outs, and the stopping distance of each boat.

import { haloText } from './field.js';
import { palette } from './palette.js';

const FONT = '600 11px system-ui, sans-serif';
/** Size of the mark where a boat would come to rest, px. */
const REST_PX = 4;

/** Traces corners `[x, y]`, m. */
export function traceCorners(context, view, corners) {
  context.beginPath();
  corners.forEach(([x, y], index) => {
    if (index === 0) context.moveTo(view.xOf(x, y), view.yOf(x, y));
    else context.lineTo(view.xOf(x, y), view.yOf(x, y));
  });
  context.closePath();
}

const places = (corners) => corners.map(({ east, north }) => [east, north]);

/** The gateways' geofences, equal ones only once: `{ outline, keepOuts }`, corners `[x, y]` in m. */
export function fencesOf(readings) {
  const fences = new Map();
  for (const { fence } of readings) {
    if (!(fence?.outline?.length > 0)) continue;
    const outline = places(fence.outline);
    const keepOuts = (fence.keep_out ?? []).map(places);
    fences.set(JSON.stringify([outline, keepOuts]), { outline, keepOuts });
  }
  return [...fences.values()];
}

/** A line that is visible on water, land and images. */
function rim(context, dash) {
  context.lineWidth = 4;
  context.strokeStyle = palette.halo;
  context.stroke();
  context.setLineDash(dash);
  context.lineWidth = 2;
  context.strokeStyle = palette.danger;
  context.stroke();
  context.setLineDash([]);
}

export function drawFences(context, view, fences) {
  context.font = FONT;
  context.textAlign = 'left';
  context.textBaseline = 'bottom';
  for (const { outline, keepOuts } of fences) {
    traceCorners(context, view, outline);
    rim(context, [12, 5]);
    const [x, y] = outline.reduce((most, corner) => {
      const [higher, righter] = [view.yOf(...most) - view.yOf(...corner), view.xOf(...corner) - view.xOf(...most)];
      return higher > 0 || (higher === 0 && righter < 0) ? corner : most;
    });
    haloText(context, 'geofence', Math.max(4, view.xOf(x, y)), Math.max(14, view.yOf(x, y) - 3));
    for (const corners of keepOuts) drawKeepOut(context, view, corners);
  }
}

function drawKeepOut(context, view, corners) {
  traceCorners(context, view, corners);
  context.globalAlpha = 0.16;
  context.fillStyle = palette.danger;
  context.fill();
  context.globalAlpha = 1;
  rim(context, [4, 4]);
  const [x, y] = [0, 1].map((axis) => corners.reduce((sum, corner) => sum + corner[axis], 0) / corners.length);
  context.textAlign = 'center';
  haloText(context, 'keep out', view.xOf(x, y), view.yOf(x, y) + 5);
  context.textAlign = 'left';
}

/** The stopping circle of each real boat, and the point where it would come to rest. */
export function drawStops(context, view, readings, game) {
  for (const { fence, index, kind } of readings) {
    if (kind === 'silent' || !(fence?.stopping_m > 0) || game.frames === 0) continue;
    const tight = fence.clearance_m < fence.stopping_m;
    context.beginPath();
    context.arc(view.xOf(game.x[index], game.y[index]), view.yOf(game.x[index], game.y[index]), fence.stopping_m * view.scale, 0, 2 * Math.PI);
    context.lineWidth = tight ? 2.5 : 1.5;
    context.strokeStyle = tight ? palette.danger : palette.ink;
    context.setLineDash([2, 3]);
    context.stroke();
    context.setLineDash([]);
    if (!fence.stops_at) continue;
    const [x, y] = [view.xOf(fence.stops_at.east, fence.stops_at.north), view.yOf(fence.stops_at.east, fence.stops_at.north)];
    context.beginPath();
    for (const way of [-1, 1]) {
      context.moveTo(x - REST_PX, y - way * REST_PX);
      context.lineTo(x + REST_PX, y + way * REST_PX);
    }
    context.lineWidth = 1.75;
    context.stroke();
  }
}
