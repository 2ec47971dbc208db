// What the page's address says of the moment and the boat to be shown: `#t=83.2&boat=blue_one`.

const words = () => new URLSearchParams(location.hash.slice(1));

/** The time, s, and the boat that the address names; null for what it does not. */
export function wanted() {
  const given = words();
  const t_s = given.has('t') && given.get('t') !== '' ? Number(given.get('t')) : NaN;
  return { t_s: Number.isFinite(t_s) ? t_s : null, boat: given.get('boat') };
}

/** Puts a moment and a boat into the address; what else it carries stays. Gives the address for others: without the token. */
export function name(t_s, boat) {
  const given = words();
  given.set('t', t_s.toFixed(1));
  if (boat === null) given.delete('boat');
  else given.set('boat', boat);
  history.replaceState(null, '', `#${given}`);
  given.delete('token');
  return `${location.href.split('#')[0]}#${given}`;
}

/** The game of a report that the address names, or null. */
export const gameOfReport = () => new URLSearchParams(location.search).get('game');

const KEPT = 'squall.report';

/** Keeps what the address says of a report, for the way back from one of its games. */
export function keepAddress() {
  try {
    sessionStorage.setItem(KEPT, location.hash);
  } catch {
    // Then the way back leads to its beginning.
  }
}

/** The address of the report from which a game was opened, as it was left. */
export function addressOfReport() {
  try {
    return `/${sessionStorage.getItem(KEPT) ?? ''}`;
  } catch {
    return '/';
  }
}

/** The address of a game of a report. */
export const addressOfGame = (game) => `/?game=${encodeURIComponent(game)}${location.hash.includes('token=') ? `#token=${encodeURIComponent(words().get('token'))}` : ''}`;
