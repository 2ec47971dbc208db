// The visible part of the chart: north is up. Converts between metres and pixels.

const SCALE_MIN = 0.02;
const SCALE_MAX = 120;
/** The inner part of the chart, as a share of its width and height. */
const INNER = 0.6;

export class View {
  constructor() {
    this.width = 1;
    this.height = 1;
    /** Pixels per metre. */
    this.scale = 1;
    this.centreX = 0;
    this.centreY = 0;
    this.bounds = { left: 0, right: 100, bottom: 0, top: 100 };
    /** Grows with every change, so that layers know when to redraw. */
    this.version = 0;
    /** Whether it is as fitted, not moved by the user. */
    this.fitted = true;
  }

  xOf(x) {
    return (x - this.centreX) * this.scale + this.width / 2;
  }

  yOf(y) {
    return this.height / 2 - (y - this.centreY) * this.scale;
  }

  /** East coordinate of a pixel. */
  eastOf(px) {
    return (px - this.width / 2) / this.scale + this.centreX;
  }

  /** North coordinate of a pixel. */
  northOf(py) {
    return (this.height / 2 - py) / this.scale + this.centreY;
  }

  resize(width, height) {
    if (width === this.width && height === this.height) return;
    this.width = Math.max(1, width);
    this.height = Math.max(1, height);
    this.version += 1;
    if (this.fitted) this.fit();
  }

  setBounds(points) {
    this.bounds = { left: Infinity, right: -Infinity, bottom: Infinity, top: -Infinity };
    this.widen(points);
    this.fit();
  }

  /** Everything that is fitted. */
  widen(points) {
    const { left, right, bottom, top } = this.bounds;
    const [xs, ys] = [0, 1].map((axis) => points.map((point) => point[axis]));
    this.bounds = { left: Math.min(left, ...xs), right: Math.max(right, ...xs), bottom: Math.min(bottom, ...ys), top: Math.max(top, ...ys) };
    if (this.fitted && JSON.stringify(this.bounds) !== JSON.stringify({ left, right, bottom, top })) this.fit();
  }

  fit() {
    const { left, right, bottom, top } = this.bounds;
    // Space for the weather above, and for the scale and the buttons below.
    const side = Math.min(44, this.width * 0.05);
    const above = Math.min(92, this.height * 0.17);
    const below = Math.min(72, this.height * 0.24);
    const across = Math.max(60, this.width - 2 * side);
    const down = Math.max(60, this.height - above - below);
    this.scale = this.limit(Math.min(across / Math.max(1, right - left), down / Math.max(1, top - bottom)));
    this.centreX = (left + right) / 2;
    this.centreY = (bottom + top) / 2 - (below - above) / 2 / this.scale;
    this.fitted = true;
    this.version += 1;
  }

  limit(scale) {
    return Math.min(SCALE_MAX, Math.max(SCALE_MIN, scale));
  }

  centreOn(x, y) {
    if (x === this.centreX && y === this.centreY) return;
    this.centreX = x;
    this.centreY = y;
    this.fitted = false;
    this.version += 1;
  }

  /** Centres a position unless it is in the inner part of the chart. */
  bringIn(x, y) {
    const across = Math.abs(this.xOf(x) - this.width / 2) / this.width;
    const down = Math.abs(this.yOf(y) - this.height / 2) / this.height;
    // While the whole field is shown, positions near the edge are visible enough.
    const most = this.fitted ? 0.5 : INNER / 2;
    if (across > most || down > most) this.centreOn(x, y);
  }

  panBy(dx, dy) {
    this.centreOn(this.centreX - dx / this.scale, this.centreY + dy / this.scale);
  }

  /** Zooms; the point under the pixel stays in place. */
  zoomAt(px, py, factor) {
    const east = this.eastOf(px);
    const north = this.northOf(py);
    this.scale = this.limit(this.scale * factor);
    this.centreX = east - (px - this.width / 2) / this.scale;
    this.centreY = north + (py - this.height / 2) / this.scale;
    this.fitted = false;
    this.version += 1;
  }
}
