// The page of a report: what kind it is, and what is wrong with it. Texts of a report only ever become text.

import { Theme } from './theme.js';
import { Tournament } from './tournament.js';
import { Training } from './training.js';
import { make, plain, write } from './words.js';

/** A training that goes on is looked at again so often, ms. */
const AGAIN_MS = 10_000;
const KINDS = { tournament: Tournament, training: Training };

const byId = (id) => document.getElementById(id);

/** Says what is wrong with the report, or what is missing in it. */
function remark(...texts) {
  byId('remarks').replaceChildren(...texts.filter(Boolean).map((text) => make('p', 'note', text)));
}

async function fetched() {
  const answer = await fetch('/report.json');
  if (!answer.ok) throw new Error('the server has no report: squall view FILE shows one');
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
      if (!kind) throw new Error(`its kind is ${report.kind}`);
      this.shown = new kind(byId('report'));
      this.tell(report);
      if (this.shown.goesOn) setInterval(() => this.again(), AGAIN_MS);
    } catch (error) {
      remark(`This report cannot be shown: ${error.message}`);
    }
  }

  /** Shows what has come since. */
  async again() {
    if (document.hidden) return;
    try {
      this.tell(await fetched());
    } catch (error) {
      remark(`What is shown is not the newest: ${error.message}`);
    }
  }

  tell(report) {
    const { name, facts, remarks } = this.shown.tell(report);
    write(byId('name'), plain(name));
    document.title = `${plain(name)} – Squall`;
    write(byId('facts'), facts);
    remark(...remarks);
  }
}

new ReportPage().start();
