// The page: connects the link, the game and all views, and draws.
//
// `window.squall` is readable for tests and debugging (nothing in it can be set):
//   mode, hello, state, player    as last sent by the server; null before
//   connected, t_s, score         score by team
//   frame                         { t_s, tick, stopped, over, boats: [{ name, team, x, y, heading_deg, course_deg, speed_m_s,
//                                 tagged, carrying, disabled, outside, agent_lost, quarantined, nav_lost }] }; null before;
//                                 carrying is the index of a flag, or -1
//   flags                         [{ team, x, y, carrier }]: current positions; carrier is a boat's name, or null
//   events                        all known; in a live game the newest 20000
//   selected, following, driving  a boat's name or null; whether it is followed; a boat's name or null
//   helm, estimate                of the selected boat, as sent; null if missing
//   modes                         of all boats' helms, as sent; null before
//   hulls, labels                 [{ name, left, top, right, bottom }]: areas of boats and names on the chart, px
//   statuses                      of gateways, by boat
//   letters                       [{ name, letter }] of marks on the chart
//   badges, alarms, sounded       [{ name, kind, label, detail, area }] of real boats, area as [left, top, right, bottom], px, or null; [{ boat, text, active }] not acknowledged; tones played so far
//   fences, stops                 [{ outline, keepOuts }] of real boats; [{ name, stopping_m, clearance_m }]
//   background                    whether an image or a shoreline is shown beneath the field
//   drawn, fps, draw_ms           frames drawn; pictures per second; mean time to draw a picture
//   view                          { x, y, scale, up_deg }: centre, pixels per metre, and the bearing that is up
//   span                          { from_s, to_s, pointed_s }: the section that the timeline shows, and the moment pointed at, or null
//   measured                      { range_m, bearing_deg }; null before two ends are chosen
//
// Elements with stable ids: score-<team>, clock, rate, phase, rights, connection, notices, events, boat-list, rose,
// rose-function, events-fold, show-plots, plots, plot-boats, plot-add, time-in, time-out, time-whole, timeline-tip, north-up, side-hide, side-show,
// side-edge, plots-edge, pane-events-edge, share, png, film, gif, boat-search, boat-order, boat-states, behaviours, variables, gateway, helm-reason, follow,
// drive, boat-facts, boat-badge, checks, operated, operate, operate-<command>, mission-file, operator-token, alarms, mute, acknowledge-all, show-chart, draw-
// fence, fence-toml, fence-part, fence-<action>,
// deselect, steering, pause, step, step-back, speed, halt, halt-confirm, halt-cancel, estop, estop-confirm, estop-cancel, stop,
// stop-confirm, stop-cancel, timeline, event-kind, event-back, event-next, event-filter, tab-boats, tab-boat, tab-events, tab-game,
// watch, zoom-in, zoom-out, fit, show-names, show-trails, show-circles, show-waves, show-legend, dark, measure, measured, place, help, help-
// box, sheet.

import { addressOfReport, gameOfReport, name as nameMoment, wanted } from './address.js';
import { Alarms } from './alarm.js';
import { Background } from './background.js';
import { Boats } from './boats.js';
import { Capture } from './capture.js';
import { Controls } from './controls.js';
import { Details, isBare } from './details.js';
import { Drive } from './drive.js';
import { fencesOf } from './fence.js';
import { FenceEditor } from './fence_editor.js';
import { drawField } from './field.js';
import { Game } from './game.js';
import { readStatuses } from './gateway.js';
import { Keys } from './keys.js';
import { Link } from './link.js';
import { Legend } from './legend.js';
import { BoatList } from './list.js';
import { Log } from './log.js';
import { Measure } from './measure.js';
import { North } from './north.js';
import { palette } from './palette.js';
import { Panels } from './panels.js';
import { Plots } from './plots.js';
import { Pointer } from './pointer.js';
import { Sea, Weather } from './sea.js';
import { Span } from './span.js';
import { notice, Status } from './status.js';
import { Tabs } from './tabs.js';
import { Theme } from './theme.js';
import { Timeline } from './timeline.js';
import { TrailLayer } from './trail.js';
import { View } from './view.js';
import { WhatIf } from './what_if.js';
import { expose } from './window.js';
import { plain, show, write } from './words.js';

