// The colours of the chart, read from the style sheets so that light and dark are defined in one place.

const NAMES = [
  'water', 'crest', 'trough', 'grid', 'ink', 'faint', 'edge', 'wall', 'land', 'halo', 'accent', 'on-accent', 'danger', 'on-danger', 'good', 'warn', 'paper',
  'team-0', 'team-1', 'team-2', 'team-3',
  'series-0', 'series-1', 'series-2', 'series-3', 'series-4', 'series-5', 'series-6', 'series-7',
  'heat-0', 'heat-1', 'heat-2', 'heat-3', 'heat-4', 'heat-5', 'heat-6', 'heat-7', 'heat-8',
];

const calm = matchMedia('(prefers-reduced-motion: reduce)');

export const palette = { version: 0 };

/** Reads them again from the style sheets. */
export function readColours() {
  const style = getComputedStyle(document.documentElement);
  for (const name of NAMES) palette[name] = style.getPropertyValue(`--${name}`).trim();
  palette.teams = [0, 1, 2, 3].map((team) => palette[`team-${team}`]);
  palette.series = NAMES.filter((name) => name.startsWith('series-')).map((name) => palette[name]);
  palette.heat = NAMES.filter((name) => name.startsWith('heat-')).map((name) => rgb(palette[name]));
  palette.version += 1;
}

readColours();

/** Whether the user prefers reduced motion. */
export const calmly = () => calm.matches;

/** The colour of a team; grey for null. */
export const teamColour = (team) => palette.teams[team] ?? palette.faint;

/** Red, green and blue of `#rrggbb`. */
export function rgb(colour) {
  const bits = Number.parseInt(colour.slice(1), 16);
  return [(bits >> 16) & 255, (bits >> 8) & 255, bits & 255];
}
