// A tournament or a league: ratings, also over time, who beats whom, each entry's results, and the games of two entries, which can be watched.
// All of it can be limited to a sea, or to a kind of entry.

import { addressOfGame, keepAddress } from './address.js';
import { CurveChart } from './curve_chart.js';
import { Dominance } from './dominance.js';
import { cell, head, sortedTable, tableOf, watch } from './table.js';
import { clockShort, make, number, options, plain, show, stem } from './words.js';

/** Number of games listed at first, and added each time. */
const LISTED = 100;
/** Minimum number of seeds for an interval: as in crates/experiment/src/estimate.rs. */
const SEEDS_MIN = 5;
const RESULTS = [['', 'all'], ['won', 'won'], ['drawn', 'drawn'], ['lost', 'lost']];
/** Counts per entry: title, key. */
const COUNTS = [['Points', 'score'], ['Grabs', 'grabs'], ['Captures', 'captures'], ['Tags', 'tags'], ['Tagged', 'tagged'],
  ['Out of bounds', 'out_of_bounds'], ['Collisions', 'collisions']];

const percent = (count, of) => Math.round((100 * count) / Math.max(1, of));
const signed = (value) => `${value > 0 ? '+' : ''}${number(value, 2)}`;
export class Tournament {
  constructor(place) {
    this.place = place;
    this.ratings = make('section');
    this.ratings.id = 'ratings';
    this.overTime = new CurveChart('Rating', 'Elo');
    this.history = make('section', '', '', make('h2', '', 'Rating over time'), make('p', 'faint', 'Computed from the games so far, in the order in which they were played.'),
      make('div', 'charts', '', this.overTime.box));
    this.entry = make('section');
    this.entry.id = 'entry';
    this.orders = { ratings: { column: 0, down: false }, entry: { column: 6, down: false } };
    this.beats = new Dominance((entry) => this.addressOf(entry));
    this.filters = make('div', 'choose');
    this.filters.id = 'filters';
    this.selects = { kind: make('select'), sea: make('select') };
    for (const [key, select] of Object.entries(this.selects)) {
      select.id = `filter-${key}`;
      select.addEventListener('change', () => this.limit(key, select.value));
      this.filters.append(make('label', '', '', make('span', '', key === 'sea' ? 'Sea ' : 'Kind '), select));
    }
    this.matrix = make('section');
    this.games = make('section');
    this.games.id = 'games';
    this.filter = make('select');
    this.filter.id = 'games-filter';
    this.listed = LISTED;
    options(this.filter, RESULTS);
    this.filter.addEventListener('change', () => this.drawGames());
    addEventListener('hashchange', () => this.fromAddress());
    place.replaceChildren(this.filters, this.ratings, this.entry, this.beats.box, this.history, this.matrix, this.games);
  }

  /** Whether more data may come: never, because the report is complete. */
  get goesOn() {
    return false;
  }

  tell({ report, unplayable }) {
    this.report = report;
    this.unplayable = unplayable;
    this.seas = report.seas ?? [];
    this.kinds = [...new Set(report.entries.map(({ kind }) => kind))];
    options(this.selects.sea, [['', 'all'], ...this.seas.map(({ sea }) => [stem(sea), plain(stem(sea))])]);
    options(this.selects.kind, [['', 'all'], ...this.kinds.map((kind) => [kind, plain(kind)])]);
    show(this.selects.sea.parentElement, this.seas.length > 0);
    show(this.selects.kind.parentElement, this.kinds.length > 1);
    this.shown = null;
    this.fromAddress();
    const played = report.games_unplayed > 0 ? `, ${report.games_unplayed} games not played` : '';
    const seas = [report.sea, ...this.seas.map(({ sea }) => sea)].filter(Boolean).map((sea) => plain(stem(sea)));
    const facts = `${plain(stem(report.game))}${seas.length > 0 ? `, ${seas.length > 1 ? 'seas' : 'sea'} ${seas.join(', ')}` : ''}. ${report.entries.length} entries, ${report.games_per_pairing} games per pairing, `
      + `${report.seeds_counted} seeds from ${report.seed}${played}. Squall ${report.version} (${report.commit || 'unknown'}).`;
    return { name: report.tournament, facts, remarks: this.remarks() };
  }

