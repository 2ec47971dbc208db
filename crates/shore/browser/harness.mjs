// What the tests of the page stand on: the program in processes of its own, a browser, and waiting for things with a limit.

import assert from 'node:assert/strict';
import { spawn } from 'node:child_process';
import { accessSync, constants, existsSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { createServer } from 'node:net';
import { tmpdir } from 'node:os';
import { delimiter, join, resolve } from 'node:path';
import { fileURLToPath } from 'node:url';
import { chromium } from 'playwright-core';

/** The limit of every wait, ms: machines are slow. Shorter ones are for those who write tests. */
export const LIMIT_MS = Number(process.env.LIMIT_MS ?? 60_000);
/** How often a condition is looked at, ms. */
const LOOK_MS = 40;
/** How long a program has to end by itself, ms. */
const LEAVE_MS = 10_000;

/** The repository. */
export const ROOT = resolve(fileURLToPath(import.meta.url), '../../../..');
const SQUALL = resolve(process.env.SQUALL ?? join(ROOT, 'target/release/squall'));
/** To work on the page without building the program: its files are taken from this folder. */
const WEB = process.env.SQUALL_WEB && resolve(process.env.SQUALL_WEB);
const FLAGS = ['--headless', '--no-sandbox', '--disable-gpu', '--disable-quic', '--no-first-run', '--disable-background-networking',
  '--disable-component-update', '--disable-sync',
  // A browser trusts no page from elsewhere to talk to this machine, and takes one from the folder for such a page.
  ...(WEB ? ['--disable-features=LocalNetworkAccessChecks'] : [])];

/** A file of the folder scenarios. */
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
  assert(found, 'no chromium on PATH: install it, or say in CHROMIUM where it is');
  return found;
}

/** A browser without a window. */
export const openBrowser = () => chromium.launch({ executablePath: browserPath(), args: FLAGS });

/** Another browser, as another person has, for one test. */
export async function openAnother(t) {
  const browser = await openBrowser();
  afterwards(t, () => browser.close());
  return browser;
}

/** Waits until `condition` gives something true, and gives it. */
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

/** Does this once the test is over: what was begun last ends first. */
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

/** A folder that goes with the test. */
export function folder(t) {
  const path = mkdtempSync(join(tmpdir(), 'squall-page-'));
  afterwards(t, () => rmSync(path, { recursive: true, force: true }));
  return path;
}

/** A game file in a folder of its own: `base` is one of ours, `text` what is different. */
export function gameFile(t, name, base, text) {
  const path = join(folder(t), `${name}.toml`);
  writeFileSync(path, `# A game of a test.\nbase = "${scenario(`games/${base}`)}"\n${text}\n`);
  return path;
}

export const readJson = (path) => JSON.parse(readFileSync(path, 'utf8'));

/** A port of this machine that nobody listens on. */
export const freePort = () => new Promise((done, fail) => {
  const server = createServer();
  server.on('error', fail);
  server.listen(0, '127.0.0.1', () => {
    const { port } = server.address();
    server.close(() => done(port));
  });
});

/** The program at work. It ends with the test. */
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

  /** Waits until it has said something, and gives that. */
  hears(pattern) {
    return until(`squall ${this.args.join(' ')} says ${pattern}`, () => {
      const found = this.said.match(pattern);
      assert(found || this.code === undefined, `squall ${this.args.join(' ')} ended with ${this.code}:\n${this.said}`);
      return found;
    });
  }

  /** Where its page is. */
  async url() {
    return (await this.hears(/at (http:\S+) \(Ctrl-C/))[1];
  }

  /** Ends it as Ctrl-C does, by force if it does not listen; its exit status. */
  async end() {
    if (this.code !== undefined) return this.code;
    this.child.kill('SIGINT');
    const late = setTimeout(() => this.child.kill('SIGKILL'), LEAVE_MS);
    const code = await this.ended;
    clearTimeout(late);
    return code;
  }

  /** Ends it as a power cut does. */
  async kill() {
    this.child.kill('SIGKILL');
    await this.ended;
  }
}

/** Runs the program to its end, and gives what it said. */
export async function squall(t, ...args) {
  const program = new Program(t, ...args);
  assert.equal(await program.ended, 0, `squall ${args.join(' ')}:\n${program.said}`);
  return program.said;
}

/** A page in a browser. A test with it fails on any error that the page's console shows, but for those it `allows`. */
export class Sight {
  /** A page with a game on it, once it is drawn. */
  static async open(t, browser, url, how = {}) {
    const sight = await Sight.load(t, browser, url, how);
    await sight.until('a picture is drawn', () => squall.drawn > 0 && squall.frame !== null);
    return sight;
  }

  /** Any page. */
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
        // A report has its page elsewhere.
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
    assert.deepEqual(this.errors, [], 'errors in the page');
  }

  /** Waits until `condition`, which runs in the page, gives something true; gives it. */
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

  /** What a function that runs in the page gives. */
  get(read, arg = undefined) {
    return this.page.evaluate(read, arg);
  }

  text(selector) {
    return this.page.textContent(selector);
  }

  /** Presses something. */
  press(selector) {
    return this.page.click(selector);
  }

  /** Strikes keys, one after another. */
  async keys(...keys) {
    for (const key of keys) await this.page.keyboard.press(key);
  }

  /** What is done to the connection meanwhile: waits until the page was greeted on another one. */
  async greetedAnew(act) {
    const hello = await this.page.evaluateHandle(() => squall.hello);
    await act();
    await this.until('the page is greeted anew', (before) => squall.connected && squall.hello !== before, hello);
    await this.until('it shows a picture', () => squall.frame !== null);
  }

  /** Waits until the chip beside the game's name says this. */
  phase(word) {
    return this.until(`the phase is ${word}`, (want) => document.getElementById('phase').textContent === want, word);
  }

  /** Waits for a picture of a later time than now. */
  async goesOn() {
    // A page that was greeted a moment ago shows no time yet.
    const { t_s } = await this.until('there is a picture', () => Number.isFinite(squall.t_s) && { t_s: squall.t_s });
    return this.until(`the clock runs on from ${t_s}`, (before) => squall.t_s > before && squall.t_s, t_s);
  }
}
