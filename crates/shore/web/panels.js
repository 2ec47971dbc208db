// The panels around the chart: resized by dragging or with keys, and hidden. Sizes are stored.

import { keep, recallObject } from './storage.js';
import { make, show } from './words.js';

const KEY = 'squall.panels';
/** A step of the arrow keys, px. */
const STEP_PX = 24;
/** Space that stays for the chart, px. */
const CHART_PX = 260;

const byId = (id) => document.getElementById(id);

/**
 * Each panel: element, name, axis of its size, minimum size, px, and the part of the page that it may fill.
 */
const PANELS = [
  { id: 'side', name: 'Panel', axis: 'X', least: 260, part: 0.6, variable: '--side-width' },
  { id: 'plots', name: 'Plots', axis: 'Y', least: 150, part: 0.7, variable: '--plots-height' },
  { id: 'pane-events', name: 'Events', axis: 'Y', least: 60, part: 0.7, variable: '--events-height' },
];

export class Panels {
  constructor() {
    this.sizes = recallObject(KEY) ?? {};
    this.handles = PANELS.map((panel) => this.handle(panel));
    for (const panel of PANELS) this.apply(panel);
    byId('side-hide').addEventListener('click', () => this.toggleSide());
    byId('side-show').addEventListener('click', () => this.toggleSide());
    this.showSide();
  }

  get hidden() {
    return this.sizes.hidden === true;
  }

  /** Hides the side, or shows it again. */
  toggleSide() {
    this.sizes.hidden = !this.hidden;
    this.store();
    const pressed = ['side-hide', 'side-show'].includes(document.activeElement?.id);
    this.showSide();
    if (pressed) byId(this.hidden ? 'side-show' : 'side-hide').focus({ preventScroll: true });
  }

  showSide() {
    document.body.classList.toggle('side-hidden', this.hidden);
    show(byId('side-show'), this.hidden);
  }

  store() {
    keep(KEY, JSON.stringify(this.sizes));
  }

  /** The edge of a panel, which changes its size. */
  handle(panel) {
    const handle = make('div', `splitter splitter-${panel.axis.toLowerCase()}`);
    Object.assign(handle, { tabIndex: 0, id: `${panel.id}-edge`, title: 'Drag to resize; double-click for the default size' });
    handle.setAttribute('role', 'separator');
    handle.setAttribute('aria-label', `Size of the panel: ${panel.name}`);
    handle.setAttribute('aria-controls', panel.id);
    handle.setAttribute('aria-orientation', panel.axis === 'X' ? 'vertical' : 'horizontal');
    // The events scroll: their edge is beside them.
    byId(panel.id === 'pane-events' ? 'side' : panel.id).append(handle);
    handle.addEventListener('pointerdown', (event) => {
      event.preventDefault();
      event.stopPropagation();
      handle.focus();
      handle.setPointerCapture(event.pointerId);
      this.grip = { at: event[`client${panel.axis}`], size: this.sizeOf(panel) };
    });
    handle.addEventListener('pointermove', (event) => {
      if (this.grip && handle.hasPointerCapture(event.pointerId)) this.set(panel, this.grip.size + this.grip.at - event[`client${panel.axis}`]);
    });
    const end = () => {
      if (this.grip) this.store();
      this.grip = null;
    };
    handle.addEventListener('pointerup', end);
    handle.addEventListener('pointercancel', end);
    handle.addEventListener('dblclick', () => this.reset(panel));
    handle.addEventListener('keydown', (event) => this.key(event, panel));
    return handle;
  }

  key(event, panel) {
    const [more, less] = panel.axis === 'X' ? ['ArrowLeft', 'ArrowRight'] : ['ArrowUp', 'ArrowDown'];
    if (event.key === more || event.key === less) this.set(panel, this.sizeOf(panel) + (event.key === more ? STEP_PX : -STEP_PX));
    else if (event.key === 'Enter') this.reset(panel);
    else return;
    this.store();
    event.preventDefault();
    event.stopPropagation();
  }

  sizeOf({ id, axis }) {
    const box = byId(id).getBoundingClientRect();
    return axis === 'X' ? box.width : box.height;
  }

  set(panel, px) {
    const page = panel.axis === 'X' ? innerWidth : byId('main').clientHeight;
    const most = Math.min(panel.part * page, page - (panel.id === 'pane-events' ? 0 : CHART_PX));
    this.sizes[panel.id] = Math.round(Math.max(panel.least, Math.min(most, px)));
    this.apply(panel);
  }

  /** Resets a panel to its default size. */
  reset(panel) {
    delete this.sizes[panel.id];
    this.store();
    this.apply(panel);
  }

  apply({ id, variable }) {
    const px = this.sizes[id];
    if (Number.isFinite(px)) document.body.style.setProperty(variable, `${px}px`);
    else document.body.style.removeProperty(variable);
  }
}
