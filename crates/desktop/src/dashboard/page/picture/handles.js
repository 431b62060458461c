// A handle: something that can be dragged, and is a slider for keys and screen readers.

import { number, set } from "../common/dom.js";
import { nameOf, tidy } from "../fields/schema.js";
import { settingAt } from "../common/words.js";

const PAGE_STEPS = 10;
const KEYS_MS = 800;

/**
 * @typedef {object} Spec
 * @property {(string | number)[]} path of the key in the file
 * @property {string} label
 * @property {(value: number) => void} place moves the element to a value
 * @property {(event: PointerEvent) => number} valueAt the value under the pointer
 */

export class Handle {
  #spec;
  #values;
  #gesture = null;
  #keys_ms = -Infinity;
  #dragged = false;

  /** @param {Element} element @param {Spec} spec @param {import("../fields/values.js").Values} values */
  constructor(element, spec, values) {
    this.element = element;
    this.#spec = spec;
    this.#values = values;
    this.step = settingAt(spec.path).step;
    set(element, { role: "slider", tabindex: 0, "data-handle": nameOf(spec.path), "aria-label": spec.label });
    element.classList.add("handle");
    element.addEventListener("pointerdown", (event) => event.button === 0 && this.grab(event));
    element.addEventListener("pointermove", (event) => this.#moved(event));
    for (const end of ["pointerup", "pointercancel"]) element.addEventListener(end, () => this.#up());
    element.addEventListener("keydown", (event) => this.#key(event));
    this.refresh();
  }

  get path() {
    return this.#spec.path;
  }

  get dragged() {
    return this.#dragged;
  }

  /** Shows the value of the draft, unless a hand holds the handle. */
  refresh() {
    const value = this.#values.at(this.path);
    if (!this.#dragged && typeof value === "number") this.#show(value);
  }

  #show(value) {
    this.value = value;
    const { min, max } = this.#values.limits(this.path);
    const unit = settingAt(this.path).unit.replace("°", "degrees");
    set(this.element, { "aria-valuenow": tidy(value), "aria-valuemin": min, "aria-valuemax": max, "aria-valuetext": `${number(value, 2).replace(/\.?0+$/, "")} ${unit}` });
    this.#spec.place(value);
  }

  #change(value) {
    const { min, max } = this.#values.limits(this.path);
    const next = tidy(Math.min(Math.max(value, min), max));
    if (next === this.value) return;
    this.#show(next);
    this.#values.write(this.path, next, this.#gesture);
  }

  /** From here on the pointer drags it. */
  grab(event) {
    event.preventDefault();
    this.element.focus();
    this.element.setPointerCapture(event.pointerId);
    this.#dragged = true;
    this.#gesture = {};
  }

  #moved(event) {
    if (!this.#dragged) return;
    this.#change(Math.round(this.#spec.valueAt(event) / this.step) * this.step);
  }

  #up() {
    this.#dragged = false;
    this.#keys_ms = -Infinity;
  }

  #key(event) {
    const next = this.#nextByKey(event.key);
    if (next === null || event.ctrlKey || event.altKey || event.metaKey) return;
    event.preventDefault();
    const now = performance.now();
    if (now - this.#keys_ms > KEYS_MS) this.#gesture = {};
    this.#keys_ms = now;
    this.#change(next);
  }

  #nextByKey(key) {
    const { min, max } = this.#values.limits(this.path);
    const by = { ArrowRight: 1, ArrowUp: 1, ArrowLeft: -1, ArrowDown: -1, PageUp: PAGE_STEPS, PageDown: -PAGE_STEPS };
    if (key in by) return this.value + by[key] * this.step;
    return { Home: min, End: max }[key] ?? null;
  }
}
