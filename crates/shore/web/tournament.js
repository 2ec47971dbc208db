// A tournament or a league: ratings, head-to-head results, and the games of two entries, which can be watched.

import { addressOfGame, keepAddress } from './address.js';
import { cell, head, tableOf, watch } from './table.js';
import { clockShort, make, number, options, plain, show } from './words.js';

/** Number of games listed at first, and added each time. */
const LISTED = 100;
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
    this.matrix = make('section');
    this.games = make('section');
    this.games.id = 'games';
    this.filter = make('select');
    this.filter.id = 'games-filter';
    this.listed = LISTED;
    options(this.filter, RESULTS);
    this.filter.addEventListener('change', () => this.drawGames());
    addEventListener('hashchange', () => this.fromAddress());
    place.replaceChildren(this.ratings, this.matrix, this.games);
  }

  /** The report is complete. */
  get goesOn() {
    return false;
  }

  tell({ report, unplayable }) {
    this.report = report;
    this.unplayable = unplayable;
    this.entries = [...report.entries].sort((a, b) => b.rating.elo - a.rating.elo);
    this.cells = new Map(report.matrix.map((each) => [`${each.row} ${each.column}`, each]));
    this.drawRatings();
    this.drawMatrix();
    this.fromAddress();
    const played = report.games_unplayed > 0 ? `, ${report.games_unplayed} games not played` : '';
    const facts = `${report.game}${report.sea ? `, sea ${report.sea}` : ''}. ${report.entries.length} entries, ${report.games_per_pairing} games per pairing, `
      + `${report.seeds_counted} seeds from ${report.seed}${played}. Squall ${report.version} (${report.commit || 'unknown'}).`;
    return { name: report.tournament, facts, remarks: this.remarks() };
  }

  remarks() {
    const { games_left_out, failures, entries } = this.report;
    return [
      entries.length === 0 ? 'No result: no seed has all its games.' : '',
      this.unplayable ? `Games cannot be watched: ${this.unplayable}` : '',
      games_left_out > 0 ? `${games_left_out} games are left out because others with the same seed are missing.` : '',
      ...failures.slice(0, 5).map((each) => `Could not start: ${each.blue} against ${each.red}, seed ${each.seed}: ${each.why}`),
      failures.length > 5 ? `${failures.length - 5} more games could not start.` : '',
    ];
  }

  draw() {}

  drawRatings() {
    const { entries } = this;
    show(this.ratings, entries.length > 0);
    const ends = entries.flatMap(({ rating }) => [rating.low ?? rating.elo, rating.high ?? rating.elo]);
    const [low, high] = [Math.min(...ends) - 20, Math.max(...ends) + 20];
    const at = (elo) => `${((elo - low) / (high - low)) * 100}%`;
    const bar = ({ elo, low, high }) => {
      const [span, dot] = [make('i', 'span'), make('i', 'dot')];
      span.style.left = at(low ?? elo);
      span.style.right = `calc(100% - ${at(high ?? elo)})`;
      dot.style.left = at(elo);
      const box = make('div', 'interval', '', span, dot);
      box.setAttribute('aria-hidden', 'true');
      return make('td', 'wide', '', box);
    };
    const mean = ({ mean, high }) => make('td', 'number', number(mean, 2), make('small', '', high === null ? '' : ` ± ${number(high - mean, 2)}`));
    const row = (entry, place) => make('tr', '', '', cell(String(place + 1), 'number'), head('row', plain(entry.name)),
      cell(number(entry.rating.elo, 0), 'number strong'),
      cell(entry.rating.low === null ? '–' : `${number(entry.rating.low, 0)} to ${number(entry.rating.high, 0)}`, 'number'), bar(entry.rating),
      cell(String(entry.wins), 'number'), cell(String(entry.draws), 'number'), cell(String(entry.losses), 'number'),
      ...COUNTS.map(([, key]) => mean(entry[key])));
    const heads = [['Place', 'number'], ['Entry'], ['Rating', 'number'], ['95 %', 'number'], [''], ['Won', 'number'], ['Drawn', 'number'], ['Lost', 'number'],
      ...COUNTS.map(([title]) => [title, 'number'])];
    this.ratings.replaceChildren(make('h2', '', 'Ratings'), make('p', 'faint', 'Elo: a lead of 100 points means winning 64 %, 200 points 76 %. All other numbers '
      + 'are means per game. Confidence intervals are 95 %, over seeds.'), tableOf('Ratings', heads, entries.map(row), 'list ratings'));
  }

  drawMatrix() {
    const { entries } = this;
    show(this.matrix, entries.length > 0);
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
    const rows = entries.map((row) => make('tr', '', '', head('row', plain(row.name)), ...entries.map((column) => of(row, column))));
    this.matrix.replaceChildren(make('h2', '', 'Head to head'), make('p', 'faint', 'How often the row beats the column, and the mean points difference per game. '
      + 'Click a cell for its games.'), tableOf('Head to head', [[''], ...entries.map(({ name }) => [plain(name)])], rows, 'matrix'));
  }

  /** Shows the games of two entries, and puts the entries into the address. */
  choose(row, column) {
    const words = new URLSearchParams(location.hash.slice(1));
    words.set('row', row);
    words.set('column', column);
    history.replaceState(null, '', `#${words}`);
    keepAddress();
    this.fromAddress();
  }

  fromAddress() {
    const words = new URLSearchParams(location.hash.slice(1));
    const chosen = this.cells.has(`${words.get('row')} ${words.get('column')}`) ? [words.get('row'), words.get('column')] : null;
    this.buttons.forEach((button, key) => button.setAttribute('aria-pressed', String(key === chosen?.join(' '))));
    this.chosen = chosen;
    this.listed = LISTED;
    this.drawGames();
  }

  /** The games of the chosen two, seen from the row's entry. */
  chosenGames() {
    const [row, column] = this.chosen;
    const own = ({ blue, red }) => (blue === row && red === column ? 0 : blue === column && red === row ? 1 : -1);
    const result = (winner, side) => (winner === null ? 'drawn' : winner === side ? 'won' : 'lost');
    return this.report.matches.filter((game) => own(game) >= 0)
      .map((game) => ({ ...game, side: own(game), result: result(game.winner, own(game)) }))
      .filter((game) => this.filter.value === '' || game.result === this.filter.value);
  }

  drawGames() {
    show(this.games, this.report.matches.length > 0);
    const title = make('h2', '', this.chosen ? `${plain(this.chosen[0])} against ${plain(this.chosen[1])}` : 'Games');
    if (!this.chosen) {
      this.games.replaceChildren(title, make('p', 'faint', 'Click a cell above to list its games here and watch them.'));
      return;
    }
    const found = this.chosenGames();
    const label = make('label', '', '', make('span', '', 'Show '), this.filter);
    const said = make('p', '', found.length === 0 ? 'No such games.' : '');
    const words = `${found.length} games${this.unplayable ? '' : '. Watching a game first replays it, which takes some seconds.'}`;
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
      return make('tr', `result-${game.result}`, '', this.unplayable ? cell('') : watch(addressOfGame(game.game), label), cell(String(game.seed), 'number'), cell(plain(teams[game.side] ?? '')), cell(`${own} : ${theirs}`, 'number strong'),
        make('td', 'result', game.result), cell(clockShort(game.duration_s), 'number'));
    };
    const heads = [[''], ['Seed', 'number'], ['Team'], ['Points', 'number'], ['Result'], ['Length', 'number']];
    const games = tableOf('Games', heads, found.slice(0, this.listed).map(row));
    show(games, found.length > 0);
    return games;
  }
}
