// The animated picture of the README: node animation.mjs OUT.gif [FROM_S TO_S]. A recorded game on the page, one frame a second of
// the game; ffmpeg makes the GIF.

import { execFileSync } from 'node:child_process';
import { mkdtempSync, readdirSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join, resolve } from 'node:path';
import { Program, Sight, openBrowser, scenario, squall } from './harness.mjs';

const [out = 'game.gif', from_s = '120', to_s = '190'] = process.argv.slice(2);
const FRAMES_PER_S = 10;
const folder = mkdtempSync(join(tmpdir(), 'animation-'));
const ends = [() => rmSync(folder, { recursive: true })];
const scene = { after: (end) => ends.unshift(end) };
try {
  await squall(scene, 'run', scenario('games/strategy_4_vs_3.toml'), '--in-process', '--record', folder);
  const recording = join(folder, readdirSync(folder).find((name) => name.endsWith('.mcap')));
  const url = `${await new Program(scene, 'replay', recording, '--listen', '127.0.0.1:0').url()}#t=0`;
  const browser = await openBrowser();
  scene.after(() => browser.close());
  const sight = await Sight.open(scene, browser, url, { size: { width: 1120, height: 640 }, colorScheme: 'light' });
  if ((await sight.text('#phase')) !== 'paused') await sight.keys(' ');
  await sight.press('[data-vehicle=blue_2]');
  await sight.until('its helm is known', () => squall.helm?.report?.collective);
  for (let t_s = await sight.get(() => squall.t_s); t_s < Number(to_s); ) {
    await sight.page.locator('body').press(t_s + 10 <= Number(from_s) ? 'Shift+ArrowRight' : 'ArrowRight');
    t_s = await sight.until('the replay has moved', (before_s) => squall.t_s > before_s && squall.t_s, t_s);
    if (t_s < Number(from_s)) continue;
    await sight.get(() => new Promise((drawn) => requestAnimationFrame(() => requestAnimationFrame(drawn))));
    await sight.page.screenshot({ path: join(folder, `${String(Math.round(t_s)).padStart(4, '0')}.png`) });
  }
  const palette = 'split[a][b];[a]palettegen=max_colors=96:stats_mode=diff[p];[b][p]paletteuse=dither=none:diff_mode=rectangle';
  execFileSync('ffmpeg', ['-y', '-loglevel', 'error', '-framerate', String(FRAMES_PER_S), '-pattern_type', 'glob', '-i', join(folder, '*.png'),
    '-vf', `scale=960:-1:flags=lanczos,${palette}`, resolve(out)]);
} finally {
  for (const end of ends) await end();
}