  remarks() {
    const { games_left_out, failures, entries } = this.report;
    return [
      entries.length === 0 ? 'No result: no seed has all its games.' : '',
      entries.length > 0 && this.hasFew ? `Only ${this.report.seeds_counted} ${this.report.seeds_counted === 1 ? 'seed' : 'seeds'}: confidence intervals need at least ${SEEDS_MIN}.` : '',
      this.unplayable ? `Games cannot be watched: ${this.unplayable}` : '',
      games_left_out > 0 ? `${games_left_out} games are excluded because others with the same seed are missing.` : '',
      ...failures.slice(0, 5).map((each) => `Could not start: ${each.blue} against ${each.red}, seed ${each.seed}: ${each.why}`),
      failures.length > 5 ? `${failures.length - 5} more games could not start.` : '',
    ];
  }

  /** Whether there are too few seeds for intervals. */
  get hasFew() {
    return this.report.seeds_counted < SEEDS_MIN;
  }

  draw() {
    this.overTime.draw();
  }

  /** The address of an entry's results; of all entries for null. */
  addressOf(entry) {
    const words = new URLSearchParams(location.hash.slice(1));
    for (const key of ['entry', 'row', 'column']) words.delete(key);
    if (entry !== null) words.set('entry', entry);
    return `#${words}`;
  }

  /** Limits what is shown, and puts the limit into the address. */
  limit(key, value) {
    const words = new URLSearchParams(location.hash.slice(1));
    if (value === '') words.delete(key);
    else words.set(key, value);
    history.replaceState(null, '', `#${words}`);
    this.fromAddress();
  }

  /** Shows the results in the address's sea, of entries of its kind. */
  pick(words) {
    const sea = this.seas.findIndex((each) => stem(each.sea) === words.get('sea'));
    const kind = this.kinds.includes(words.get('kind')) ? words.get('kind') : '';
    const shown = `${sea} ${kind}`;
    if (this.shown === shown) return;
    const view = this.seas[sea] ?? this.report;
    Object.assign(this, { shown, sea, kind, view });
    this.selects.sea.value = sea < 0 ? '' : stem(this.seas[sea].sea);
    this.selects.kind.value = kind;
    this.entries = [...view.entries].sort((a, b) => b.rating.elo - a.rating.elo);
    this.cells = new Map(view.matrix.map((each) => [`${each.row} ${each.column}`, each]));
    this.drawRatings();
    this.drawMatrix();
    this.beats.take({ ...view, entries: this.entries }, kind);
  }

  /** Whether an entry is of the chosen kind. */
  isShown(entry) {
    return this.kind === '' || entry.kind === this.kind;
  }

  linkTo(entry, classes = '') {
    const link = make('a', classes, plain(entry));
    link.href = this.addressOf(entry);
    return link;
  }