/** Interval at which text is updated, ms. */
const TELL_MS = 200;
/** The same for the details of the selected boat. */
const DETAILS_MS = 40;
/** The same for the list of boats. */
const LIST_EVERY = 3;
/** Time after which a page without a game reports this, ms. */
const MISSING_MS = 1500;
/** The longest game, s. */
const GAME_MAX_S = 86_400;
/** Maximum distance of the pointer from a boat, px. */
const REACH_MOUSE_PX = 8;
const REACH_TOUCH_PX = 22;

const byId = (id) => document.getElementById(id);

class Page {
  constructor() {
    this.game = new Game();
    this.view = new View();
    const send = (message) => this.send(message);
    this.link = new Link({
      lost: (unheard, displaced) => this.lost(unheard, displaced),
      message: (message) => this.take(message),
      frame: (kind, buffer) => this.game.takeFrame(kind, buffer, performance.now()),
    });
    this.sheet = byId('sheet');
    this.layers = ['sea', 'field', 'trails', 'boats'].map((name) => byId(`layer-${name}`));
    this.sea = new Sea(this.layers[0]);
    this.field = this.layers[1].getContext('2d');
    this.trails = new TrailLayer(this.layers[2]);
    this.boats = new Boats(this.layers[3]);
    this.weather = new Weather();
    this.theme = new Theme();
    this.legend = new Legend();
    this.measure = new Measure({ changed: () => { this.drawnBoats = ''; } });
    this.fenceEditor = new FenceEditor({ changed: () => { this.drawnBoats = ''; } });
    this.status = new Status(() => this.timeline.watch());
    this.controls = new Controls(send);
    this.drive = new Drive(send);
    this.span = new Span();
    this.panels = new Panels();
    this.timeline = new Timeline(send, this.span);
    this.whatIf = new WhatIf(send, () => this.timeline.at_s);
    this.north = new North(this.view, [this.drive]);
    this.plots = new Plots({ send: (message) => this.link.send(message), seek: (t_s) => this.timeline.seek(t_s), span: this.span });
    this.capture = new Capture(this.layers, this.game);
    this.list = new BoatList({ choose: (name) => this.look(name), hover: (at) => { this.boats.hovered = at; } });
    this.log = new Log((event) => this.goTo(event));
    this.details = new Details({
      follow: () => this.toggleFollow(), drive: () => this.toggleDrive(), close: () => this.select(null), send,
      acknowledge: (name) => this.alarms.acknowledge((alarm) => alarm.boat === name),
    });
    this.north.dials.push(this.details.rose);
    this.alarms = new Alarms({ choose: (name) => this.look(name) });
    this.background = new Background({ changed: () => { this.drawnField = ''; } });
    this.background.load();
    /** The gateways' reports on real boats. */
    this.readings = [];
    this.following = false;
    this.asked = '';
    this.askedModes = false;
    this.stats = { drawn: 0, fps: 0, draw_ms: 0, last_ms: 0 };
    this.drawnField = '';
    this.drawnBoats = '';
    this.ticks = 0;
    this.told_ms = 0;
    this.bind();
    this.keys = new Keys(this);
  }

  bind() {
    show(byId('back'), gameOfReport() !== null);
    byId('back').href = addressOfReport();
    byId('zoom-in').addEventListener('click', () => this.zoom(1.4));
    byId('zoom-out').addEventListener('click', () => this.zoom(1 / 1.4));
    byId('share').addEventListener('click', () => this.share());
    addEventListener('hashchange', () => this.game.hello && this.goToAddress());
    byId('fit').addEventListener('click', () => this.fit());
    this.tabs = new Tabs({ changed: (name, wide) => this.tabbed(name, wide) });
    this.tab('boats');
    this.pointer = new Pointer(this.sheet, this.view, {
      tap: (x, y, touch) => this.tap(x, y, touch),
      hover: (x, y) => this.hover(x, y),
      moved: () => this.setFollowing(false),
      zoomed: () => {},
    });
    new ResizeObserver(() => this.resize()).observe(this.sheet);
    this.resize();
  }

