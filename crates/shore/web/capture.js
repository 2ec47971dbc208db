// Saves the chart as a PNG image, or a section of the game as a video or a GIF.

import { Gif } from './gif.js';
import { palette } from './palette.js';
import { clock, plain } from './words.js';
import { notice } from './status.js';

const FRAMES_PER_S = 25;
/** Types of video, by preference: Safari records no WebM. */
const VIDEOS = ['video/webm', 'video/mp4'];
/** Maximum length of a video, ms: browsers keep it in memory. */
const VIDEO_MAX_MS = 10 * 60 * 1000;
/** Interval of a GIF's pictures, its maximum length, ms, and its maximum width, px. */
const GIF_EVERY_MS = 125;
const GIF_MAX_MS = 60 * 1000;
const GIF_WIDTH_MAX = 800;
const HEAD_PX = 34;

const byId = (id) => document.getElementById(id);

/** Offers the user a file: to save or, on a phone, to share. */
async function offer(blob, name) {
  const files = [new File([blob], name, { type: blob.type })];
  if (matchMedia('(pointer: coarse)').matches && navigator.canShare?.({ files })) {
    try {
      await navigator.share({ files });
      return;
    } catch (error) {
      if (error.name === 'AbortError') return;
      // The press was too long ago for sharing: save the file instead.
    }
  }
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
    this.small = document.createElement('canvas');
    this.recorder = null;
    this.gif = null;
    const records = typeof MediaRecorder === 'undefined' || !this.canvas.captureStream ? () => false : (type) => MediaRecorder.isTypeSupported(type);
    this.type = VIDEOS.find(records);
    byId('film').hidden = this.type === undefined;
    byId('png').addEventListener('click', () => this.png());
    byId('film').addEventListener('click', () => this.film());
    byId('gif').addEventListener('click', () => this.animate());
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
      if (blob) offer(blob, `${this.name}.png`);
      else notice('The browser could not create the image.');
    });
  }

  /** Starts a video, or ends and saves it. */
  film() {
    if (this.recorder) {
      this.recorder.stop();
      return;
    }
    this.compose();
    const parts = [];
    const { name, type } = this;
    const recorder = new MediaRecorder(this.canvas.captureStream(FRAMES_PER_S), { mimeType: type, videoBitsPerSecond: 6e6 });
    recorder.ondataavailable = ({ data }) => data.size > 0 && parts.push(data);
    recorder.onstop = () => {
      clearTimeout(this.late);
      this.recorder = null;
      this.tell();
      offer(new Blob(parts, { type }), `${name}.${type.split('/')[1]}`);
    };
    recorder.start(1000);
    this.recorder = recorder;
    this.late = setTimeout(() => recorder.state === 'recording' && recorder.stop(), VIDEO_MAX_MS);
    this.tell();
  }

  /** Starts a GIF, or ends and saves it. */
  animate() {
    const { gif, name } = this;
    if (!gif) {
      const { width, clientWidth, height } = this.layers[3];
      const ratio = width / Math.max(1, clientWidth);
      const scale = Math.min(1, GIF_WIDTH_MAX / clientWidth) / ratio;
      Object.assign(this.small, { width: Math.round(width * scale), height: Math.round((height + HEAD_PX * ratio) * scale) });
      this.gif = { name, file: new Gif(this.small.width, this.small.height), began_ms: performance.now(), at_ms: -Infinity, picture: null };
      this.sample();
    } else {
      this.sample(true);
      this.gif = null;
      offer(gif.file.finish(), `${gif.name}.gif`);
    }
    this.tell();
  }

  /** Adds the previous picture to the GIF once it is known how long it was shown. */
  sample(last = false) {
    const { gif, small } = this;
    const now_ms = performance.now();
    if (!last && now_ms - gif.at_ms < GIF_EVERY_MS) return;
    if (gif.picture) gif.file.add(gif.picture, now_ms - gif.at_ms);
    this.compose();
    const context = small.getContext('2d', { willReadFrequently: true });
    context.drawImage(this.canvas, 0, 0, small.width, small.height);
    gif.picture = context.getImageData(0, 0, small.width, small.height).data;
    gif.at_ms = now_ms;
    if (!last && now_ms - gif.began_ms > GIF_MAX_MS) this.animate();
  }

  tell() {
    for (const [id, on, text] of [['film', this.recorder, 'video'], ['gif', this.gif, 'GIF']]) {
      byId(id).textContent = on ? `End ${text}` : text.replace('video', 'Video');
      byId(id).setAttribute('aria-pressed', String(on !== null));
    }
  }

  /** Call after each drawn picture. */
  drawn() {
    if (this.recorder) this.compose();
    if (this.gif) this.sample();
  }
}