  drawRatings() {
    const { entries } = this;
    const ends = entries.flatMap(({ rating }) => (this.hasFew ? [rating.elo] : [rating.low ?? rating.elo, rating.high ?? rating.elo]));
    const [low, high] = [Math.min(...ends) - 20, Math.max(...ends) + 20];
    const at = (elo) => `${((elo - low) / (high - low)) * 100}%`;
    const bar = ({ elo, low, high }) => {
      const [span, dot] = [make('i', 'span'), make('i', 'dot')];
      span.style.left = at((this.hasFew ? null : low) ?? elo);
      span.style.right = `calc(100% - ${at((this.hasFew ? null : high) ?? elo)})`;
      dot.style.left = at(elo);
      const box = make('div', 'interval', '', span, dot);
      box.setAttribute('aria-hidden', 'true');
      return make('td', 'wide', '', box);
    };
    const place = new Map(entries.map((entry, i) => [entry, i + 1]));
    const nash = entries.every((entry) => entry.nash);
    const share = (of) => `${number(100 * of, 0)}`;
    const part = ({ mean, low, high }, words) => make('td', 'number', words(mean), make('small', '', this.hasFew || low == null ? '' : ` ${words(low)}…${words(high)}`));
    const count = (text, key) => ({ text, classes: 'number', key: (entry) => entry[key], cell: (entry) => cell(String(entry[key]), 'number') });
    const columns = [
      { text: 'Place', classes: 'number', rises: true, key: (entry) => place.get(entry), cell: (entry) => cell(String(place.get(entry)), 'number') },
      { text: 'Entry', key: ({ name }) => name, cell: ({ name }) => { const th = head('row', ''); th.append(this.linkTo(name)); return th; } },
      ...(this.kinds.length > 1 ? [{ text: 'Kind', key: ({ kind }) => kind, cell: ({ kind }) => cell(plain(kind)) }] : []),
      { text: 'Rating', classes: 'number', key: ({ rating }) => rating.elo, cell: ({ rating }) => cell(number(rating.elo, 0), 'number strong') },
      { text: '95 %', classes: 'number', cell: ({ rating }) => cell(this.interval(rating), 'number') },
      { text: '', cell: ({ rating }) => bar(rating) },
      ...(nash ? [{ text: 'Nash %', classes: 'number', key: (entry) => entry.nash.share.mean, cell: (entry) => part(entry.nash.share, share) },
        { text: 'against it', classes: 'number', key: (entry) => entry.nash.lead.mean, cell: (entry) => part(entry.nash.lead, (of) => number(Math.round(of) + 0, 0)) }] : []),
      count('Won', 'wins'), count('Drawn', 'draws'), count('Lost', 'losses'),
      ...COUNTS.map(([text, key]) => ({ text, classes: 'number', key: (entry) => entry[key].mean, cell: (entry) => this.mean(entry[key]) })),
    ];
    this.ratings.replaceChildren(make('h2', '', 'Ratings'), make('p', 'faint', `Elo: a lead of 100 points means winning 64 %, 200 points 76 %. ${nash ? 'Nash %: the entry’s part in the mixture of entries that no entry beats, and its Elo points against that mixture: cycles and copies of entries do not change it. ' : ''}Columns from Points on `
      + `are means per game${this.hasFew ? '' : ' with 95 % confidence intervals over seeds'}. An entry’s name leads to its opponents and results.`),
    sortedTable('Ratings', columns, entries.filter((entry) => this.isShown(entry)), this.orders.ratings, () => this.drawRatings(), 'list ratings'));
  }

  interval({ low, high }) {
    return this.hasFew || low === null ? 'too few seeds' : `${number(low, 0)} to ${number(high, 0)}`;
  }

  /** A mean per game, with the half width of its interval. */
  mean({ mean, high }) {
    return make('td', 'number', number(mean, 2), make('small', '', this.hasFew || high === null ? '' : ` ± ${number(high - mean, 2)}`));
  }

  /** The ratings after a growing number of games: of all entries, or of one. */
  drawHistory() {
    const { history = [] } = this.report;
    show(this.history, history.length > 1 && this.sea < 0);
    const curves = this.report.entries.map(({ name }, i) => ({ name, colour: i % 4, style: Math.floor(i / 4), xs: history.map(({ games }) => games), values: history.map(({ elo }) => elo[i]) }));
    const ofKind = curves.filter((_, i) => this.isShown(this.report.entries[i]));
    const shown = this.chosenEntry ? curves.filter(({ name }) => name === this.chosenEntry.name) : ofKind;
    this.overTime.take(shown, { title: 'games played', words: (games) => `${Math.round(games)} games` });
  }

