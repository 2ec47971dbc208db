// Saves the chart as a PNG image, or a section of the game as a film.

import { palette } from './palette.js';
import { clock, plain } from './words.js';
import { notice } from './status.js';

const FRAMES_PER_S = 25;
/** Maximum length of a film, ms: browsers keep it in memory. */
const FILM_MAX_MS = 10 * 60 * 1000;
const HEAD_PX = 34;

/** Offers the user a file to save. */
function save(blob, name) {
  const link = document.createElement('a');
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}

export class Capture {
  /** `layers` are the chart's canvases, lowest first. */
  constructor(layers, game) {
    this.layers = layers;
    this.game = game;
    this.canvas = document.createElement('canvas');
    this.recorder = null;
    this.button = document.getElementById('film');
    document.getElementById('png').addEventListener('click', () => this.png());
    this.button.addEventListener('click', () => this.film());
  }

  get name() {
    return `${this.game.hello?.game ?? 'squall'}_${clock(this.game.t_s).replaceAll(':', '-')}`;
  }

  /** Combines the chart's layers below a line with the game, the score and the time. */
  compose() {
    const { layers, game, canvas } = this;
    const ratio = layers[3].width / Math.max(1, layers[3].clientWidth);
    const head = Math.round(HEAD_PX * ratio);
    const [width, height] = [layers[3].width, layers[3].height + head];
    if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
    const context = canvas.getContext('2d');
    context.fillStyle = palette.paper;
    context.fillRect(0, 0, width, head);
    for (const layer of layers) context.drawImage(layer, 0, head, width, height - head);
    context.font = `600 ${15 * ratio}px system-ui, sans-serif`;
    context.textBaseline = 'middle';
    context.fillStyle = palette.ink;
    context.fillText(`${game.scoreWords}   ${clock(game.t_s)}   ${plain(game.chart.name ?? '')}`, 12 * ratio, head / 2);
  }

  png() {
    this.compose();
    this.canvas.toBlob((blob) => {
      if (blob) save(blob, `${this.name}.png`);
      else notice('The browser could not create the image.');
    });
  }

  /** Starts a film, or ends and saves it. */
  film() {
    if (this.recorder) {
      this.recorder.stop();
      return;
    }
    if (typeof MediaRecorder === 'undefined' || !MediaRecorder.isTypeSupported('video/webm')) {
      notice('This browser cannot record films (WebM).');
      return;
    }
    this.compose();
    const parts = [];
    const name = this.name;
    const recorder = new MediaRecorder(this.canvas.captureStream(FRAMES_PER_S), { mimeType: 'video/webm', videoBitsPerSecond: 6e6 });
    recorder.ondataavailable = ({ data }) => data.size > 0 && parts.push(data);
    recorder.onstop = () => {
      clearTimeout(this.late);
      this.recorder = null;
      this.tell();
      save(new Blob(parts, { type: 'video/webm' }), `${name}.webm`);
    };
    recorder.start(1000);
    this.recorder = recorder;
    this.late = setTimeout(() => recorder.state === 'recording' && recorder.stop(), FILM_MAX_MS);
    this.tell();
  }

  tell() {
    this.button.textContent = this.recorder ? 'End film' : 'Film';
    this.button.setAttribute('aria-pressed', String(this.recorder !== null));
  }

  /** Call after each drawn picture. */
  drawn() {
    if (this.recorder) this.compose();
  }
}
