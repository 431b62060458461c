// One key of a profile as a field: label, control, explanation, and a reset to what holds without it.

import { adviceAt, pressedAt } from "./advice.js";
import { captureButton } from "./capture.js";
import { button, el, say, set } from "../common/dom.js";
import { NumberField } from "./number_field.js";
import { nameOf, tidy } from "./schema.js";
import { capital, choiceWritten, controlsWritten, DEVICES, pathInWords, settingAt, valueInWords } from "../common/words.js";

/** What is off as usual: what its tick turns on, and where to begin. */
const SWITCHES = { rest_n: { turnsOn: "Ignore a resting hand", beginning: 0.5 }, tremor_hz: { turnsOn: "Calm trembling", beginning: 2 } };
let fields = 0;

export class Field {
  /** @type {object | null} one step back for what is typed or slid without a pause */
  #gesture = null;

  /**
   * @param {(string | number)[]} path
   * @param {{ key: string, kind: string, required: boolean, options: string[] | null, none?: string, min?: number, max?: number, default?: any, help: string }} about
   * @param {import("./values.js").Values} values
   */
  constructor(path, about, values) {
    Object.assign(this, { path, about, values, id: `field-${fields++}`, setting: settingAt(path) });
    this.described = `${this.id}-note ${this.id}-help ${this.id}-advice`;
    this.pressed = pressedAt(path, values);
    this.press = el("span", { class: "field-press quiet" });
    this.advice = el("span", { id: `${this.id}-advice` });
    this.follow = button("", () => this.#write(this.usual_n));
    this.control = this.#control();
    set(this.control, { id: this.id, "data-field": nameOf(path) });
    this.note = el("span", { class: "field-note quiet", id: `${this.id}-note` });
    this.back = el("button", { type: "button", class: "back", text: "↺", title: "As usual", "aria-label": `${this.setting.word}: as usual`, onclick: () => this.#unwrite() });
    const { word, unit } = this.setting;
    const code = el("code", { class: "code-name", "aria-hidden": "true", text: about.key });
    if (about.key in SWITCHES) this.#makeTick(SWITCHES[about.key]);
    this.node = el("div", { class: `field ${about.kind}` }, el("label", { for: this.id, class: this.tick === undefined ? null : "unseen" }, capital(word), code),
      el("div", { class: "field-controls" }, this.tickLabel, this.control, unit === "" ? null : el("span", { class: "quiet", text: unit, "aria-hidden": "true" }), ...this.#extras(), this.back, this.note, this.number?.range, this.press),
      this.number?.error,
      el("p", { class: "help", id: `${this.id}-help`, text: about.help }),
      el("p", { class: "advice small" }, this.advice, " ", this.follow));
    this.refresh();
  }

  /** What can be off has a tick before its number. */
  #makeTick({ turnsOn, beginning }) {
    this.tick = el("input", { type: "checkbox", "aria-describedby": this.described, onchange: () => this.#write(this.tick.checked ? beginning : null) });
    this.tickLabel = el("label", { class: "check" }, this.tick, turnsOn);
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
    return el("input", { type: "text", autocomplete: "off", spellcheck: "false", list: this.#list(), ...described, onchange: (event) => this.#write(this.#fromWords(event.target.value.trim())) });
  }

  #list() {
    return DEVICES.has(this.about.kind) ? `names-${this.about.kind}` : null;
  }

  /** How a value reads. */
  #inWords(value) {
    return valueInWords(this.path, value);
  }

  /** What stands in the file for words; null for none. */
  #fromWords(words) {
    if (words === "") return null;
    return DEVICES.has(this.about.kind) ? controlsWritten(this.about.kind, words) : choiceWritten(this.path, words);
  }

  #select() {
    const { required, options, none, default: fallback } = this.about;
    const unwritten = required ? [] : [el("option", { value: "", text: fallback === undefined ? none ?? "as usual" : `as usual: ${this.#inWords(fallback)}` })];
    return el("select", { "aria-describedby": this.described, onchange: (event) => this.#write(event.target.value === "" ? null : event.target.value) },
      ...unwritten, ...options.map((option) => el("option", { value: option, text: this.#inWords(option) })));
  }

  #number() {
    const { kind, required } = this.about;
    const { unit, step } = this.setting;
    this.number = new NumberField({
      unit,
      whole: kind === "integer",
      step,
      limits: () => this.values.limits(this.path),
      blank: required ? "" : ", or ↺ for the usual",
      start: () => this.values.at(this.path) ?? SWITCHES[this.about.key]?.beginning ?? this.about.min ?? 0,
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
    const { kind, min, max } = this.about;
    return el("input", { type: "range", min, max, step: kind === "integer" ? 1 : "any", "aria-label": `${pathInWords(this.path)}, slider`,
      oninput: ({ target }) => this.#typed(Number(target.value)), onblur: () => { this.#gesture = null; }, onkeydown: (event) => this.#slide(event, this.setting.step) });
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
    const { kind } = this.about;
    if (kind === "keyboard" || kind === "gamepad") return [captureButton(kind, pathInWords(this.path), (names) => this.#write(names))];
    if (!this.#numeric || this.setting.unit !== "ms") return [];
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

  /** Shows how strong the last press was, where that says something. @param {import("../live/last_touch.js").LastTouch} touch */
  showPress(touch) {
    if (this.pressed !== null) say(this.press, this.pressed(touch));
  }

  #advise() {
    const { sentence, usual_n } = adviceAt(this.path, this.values);
    this.usual_n = usual_n;
    say(this.advice, sentence);
    this.advice.parentElement.hidden = sentence === "";
    this.follow.hidden = usual_n === undefined;
    say(this.follow, usual_n === undefined ? "" : `Set it to ${this.#inWords(usual_n)}`);
  }

  /** Shows the draft's value, but not over what is being typed. */
  refresh() {
    if (this.values.draft.waitsFor(this.path)) return;
    this.#advise();
    const value = this.values.at(this.path);
    const written = this.values.isWritten(this.path);
    this.back.hidden = !written || this.about.required || this.tick !== undefined;
    if (this.tick !== undefined) this.tick.checked = written;
    this.node.classList.toggle("unwritten", !written);
    say(this.note, written ? "" : this.#unwritten(value));
    if (this.about.kind === "boolean") this.control.checked = value === true;
    else if (this.#numeric) this.number.show(written ? value : "");
    else this.#fill(this.control, !written ? "" : this.about.kind === "choice" ? value : this.#inWords(value));
    if (this.slider !== undefined) this.#fill(this.slider, value ?? this.about.min);
  }

  /** What holds while nothing is written. */
  #unwritten(value) {
    if (value !== undefined) return `as usual: ${this.#inWords(value)}`;
    const { beginning } = SWITCHES[this.about.key] ?? {};
    return beginning === undefined ? "" : `off; ${this.#inWords(beginning)} is a good beginning`;
  }

  #fill(node, value) {
    if (node.value !== String(value)) node.value = String(value);
  }
}
