// The page of a report. Strings from a report are only ever inserted as text.

import { Sweep } from './sweep.js';
import { Theme } from './theme.js';
import { Tournament } from './tournament.js';
import { Training } from './training.js';
import { make, plain, show, write } from './words.js';

/** Refresh interval for a training run in progress, ms. */
const AGAIN_MS = 10_000;
const KINDS = { sweep: Sweep, tournament: Tournament, training: Training };

const byId = (id) => document.getElementById(id);

/** Shows what is wrong with the report or missing in it. */
function remark(...texts) {
  byId('remarks').replaceChildren(...texts.filter(Boolean).map((text) => make('p', 'note', text)));
}

async function fetched() {
  const answer = await fetch('/report.json');
  if (!answer.ok) throw new Error('the server has no report; to show one, use squall view FILE');
  return answer.json();
}

class ReportPage {
  constructor() {
    this.theme = new Theme(() => this.shown?.draw());
    this.shown = null;
  }

  async start() {
    try {
      const report = await fetched();
      const kind = KINDS[report.kind];
      if (!kind) throw new Error(`unknown kind ${report.kind}`);
      this.shown = new kind(byId('report'));
      this.tell(report);
      if (this.shown.goesOn) setInterval(() => this.again(), AGAIN_MS);
    } catch (error) {
      remark(`This report cannot be shown: ${error.message}`);
    }
  }

  /** Shows new data. */
  async again() {
    if (document.hidden) return;
    try {
      this.tell(await fetched());
    } catch (error) {
      remark(`The data shown is outdated: ${error.message}`);
    }
  }

  tell(report) {
    const { name, facts, chip: [state, tone] = ['', ''], remarks } = this.shown.tell(report);
    write(byId('name'), plain(name));
    document.title = `${plain(name)} – Squall`;
    write(byId('facts'), facts);
    write(byId('state'), state);
    byId('state').dataset.tone = tone;
    show(byId('state'), state !== '');
    remark(...remarks);
  }
}

new ReportPage().start();
