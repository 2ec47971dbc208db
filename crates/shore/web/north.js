// The bearing that is up on the chart. Everything that shows courses turns with it.

import { keep, recall } from './storage.js';
import { show } from './words.js';

const KEY = 'squall.north-up';

export class North {
  /** `dials` show courses: they have `up_deg`. */
  constructor(view, dials) {
    this.view = view;
    this.dials = dials;
    this.button = document.getElementById('north-up');
    this.up_deg = null;
    view.northUp = recall(KEY) === 'true';
    this.button.addEventListener('click', () => {
      view.keepNorthUp(!view.northUp);
      keep(KEY, view.northUp ? 'true' : null);
    });
  }

  /** Call before each picture. */
  tell() {
    const { view, button } = this;
    const pressed = String(view.northUp);
    if (button.getAttribute('aria-pressed') !== pressed) button.setAttribute('aria-pressed', pressed);
    show(button, view.turned || view.northUp);
    if (view.up_deg === this.up_deg) return;
    this.up_deg = view.up_deg;
    for (const dial of this.dials) dial.up_deg = view.up_deg;
    // Angle by which arrows in text turn.
    document.body.style.setProperty('--turn', `${-view.up_deg}deg`);
  }
}
