// One key of a profile as a field: label, control, explanation, and a reset to what holds without it.

import { captureButton } from "./capture.js";
import { el, say, set } from "./dom.js";
import { NumberField } from "./number_field.js";
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
    this.described = `${this.id}-note ${this.id}-help`;
    this.control = this.#control();
    set(this.control, { id: this.id, "data-field": nameOf(path) });
    this.note = el("span", { class: "field-note quiet", id: `${this.id}-note` });
    this.back = el("button", { type: "button", class: "back", text: "↺", title: "Write nothing", "aria-label": `Do not write ${about.key}`, onclick: () => this.#unwrite() });
    const unit = unitOf(about.key);
    this.node = el("div", { class: `field ${about.kind}` },
      el("label", { for: this.id, text: about.key }),
      el("div", { class: "field-controls" }, this.control, unit === "" ? null : el("span", { class: "quiet", text: unit, "aria-hidden": "true" }), ...this.#extras(), this.back, this.note, this.number?.range),
      this.number?.error,
      el("p", { class: "help", id: `${this.id}-help`, text: about.help }));
    this.refresh();
  }

  get #numeric() {
    return this.about.kind === "number" || this.about.kind === "integer";
  }

  #control() {
    const { kind } = this.about;
    if (kind === "choice") return this.#select();
    if (this.#numeric) return this.#number().node;
    const described = { "aria-describedby": this.described };
    if (kind === "boolean") return el("input", { type: "checkbox", ...described, onchange: (event) => this.#write(event.target.checked) });
    return el("input", { type: "text", autocomplete: "off", spellcheck: "false", list: this.#list(), ...described, onchange: (event) => this.#write(event.target.value === "" ? null : event.target.value) });
  }

  #list() {
    return CHOICES_WITH_OWN_WORDS.has(this.about.kind) ? `names-${this.about.kind}` : null;
  }

  #select() {
    const { required, options, default: fallback } = this.about;
    const none = required ? [] : [el("option", { value: "", text: fallback === undefined ? "not written" : `not written: ${fallback}` })];
    return el("select", { "aria-describedby": this.described, onchange: (event) => this.#write(event.target.value === "" ? null : event.target.value) },
      ...none, ...options.map((option) => el("option", { value: option, text: option })));
  }

  #number() {
    const { key, kind, required } = this.about;
    this.number = new NumberField({
      unit: unitOf(key),
      whole: kind === "integer",
      step: stepOf(key, kind),
      limits: () => this.values.limits(this.path),
      blank: required ? "" : ", or ↺ to write none",
      start: () => this.values.at(this.path) ?? this.about.min ?? 0,
      take: (value) => this.#typed(value),
    }, { "aria-describedby": this.described, onfocusout: () => { this.#gesture = null; } });
    return this.number;
  }

  /** What is typed or slid without a pause is one step back. */
  #typed(value) {
    this.#gesture ??= {};
    this.#write(value);
  }

  #makeSlider() {
    const { key, kind, min, max } = this.about;
    return el("input", { type: "range", min, max, step: kind === "integer" ? 1 : "any", "aria-label": `${nameOf(this.path)}, slider`,
      oninput: ({ target }) => this.#typed(Number(target.value)), onblur: () => { this.#gesture = null; }, onkeydown: (event) => this.#slide(event, stepOf(key, kind)) });
  }

  /** Arrow keys step by what suits the key, as the handle does. */
  #slide(event, step) {
    const by = { ArrowUp: 1, ArrowDown: -1, ArrowRight: 1, ArrowLeft: -1, PageUp: 10, PageDown: -10 }[event.key];
    if (by === undefined) return;
    event.preventDefault();
    const { min, max } = this.about;
    this.#typed(tidy(Math.min(Math.max(Number(this.slider.value) + by * step, min), max)));
  }

  #extras() {
    const { key, kind } = this.about;
    if (kind === "keyboard" || kind === "gamepad") return [captureButton(kind, nameOf(this.path), (names) => this.#write(names))];
    if (!this.#numeric || unitOf(key) !== "ms") return [];
    this.slider = this.#makeSlider();
    return [this.slider];
  }

  /** The button goes with what it took away, and the focus stays at the field. */
  #unwrite() {
    this.#write(null);
    this.control.focus();
  }

  #write(value) {
    this.values.write(this.path, value, this.#gesture ?? {});
  }

  /** Shows the draft's value, but not over what is being typed. */
  refresh() {
    if (this.values.draft.waitsFor(this.path)) return;
    const value = this.values.at(this.path);
    const written = this.values.isWritten(this.path);
    this.back.hidden = !written || this.about.required;
    this.node.classList.toggle("unwritten", !written);
    say(this.note, written ? "" : `not written: ${shown(value)}`);
    if (this.about.kind === "boolean") this.control.checked = value === true;
    else if (this.#numeric) this.number.show(written ? value : "");
    else this.#fill(this.control, written ? value : "");
    if (this.slider !== undefined) this.#fill(this.slider, value ?? this.about.min);
  }

  #fill(node, value) {
    if (node.value !== String(value)) node.value = String(value);
  }
}