  start() {
    this.link.start();
    setInterval(() => this.tell(), TELL_MS);
    const loop = (now_ms) => {
      // Request the next picture first, so that an error in this one does not stop it.
      requestAnimationFrame(loop);
      this.draw(now_ms);
    };
    requestAnimationFrame(loop);
  }

  /** Sends a command; shows a notice if that fails. */
  send(message) {
    if (this.link.send(message) || message.do === 'drive' || message.do === 'let_go') return;
    notice('No connection. The command was not sent.');
  }

  lost(unheard, displaced) {
    this.drive.letGo();
    if (unheard) notice('The connection broke before the server replied. The last command may not have arrived.');
    document.body.classList.add('lost');
    write(byId('connection'), displaced
      ? 'Too many pages are open, and another one replaced this one. Reconnecting in half a minute.'
      : 'Connection lost. Reconnecting.');
    show(byId('connection'), true);
  }

  take(message) {
    const { game } = this;
    switch (message.kind) {
      case 'hello': return this.greet(message);
      case 'preparing': return this.wait(message);
      case 'state': game.state = message; break;
      case 'player':
        game.player = message;
        this.whatIf.setRecording(message.file);
        break;
      case 'events':
        game.takeEvents(message);
        this.controls.tellEvents(message.events ?? [], message.reset);
        break;
      case 'helm':
        if (message.vehicle !== game.selected) break;
        game.helm = message;
        this.due = true;
        break;
      case 'modes': game.modes = message.modes; break;
      case 'curves':
        this.plots.curves.take(message);
        this.timeline.takeScore(message);
        break;
      case 'what_if': this.whatIf.take(message); break;
      case 'estimate': if (message.vehicle === game.selected) game.estimate = message; break;
      case 'status': game.takeStatus(message, performance.now()); break;
      case 'operated': this.details.operate.hear(message); break;
      case 'drive':
        game.drivers.set(message.vehicle, message.by);
        this.drive.hear(message);
        break;
      case 'refused':
        // A refused page does not drive.
        if (message.what === 'drive') this.drive.letGo();
        if (['operate', 'mission'].includes(message.what)) return this.details.operate.refuse(message.reason);
        notice(`Not done: ${plain(message.what)}. ${message.reason}`);
        break;
      // Unknown kinds come from newer servers.
      default: return;
    }
    if (message.kind === 'state') this.drive.hearState(message);
    if (message.kind === 'state' || message.kind === 'player') this.controls.tell(game);
  }

  /** There is no game yet: shows the progress or the failure. */
  wait({ text, failed }) {
    this.link.tries = 0;
    document.body.classList.add('unplayed');
    document.body.classList.remove('lost');
    show(byId('connection'), false);
    const ofReport = gameOfReport() !== null;
    if (!failed || ofReport) write(byId('about'), text);
    write(byId('phase'), !failed ? 'preparing' : ofReport ? 'no game' : 'connecting');
    this.waiting = true;
    clearTimeout(this.missing);
    // `squall run` opens the page before its game.
    if (failed && !ofReport) this.missing = setTimeout(() => this.waiting && this.status.tellNone(text), MISSING_MS);
  }

