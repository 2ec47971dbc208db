// The details of the selected boat: its mode, its decision and the reasons, its steering and its navigation error.

import { MARKS } from './game.js';
import { Operate } from './operate.js';
import { Rose } from './rose.js';
import { keep, recall } from './storage.js';
import { bearing, fill, make, number, options, plain, show, write } from './words.js';

const COLLECTIVE = 'all together';
const UNSEEN = 'No utilities yet for this decision. Step once to compute them.';

/** Whether a report has functions without their utilities. */
export const isBare = (report) => report?.functions?.length > 0 && !report.functions.some((each) => each.utilities?.length > 0);

/** Whether the rose is unfolded. */
const ROSE_KEY = 'squall.rose';

export class Details {
  /** `on` has `follow()`, `drive()` and `close()`, and what `Operate` needs. */
  constructor(on) {
    this.operate = new Operate(on);
    this.pane = document.getElementById('pane-boat');
    this.build(on);
    this.rose = new Rose(this.canvas);
    this.wanted = COLLECTIVE;
    this.chooser.addEventListener('change', () => { this.wanted = this.chooser.value; });
  }

  build(on) {
    this.none = make('p', 'faint', 'No boat selected. Click one on the chart or in the list.');
    this.name = make('h2');
    this.about = make('p', 'faint');
    this.follow = this.button('follow', 'Follow', 'Keep this boat at the centre of the chart (o)', on.follow);
    this.drive = this.button('drive', 'Drive', 'Drive this boat yourself (d)', on.drive);
    this.close = this.button('deselect', '×', 'Deselect the boat (Escape)', on.close);
    this.close.setAttribute('aria-label', 'Close');
    this.matter = make('p', 'trouble');
    this.summary = make('p', 'boat-summary');
    this.summary.id = 'boat-summary';
    const head = make('div', 'boat-head', '', make('div', 'boat-name', '', this.name, this.about, this.matter), this.follow, this.drive, this.close);
    this.steeringNote = make('p', 'note');
    this.facts = make('dl', 'facts');
    this.facts.id = 'boat-facts';
    this.thrust = make('div', 'thrust', '', this.bar('Port'), this.bar('Starboard'));
    this.canvas = make('canvas');
    this.canvas.id = 'rose';
    this.canvas.setAttribute('role', 'img');
    this.chooser = make('select');
    this.chooser.id = 'rose-function';
    this.chooser.setAttribute('aria-label', 'Objective function');
    this.reason = make('p', 'faint');
    this.reason.id = 'helm-reason';
    this.key = make('p', 'rose-key faint', '', make('span', '', 'Angle: course. Distance: speed. Ring: chosen. Diamond: the boat now.'),
      make('span', 'heat-scale', '', make('span', '', 'utility 0'), make('span', 'heat'), make('span', '', '100')));
    this.behaviours = make('div', 'behaviours');
    this.behaviours.id = 'behaviours';
    this.policy = make('dl', 'facts');
    this.policy.id = 'policy';
    this.observed = make('dl', 'facts');
    this.observed.id = 'observed';
    this.observedBox = make('details', '', '', make('summary', '', 'Observation'), this.observed);
    this.policyBox = make('div', '', '', make('h3', '', 'Policy'), this.policy, this.observedBox);
    this.variables = make('dl', 'facts');
    this.variables.id = 'variables';
    // The facts fit on one line, so that the rose below is visible as a whole.
    this.picture = make('details', 'helm-picture', '', make('summary', '', 'Helm'), make('div', 'helm-rose', '', this.chooser, this.canvas, this.key));
    this.picture.open = recall(ROSE_KEY) !== 'false';
    this.picture.addEventListener('toggle', () => keep(ROSE_KEY, String(this.picture.open)));
    this.helmBox = make('div', '', '', this.policyBox, this.behaviourHead = make('h3', '', 'Behaviours'), this.behaviours, this.variableHead = make('h3', '', 'Variables'), this.variables);
    this.body = make('div', 'boat', '', head, this.summary, this.steeringNote, this.operate.element, this.picture, this.reason, this.facts,
      make('h3', '', 'Thrust'), this.thrust, this.helmBox);
    this.pane.replaceChildren(this.none, this.body);
    this.operate.bind();
  }

