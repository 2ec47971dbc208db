// The state of the game: score, clock, phase, and the pane about the game and its server.

import { bytes, clock, clockShort, fill, make, number, plain, show, write } from './words.js';

const PHASES = { waiting: 'waiting', playing: 'playing', paused: 'paused', over: 'game over', gone: 'no game' };

/** A command that starts a game. */
const START = 'squall run surveyor_2v2';

const byId = (id) => document.getElementById(id);

/** A name as part of an id. */
const idOf = (name) => String(name).replace(/[^\w-]/g, '_');

export class Status {
  /** `watch()` plays the replay from its start. */
  constructor(watch) {
    byId('watch').addEventListener('click', watch);
    this.score = byId('score');
    this.pane = byId('pane-game');
    this.facts = make('dl', 'facts');
    this.drawn = make('dl', 'facts');
    this.drawnBox = make('details', '', '', make('summary', '', 'Randomised'), this.drawn);
    this.rights = make('p', 'note', 'This page may only watch. To control the game, open it with the token.');
    this.trouble = make('p', 'matter');
    this.pane.prepend(this.rights, this.trouble, this.facts, this.drawnBox);
  }

  greet(game) {
    const { chart, hello } = game;
    write(byId('game-name'), plain(chart.name || hello.game || 'Squall'));
    this.values = chart.teams.map((team, index) => {
      const value = make('span', 'value', '–');
      value.id = `score-${idOf(team.name)}`;
      const box = make('div', `team team-${index}`, '', make('span', 'swatch'), make('span', 'name', game.players[index]), value);
      box.title = `Team ${plain(team.name)}`;
      return { box, value };
    });
    this.score.replaceChildren(...this.values.map(({ box }) => box));
    show(this.rights, hello.mode === 'live' && !hello.rights);
  }

  /** Score and clock, which change with every frame. */
  tellFrame(game) {
    this.values?.forEach(({ value }, team) => write(value, String(game.score[team] ?? '–')));
    const title = `${game.scoreWords} – Squall`;
    if (document.title !== title) document.title = title;
    const duration = game.chart.duration_s;
    write(byId('clock'), Number.isFinite(game.t_s) ? clock(game.t_s) : '–');
    write(byId('rate'), this.rateWords(game, duration));
  }

  rateWords(game, duration) {
    const words = Number.isFinite(duration) ? `of ${clockShort(duration)}` : '';
    const rate = game.state?.rate;
    return Number.isFinite(rate) && game.state.phase === 'playing' ? `${words} · ${number(rate, rate < 9.95 ? 1 : 0)}×` : words;
  }

  tell(game, connected, eStopped) {
    const words = this.phaseWords(game, connected, eStopped);
    const chip = byId('phase');
    write(chip, words[0]);
    if (chip.dataset.tone !== words[1]) chip.dataset.tone = words[1];
    if (this.pane.offsetParent !== null) this.tellPane(game);
    this.tellOver(game);
  }

  phaseWords(game, connected, eStopped) {
    if (!connected) return ['no connection', 'bad'];
    if (!game.hello) return ['connecting', 'plain'];
    if (game.mode === 'replay') return [game.player?.playing ? 'replay' : 'replay, paused', 'plain'];
    if (eStopped) return ['E-STOPPED', 'bad'];
    if (game.stopped) return ['halted', 'warn'];
    const phase = game.isOver ? 'over' : game.state?.phase;
    return [PHASES[phase] ?? phase ?? 'live', phase === 'playing' ? 'good' : 'warn'];
  }

  /** The text over the chart while the game is not running. */
  tellOver(game) {
    const { state } = game;
    let words = '';
    const waited = [...(state?.gateways ?? []).map((name) => `the gateway of ${plain(name)}`)];
    if (state?.minds && state.phase === 'waiting') waited.unshift(...this.agentWords(state.minds));
    if (state?.phase === 'waiting') words = waited.length > 0 ? `Waiting for ${waited.join(', ')}` : 'Waiting to start';
    if (state?.phase === 'gone') words = 'The game has disappeared: its server no longer answers. Waiting for another.';
    const ended = isAtItsEnd(game);
    if (ended) words = [`${game.scoreWords}. ${resultWords(game)}`, ...endWords(game)].join('\n');
    this.tellMiddle(words);
    show(byId('watch'), ended && game.mode === 'replay');
  }

  /** Explains why there is no game, and what to do. */
  tellNone(reason) {
    write(byId('phase'), 'no game');
    byId('phase').dataset.tone = 'warn';
    this.tellMiddle(`No game to show: ${reason}.\nTo start one, type this in a terminal: ${START}\nIt will appear here automatically.`);
  }

