// The time and the boat in the page's address: `#t=83.2&boat=blue_one`.

const words = () => new URLSearchParams(location.hash.slice(1));

/** The time, s, and the boat in the address; null where missing. */
export function wanted() {
  const given = words();
  const t_s = given.has('t') && given.get('t') !== '' ? Number(given.get('t')) : NaN;
  return { t_s: Number.isFinite(t_s) ? t_s : null, boat: given.get('boat') };
}

/** Puts a time and a boat into the address and keeps its other parts. Returns an address to share, without the token. */
export function name(t_s, boat) {
  const given = words();
  given.set('t', t_s.toFixed(1));
  if (boat === null) given.delete('boat');
  else given.set('boat', boat);
  history.replaceState(null, '', `#${given}`);
  given.delete('token');
  return `${location.href.split('#')[0]}#${given}`;
}

/** The game of a report in the address, or null. */
export const gameOfReport = () => new URLSearchParams(location.search).get('game');

const KEPT = 'squall.report';

/** Stores the address of a report, for the way back from one of its games. */
export function keepAddress() {
  try {
    sessionStorage.setItem(KEPT, location.hash);
  } catch {
    // Without storage, the way back leads to the start of the report.
  }
}

/** The address of the report from which a game was opened. */
export function addressOfReport() {
  try {
    return `/${sessionStorage.getItem(KEPT) ?? ''}`;
  } catch {
    return '/';
  }
}

/** The address of a game in a report. */
export const addressOfGame = (game) => `/?game=${encodeURIComponent(game)}${location.hash.includes('token=') ? `#token=${encodeURIComponent(words().get('token'))}` : ''}`;
