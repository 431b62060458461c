// One key of a profile as a field: label, control, explanation, and a way back to what holds without it.

import { captureButton } from "./capture.js";
import { el, numberField, say, set } from "./dom.js";
import { nameOf, stepOf, tidy, unitOf } from "./schema.js";

const CHOICES_WITH_OWN_WORDS = new Set(["gamepad", "pointer"]);
let fields = 0;

/** How a value reads. */
function shown(value) {
  if (value === undefined) return "none";
  if (value === true) return "yes";
  return value === false ? "no" : String(value);
}

export class Field {
  /** @type {object | null} one step back for what is typed or slid without a pause */
  #gesture = null;

  /**
   * @param {(string | number)[]} path
   * @param {{ key: string, kind: string, required: boolean, options: string[] | null, min?: number, max?: number, default?: any, help: string }} about
   * @param {import("./values.js").Values} values
   */
  constructor(path, about, values) {
    Object.assign(this, { path, about, values, id: `field-${fields++}` });
    this.control = this.#control();
    set(this.control, { id: this.id, "data-field": nameOf(path), "aria-describedby": `${this.id}-note ${this.id}-help` });
    this.note = el("span", { class: "field-note quiet", id: `${this.id}-note` });
    this.back = el("button", { type: "button", class: "back", text: "↺", title: "Write nothing", "aria-label": `Do not write ${about.key}`, onclick: () => this.#write(null) });
    const unit = unitOf(about.key);
    this.node = el("div", { class: `field ${about.kind}` },
      el("label", { for: this.id, text: about.key }),
      el("div", { class: "field-controls" }, this.control, unit === "" ? null : el("span", { class: "quiet", text: unit, "aria-hidden": "true" }), ...this.#extras(), this.back, this.note),
      el("p", { class: "help", id: `${this.id}-help`, text: about.help }));
    this.refresh();
  }

  get #numeric() {
    return this.about.kind === "number" || this.about.kind === "integer";
  }

  #control() {
    const { kind } = this.about;
    if (kind === "choice") return this.#select();
    if (kind === "boolean") return el("input", { type: "checkbox", onchange: (event) => this.#write(event.target.checked) });
    if (this.#numeric) return this.#number("number");
    return el("input", { type: "text", autocomplete: "off", spellcheck: "false", list: this.#list(), onchange: (event) => this.#write(event.target.value === "" ? null : event.target.value) });
  }

  #list() {
    return CHOICES_WITH_OWN_WORDS.has(this.about.kind) ? `names-${this.about.kind}` : null;
  }

  #select() {
    const { required, options, default: fallback } = this.about;
    const none = required ? [] : [el("option", { value: "", text: fallback === undefined ? "not written" : `not written: ${fallback}` })];
    return el("select", { onchange: (event) => this.#write(event.target.value === "" ? null : event.target.value) },
      ...none, ...options.map((option) => el("option", { value: option, text: option })));
  }

  #number(type) {
    const { kind, min, max } = this.about;
    const make = type === "number" ? numberField : (attributes) => el("input", { type, ...attributes });
    const node = make({ min, max, step: kind === "integer" ? 1 : "any", oninput: () => this.#typed(node),
      onblur: () => { this.#gesture = null; }, onkeydown: (event) => this.#stepped(event, node) });
    return node;
  }

  /** Arrow keys step by what suits the key, as the handle does. */
  #stepped(event, node) {
    const sideways = node.type === "range" ? { ArrowRight: 1, ArrowLeft: -1 } : {};
    const by = { ArrowUp: 1, ArrowDown: -1, PageUp: 10, PageDown: -10, ...sideways }[event.key];
    if (by === undefined) return;
    event.preventDefault();
    const { key, kind, min = -Infinity, max = Infinity } = this.about;
    const value = Number(node.value === "" ? this.values.at(this.path) ?? 0 : node.value) + by * stepOf(key, kind);
    node.value = String(tidy(Math.min(Math.max(value, min), max)));
    this.#typed(node);
  }

  #typed(node) {
    if (node.value === "" && node.validity.badInput) return;
    if (node.value === "" && this.about.required) return;
    this.#gesture ??= {};
    this.#write(node.value === "" ? null : Number(node.value));
  }

  #extras() {
    const { key, kind } = this.about;
    if (kind === "keyboard" || kind === "gamepad") return [captureButton(kind, nameOf(this.path), (names) => this.#write(names))];
    if (!this.#numeric || unitOf(key) !== "ms") return [];
    this.slider = this.#number("range");
    set(this.slider, { "aria-label": `${nameOf(this.path)}, slider` });
    return [this.slider];
  }

  #write(value) {
    this.values.write(this.path, value, this.#gesture ?? {});
  }

  /** Shows the draft's value, but not over what is being typed. */
  refresh() {
    const value = this.values.at(this.path);
    const written = this.values.isWritten(this.path);
    this.back.hidden = !written || this.about.required;
    this.node.classList.toggle("unwritten", !written);
    say(this.note, written ? "" : `not written: ${shown(value)}`);
    if (this.about.kind === "boolean") this.control.checked = value === true;
    else this.#fill(this.control, written ? value : "");
    if (this.slider !== undefined) this.#fill(this.slider, value ?? this.about.min);
  }

  #fill(node, value) {
    const busy = node === document.activeElement && this.#numeric && node.type === "number" && node.value !== "" && Number(node.value) === value;
    if (!busy && node.value !== String(value)) node.value = String(value);
  }
}
