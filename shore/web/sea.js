// The sea: waves as a faint shading, and wind and current in words beside their arrows.

import { palette, rgb } from './palette.js';
import { bearing, number, show, wrapDeg, write } from './words.js';

/** Pixels of the chart to a cell of the shading. */
const CELL_PX = 9;
const CELLS_MAX = 14000;
/** More components than these cost time and change little. */
const COMPONENTS_MAX = 40;
/** How often the shading moves, ms. */
const STEP_MS = 80;
/** Strength of the shading, of 255. */
const STRENGTH = 115;

export class Sea {
  constructor(canvas) {
    this.context = canvas.getContext('2d', { alpha: false });
    this.small = document.createElement('canvas');
    this.smallContext = this.small.getContext('2d');
    this.components = [];
    this.drawn = '';
    this.last_ms = -1e9;
  }

  /** Takes the waves of a chart, greatest first. */
  greet(waves) {
    const sorted = [...(waves ?? [])].sort((a, b) => Math.abs(b.amplitude_m) - Math.abs(a.amplitude_m));
    this.components = sorted.slice(0, COMPONENTS_MAX);
    this.height_m = Math.sqrt(this.components.reduce((sum, wave) => sum + wave.amplitude_m ** 2, 0) / 2);
    this.drawn = '';
  }

  /** Draws water, and waves on it, if something changed. Whether it drew. */
  draw(view, t_s, shown, now_ms) {
    const waves = shown.waves && this.height_m > 0 && Number.isFinite(t_s);
    const key = `${view.version} ${palette.version} ${waves ? t_s : '-'}`;
    if (key === this.drawn) return false;
    const moved = !this.drawn.startsWith(`${view.version} ${palette.version} `);
    if (!moved && waves && now_ms - this.last_ms < STEP_MS) return false;
    this.drawn = key;
    this.last_ms = now_ms;
    this.context.fillStyle = palette.water;
    this.context.fillRect(0, 0, view.width, view.height);
    if (waves) this.shade(view, t_s);
    return true;
  }

  shade(view, t_s) {
    const cell = Math.max(CELL_PX, Math.sqrt((view.width * view.height) / CELLS_MAX));
    const across = Math.ceil(view.width / cell) + 1;
    const down = Math.ceil(view.height / cell) + 1;
    if (this.small.width !== across || this.small.height !== down) {
      this.small.width = across;
      this.small.height = down;
      this.image = this.smallContext.createImageData(across, down);
      this.heights = new Float32Array(across * down);
    }
    this.sum(view, t_s, cell, across, down);
    this.paint(across * down);
    this.smallContext.putImageData(this.image, 0, 0);
    this.context.imageSmoothingEnabled = true;
    this.context.imageSmoothingQuality = 'high';
    this.context.drawImage(this.small, -cell / 2, -cell / 2, across * cell, down * cell);
  }

  /** Adds up the components. Along a row each is a turning pointer, which costs four products a cell and no cosine. */
  sum(view, t_s, cell, across, down) {
    const heights = this.heights.fill(0);
    const cell_m = cell / view.scale;
    const left = view.eastOf(0);
    const top = view.northOf(0);
    for (const { amplitude_m, k_x, k_y, omega_rad_s, phase_rad } of this.components) {
      // Waves too short for the cells would only shimmer.
      const finest = Math.hypot(k_x, k_y) * cell_m;
      const amplitude = amplitude_m * Math.min(1, Math.max(0, 2 - finest));
      if (amplitude === 0) continue;
      const turnCos = Math.cos(k_x * cell_m);
      const turnSin = Math.sin(k_x * cell_m);
      for (let row = 0; row < down; row++) {
        const phase = k_x * left + k_y * (top - row * cell_m) - omega_rad_s * t_s + phase_rad;
        let c = amplitude * Math.cos(phase);
        let s = amplitude * Math.sin(phase);
        const end = (row + 1) * across;
        for (let at = row * across; at < end; at++) {
          heights[at] += c;
          const next = c * turnCos - s * turnSin;
          s = s * turnCos + c * turnSin;
          c = next;
        }
      }
    }
  }

  paint(count) {
    const [cr, cg, cb] = rgb(palette.crest);
    const [tr, tg, tb] = rgb(palette.trough);
    const data = this.image.data;
    const scale = STRENGTH / (3 * this.height_m);
    for (let i = 0; i < count; i++) {
      const height = this.heights[i];
      const up = height > 0;
      data[4 * i] = up ? cr : tr;
      data[4 * i + 1] = up ? cg : tg;
      data[4 * i + 2] = up ? cb : tb;
      data[4 * i + 3] = Math.min(STRENGTH, (up ? height : -height) * scale);
    }
  }
}

/** Wind and current beside the chart. */
export class Weather {
  constructor() {
    this.place = document.getElementById('weather');
    this.wind = document.getElementById('wind');
    this.current = document.getElementById('current');
    this.state = document.getElementById('sea-state');
  }

  /** Tells what the frame's sea is like. */
  tell(sea, waves_m) {
    show(this.place, Boolean(sea));
    if (!sea) return;
    const windTo = wrapDeg((Math.atan2(sea.wind_east_m_s, sea.wind_north_m_s) * 180) / Math.PI);
    const wind = Math.hypot(sea.wind_north_m_s, sea.wind_east_m_s);
    const currentTo = wrapDeg((Math.atan2(sea.current_east_m_s, sea.current_north_m_s) * 180) / Math.PI);
    const current = Math.hypot(sea.current_north_m_s, sea.current_east_m_s);
    this.line(this.wind, wind, windTo, 'Wind from', `${bearing(windTo + 180)} ${number(wind, 1, 'm/s')}`, 'No wind');
    this.line(this.current, current, currentTo, 'Current to', `${bearing(currentTo)} ${number(current, 2, 'm/s')}`, 'No current');
    // Four times the standard deviation is the significant height (Holthuijsen 2007, 4.2).
    write(this.state, waves_m > 0 ? `Waves ${number(4 * waves_m, 2, 'm')}` : 'No waves');
  }

  line(place, speed, to_deg, lead, words, none) {
    const some = speed >= 0.005;
    write(place.children[1], some ? lead : '');
    write(place.lastElementChild, some ? words : none);
    const arrow = place.firstElementChild;
    arrow.style.visibility = some ? 'visible' : 'hidden';
    arrow.style.transform = `rotate(${Math.round(to_deg)}deg)`;
  }
}
