// A field for a number: a decimal comma is a decimal point, and what is no number of its range is told beside it and goes nowhere.

import { announce } from "../common/announce.js";
import { el, say, set } from "../common/dom.js";

const NUMBER = /^[+-]?(?:\d+(?:[.,]\d*)?|[.,]\d+)$/;
/** Whoever types on is not told of the half of a number. */
const PAUSE_MS = 600;
const PAGE_STEPS = 10;
let fields = 0;

/** The number that a text says, with its unit or without; null for any other text. */
function readNumber(text, unit) {
  const trimmed = text.trim().replace("−", "-");
  const plain = unit !== "" && trimmed.endsWith(unit) ? trimmed.slice(0, -unit.length).trimEnd() : trimmed;
  // With two separators nobody can tell which one is meant.
  return NUMBER.test(plain) ? Number(plain.replace(",", ".")) : null;
}

/**
 * @typedef {object} Asked
 * @property {string} unit behind the number; "" is none
 * @property {boolean} whole whether only whole numbers are taken
 * @property {number} step of the arrow keys
 * @property {() => { min: number, max: number }} limits
 * @property {string} blank what else there is to do where nothing stands
 * @property {() => number} start from which arrow keys go where nothing stands
 * @property {(value: number) => void} take is told each number that can be taken
 */

export class NumberField {
  #timer = null;
  #wrong = "";
  /** What the field shows by itself, rather than by a person's hand. */
  #shown = "";

  /** @param {Asked} asked @param {Record<string, any>} attributes of the field */
  constructor(asked, attributes = {}) {
    this.asked = asked;
    const id = `number-${fields++}`;
    this.range = el("span", { class: "number-range quiet", id: `${id}-range` });
    this.error = el("p", { class: "number-error bad", id: `${id}-error`, hidden: true });
    this.node = el("input", { type: "text", inputmode: "decimal", role: "spinbutton", autocomplete: "off", spellcheck: "false", class: "number", ...attributes,
      "aria-describedby": [attributes["aria-describedby"], `${id}-range`, `${id}-error`].filter(Boolean).join(" "),
      oninput: () => this.#typed(), onblur: () => this.#left(), onkeydown: (event) => this.#key(event) });
    this.#describe();
  }

  #describe() {
    const { unit, limits, step } = this.asked;
    const { min, max } = limits();
    say(this.range, `${min} to ${max}${unit === "" ? "" : ` ${unit}`}, arrow keys ±${step}`);
    set(this.node, { "aria-valuemin": min, "aria-valuemax": max });
  }

  /** Shows a number, or "" for none; what a person is writing stays while it says the same, or is still wrong. */
  show(value) {
    this.#describe();
    const text = String(value);
    const isNew = text !== this.#shown;
    this.#shown = text;
    if (isNew || this.#wrong === "") this.#fill(value);
  }

  #fill(value) {
    const isWritten = document.activeElement === this.node && readNumber(this.node.value, this.asked.unit) === value;
    if (!isWritten && this.node.value !== String(value)) this.node.value = String(value);
    if (value === "") this.node.removeAttribute("aria-valuenow");
    else set(this.node, { "aria-valuenow": value });
    this.#tell("");
  }

  /** The number that stands here; null if it cannot be taken, which is told at once. */
  read() {
    const { value, wrong } = this.#look();
    this.#tell(wrong);
    if (wrong === "") return value;
    announce(wrong);
    return null;
  }

  #look() {
    const { unit, whole, limits, blank } = this.asked;
    const { min, max } = limits();
    const range = `${min} to ${max}${unit === "" ? "" : ` ${unit}`}`;
    const text = this.node.value.trim();
    const value = readNumber(text, unit);
    if (text === "") return { value, wrong: `Nothing stands here: a number from ${range}${blank}.` };
    if (value === null) return { value, wrong: `“${text}” is no number: write one from ${range}, such as ${example(min, max, whole)}.` };
    if (whole && !Number.isInteger(value)) return { value, wrong: `${value} is no whole number: one from ${range}.` };
    if (value < min || value > max) return { value, wrong: `${value} is out of range: ${range}.` };
    return { value, wrong: "" };
  }

  #tell(wrong) {
    clearTimeout(this.#timer);
    this.#wrong = wrong;
    this.error.hidden = wrong === "";
    say(this.error, wrong === "" ? "" : `✕ ${wrong}`);
    set(this.node, { "aria-invalid": wrong !== "" });
  }

  #typed() {
    clearTimeout(this.#timer);
    const { value, wrong } = this.#look();
    if (wrong !== "") {
      // What stood here before holds on.
      this.#wrong = wrong;
      this.#timer = setTimeout(() => this.read(), PAUSE_MS);
      return;
    }
    this.#tell("");
    this.#shown = String(value);
    set(this.node, { "aria-valuenow": value });
    this.asked.take(value);
  }

  #left() {
    if (this.#wrong !== "") this.read();
  }

  #key(event) {
    if (event.ctrlKey || event.altKey || event.metaKey) return;
    if (event.key === "Escape" && this.#wrong !== "") {
      event.preventDefault();
      this.#wrong = "";
      this.#fill(this.#shown);
      announce("It is as it was.");
    }
    if (event.key === "Enter" && this.read() !== null) this.asked.enter?.();
    const by = { ArrowUp: 1, ArrowDown: -1, PageUp: PAGE_STEPS, PageDown: -PAGE_STEPS }[event.key];
    if (by === undefined) return;
    event.preventDefault();
    const { limits, step, start, unit } = this.asked;
    const { min, max } = limits();
    const from = readNumber(this.node.value, unit) ?? start();
    this.node.value = String(Number(Math.min(Math.max(from + by * step, min), max).toFixed(4)));
    this.#typed();
  }
}

/** A number that could be taken, for who wrote none. */
function example(min, max, whole) {
  const middle = (Math.max(min, -1e6) + Math.min(max, 1e6)) / 2;
  return whole ? Math.round(middle) : Number(middle.toFixed(1));
}
