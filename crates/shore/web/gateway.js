// The status of a real boat's gateway in words: the boat's state, its urgency, and the age of every value.

import { number } from './words.js';

/** Gateways report twice per second. After this time without a report a gateway is silent, s. */
const SILENT_S = 3;
/** Values older than this are marked as old, s. */
const FIX_OLD_S = 2;
const CONTROL_OLD_S = 2;
const BATTERY_OLD_S = 10;

/** How each state begins, its label and its style. The rest of the text is the cause or the task. */
const STATES = [
  ['e-stopped', 'stopped', 'E-stopped', 'bad'], ['failsafe', 'failsafe', 'Failsafe', 'bad'], ['armed', 'armed', 'Armed', 'good'],
  ['delegated', 'delegated', 'Delegated', 'task'], ['disarmed', 'disarmed', 'Disarmed', 'plain'],
  // Only in recordings of earlier versions.
  ['safed', 'disarmed', 'Disarmed', 'plain'],
];

/** The modes of a boat's own controller, by the letter that gateways report. */
const MODES = {
  L: 'standby', T: 'thrust', C: 'heading', G: 'heading and speed', R: 'station keeping', N: 'river navigation', W: 'mission', I: 'autopilot',
  3: 'compass calibration', H: 'to the recovery point', D: 'depth', S: 'gravity vector', F: 'receiving a mission', '!': 'boot loader',
};

const age = (seconds) => `${number(seconds, 1, 's')} ago`;

/** The state of a real boat: `kind`, `label`, `detail` (cause or task), `tone`, `silent_s`, `facts` and `missing`; null for a simulated one. */
export function readStatus(game, index, now_ms) {
  const { name, external } = game.vehicles[index];
  if (!external) return null;
  // Logs of other programs contain no reports of gateways.
  if (game.mode !== 'live' && game.statuses.size === 0) return null;
  const status = game.statuses.get(name);
  if (!status) return { name, kind: 'unknown', label: 'No gateway', detail: '', tone: 'warn', facts: [], missing: [], alarms: [], failsafes: 0, silent_s: 0, link: false };
  // A recording shows ages at the time of the report.
  const waited_s = game.mode === 'live' ? Math.max(0, (now_ms - game.heard_ms.get(name)) / 1000) : 0;
  // The end of a game ends the reports too.
  const ended = game.mode === 'live' && game.isOver && waited_s > SILENT_S;
  const silent = waited_s > SILENT_S && !ended;
  const state = status.state ?? '';
  const [begins, kind, label, tone] = STATES.find(([word]) => state.startsWith(word)) ?? [state, 'other', state || '–', 'warn'];
  const detail = silent ? `no report from its gateway for ${number(waited_s, 0, 's')}; last state: ${state}` : state.slice(begins.length).replace(/^[:,\s]+/, '');
  if (ended) {
    return { name, kind: 'ended', said: 'ended', label: 'Game over', detail: `last state: ${label.toLowerCase()}`, tone: 'plain', silent_s: 0, facts: [], missing: [], alarms: [], fence: null, failsafes: 0, link: true };
  }
  return {
    name, kind: silent ? 'silent' : kind, label: silent ? 'Silent' : label, detail, tone: silent ? 'bad' : tone, silent_s: silent ? waited_s : 0,
    said: kind, facts: factsOf(status, waited_s), fence: status.geofence ?? null, missing: status.missing ?? [], alarms: status.alarms ?? [], failsafes: status.failsafes?.length ?? 0, link: status.link === 'up' && !silent,
  };
}

/** Values in words, with their names, and whether they are old or bad. `short` is for the list. */
function factsOf(status, waited_s) {
  const later = (seconds) => (Number.isFinite(seconds) ? seconds + waited_s : NaN);
  const [fix_s, battery_s, mode_s] = [later(status.nav_age_s), later(status.battery_age_s), later(status.mode_age_s)];
  const facts = [{ name: 'Link', short: status.link === 'up' ? 'link up' : 'no link', words: status.link ?? '–', bad: status.link !== 'up' }];
  // The boat's own faults do not stop it, but are listed first.
  for (const words of status.alarms ?? []) facts.unshift({ name: 'Alarm', short: words.split(',')[0], words, bad: true });
  // In a dry run the boat is only sent standby, whatever its state.
  if (typeof status.would_send === 'string') {
    facts.unshift({ name: 'Dry run', short: 'DRY RUN', words: `sends only standby${status.would_send ? `, instead of ${status.would_send}` : ''}`, bad: true });
  }
  facts.push(Number.isFinite(fix_s)
    ? { name: 'Fix', short: `fix ${number(fix_s, 1, 's')}`, words: age(fix_s), bad: fix_s > FIX_OLD_S }
    : { name: 'Fix', short: 'no fix', words: 'none', bad: true });
  if (Number.isFinite(status.battery_v)) facts.push(batteryFact(status, battery_s));
  const told = Number.isFinite(mode_s) ? `, ${age(mode_s)}` : '';
  const { clearance_m, stopping_m } = status.geofence ?? {};
  if (Number.isFinite(clearance_m)) {
    const stops = Number.isFinite(stopping_m) ? `, stops in ${number(stopping_m, 1, 'm')}` : '';
    facts.push({ name: 'Geofence', words: `${number(clearance_m, 1, 'm')} to its edge${stops}`, bad: clearance_m < (stopping_m ?? 0) });
  }
  if (status.operator) facts.push({ name: 'In control', words: `${status.operator}${told}`, bad: mode_s > CONTROL_OLD_S });
  if (status.mode) facts.push({ name: 'Mode', words: `${MODES[status.mode] ?? status.mode}${told}`, bad: mode_s > CONTROL_OLD_S });
  const last = status.failsafes?.at(-1);
  if (last) facts.push({ name: 'Failsafes', words: `${status.failsafes.length}; latest: ${last.cause ?? last}`, bad: false });
  return facts;
}

/** The charge, if the gateway knows it, and the voltage. */
function batteryFact({ battery_v, battery_pct }, age_s) {
  const old = age_s > BATTERY_OLD_S;
  const volts = number(battery_v, 1, 'V');
  const left = Number.isFinite(battery_pct) ? number(battery_pct, 0, '%') : volts;
  const since = Number.isFinite(age_s) ? `, ${age(age_s)}` : '';
  return { name: 'Battery', short: `${left}${old ? ` ${age(age_s)}` : ''}`, words: `${left}${left === volts ? '' : ` (${volts})`}${since}`, bad: old };
}

/** The states of all real boats. */
export function readStatuses(game, now_ms) {
  const readings = [];
  for (let index = 0; index < game.count; index++) {
    const reading = readStatus(game, index, now_ms);
    if (reading) readings.push({ ...reading, index });
  }
  return readings;
}