  /** The opponents of an entry, and its results against each. */
  drawEntry() {
    const chosen = this.chosenEntry;
    show(this.entry, chosen !== null);
    if (!chosen) return;
    const { name, rating, wins, draws, losses } = chosen;
    const place = this.entries.indexOf(chosen) + 1;
    const back = make('a', 'watch', '← All entries');
    back.href = this.addressOf(null);
    const against = [...this.cells.values()].filter(({ row }) => row === name);
    const elo = ({ column }) => this.entries.find((entry) => entry.name === column)?.rating.elo ?? 0;
    const count = (text, key) => ({ text, classes: 'number', key: (one) => one[key], cell: (one) => cell(String(one[key]), 'number') });
    const part = ({ share }, text) => make('td', 'number strong', text, make('small', '', share?.high == null ? '' : ` ± ${number(100 * (share.high - share.mean), 0)}`));
    const columns = [
      { text: 'Opponent', key: ({ column }) => column, cell: ({ column }) => { const th = head('row', ''); th.append(this.linkTo(column)); return th; } },
      { text: 'Its rating', classes: 'number', key: elo, cell: (one) => cell(number(elo(one), 0), 'number') },
      count('Games', 'games'), count('Won', 'wins'), count('Drawn', 'draws'), count('Lost', 'losses'),
      { text: 'Win rate', classes: 'number', key: (one) => (one.wins + one.draws / 2) / one.games,
        cell: (one) => part(one, `${percent(one.wins + one.draws / 2, one.games)} %`) },
      { text: 'Points', classes: 'number', key: ({ score }) => score[0], cell: ({ score }) => cell(`${number(score[0], 2)} : ${number(score[1], 2)}`, 'number') },
      { text: 'Difference', classes: 'number', key: (one) => one.score_difference, cell: (one) => cell(signed(one.score_difference), 'number') },
      { text: '', cell: (one) => this.gamesButton(one) },
    ];
    const facts = `Place ${place} of ${this.entries.length}, rating ${number(rating.elo, 0)} (95 %: ${this.interval(rating)}). ${wins} won, ${draws} drawn, ${losses} lost.${stem(chosen.strategy) === name ? '' : ` Strategy ${plain(stem(chosen.strategy))}.`}`;
    this.entry.replaceChildren(make('div', 'choose', '', make('h2', '', plain(name)), back), make('p', 'faint', facts),
      sortedTable('Opponents', columns, against, this.orders.entry, () => this.drawEntry()),
      make('p', 'faint', 'The hardest opponent first. Win rate: draws count half. Points are means per game.'));
  }

  gamesButton({ row, column }) {
    const button = make('button', '', 'Games');
    Object.assign(button, { type: 'button' });
    button.setAttribute('aria-label', `List the games against ${plain(column)}`);
    button.setAttribute('aria-pressed', String(this.chosen?.[0] === row && this.chosen[1] === column));
    button.addEventListener('click', () => this.choose(row, column));
    return make('td', '', '', button);
  }

  drawMatrix() {
    const { entries } = this;
    this.buttons = new Map();
    const of = (row, column) => {
      const found = this.cells.get(`${row.name} ${column.name}`);
      if (!found) return cell('', 'none');
      const { games, wins, draws, losses, score_difference } = found;
      const button = make('button', '', '', make('strong', '', `${percent(wins, games)} %`), make('small', '', `${percent(draws, games)} % drawn`),
        make('small', '', signed(score_difference)));
      button.type = 'button';
      button.setAttribute('aria-pressed', 'false');
      button.setAttribute('aria-label', `${plain(row.name)} against ${plain(column.name)}: won ${percent(wins, games)} %, drawn ${percent(draws, games)} %, `
        + `lost ${percent(losses, games)} % of ${games} games, ${signed(score_difference)} points per game. Lists the games.`);
      button.addEventListener('click', () => this.choose(row.name, column.name));
      const share = (wins + draws / 2) / Math.max(1, games);
      button.style.setProperty('--share', `${Math.abs(share - 0.5) * 60}%`);
      button.classList.add(share >= 0.5 ? 'ahead' : 'behind');
      this.buttons.set(`${row.name} ${column.name}`, button);
      return make('td', '', '', button);
    };
    const rows = entries.filter((row) => this.isShown(row)).map((row) => make('tr', '', '', head('row', plain(row.name)), ...entries.map((column) => of(row, column))));
    this.matrix.replaceChildren(make('h2', '', 'Head to head'), make('p', 'faint', 'How often the row beats the column, and the mean points difference per game. '
      + 'Click a cell for its games.'), tableOf('Head to head', [[''], ...entries.map(({ name }) => [plain(name)])], rows, 'matrix'));
  }

