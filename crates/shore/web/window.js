// `window.squall`, the part of the page that tests may read; described at the top of page.js.

import { wrapDeg } from './words.js';

const degrees = (rad) => wrapDeg((rad * 180) / Math.PI);

function boatOf(game, index) {
  const truth = game.raw.vehicles[index];
  const { name, team } = game.vehicles[index];
  return {
    name, team, x: game.toX[index], y: game.toY[index], heading_deg: degrees(game.toH[index]), course_deg: degrees(game.course[index]),
    speed_m_s: game.speed[index], tagged: truth.tagged, carrying: truth.carrying, disabled: truth.disabled, outside: truth.outside,
    agent_lost: truth.agent_lost, quarantined: truth.quarantined, nav_lost: truth.nav_lost,
  };
}

function frameOf(game) {
  if (game.frames === 0) return null;
  const count = Math.min(game.count, game.raw.vehicles.length);
  const boats = Array.from({ length: count }, (_, index) => boatOf(game, index));
  return { t_s: game.t_s, tick: game.tick, stopped: game.stopped, over: game.over, boats };
}

function flagsOf(game) {
  return (game.chart.field?.flags ?? []).map(({ team, x, y }, index) => {
    const carrier = game.carrierOf(index);
    if (carrier < 0) return { team, x, y, carrier: null };
    return { team, x: game.toX[carrier], y: game.toY[carrier], carrier: game.vehicles[carrier].name };
  });
}

/** Publishes `window.squall`. */
export function expose(page) {
  const { game, link, stats, view, drive } = page;
  const readers = {
    mode: () => game.mode, hello: () => game.hello, state: () => game.state, player: () => game.player,
    connected: () => link.connected, t_s: () => game.t_s, score: () => [...game.score], frame: () => frameOf(game), flags: () => flagsOf(game),
    events: () => [...game.events], selected: () => game.selected, following: () => page.following, driving: () => drive.vehicle,
    modes: () => game.modes, hulls: () => page.boats.hulls(game, view), labels: () => page.boats.labels.boxes(),
    helm: () => game.helm, estimate: () => game.estimate, statuses: () => Object.fromEntries(game.statuses),
    badges: () => page.readings.map(({ name, kind, label, detail, index }) => ({ name, kind, label, detail, area: page.boats.badges.find((badge) => badge.index === index)?.area ?? null })),
    letters: () => page.boats.letters.map(([index, letter]) => ({ name: game.vehicles[index].name, letter })),
    alarms: () => page.alarms.waiting.map(({ boat, text, active }) => ({ boat, text, active })),
    sounded: () => page.alarms.sound.played, fences: () => page.boats.fences,
    stops: () => page.readings.filter(({ fence }) => fence).map(({ name, fence }) => ({ name, stopping_m: fence.stopping_m, clearance_m: fence.clearance_m })),
    background: () => page.background.drawn,
    drawn: () => stats.drawn, fps: () => stats.fps, draw_ms: () => stats.draw_ms,
    measured: () => {
      const { range_m, bearing_deg } = (page.measure.ends.length === 2 && page.measure.reading(game, view)) || {};
      return range_m === undefined ? null : { range_m, bearing_deg };
    },
    view: () => ({ x: view.centreX, y: view.centreY, scale: view.scale, up_deg: view.up_deg }),
    span: () => ({ from_s: page.span.from_s, to_s: page.span.to_s, pointed_s: page.span.pointed_s }),
  };
  const squall = {};
  for (const [name, get] of Object.entries(readers)) Object.defineProperty(squall, name, { get, enumerable: true });
  Object.defineProperty(window, 'squall', { value: Object.freeze(squall) });
}
