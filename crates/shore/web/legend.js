// The legend: the marks on the chart, each as the chart draws it.

import { drawFlag, drawHullAt } from './boats.js';
import { palette, teamColour } from './palette.js';
import { make, plain, show } from './words.js';

const WIDTH = 44;
const HEIGHT = 26;

function ring(context, radius, dash, colour) {
  context.beginPath();
  context.arc(WIDTH / 2, HEIGHT / 2, radius, 0, 2 * Math.PI);
  context.setLineDash(dash);
  context.strokeStyle = colour;
  context.lineWidth = 1.5;
  context.stroke();
  context.setLineDash([]);
}

function line(context, dash, colour, width = 1.75) {
  context.beginPath();
  context.moveTo(4, HEIGHT / 2);
  context.lineTo(WIDTH - 4, HEIGHT / 2);
  context.setLineDash(dash);
  context.strokeStyle = colour;
  context.lineWidth = width;
  context.stroke();
  context.setLineDash([]);
}

const hull = (look) => (context) => drawHullAt(context, WIDTH / 2, HEIGHT / 2, Math.PI / 2, 24, 12, look);

/** The entries of a chart: text and drawing. */
function entriesOf(chart) {
  const { radii = {}, field } = chart;
  const entries = chart.teams.map((team, index) => [`boat of ${plain(team.name)}`, hull({ team: index })]);
  entries.push(['tagged: out of play until home', hull({ team: 0, idle: true })]);
  entries.push(['out of action', hull({ team: 0, idle: true, disabled: true })]);
  entries.push(['the selected boat’s own estimated position', hull({ ghost: true })]);
  entries.push(['path in the next 3 s', (context) => line(context, [], teamColour(0), 1.25)]);
  entries.push(['track of the last minute', (context) => {
    context.globalAlpha = 0.5;
    line(context, [], teamColour(0), 2);
    context.globalAlpha = 1;
  }]);
  entries.push(['flag; on a hull, carried', (context) => drawFlag(context, WIDTH / 2 - 5, HEIGHT - 3, 0, 12)]);
  if (radii.tag_m > 0) entries.push([`tag range, ${radii.tag_m} m`, (context) => ring(context, 10, [3, 4], teamColour(0))]);
  const around = (key) => [...new Set((field?.flags ?? []).map((flag) => (flag.radii ?? radii)[key]))].filter((metres) => metres > 0).join(' or ');
  if (around('grab_m')) entries.push([`grab range, ${around('grab_m')} m`, (context) => ring(context, 10, [], teamColour(0))]);
  if (around('keepout_m')) entries.push([`keep out, ${around('keepout_m')} m`, (context) => ring(context, 10, [2, 4], teamColour(0))]);
  if (field?.scrimmage) entries.push(['scrimmage line', (context) => line(context, [12, 5, 2, 5], palette.edge)]);
  if (chart.vehicles.some(({ external }) => external)) {
    entries.push(['geofence of real boats (dotted: keep-out)', (context) => line(context, [12, 5], palette.danger, 2)]);
    entries.push(['stopping distance of a real boat', (context) => ring(context, 10, [2, 3], palette.ink)]);
  }
  if (field?.obstacles?.length > 0) {
    entries.push(['obstacle', (context) => {
      context.beginPath();
      context.arc(WIDTH / 2, HEIGHT / 2, 9, 0, 2 * Math.PI);
      context.fillStyle = palette.land;
      context.fill();
      context.strokeStyle = palette.wall;
      context.stroke();
    }]);
  }
  if (chart.waves?.length > 0) {
    entries.push(['wave crest and trough', (context) => {
      context.fillStyle = palette.crest;
      context.fillRect(4, 5, WIDTH / 2 - 4, 16);
      context.fillStyle = palette.trough;
      context.fillRect(WIDTH / 2, 5, WIDTH / 2 - 4, 16);
      context.strokeStyle = palette.grid;
      context.strokeRect(4.5, 5.5, WIDTH - 9, 15);
    }]);
  }
  return entries;
}

export class Legend {
  constructor() {
    this.place = document.getElementById('chart-legend');
    this.wide = matchMedia('(min-width: 900px)');
    this.drawn = '';
  }

  /** Shows or hides the legend, and redraws it if colours or the game have changed. */
  tell(game, visible) {
    show(this.place, visible && Boolean(game.hello));
    // Beside the chart, or where a phone has space for it.
    const beside = document.getElementById(this.wide.matches ? 'main' : 'pane-game');
    if (this.place.parentElement !== beside) beside.prepend(this.place);
    const key = `${palette.version} ${game.greeted}`;
    if (!visible || !game.hello || key === this.drawn) return;
    this.drawn = key;
    const ratio = Math.min(2, devicePixelRatio);
    this.place.replaceChildren(...entriesOf(game.chart).map(([words, draw]) => {
      const canvas = make('canvas');
      canvas.setAttribute('aria-hidden', 'true');
      Object.assign(canvas, { width: WIDTH * ratio, height: HEIGHT * ratio });
      const context = canvas.getContext('2d');
      context.scale(ratio, ratio);
      draw(context);
      return make('li', '', '', canvas, words);
    }));
  }
}
