// A question that is asked once before something grave is done: a small box of our own beside the button.

let open = null;

/** Closes the question that is open. Whether there was one. */
export function closeAsk() {
  if (!open) return false;
  open.close(true);
  return true;
}

export class Ask {
  /** The elements are called `<name>`, `<name>-ask`, `-question`, `-confirm` and `-cancel`. */
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
      // Not back to the button: a second Enter would ask for the opposite.
      this.close(false);
      document.getElementById('sheet').focus({ preventScroll: true });
      this.act?.();
    });
    this.cancel.addEventListener('click', () => this.close(true));
    document.addEventListener('pointerdown', (event) => {
      if (open === this && !this.box.contains(event.target) && !this.button.contains(event.target)) this.close(false);
    });
  }

  /** Asks; `act` is called once somebody says yes. `slow` waits on the no, for what is not to be done by a second Enter. */
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
