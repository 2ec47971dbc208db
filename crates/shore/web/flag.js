// Homes of flags that move.

/** Moves the homes with a route to their positions at a time, as `Route::at` of the rules. */
export function moveFlags(flags, t_s) {
  for (const flag of flags) {
    if (!flag.route) continue;
    const { points, ends_m, speed_m_s } = flag.route;
    const gone_m = (speed_m_s * Math.max(t_s, 0)) % ends_m.at(-1);
    const leg = ends_m.findIndex((end_m) => gone_m < end_m);
    const from_m = ends_m[leg - 1] ?? 0;
    const share = (gone_m - from_m) / (ends_m[leg] - from_m);
    const [from, to] = [points[leg], points[(leg + 1) % points.length]];
    [flag.x, flag.y] = [0, 1].map((axis) => from[axis] + (to[axis] - from[axis]) * share);
  }
}
