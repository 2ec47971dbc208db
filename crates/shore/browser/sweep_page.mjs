// The page of a sweep as the program makes it, of a report that somebody changed.

import { readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { pathToFileURL } from 'node:url';
import { ROOT } from './harness.mjs';

/** Writes the page of a report into a file, and gives its address. What ends a script is escaped as `crates/experiment/src/sweep/html.rs` does. */
export function writePage(report, path) {
  const json = JSON.stringify(report).replaceAll('</', '<\\/').replaceAll('<!--', '<\\!--');
  const page = readFileSync(join(ROOT, 'crates/experiment/src/sweep/report.html'), 'utf8');
  writeFileSync(path, page.replace('<title></title>', () => `<title>${report.sweep}</title>`).replace('/*REPORT*/null', () => json));
  return pathToFileURL(path).href;
}