  button(id, text, title, press) {
    const button = make('button', '', text);
    Object.assign(button, { id, type: 'button', title });
    button.addEventListener('click', press);
    return button;
  }

  bar(side) {
    return make('div', 'bar-row', '', make('span', '', side), make('span', 'bar middle', '', make('span', 'fill')), make('span', 'value'));
  }

  /** Whether the rose is visible, so that its functions are needed. */
  get visible() {
    return this.pane.offsetParent !== null;
  }

  /** `readings` are the gateways' reports on real boats. */
  tell(game, following, driver, readings) {
    const index = game.indexOf.get(game.selected) ?? -1;
    show(this.none, index < 0);
    show(this.body, index >= 0);
    if (index < 0 || !this.visible) return;
    const vehicle = game.vehicles[index];
    const team = game.chart.teams[vehicle.team]?.name ?? '';
    write(this.name, plain(vehicle.name));
    this.name.className = `team-${vehicle.team}`;
    const source = vehicle.external ? 'real boat' : vehicle.strategy && plain(vehicle.strategy);
    write(this.about, [plain(team), source, `${number(vehicle.length_m)} m`].filter(Boolean).join(' · '));
    this.follow.setAttribute('aria-pressed', String(following));
    show(this.drive, Boolean(vehicle.teleop) && game.mode === 'live');
    this.drive.disabled = !game.hello.rights;
    this.drive.title = game.hello.rights ? 'Drive this boat yourself (d)' : 'This page may only watch.';
    this.drive.setAttribute('aria-pressed', String(driver === 'you'));
    const steering = { you: 'You are driving this boat. Press Escape to stop.', other: 'Another page is driving this boat.' }[driver] ?? '';
    write(this.steeringNote, steering);
    show(this.steeringNote, steering !== '');
    this.tellFacts(game, index);
    this.tellThrust(game, index);
    this.operate.tell(game, readings.find((reading) => reading.index === index) ?? null);
    this.tellHelm(game, index);
  }

  tellFacts(game, index) {
    const matter = MARKS.filter(([bit]) => game.marks[index] & bit).map(([, , text]) => text);
    write(this.matter, matter.join(', '));
    this.matter.title = matter.join(', ');
    // A single line for both, so that the rose below stays in place.
    show(this.matter, matter.length > 0);
    show(this.about, matter.length === 0);
    const report = game.helm?.report;
    const error = game.estimateError();
    const flag = game.chart.field.flags?.[game.carrying[index]];
    const carries = flag ? `carries the ${plain(game.chart.teams[flag.team]?.name ?? '')} flag` : '';
    const mode = report?.mode && !matter.includes(report.mode) ? plain(report.mode).replaceAll(':', ' › ') : '';
    const motion = [number(game.speed[index], 1, 'm/s'), bearing((game.course[index] * 180) / Math.PI)];
    write(this.summary, [mode, carries, ...motion].filter(Boolean).join(' · '));
    const facts = [
      ['Heading', bearing((game.toH[index] * 180) / Math.PI)],
      ['Over ground', `${bearing((game.course[index] * 180) / Math.PI)} at ${number(game.speed[index], 2, 'm/s')}`],
    ];
    if (game.estimate) {
      const fix_age_s = game.estimate.fix_age_s;
      const fix = Number.isFinite(fix_age_s) ? `; fix ${number(fix_age_s, 1, 's')} old` : '';
      facts.push(['Navigation error', error === null ? `–${fix}` : `${number(error, 2, 'm')}${fix}`]);
    }
    if (report) {
      facts.push(['Decision', report.hold ? `hold: ${report.hold}` : `${bearing(report.course_deg)} at ${number(report.speed_m_s, 2, 'm/s')}`]);
    }
    this.tellPairs(this.facts, facts);
  }

  tellPairs(place, pairs) {
    fill(place, pairs, () => make('div', '', '', make('dt'), make('dd')), (row, [name, value]) => {
      write(row.firstElementChild, name);
      write(row.lastElementChild, value);
    });
  }