  greet(hello) {
    const { game } = this;
    this.waiting = false;
    clearTimeout(this.missing);
    show(byId('over'), false);
    document.body.classList.remove('unplayed');
    write(byId('about'), hello.about ?? '');
    const [before, wasLive] = [game.selected, game.mode === 'live'];
    const sameField = game.chart.field && JSON.stringify(game.chart.field) === JSON.stringify(hello.chart.field);
    this.drive.letGo();
    try {
      game.greet(hello);
    } catch (error) {
      notice(`This page cannot read the server's frames: ${error.message}`);
    }
    document.body.classList.remove('connecting', 'lost');
    document.body.classList.toggle('replay', hello.mode === 'replay');
    document.body.classList.toggle('real', hello.mode === 'live' && game.vehicles.some(({ external }) => external));
    this.background.greet(hello.chart);
    this.whatIf.greet(hello);
    this.alarms.greet(hello);
    show(byId('connection'), false);
    const field = hello.chart.field;
    if (!sameField && field) this.view.setBounds([...field.corners, ...(field.flags ?? []).map(({ x, y }) => [x, y])]);
    this.sea.greet(hello.chart.waves);
    this.boats.hovered = -1;
    this.measure.forget();
    this.fenceEditor.greet(hello.chart);
    this.status.greet(game);
    this.controls.greet(hello);
    this.list.greet(game);
    this.timeline.greet(game);
    this.plots.greet(game);
    this.drawnField = '';
    this.asked = '';
    this.askedModes = false;
    if (game.indexOf.has(before)) this.select(before);
    else this.setFollowing(false);
    this.begin(game.greeted === 1, wasLive);
    this.tell();
  }

  /** A replay starts at the address's moment, or else plays. A replay shown after its own game stays paused, with the final score. */
  begin(first, wasLive) {
    const isMoved = first && this.goToAddress();
    if (this.game.mode !== 'replay' || isMoved) return;
    if (first) this.link.send({ do: 'control', what: 'resume' });
    else if (wasLive) this.link.send({ do: 'seek', t_s: GAME_MAX_S });
  }

  /** Goes to the address's moment and boat. Returns whether it has a moment. */
  goToAddress() {
    const { t_s, boat } = wanted();
    if (boat !== null) this.look(boat);
    if (t_s === null || this.game.mode !== 'replay') return false;
    this.link.send({ do: 'control', what: 'pause' });
    this.link.send({ do: 'seek', t_s });
    return true;
  }

  /** Puts what is shown into the address, and copies the address to the clipboard. */
  async share() {
    const address = nameMoment(this.game.t_s, this.game.selected);
    try {
      await navigator.clipboard.writeText(address);
      notice('Link copied.');
    } catch {
      notice('The browser’s address now shows this moment: copy it from there.');
    }
  }

  /** Selects a boat, or none. `look` opens its details. */
  select(name, look = false) {
    const { game } = this;
    if (name !== null && !game.indexOf.has(name)) return;
    if (name !== game.selected) {
      if (this.drive.driving) this.drive.letGo();
      game.select(name);
    }
    if (name === null) this.setFollowing(false);
    if (look) this.tab('boat');
    else if (name === null && this.tabs.name === 'boat') this.tab('boats');
    this.tell();
  }

  /** Selects a boat anywhere, and moves the chart to it. */
  look(name) {
    const index = this.game.indexOf.get(name);
    if (index === undefined) return;
    this.select(name, true);
    if (this.game.frames > 0) this.view.bringIn(this.game.toX[index], this.game.toY[index]);
  }

  selectNext(by) {
    const { count, indexOf, selected, vehicles } = this.game;
    if (count === 0) return;
    const at = indexOf.get(selected);
    const next = at === undefined ? (by > 0 ? 0 : count - 1) : (at + by + count) % count;
    this.look(vehicles[next].name);
  }

  /** Requests the helm and the estimate of the selected boat if the selection has changed. */
  ask() {
    const modes = this.list.visible && !document.hidden;
    if (this.game.hello && modes !== this.askedModes && this.link.send({ do: 'modes', wanted: modes })) this.askedModes = modes;
    const vehicle = this.game.selected;
    const functions = vehicle !== null && this.details.visible;
    const key = `${vehicle} ${functions}`;
    if (key === this.asked || !this.game.hello) return;
    if (vehicle === null && this.asked === '') return;
    if (!this.link.send({ do: 'select', vehicle, functions })) return;
    this.asked = key;
    // Known data may date from before the page was hidden.
    if (functions && isBare(this.game.helm?.report)) this.game.helm = null;
  }