  /** Shows the games of two entries, and puts the entries into the address. */
  choose(row, column) {
    const words = new URLSearchParams(location.hash.slice(1));
    words.set('row', row);
    words.set('column', column);
    history.replaceState(null, '', `#${words}`);
    this.fromAddress();
    this.games.scrollIntoView({ block: 'nearest' });
  }

  fromAddress() {
    const words = new URLSearchParams(location.hash.slice(1));
    const before = this.chosenEntry?.name;
    keepAddress();
    this.pick(words);
    const chosen = this.cells.has(`${words.get('row')} ${words.get('column')}`) ? [words.get('row'), words.get('column')] : null;
    this.buttons.forEach((button, key) => button.setAttribute('aria-pressed', String(key === chosen?.join(' '))));
    this.chosen = chosen;
    this.chosenEntry = this.entries.find(({ name }) => name === words.get('entry')) ?? null;
    this.listed = LISTED;
    for (const section of [this.ratings, this.beats.box, this.matrix]) show(section, this.entries.length > 0 && !this.chosenEntry);
    this.drawEntry();
    this.drawHistory();
    this.drawGames();
    if (this.chosenEntry?.name !== before) scrollTo(0, 0);
  }

  /** The games of the chosen two, seen from the row's entry. */
  chosenGames() {
    const [row, column] = this.chosen;
    const own = ({ blue, red }) => (blue === row && red === column ? 0 : blue === column && red === row ? 1 : -1);
    const result = (winner, side) => (winner === null ? 'drawn' : winner === side ? 'won' : 'lost');
    return this.report.matches.filter((game) => own(game) >= 0 && (this.sea < 0 || game.sea === this.sea))
      .map((game) => ({ ...game, side: own(game), result: result(game.winner, own(game)) }))
      .filter((game) => this.filter.value === '' || game.result === this.filter.value);
  }

  drawGames() {
    show(this.games, this.report.matches.length > 0);
    const title = make('h2', '', this.chosen ? `${plain(this.chosen[0])} against ${plain(this.chosen[1])}` : 'Games');
    if (!this.chosen) {
      this.games.replaceChildren(title, make('p', 'faint', this.chosenEntry ? 'Press Games above to list the games against an opponent here and watch them.' : 'Click a cell above to list its games here and watch them.'));
      return;
    }
    const found = this.chosenGames();
    const label = make('label', '', '', make('span', '', 'Show '), this.filter);
    const said = make('p', '', found.length === 0 ? 'No such games.' : '');
    const words = `${found.length} games${this.unplayable ? '' : '. Watching a game first replays it, which takes a few seconds.'}`;
    const more = make('button', '', `${Math.min(LISTED, found.length - this.listed)} more`);
    more.id = 'games-more';
    more.type = 'button';
    more.addEventListener('click', () => {
      this.listed += LISTED;
      this.drawGames();
    });
    show(more, found.length > this.listed);
    this.games.replaceChildren(title, make('div', 'choose', '', label, make('span', 'faint', words)), said, this.gameTable(found), more);
  }

  gameTable(found) {
    const { teams } = this.report;
    const row = (game) => {
      const [own, theirs] = [game.score[game.side], game.score[1 - game.side]];
      const label = `Watch seed ${game.seed}, ${plain(this.chosen[0])} as ${teams[game.side]}, ${own} to ${theirs}`;
      return make('tr', `result-${game.result}`, '', this.unplayable ? cell('') : watch(addressOfGame(game.game), label), cell(String(game.seed), 'number'), cell(plain(teams[game.side] ?? '')),
        this.sea < 0 && this.seas.length > 0 ? cell(plain(stem(this.seas[game.sea].sea))) : null, cell(`${own} : ${theirs}`, 'number strong'),
        make('td', 'result', game.result), cell(clockShort(game.duration_s), 'number'));
    };
    const heads = [[''], ['Seed', 'number'], ['Team'], ...(this.sea < 0 && this.seas.length > 0 ? [['Sea']] : []), ['Points', 'number'], ['Result'], ['Length', 'number']];
    const games = tableOf('Games', heads, found.slice(0, this.listed).map(row));
    show(games, found.length > 0);
    return games;
  }
}