  tellThrust(game, index) {
    const values = [game.port[index], game.starboard[index]];
    this.most = Math.max(this.forBoat === game.selected ? this.most : 10, ...values.map(Math.abs));
    this.forBoat = game.selected;
    values.forEach((value, side) => {
      const row = this.thrust.children[side];
      const bar = row.children[1].firstElementChild;
      const part = Math.round((Math.abs(value) / this.most) * 50);
      bar.style.left = `${value < 0 ? 50 - part : 50}%`;
      bar.style.width = `${part}%`;
      write(row.children[2], number(value, 0, 'N'));
    });
  }

  tellHelm(game, index) {
    const helm = game.helm;
    const report = helm?.report;
    // A helm keeps utilities only while a page requests them; a paused game computes none.
    const unseen = isBare(report) && game.state?.phase === 'paused';
    const words = unseen ? UNSEEN : report ? this.computedWords(helm) : plain(helm?.reason ?? 'Waiting for the boat’s helm …');
    write(this.reason, words);
    show(this.reason, words !== '');
    show(this.helmBox, Boolean(report));
    show(this.picture, Boolean(report) && !unseen);
    if (!report) return;
    const functions = report.functions ?? [];
    const named = functions.map((each) => [each.contact ? `${each.behaviour} · ${each.contact}` : each.behaviour, each]);
    const known = new Map(named);
    options(this.chooser, [[COLLECTIVE, 'Weighted sum'], ...[...known.keys()].map((name) => [name, plain(name)])]);
    const chosen = known.get(this.wanted);
    const value = chosen ? this.wanted : COLLECTIVE;
    if (this.chooser.value !== value) this.chooser.value = value;
    const utilities = chosen ? chosen.utilities : report.collective;
    this.rose.draw(report, utilities?.length > 0 ? utilities : null, {
      course_deg: (game.course[index] * 180) / Math.PI,
      speed_m_s: game.speed[index],
      speed_max_m_s: game.vehicles[index].speed_max_m_s || 1,
    });
    this.canvas.setAttribute('aria-label',
      `Rose: chosen course ${bearing(report.course_deg)}, speed ${number(report.speed_m_s, 1)} metres per second`);
    this.tellBehaviours(report);
    this.tellPolicies(report.policies ?? []);
    const variables = (report.variables ?? []).map((each) => [plain(each.name), String(each.value)]);
    show(this.variableHead, variables.length > 0);
    this.tellPairs(this.variables, variables);
  }

  tellPolicies(policies) {
    const pairs = policies.flatMap((policy) => [
      [plain(policy.behaviour), policy.model],
      ['Proposes', policy.fault ?? policy.option ?? `${bearing(policy.course_deg)} at ${number(policy.speed_m_s, 2, 'm/s')}`],
      ...(policy.actions ?? []).map(([asked, share]) => [`${number(100 * share, 0)}\u00a0%`, asked]),
    ]);
    const observed = policies.flatMap((policy) => policy.observed ?? []);
    show(this.policyBox, policies.length > 0);
    show(this.observedBox, observed.length > 0);
    this.tellPairs(this.policy, pairs);
    if (this.observedBox.open) this.tellPairs(this.observed, observed.map(([name, value]) => [plain(name), number(value, 3)]));
  }

  computedWords(helm) {
    if (!helm.computed) return '';
    if (helm.agrees === false) return 'Recomputed from the recording. The order does NOT match the recorded one.';
    return `Recomputed from the recording${helm.agrees ? '; the order matches the recorded one.' : '.'}`;
  }

  tellBehaviours(report) {
    const behaviours = report.behaviours ?? [];
    show(this.behaviourHead, behaviours.length > 0);
    const most = Math.max(1, ...behaviours.map((each) => each.weight));
    const row = () => make('div', 'behaviour', '', make('span', 'name'), make('span', 'run-state'),
      make('span', 'bar', '', make('span', 'fill')), make('span', 'value'));
    fill(this.behaviours, behaviours, row, (line, each) => {
      const classes = `behaviour ${each.run_state}`;
      if (line.className !== classes) line.className = classes;
      write(line.children[0], plain(each.name));
      line.children[0].title = `${each.name} (${each.kind})`;
      write(line.children[1], each.run_state);
      line.children[2].firstElementChild.style.width = `${Math.round((100 * each.weight) / most)}%`;
      write(line.children[3], number(each.weight, 0));
    });
  }
}
