// Takes pictures of sweep pages for people: node sweep_shots.mjs FOLDER REPORT.json … [metric=NAME]

import { mkdirSync } from 'node:fs';
import { basename, dirname, join, resolve } from 'node:path';
import { openBrowser, readJson } from './harness.mjs';
import { writePage } from './sweep_page.mjs';

const words = process.argv.slice(2);
const metric = words.find((word) => word.startsWith('metric=')) ?? '';
const [place = 'shots', ...reports] = words.filter((word) => word !== metric);
const SIZES = {
  laptop: { viewport: { width: 1400, height: 900 } },
  desk: { viewport: { width: 1920, height: 1080 } },
  phone: { viewport: { width: 390, height: 844 }, deviceScaleFactor: 2, hasTouch: true },
};

/** Pairs of overlapping texts in charts. */
const overlaps = () => [...document.querySelectorAll('.chart svg')].flatMap((picture) => {
  const texts = [...picture.querySelectorAll('text')].filter((text) => !text.hasAttribute('transform'));
  const boxes = texts.map((text) => [text.textContent, text.getBoundingClientRect()]);
  return boxes.flatMap(([one, a], i) => boxes.slice(i + 1).filter(([, b]) =>
    a.left < b.right && b.left < a.right && a.top + 2 < b.bottom && b.top + 2 < a.bottom).map(([other]) => `${one} | ${other}`));
});

mkdirSync(place, { recursive: true });
const browser = await openBrowser();
for (const report of reports) {
  const name = basename(dirname(resolve(report)));
  const address = writePage(readJson(report), join(resolve(place), `${name}.html`)) + (metric && `#${metric}`);
  for (const [size, { viewport, ...device }] of Object.entries(SIZES)) {
    for (const colorScheme of ['light', 'dark']) {
      const page = await browser.newPage({ viewport, colorScheme, ...device });
      page.on('console', (message) => process.stdout.write(`  ${message.text()}\n`));
      page.on('pageerror', (error) => process.stdout.write(`  ${error.stack}\n`));
      await page.goto(address);
      await page.screenshot({ path: join(place, `${name}-${size}-${colorScheme}.png`), fullPage: true });
      const wide = await page.evaluate(() => document.documentElement.scrollWidth > innerWidth);
      const over = await page.evaluate(overlaps);
      process.stdout.write(`${name} ${size} ${colorScheme}${wide ? ', wider than the screen' : ''}${over.length > 0 ? `, texts overlap: ${over.join(', ')}` : ''}\n`);
      if (size === 'laptop' && colorScheme === 'light') await page.pdf({ path: join(place, `${name}.pdf`), format: 'A4' });
      await page.close();
    }
  }
}
await browser.close();
