// The visible part of the chart. Converts between metres and pixels. North is up, or to the left if the field then fits better.

const SCALE_MIN = 0.02;
const SCALE_MAX = 120;
/** The inner part of the chart, as a fraction of its width and height. */
const INNER = 0.6;
/** The chart turns if the field becomes this many times larger. */
const TURN_GAIN = 1.25;

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
    /** Whether it is still fitted, not moved by the user. */
    this.fitted = true;
    /** Whether east is up, because the field then fits better. */
    this.turned = false;
    this.northUp = false;
  }

  /** The bearing that is up, rad. */
  get up_rad() {
    return this.turned ? Math.PI / 2 : 0;
  }

  get up_deg() {
    return this.turned ? 90 : 0;
  }

  /** Pixels from the left of a position, m. */
  xOf(x, y) {
    return (this.turned ? this.centreY - y : x - this.centreX) * this.scale + this.width / 2;
  }

  /** Pixels from the top. */
  yOf(x, y) {
    return this.height / 2 - (this.turned ? x - this.centreX : y - this.centreY) * this.scale;
  }

  /** Position of a pixel, east and north, m. */
  placeOf(px, py) {
    const right = (px - this.width / 2) / this.scale;
    const up = (this.height / 2 - py) / this.scale;
    return this.turned ? [this.centreX + up, this.centreY - right] : [this.centreX + right, this.centreY + up];
  }

  /** Keeps north up, or lets the chart turn. */
  keepNorthUp(northUp) {
    this.northUp = northUp;
    if (northUp) this.turned = false;
    this.version += 1;
    if (this.fitted || !northUp) this.fit();
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
    this.turned = false;
    this.widen(points);
    this.fit();
  }

  /** The area to fit. */
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
    const [wide, high] = [Math.max(1, right - left), Math.max(1, top - bottom)];
    const scales = { false: Math.min(across / wide, down / high), true: Math.min(across / high, down / wide) };
    // With a margin, so that it does not turn back and forth while a panel is resized.
    if (!this.northUp && scales[!this.turned] > TURN_GAIN * scales[this.turned]) this.turned = !this.turned;
    this.scale = this.limit(scales[this.turned]);
    const lower = (below - above) / 2 / this.scale;
    this.centreX = (left + right) / 2 - (this.turned ? lower : 0);
    this.centreY = (bottom + top) / 2 - (this.turned ? 0 : lower);
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
    const across = Math.abs(this.xOf(x, y) - this.width / 2) / this.width;
    const down = Math.abs(this.yOf(x, y) - this.height / 2) / this.height;
    // While the whole field is shown, positions near the edge are visible enough.
    const most = this.fitted ? 0.5 : INNER / 2;
    if (across > most || down > most) this.centreOn(x, y);
  }

  panBy(dx, dy) {
    this.centreOn(...this.placeOf(this.width / 2 - dx, this.height / 2 - dy));
  }

  /** Zooms; the point under the pixel stays in place. */
  zoomAt(px, py, factor) {
    const [east, north] = this.placeOf(px, py);
    this.scale = this.limit(this.scale * factor);
    const [nowEast, nowNorth] = this.placeOf(px, py);
    this.centreX += east - nowEast;
    this.centreY += north - nowNorth;
    this.fitted = false;
    this.version += 1;
  }
}