  tap(x, y, touch) {
    this.sheet.focus({ preventScroll: true });
    const at = this.boats.at(this.game, this.view, x, y, touch ? REACH_TOUCH_PX : REACH_MOUSE_PX);
    const place = this.view.placeOf(x, y);
    if (this.fenceEditor.active) this.fenceEditor.take(...place);
    else if (this.measure.active) this.measure.take(at >= 0 ? { boat: at } : { x: place[0], y: place[1] });
    else if (at >= 0) this.select(this.game.vehicles[at].name, true);
  }

  /** Enter adds a corner of a geofence at the chart's centre, or an end of a measurement at the selected boat or the centre. */
  takeHere() {
    if (this.fenceEditor.active) {
      this.fenceEditor.take(this.view.centreX, this.view.centreY);
      return true;
    }
    if (!this.measure.active) return false;
    const boat = this.game.indexOf.get(this.game.selected);
    this.measure.take(boat === undefined ? { x: this.view.centreX, y: this.view.centreY } : { boat });
    return true;
  }

  hover(x, y) {
    this.measure.point(x, y);
    this.boats.hovered = this.boats.at(this.game, this.view, x, y, REACH_MOUSE_PX);
    this.sheet.classList.toggle('over-boat', this.boats.hovered >= 0);
  }

  /** Zooms at the selected boat if it is on the chart, or else at the centre. */
  zoom(factor) {
    const { game, view } = this;
    const index = game.frames > 0 ? game.indexOf.get(game.selected) : undefined;
    const [x, y] = index === undefined ? [-1, -1] : [view.xOf(game.x[index], game.y[index]), view.yOf(game.x[index], game.y[index])];
    const within = x >= 0 && y >= 0 && x <= view.width && y <= view.height;
    view.zoomAt(within ? x : view.width / 2, within ? y : view.height / 2, factor);
  }

  fit() {
    this.setFollowing(false);
    this.view.fit();
  }

  pan(dx, dy) {
    this.setFollowing(false);
    this.view.panBy(dx, dy);
  }

  setFollowing(following) {
    if (this.following === following) return;
    this.following = following && this.game.selected !== null;
    this.details.tell(this.game, this.following, this.driver, this.readings);
  }

  toggleFollow() {
    this.setFollowing(!this.following);
  }

  get driver() {
    return this.game.drivers.get(this.game.selected) ?? null;
  }

  toggleDrive() {
    const { game, drive } = this;
    const index = game.indexOf.get(game.selected);
    if (drive.driving) drive.letGo();
    else if (this.driver === 'other') notice(`Another page is driving ${plain(game.selected)}.`);
    else if (index !== undefined && game.vehicles[index].teleop && game.mode === 'live' && game.hello.rights) {
      drive.take(game.vehicles[index], (game.heading[index] * 180) / Math.PI);
    }
    this.tell();
  }

  /** Goes to an event: selects its boat and, in a replay, its moment. */
  goTo(event) {
    const { game } = this;
    if (game.mode === 'replay') this.timeline.seek(this.timeline.seen_s(event.at_s));
    const index = game.indexOf.get(event.vehicle);
    if (index === undefined) return;
    this.select(event.vehicle);
    if (game.mode === 'replay') this.setFollowing(true);
    else this.view.centreOn(game.toX[index], game.toY[index]);
  }

  /** Opens the list of boats with its search field. */
  find() {
    this.tab('boats');
    this.list.roster.find();
  }

  tab(name) {
    this.tabs.show(name);
  }

  tabbed(name, wide) {
    this.log.under(name, wide);
    if (this.game.hello) this.tell();
  }

  /** Writes all text that does not belong to a single frame. */
  tell() {
    const { game } = this;
    this.ticks += 1;
    this.ask();
    game.smooth = game.mode === 'replay' ? game.player?.speed !== null : game.state?.speed !== null;
    if (!this.waiting) this.status.tell(game, this.link.connected, this.controls.eStopped);
    if (!game.hello) return;
    this.controls.tell(game);
    this.tellReal(performance.now());
    this.details.tell(game, this.following, this.driver, this.readings);
    if (this.ticks % LIST_EVERY === 0 || this.list.selected !== game.selected) this.list.tell(game, this.readings);
    this.log.tell(game);
    this.timeline.tell(game);
    this.plots.tell(game);
    this.weather.tell(game.sea, this.sea.deviation_m);
    this.legend.tell(game, this.controls.shown.legend);
    this.measure.tell(game, this.view);
    if (document.hidden) this.status.tellFrame(game);
  }

