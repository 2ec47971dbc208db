// Light and dark: as the system has it, until somebody switches.

import { readColours } from './palette.js';

const KEY = 'squall.theme';
const SYSTEM = '(prefers-color-scheme: dark)';

const system = matchMedia(SYSTEM);

function remembered() {
  try {
    const theme = localStorage.getItem(KEY);
    return ['light', 'dark'].includes(theme) ? theme : null;
  } catch {
    return null;
  }
}

export class Theme {
  /** `changed` is called when the colours are others. */
  constructor(changed = () => {}) {
    this.changed = changed;
    this.sheet = document.getElementById('dark-style');
    this.button = document.getElementById('dark');
    this.chosen = remembered();
    this.button.addEventListener('click', () => this.toggle());
    system.addEventListener('change', () => this.apply());
    // The browser may not have the style yet when it is wanted.
    this.sheet.addEventListener('load', () => this.apply());
    this.apply();
  }

  get dark() {
    return this.chosen ? this.chosen === 'dark' : system.matches;
  }

  toggle() {
    const wanted = this.dark ? 'light' : 'dark';
    // What the system has needs no keeping: then the page goes on to follow it.
    this.chosen = (wanted === 'dark') === system.matches ? null : wanted;
    try {
      if (this.chosen) localStorage.setItem(KEY, this.chosen);
      else localStorage.removeItem(KEY);
    } catch {
      // Then it is forgotten with the page.
    }
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
