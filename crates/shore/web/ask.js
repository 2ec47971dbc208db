// A confirmation before a serious action: a small box beside the button.

let open = null;

/** Closes the open question. Returns whether there was one. */
export function closeAsk() {
  if (!open) return false;
  open.close(true);
  return true;
}

export class Ask {
  /** The elements are `<name>`, `<name>-ask`, `-question`, `-confirm` and `-cancel`. */
  constructor(name) {
    const element = (part) => document.getElementById(`${name}${part}`);
    this.button = element('');
    this.box = element('-ask');
    this.question = element('-question');
    this.confirm = element('-confirm');
    this.button.setAttribute('aria-expanded', 'false');
    this.button.setAttribute('aria-controls', this.box.id);
    this.cancel = element('-cancel');
    this.confirm.addEventListener('click', () => {
      // Do not return the focus to the button, where a second Enter would request the opposite.
      this.close(false);
      document.getElementById('sheet').focus({ preventScroll: true });
      this.act?.();
    });
    this.cancel.addEventListener('click', () => this.close(true));
    document.addEventListener('pointerdown', (event) => {
      if (open === this && !this.box.contains(event.target) && !this.button.contains(event.target)) this.close(false);
    });
  }

  /** Asks; calls `act` if confirmed. With `slow` the focus is on Cancel, so that a second Enter cannot confirm. */
  ask(question, yes, act, slow = false) {
    if (open !== this) closeAsk();
    open = this;
    this.act = act;
    this.question.textContent = question;
    this.confirm.textContent = yes;
    this.box.hidden = false;
    this.button.setAttribute('aria-expanded', 'true');
    (slow ? this.cancel : this.confirm).focus();
  }

  close(back) {
    if (open !== this) return;
    open = null;
    this.box.hidden = true;
    this.button.setAttribute('aria-expanded', 'false');
    if (back) this.button.focus();
  }
}
