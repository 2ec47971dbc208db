// Marks on the axes of charts, and samples at a position.

/** About `count` round numbers between `low` and `high`. */
export function ticksOf(low, high, count) {
  const raw = (high - low) / count;
  if (!(raw > 0) || !Number.isFinite(raw)) return [low];
  const power = 10 ** Math.floor(Math.log10(raw));
  const step = [1, 2, 5, 10].map((times) => times * power).find((each) => each >= raw * 0.999);
  const ticks = [];
  for (let i = Math.ceil(low / step - 1e-9); i * step <= high + 1e-9 * step; i += 1) ticks.push(Number((i * step).toPrecision(12)));
  return ticks;
}

/** The sample at a position on the axis: the last one up to it. */
export function sampleAt(xs, x) {
  let low = 0;
  let high = xs.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (xs[middle] <= x + 1e-6) low = middle + 1;
    else high = middle;
  }
  return Math.max(0, low - 1);
}
