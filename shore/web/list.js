// The list of boats: one line each, by team, with what is the matter with it.

import { MARKS } from './game.js';
import { fill, make, number, plain, write } from './words.js';

export class BoatList {
  /** `choose(name)` is called for the boat that somebody presses. */
  constructor(choose) {
    this.place = document.getElementById('boat-list');
    this.choose = choose;
    this.rows = [];
    this.place.addEventListener('click', (event) => {
      const row = event.target.closest('[data-vehicle]');
      if (row) this.choose(row.dataset.vehicle);
    });
    this.place.addEventListener('keydown', (event) => this.key(event));
  }

  /** Up and down go through the list. */
  key(event) {
    const step = { ArrowDown: 1, ArrowUp: -1 }[event.key];
    const at = this.rows.findIndex((row) => row.button === document.activeElement);
    if (!step || at < 0) return;
    event.preventDefault();
    event.stopPropagation();
    this.rows[Math.min(this.rows.length - 1, Math.max(0, at + step))].button.focus();
  }

  greet(game) {
    this.rows = [];
    this.place.replaceChildren();
    const teams = game.chart.teams;
    teams.forEach((team, index) => {
      const members = game.vehicles.map((vehicle, at) => at).filter((at) => game.vehicles[at].team === index);
      if (members.length === 0) return;
      const head = make('h3', `team-${index}`, '', make('span', 'swatch'), plain(team.name), make('small', '', ` ${members.length}`));
      this.place.append(head);
      const box = make('div', 'boat-rows');
      this.place.append(box);
      fill(box, members, () => this.row(), (button, at) => {
        button.dataset.vehicle = game.vehicles[at].name;
        write(button.children[0], plain(game.vehicles[at].name));
        this.rows.push({ button, at, state: button.children[1], speed: button.children[2] });
      });
    });
  }

  row() {
    const button = make('button', 'boat-row', '', make('span', 'name'), make('span', 'state'), make('span', 'speed'));
    button.type = 'button';
    return button;
  }

  tell(game) {
    this.selected = game.selected;
    if (this.place.offsetParent === null) return;
    for (const { button, at, state, speed } of this.rows) {
      const chosen = game.vehicles[at].name === game.selected;
      if ((button.getAttribute('aria-pressed') === 'true') !== chosen) button.setAttribute('aria-pressed', String(chosen));
      write(state, this.words(game, at));
      write(speed, game.frames > 0 ? number(game.speed[at], 1, 'm/s') : '');
    }
  }

  words(game, at) {
    const words = [];
    if (game.carrying[at] >= 0) {
      const flag = game.chart.field.flags[game.carrying[at]];
      words.push(`carries the ${plain(game.chart.teams[flag?.team]?.name ?? '')} flag`);
    }
    for (const [bit, , text] of MARKS) if (game.marks[at] & bit) words.push(text);
    const status = game.statuses.get(game.vehicles[at].name);
    if (status) words.push(`gateway ${status.state}`);
    else if (game.vehicles[at].external) words.push('real boat');
    return words.join(', ');
  }
}
