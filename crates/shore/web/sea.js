// The sea: waves as faint shading, and wind and current as arrows with text.

import { calmly, palette, rgb } from './palette.js';
import { bearing, number, show, wrapDeg, write } from './words.js';

/** Pixels of the chart per cell of the shading. */
const CELL_PX = 8;
const CELLS_MAX = 14000;
/** More components than these cost time and change little. */
const COMPONENTS_MAX = 40;
/** Interval at which the shading moves, ms. */
const STEP_MS = 80;
/** The same if the user prefers reduced motion, ms. */
const STEP_CALM_MS = 5000;
/** Maximum opacity of the shading. */
const STRENGTH = 0.45;

export class Sea {
  /** The canvas has one pixel per cell; the browser scales it to the chart. */
  constructor(canvas) {
    this.canvas = canvas;
    this.context = canvas.getContext('2d', { alpha: false });
    this.components = [];
    this.heights = new Float32Array(0);
    this.drawn = '';
    this.last_ms = -1e9;
  }

  /** Takes the waves of a chart, largest first. */
  greet(waves) {
    const sorted = [...(waves ?? [])].sort((a, b) => Math.abs(b.amplitude_m) - Math.abs(a.amplitude_m));
    this.components = sorted.slice(0, COMPONENTS_MAX);
    this.deviation_m = Math.sqrt(sorted.reduce((sum, wave) => sum + wave.amplitude_m ** 2, 0) / 2);
    this.drawn = '';
  }

  /** Draws the water if something has changed. */
  draw(view, t_s, shown, now_ms) {
    const waves = shown.waves && this.deviation_m > 0 && Number.isFinite(t_s);
    const place = `${waves ? view.version : 'flat'} ${palette.version} `;
    const key = `${place}${waves ? t_s : '-'}`;
    if (key === this.drawn) return;
    if (this.drawn.startsWith(place) && now_ms - this.last_ms < (calmly() ? STEP_CALM_MS : STEP_MS)) return;
    this.drawn = key;
    this.last_ms = now_ms;
    const cell = Math.max(CELL_PX, Math.sqrt((view.width * view.height) / CELLS_MAX));
    this.fit(cell, Math.ceil(view.width / cell) + 1, Math.ceil(view.height / cell) + 1);
    if (waves) this.sum(view, t_s, cell, this.canvas.width, this.canvas.height);
    else this.heights.fill(0);
    this.paint();
  }

  fit(cell, across, down) {
    const { canvas } = this;
    if (canvas.width === across && canvas.height === down && this.cell === cell) return;
    this.cell = cell;
    canvas.width = across;
    canvas.height = down;
    // The centre of the first pixel is at the chart's corner.
    Object.assign(canvas.style, { left: `${-cell / 2}px`, top: `${-cell / 2}px`, width: `${across * cell}px`, height: `${down * cell}px` });
    this.image = this.context.createImageData(across, down);
    this.heights = new Float32Array(across * down);
  }

  /** Sums the components. Along a row, each is a rotating phasor, which costs four multiplications per cell and no cosine. */
  sum(view, t_s, cell, across, down) {
    const heights = this.heights.fill(0);
    const cell_m = cell / view.scale;
    const [left, top] = view.placeOf(0, 0);
    // One cell to the right, and one down, m.
    const [rightX, rightY, downX, downY] = view.turned ? [0, -cell_m, -cell_m, 0] : [cell_m, 0, 0, -cell_m];
    for (const { amplitude_m, k_x, k_y, omega_rad_s, phase_rad } of this.components) {
      // Waves too short for the cells would only flicker.
      const finest = Math.hypot(k_x, k_y) * cell_m;
      const amplitude = amplitude_m * Math.min(1, Math.max(0, 2 - finest));
      if (amplitude === 0) continue;
      const turnCos = Math.cos(k_x * rightX + k_y * rightY);
      const turnSin = Math.sin(k_x * rightX + k_y * rightY);
      for (let row = 0; row < down; row++) {
        const phase = k_x * (left + row * downX) + k_y * (top + row * downY) - omega_rad_s * t_s + phase_rad;
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

  paint() {
    const water = rgb(palette.water);
    const crest = rgb(palette.crest);
    const trough = rgb(palette.trough);
    const { data } = this.image;
    const scale = this.deviation_m > 0 ? STRENGTH / (3 * this.deviation_m) : 0;
    for (let i = 0, at = 0; i < this.heights.length; i++, at += 4) {
      const height = this.heights[i];
      const shade = height > 0 ? crest : trough;
      const part = Math.min(STRENGTH, Math.abs(height) * scale);
      data[at] = water[0] + (shade[0] - water[0]) * part;
      data[at + 1] = water[1] + (shade[1] - water[1]) * part;
      data[at + 2] = water[2] + (shade[2] - water[2]) * part;
      data[at + 3] = 255;
    }
    this.context.putImageData(this.image, 0, 0);
  }
}

/** Wind and current below this count as zero, m/s. */
const LEAST_M_S = 0.005;

/** Wind and current beside the chart. */
export class Weather {
  constructor() {
    this.place = document.getElementById('weather');
    this.wind = document.getElementById('wind');
    this.current = document.getElementById('current');
    this.state = document.getElementById('sea-state');
  }

  /** Shows the sea of a frame. */
  tell(sea, waves_m) {
    const some = Boolean(sea) && (waves_m > 0 || [[sea.wind_east_m_s, sea.wind_north_m_s], [sea.current_east_m_s, sea.current_north_m_s]]
      .some((each) => Math.hypot(...each) >= LEAST_M_S));
    show(this.place, some);
    if (!some) return;
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
    const some = speed >= LEAST_M_S;
    write(place.children[1], some ? lead : '');
    write(place.lastElementChild, some ? words : none);
    const arrow = place.firstElementChild;
    arrow.style.visibility = some ? 'visible' : 'hidden';
    arrow.style.transform = `rotate(${Math.round(to_deg)}deg)`;
  }
}
