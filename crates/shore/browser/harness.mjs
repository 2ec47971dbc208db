// The basis of the page's tests: the program in its own processes, a browser, and waits with a limit.

import assert from 'node:assert/strict';
import { spawn } from 'node:child_process';
import { accessSync, constants, existsSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { createServer } from 'node:net';
import { tmpdir } from 'node:os';
import { delimiter, join, resolve } from 'node:path';
import { fileURLToPath } from 'node:url';
import { chromium } from 'playwright-core';

/** Limit of every wait, ms, long enough for slow machines. Set a shorter one while writing tests. */
export const LIMIT_MS = Number(process.env.LIMIT_MS ?? 60_000);
/** Interval at which a condition is checked, ms. */
const LOOK_MS = 40;
/** How long a program may take to end by itself, ms. */
const LEAVE_MS = 10_000;

/** The repository. */
export const ROOT = resolve(fileURLToPath(import.meta.url), '../../../..');
const SQUALL = resolve(process.env.SQUALL ?? join(ROOT, 'target/release/squall'));
/** The folder from which the page's files are served, to work on the page without rebuilding the program. */
const WEB = process.env.SQUALL_WEB && resolve(process.env.SQUALL_WEB);
const FLAGS = ['--headless', '--no-sandbox', '--disable-gpu', '--disable-quic', '--no-first-run', '--disable-background-networking',
  '--disable-component-update', '--disable-sync',
  // Browsers keep public pages from connecting to this machine, and treat pages from the folder as public.
  ...(WEB ? ['--disable-features=LocalNetworkAccessChecks'] : [])];

/** A file in the folder scenarios. */
export const scenario = (path) => join(ROOT, 'scenarios', path);

function browserPath() {
  if (process.env.CHROMIUM) return process.env.CHROMIUM;
  const places = (process.env.PATH ?? '').split(delimiter).flatMap((folder) =>
    ['chromium', 'chromium-browser', 'google-chrome'].map((name) => join(folder, name)));
  const found = places.find((place) => {
    try {
      accessSync(place, constants.X_OK);
      return true;
    } catch {
      return false;
    }
  });
  assert(found, 'no chromium on PATH: install it, or set CHROMIUM to its path');
  return found;
}

/** A headless browser. */
export const openBrowser = () => chromium.launch({ executablePath: browserPath(), args: FLAGS });

/** A second browser, as for another person, for one test. */
export async function openAnother(t) {
  const browser = await openBrowser();
  afterwards(t, () => browser.close());
  return browser;
}

/** Waits until `condition` returns a truthy value, and returns it. */
export async function until(what, condition, limit_ms = LIMIT_MS) {
  const end_ms = Date.now() + limit_ms;
  for (;;) {
    const found = await condition();
    if (found) return found;
    assert(Date.now() < end_ms, `not within ${limit_ms / 1000} s: ${what}`);
    await new Promise((done) => setTimeout(done, LOOK_MS));
  }
}

const left = new WeakMap();

/** Runs `end` after the test; several run in reverse order. */
function afterwards(t, end) {
  if (!left.has(t)) {
    const ends = [];
    left.set(t, ends);
    t.after(async () => {
      while (ends.length > 0) await ends.pop()();
    });
  }
  left.get(t).push(end);
}

/** A folder that is removed after the test. */
export function folder(t) {
  const path = mkdtempSync(join(tmpdir(), 'squall-page-'));
  afterwards(t, () => rmSync(path, { recursive: true, force: true }));
  return path;
}

/** A game file in its own folder: `base` is a shipped game, `text` the differences. */
export function gameFile(t, name, base, text) {
  const path = join(folder(t), `${name}.toml`);
  writeFileSync(path, `# A game of a test.\nbase = "${scenario(`games/${base}`)}"\n${text}\n`);
  return path;
}

export const readJson = (path) => JSON.parse(readFileSync(path, 'utf8'));

/** A free port of this machine. */
export const freePort = () => new Promise((done, fail) => {
  const server = createServer();
  server.on('error', fail);
  server.listen(0, '127.0.0.1', () => {
    const { port } = server.address();
    server.close(() => done(port));
  });
});

/** A running program. It ends with the test. */
export class Program {
  constructor(t, ...args) {
    this.args = args;
    this.said = '';
    this.code = undefined;
    this.child = spawn(SQUALL, args.map(String), { cwd: tmpdir(), stdio: ['pipe', 'pipe', 'pipe'] });
    this.ended = new Promise((done) => {
      this.child.on('error', (error) => done(error.message));
      this.child.on('close', (code, signal) => done(code ?? signal));
    });
    this.ended.then((code) => { this.code = code; });
    for (const stream of [this.child.stdout, this.child.stderr]) stream.on('data', (text) => { this.said += text; });
    afterwards(t, () => this.end());
  }

  /** Waits for a match in the program's output, and returns the match. */
  hears(pattern) {
    return until(`squall ${this.args.join(' ')} says ${pattern}`, () => {
      const found = this.said.match(pattern);
      assert(found || this.code === undefined, `squall ${this.args.join(' ')} ended with ${this.code}:\n${this.said}`);
      return found;
    });
  }

  /** The address of its page. */
  async url() {
    return (await this.hears(/at (http:\S+) \(Ctrl-C/))[1];
  }

  /** Ends the program like Ctrl-C, by force if necessary. Returns its exit status. */
  async end() {
    if (this.code !== undefined) return this.code;
    this.child.kill('SIGINT');
    const late = setTimeout(() => this.child.kill('SIGKILL'), LEAVE_MS);
    const code = await this.ended;
    clearTimeout(late);
    return code;
  }

  /** Kills the program, as a power cut would. */
  async kill() {
    this.child.kill('SIGKILL');
    await this.ended;
  }
}

/** Runs the program to its end. Returns its output. */
export async function squall(t, ...args) {
  const program = new Program(t, ...args);
  assert.equal(await program.ended, 0, `squall ${args.join(' ')}:\n${program.said}`);
  return program.said;
}

/** A page in a browser. A test that uses it fails on any error on the page's console, except those that it `allows`. */
export class Sight {
  /** Opens a page with a game, and waits until it is drawn. */
  static async open(t, browser, url, how = {}) {
    const sight = await Sight.load(t, browser, url, how);
    await sight.until('a picture is drawn', () => squall.drawn > 0 && squall.frame !== null);
    return sight;
  }

  /** Opens any page. */
  static async load(t, browser, url, { size = { width: 1440, height: 900 }, allows = null, before = null, ...more } = {}) {
    const context = await browser.newContext({ viewport: size, ...more });
    const page = await context.newPage();
    page.setDefaultTimeout(LIMIT_MS);
    if (before) await page.addInitScript(before);
    const sight = new Sight(context, page, allows);
    afterwards(t, () => sight.close());
    if (WEB) {
      const file = (address) => join(WEB, new URL(address).pathname.replace(/\/$/, '/index.html'));
      await page.route((address) => existsSync(file(address)), async (route) => {
        // A report's page is elsewhere.
        const { pathname, search } = new URL(route.request().url());
        const leads = pathname === '/' && search === '' && (await route.fetch({ maxRedirects: 0 })).status() === 307;
        return leads ? route.continue() : route.fulfill({ path: file(route.request().url()) });
      });
    }
    await page.goto(url);
    return sight;
  }

  constructor(context, page, allows) {
    this.context = context;
    this.page = page;
    this.errors = [];
    const hear = (text) => allows?.test(text) || this.errors.push(text);
    page.on('console', (message) => ['error', 'warning'].includes(message.type()) && hear(message.text()));
    page.on('pageerror', (error) => hear(error.stack ?? error.message));
  }

  async close() {
    await this.context.close();
    assert.deepEqual(this.errors, [], 'errors on the page\'s console');
  }

  /** Waits until `condition`, which runs in the page, returns a truthy value, and returns it. */
  async until(what, condition, arg = undefined) {
    try {
      const handle = await this.page.waitForFunction(condition, arg, { polling: LOOK_MS, timeout: LIMIT_MS });
      return await handle.jsonValue();
    } catch (error) {
      const now = await this.get(() => typeof squall === 'undefined' ? document.body.innerText.slice(0, 500) : JSON.stringify({ mode: squall.mode, helm: squall.helm && { ...squall.helm, report: Object.keys(squall.helm.report ?? {}) }, t_s: squall.t_s, score: squall.score, state: squall.state,
        player: squall.player, selected: squall.selected, driving: squall.driving, connected: squall.connected,
        notices: document.getElementById('notices').textContent })).catch(() => 'nothing');
      throw new Error(`${what}: ${error.message.split('\n')[0]}; the page shows ${now}`);
    }
  }

  /** The result of a function that runs in the page. */
  get(read, arg = undefined) {
    return this.page.evaluate(read, arg);
  }

  text(selector) {
    return this.page.textContent(selector);
  }

  press(selector) {
    return this.page.click(selector);
  }

  /** Presses keys, one after another. */
  async keys(...keys) {
    for (const key of keys) await this.page.keyboard.press(key);
  }

  /** Runs `act`, which ends the connection, and waits until the page has been greeted on a new one. */
  async greetedAnew(act) {
    const hello = await this.page.evaluateHandle(() => squall.hello);
    await act();
    await this.until('the page is greeted again', (before) => squall.connected && squall.hello !== before, hello);
    await this.until('the page shows a picture', () => squall.frame !== null);
  }

  /** Waits until the chip beside the game's name shows this. */
  phase(word) {
    return this.until(`the phase is ${word}`, (want) => document.getElementById('phase').textContent === want, word);
  }

  /** Waits for a picture later than the current one. */
  async goesOn() {
    // A page that has just been greeted shows no time yet.
    const { t_s } = await this.until('a picture is shown', () => Number.isFinite(squall.t_s) && { t_s: squall.t_s });
    return this.until(`the clock runs on from ${t_s}`, (before) => squall.t_s > before && squall.t_s, t_s);
  }
}
