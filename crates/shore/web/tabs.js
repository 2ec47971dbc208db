// The tabs of the side: boats, details, events, game.

const NAMES = ['boats', 'boat', 'events', 'game'];
const byId = (id) => document.getElementById(id);

export class Tabs {
  /** `on` has `changed(name, wide)`, called when another tab is shown or the page's width changes. */
  constructor(on) {
    this.on = on;
    this.name = 'boats';
    for (const name of NAMES) byId(`tab-${name}`).addEventListener('click', () => this.show(name));
    byId('tabs').addEventListener('keydown', (event) => this.key(event));
    this.wide = matchMedia('(min-width: 900px) and (min-height: 561px)');
    this.wide.addEventListener('change', () => this.show(this.name));
  }

  show(name) {
    const wide = this.wide.matches;
    // On a wide page the events have their own place.
    this.name = name === 'events' && wide ? 'boats' : name;
    document.body.dataset.tab = this.name;
    // A phone has no space for these below the chart.
    const place = wide ? byId('controls') : byId('pane-game');
    if (byId('shown').parentElement !== place) {
      const before = wide ? byId('help') : place.firstChild;
      for (const id of ['captures', 'shown']) place.insertBefore(byId(id), before);
    }
    for (const each of NAMES) {
      const chosen = each === this.name;
      byId(`tab-${each}`).setAttribute('aria-selected', String(chosen));
      byId(`tab-${each}`).tabIndex = chosen ? 0 : -1;
    }
    this.on.changed(this.name, wide);
  }

  key(event) {
    const step = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
    if (!step) return;
    const tabs = [...byId('tabs').children].filter((each) => each.offsetParent !== null);
    const at = tabs.indexOf(document.activeElement);
    const next = tabs[(at + step + tabs.length) % tabs.length];
    next.focus();
    next.click();
    event.preventDefault();
    event.stopPropagation();
  }
}
