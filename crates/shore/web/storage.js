// Settings of this browser. Some browsers store nothing; a setting then lasts as long as the page.

/** The stored string, or null. */
export function recall(key) {
  try {
    return localStorage.getItem(key);
  } catch {
    return null;
  }
}

/** The stored object, or null. */
export function recallObject(key) {
  try {
    return JSON.parse(recall(key));
  } catch {
    return null;
  }
}

/** Stores a string; null removes it. */
export function keep(key, text) {
  try {
    if (text === null) localStorage.removeItem(key);
    else localStorage.setItem(key, text);
  } catch {
    // The setting is not stored.
  }
}