  /** Writes the details for each new frame and report: at ten times real time the other text would lag the chart by seconds. */
  tellDetails(now_ms) {
    const { game } = this;
    if (game.selected === null || (game.frames === this.toldFrames && !this.due) || now_ms - this.told_ms < DETAILS_MS) return;
    Object.assign(this, { toldFrames: game.frames, told_ms: now_ms, due: false });
    this.details.tell(game, this.following, this.driver, this.readings);
  }

  /** The gateways' reports on real boats: badges and alarms. */
  tellReal(now_ms) {
    const { game } = this;
    this.readings = readStatuses(game, now_ms);
    this.boats.readings = this.readings;
    this.boats.fences = fencesOf(this.readings);
    this.fenceEditor.tell(this.boats.fences);
    this.view.widen(this.boats.fences.flatMap(({ outline }) => outline));
    this.badged = this.readings.map(({ label, detail }) => `${label} ${detail}`).join();
    this.alarms.tell(this.readings, { live: game.mode === 'live', connected: this.link.connected }, now_ms);
  }

  resize() {
    const { clientWidth, clientHeight } = this.sheet;
    this.ratio = Math.min(2, devicePixelRatio || 1);
    // The canvas of the sea sets its own size.
    for (const canvas of this.layers.slice(1)) {
      canvas.width = Math.max(1, Math.round(clientWidth * this.ratio));
      canvas.height = Math.max(1, Math.round(clientHeight * this.ratio));
      canvas.getContext('2d').setTransform(this.ratio, 0, 0, this.ratio, 0, 0);
    }
    this.view.resize(clientWidth, clientHeight);
    this.view.version += 1;
    this.trails.forget();
  }

  draw(now_ms) {
    const began_ms = performance.now();
    const { game, view, stats } = this;
    const moving = game.pose(now_ms);
    const index = game.indexOf.get(game.selected) ?? -1;
    if (this.following && index >= 0) view.centreOn(game.x[index], game.y[index]);
    this.north.tell();
    const shown = this.controls.shown;
    this.sea.draw(view, game.t_s, shown, now_ms);
    const flagsMove = game.chart.field?.flags?.some(({ route }) => route);
    const look = `${view.version} ${palette.version} ${this.controls.shownVersion} ${flagsMove ? game.t_s : ''}`;
    if (look !== this.drawnField) drawField(this.field, view, game.chart, shown, this.background);
    this.drawnField = look;
    this.trails.draw(game, view, shown, `${this.controls.shownVersion} ${index}`, index, now_ms);
    const boats = `${look} ${game.frames} ${index} ${this.boats.hovered} ${game.estimate?.at_s} ${this.badged}`;
    if (moving || boats !== this.drawnBoats) {
      this.boats.draw(game, view, shown, this.ratio);
      this.measure.draw(this.boats.context, game, view);
      this.fenceEditor.draw(this.boats.context, view);
    }
    this.drawnBoats = moving ? '' : boats;
    this.timeline.draw();
    if (game.mode === 'live' && game.frames > 0) this.plots.history.take(game);
    this.plots.draw(game, now_ms);
    this.tellDetails(now_ms);
    this.capture.drawn();
    if (game.frames > 0 || game.hello) this.status.tellFrame(game);
    if (this.link.owed > 0) {
      stats.drawn += this.link.owed;
      this.link.drawn();
    }
    stats.draw_ms = stats.draw_ms * 0.95 + (performance.now() - began_ms) * 0.05;
    if (stats.last_ms > 0) stats.fps = stats.fps * 0.95 + (1000 / Math.max(1, now_ms - stats.last_ms)) * 0.05;
    stats.last_ms = now_ms;
  }
}

const page = new Page();
expose(page);
page.start();