  /** Shows a message in the middle of the chart; one with a command can be copied. */
  tellMiddle(words) {
    const over = byId('over');
    write(over, words);
    show(over, words !== '');
    over.classList.toggle('copied', words.includes('squall '));
  }

  agentWords(minds) {
    if (Array.isArray(minds)) return minds.map((name) => `the agent of ${plain(name)}`);
    return Number.isFinite(minds) && minds > 0 ? [`${minds} agents`] : [];
  }

  tellPane(game) {
    const { chart, hello, state, player } = game;
    const pairs = [['Game', hello?.game || chart.name || '–'], ['Field', plain(chart.field?.name ?? '–')], ['Rules', plain(chart.rules ?? '–')], ['Sea', plain(chart.sea ?? '–')],
      ['Seed', String(chart.seed ?? '–')], ['Boats', String(game.count)], ['Decision period', number(chart.decision_s, 2, 's')]];
    if (state) pairs.push(...this.stateFacts(state));
    if (player) {
      pairs.push(['File', player.file ?? '–'], ['From', clock(player.from_s)], ['To', clock(player.to_s)]);
      if (player.cut) pairs.push(['Truncated', 'yes']);
    }
    if (game.unread > 0) pairs.push(['Unreadable frames', String(game.unread)]);
    pairs.push(['Squall', hello?.version ?? '–']);
    this.tellPairs(this.facts, pairs);
    const drawn = Object.entries(chart.drawn ?? {}).map(([name, value]) =>
      [name, typeof value === 'number' ? number(value, 3) : String(value)]);
    show(this.drawnBox, drawn.length > 0);
    this.tellPairs(this.drawn, drawn);
    const failed = state?.recording?.failed;
    const why = typeof failed === 'string' ? `: ${failed}` : '';
    const trouble = failed ? `The recording failed${why}.` : '';
    write(this.trouble, trouble);
    show(this.trouble, trouble !== '');
  }

  stateFacts(state) {
    const pairs = [];
    if (state.pace !== undefined && state.pace !== null) pairs.push(['Pace', plain(String(state.pace))]);
    if (Number.isFinite(state.rate)) pairs.push(['Achieved', `${number(state.rate, 1)}× real time`]);
    if (Number.isFinite(state.frames_hz)) pairs.push(['Frames', `${number(state.frames_hz, 0)} per second`]);
    const lists = [['Waiting for agents', state.minds], ['Waiting for gateways', state.gateways]];
    for (const [name, list] of lists) {
      if (Array.isArray(list) ? list.length > 0 : list) pairs.push([name, Array.isArray(list) ? list.map(plain).join(', ') : String(list)]);
    }
    if (state.refused > 0) pairs.push(['Refused orders', String(state.refused)]);
    if (state.overruns > 0) pairs.push(['Late ticks', String(state.overruns)]);
    const { recording } = state;
    pairs.push(['Recording', recording ? `${recording.file}, ${bytes(recording.bytes)}` : 'none']);
    if (recording?.dropped > 0) pairs.push(['Not recorded', `${recording.dropped} messages`]);
    return pairs;
  }

  tellPairs(place, pairs) {
    fill(place, pairs, () => make('div', '', '', make('dt'), make('dd')), (row, [name, value]) => {
      write(row.firstElementChild, name);
      write(row.lastElementChild, value);
    });
  }
}

/** Whether the game, or its replay, is at its end. */
function isAtItsEnd({ mode, isOver, player, t_s }) {
  if (mode !== 'replay') return isOver;
  return Boolean(player) && !player.playing && t_s >= player.to_s - 1e-6 && player.to_s > player.from_s;
}

/** How to replay a game that ran elsewhere. */
function endWords({ mode, state }) {
  if (mode === 'replay') return [];
  const { recording, phase } = state ?? {};
  return [recording ? `To see it again, type: squall replay ${recording.file}` : 'It was not recorded.', ...(phase === 'gone' ? ['Waiting for another game.'] : [])];
}

function resultWords(game) {
  const best = Math.max(...game.score);
  const winners = game.chart.teams.filter((_, team) => game.score[team] === best);
  return winners.length === 1 ? `${plain(winners[0].name).replace(/^./, (letter) => letter.toUpperCase())} wins.` : 'A draw.';
}

/** How long a notice is shown, ms. */
const NOTICE_MS = 6000;
const NOTICES_MAX = 3;

/** Shows a notice for a while; a repeated one only once. */
export function notice(text) {
  const place = byId('notices');
  const same = [...place.children].find((each) => each.dataset.text === text);
  same?.remove();
  const line = make('div', 'notice', text);
  line.dataset.text = text;
  place.append(line);
  while (place.children.length > NOTICES_MAX) place.firstElementChild.remove();
  setTimeout(() => line.remove(), NOTICE_MS);
}
