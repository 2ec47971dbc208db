// Light and dark: follows the system until the user switches.

import { readColours } from './palette.js';
import { keep, recall } from './storage.js';

const KEY = 'squall.theme';
const SYSTEM = '(prefers-color-scheme: dark)';

const system = matchMedia(SYSTEM);

function remembered() {
  const theme = recall(KEY);
  return ['light', 'dark'].includes(theme) ? theme : null;
}

export class Theme {
  /** `changed` is called when the colours change. */
  constructor(changed = () => {}) {
    this.changed = changed;
    this.sheet = document.getElementById('dark-style');
    this.button = document.getElementById('dark');
    this.chosen = remembered();
    this.button.addEventListener('click', () => this.toggle());
    system.addEventListener('change', () => this.apply());
    // The browser may not have loaded the style yet.
    this.sheet.addEventListener('load', () => this.apply());
    this.apply();
  }

  get dark() {
    return this.chosen ? this.chosen === 'dark' : system.matches;
  }

  toggle() {
    const wanted = this.dark ? 'light' : 'dark';
    // The system's own setting is not stored, so that the page keeps following it.
    this.chosen = (wanted === 'dark') === system.matches ? null : wanted;
    keep(KEY, this.chosen);
    this.apply();
  }

  apply() {
    const media = this.chosen === null ? SYSTEM : this.chosen === 'dark' ? 'all' : 'not all';
    if (this.sheet.media !== media) this.sheet.media = media;
    document.documentElement.style.colorScheme = this.dark ? 'dark' : 'light';
    this.button.setAttribute('aria-pressed', String(this.dark));
    readColours();
    this.changed();
  }
}
