// Pointer input on the chart: drag to move, wheel and pinch to zoom, click or tap to choose a boat.

/** A press that moves less than this is a click, px. */
const STILL_PX = 5;

export class Pointer {
  /** `on` has `tap(x, y, touch)`, `hover(x, y)`, and `moved()`, called when the user moves the chart. */
  constructor(element, view, on) {
    Object.assign(this, { element, view, on, pointers: new Map(), travelled: 0 });
    element.addEventListener('pointerdown', (event) => this.down(event));
    element.addEventListener('pointermove', (event) => this.move(event));
    element.addEventListener('pointerup', (event) => this.up(event, true));
    element.addEventListener('pointercancel', (event) => this.up(event, false));
    element.addEventListener('pointerleave', () => on.hover(-1e9, -1e9));
    element.addEventListener('wheel', (event) => this.wheel(event), { passive: false });
  }

  place(event) {
    const box = this.element.getBoundingClientRect();
    return { x: event.clientX - box.left, y: event.clientY - box.top };
  }

  /** Buttons on the chart handle their own events. */
  elsewhere(event) {
    return event.target.closest('button, #steering-place, #fence-editor') !== null;
  }

  down(event) {
    if (event.button !== 0 || this.elsewhere(event)) return;
    this.element.setPointerCapture(event.pointerId);
    if (this.pointers.size === 0) this.travelled = 0;
    this.pointers.set(event.pointerId, this.place(event));
  }

  move(event) {
    const now = this.place(event);
    const before = this.pointers.get(event.pointerId);
    if (!before) {
      if (event.pointerType === 'mouse') this.on.hover(now.x, now.y);
      return;
    }
    this.travelled += Math.hypot(now.x - before.x, now.y - before.y);
    if (this.pointers.size === 2) this.pinch(event.pointerId, before, now);
    else if (this.travelled > STILL_PX) {
      this.view.panBy(now.x - before.x, now.y - before.y);
      this.element.classList.add('dragging');
      this.on.moved();
    }
    this.pointers.set(event.pointerId, now);
  }

  pinch(id, before, now) {
    const [, other] = [...this.pointers].find(([each]) => each !== id);
    const was = Math.hypot(before.x - other.x, before.y - other.y);
    const is = Math.hypot(now.x - other.x, now.y - other.y);
    this.view.panBy((now.x - before.x) / 2, (now.y - before.y) / 2);
    if (was > 1 && is > 1) this.view.zoomAt((now.x + other.x) / 2, (now.y + other.y) / 2, is / was);
    this.on.moved();
  }

  up(event, meant) {
    if (!this.pointers.delete(event.pointerId)) return;
    this.element.classList.remove('dragging');
    const { x, y } = this.place(event);
    if (meant && this.pointers.size === 0 && this.travelled <= STILL_PX) this.on.tap(x, y, event.pointerType !== 'mouse');
  }

  wheel(event) {
    if (this.elsewhere(event)) return;
    event.preventDefault();
    const lines = event.deltaMode === 1 ? 16 : 1;
    const { x, y } = this.place(event);
    this.view.zoomAt(x, y, Math.exp(Math.max(-1, Math.min(1, -event.deltaY * lines * 0.002))));
    this.on.zoomed();
  }
}
