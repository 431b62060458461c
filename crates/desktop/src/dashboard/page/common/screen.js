// Draws at most once per picture of the screen, and only the view that is seen.

import { calm } from "./settings.js";

const CALM_MS = 250;

export class Screen {
  #parts = [];
  #asked = false;
  #last_ms = 0;

  /** `draw` is called while `section` is shown, after something came. */
  add(section, draw) {
    this.#parts.push({ section, draw });
  }

  /** Something came. */
  ask() {
    if (this.#asked) return;
    this.#asked = true;
    const wait_ms = calm() ? CALM_MS - (performance.now() - this.#last_ms) : 0;
    if (wait_ms > 0) setTimeout(() => requestAnimationFrame(() => this.#draw()), wait_ms);
    else requestAnimationFrame(() => this.#draw());
  }

  #draw() {
    this.#asked = false;
    this.#last_ms = performance.now();
    for (const { section, draw } of this.#parts) if (!section.hidden) draw();
  }
}
