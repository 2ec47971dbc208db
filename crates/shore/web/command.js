// A command line with a button that copies it.

import { make, write } from './words.js';

/** How long the button confirms the copy, ms. */
const SAID_MS = 2000;

/** Copies a string. Pages from other machines have no clipboard. Returns whether it succeeded. */
async function copy(text) {
  try {
    await navigator.clipboard.writeText(text);
    return true;
  } catch {
    const field = make('textarea', 'hidden-text');
    field.value = text;
    document.body.append(field);
    field.select();
    const done = document.execCommand('copy');
    field.remove();
    return done;
  }
}

/** A command, and a button that copies it; `what` describes its effect. */
export function commandOf(text, what) {
  // A browser would break the line after the first dash of `--seed`.
  const code = make('code', '', '', ...text.split(/(\s+)/).map((word) => (/^\S{1,30}$/.test(word) ? make('span', '', word) : word)));
  const button = make('button', '', 'Copy');
  button.type = 'button';
  button.setAttribute('aria-label', `Copy the command that ${what}`);
  button.addEventListener('click', async () => {
    const done = await copy(text);
    button.focus();
    if (!done) getSelection().selectAllChildren(code);
    write(button, done ? 'Copied' : 'Marked');
    setTimeout(() => write(button, 'Copy'), SAID_MS);
  });
  return make('div', 'command', '', code, button);
}
