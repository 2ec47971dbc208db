// The page of a sweep as the program creates it, from a modified report.

import { readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { pathToFileURL } from 'node:url';
import { ROOT } from './harness.mjs';

/** Writes the page of a report to a file, and returns its address. The end of a script is escaped as in `crates/experiment/src/sweep/html.rs`. */
export function writePage(report, path) {
  const json = JSON.stringify(report).replaceAll('</', '<\\/').replaceAll('<!--', '<\\!--');
  const page = readFileSync(join(ROOT, 'crates/experiment/src/sweep/report.html'), 'utf8');
  writeFileSync(path, page.replace('<title></title>', () => `<title>${report.sweep}</title>`).replace('/*REPORT*/null', () => json));
  return pathToFileURL(path).href;
}
