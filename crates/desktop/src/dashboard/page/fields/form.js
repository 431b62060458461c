// The form of all keys of a profile, made from the JSON Schema and the draft's document.

import { announce } from "../common/announce.js";
import { button, el, say } from "../common/dom.js";
import { Field } from "./field.js";
import { nameOf } from "./schema.js";
import { TABLES, withEffect, withTable, withoutTable } from "./templates.js";
import { tablesOf, written } from "./values.js";
import { capital, choiceInWords, controlsOf, settingAt } from "../common/words.js";

/** Keys that stand in sight even while they are not written: handles and the usual choices. */
const IN_SIGHT = new Set(["release_n", "release_force_n", "min_force_n", "mode", "centre_radius_mm", "radius_hysteresis_mm", "rotation_deg",
  "diagonal_deg", "centre_x_mm", "centre_y_mm", "from_deg", "to_deg", "inner_radius_mm", "outer_radius_mm", "hysteresis_mm", "left_handed", "filter_samples",
  "min_press_ms", "slow_ms", "bounce_ms", "gamepad", "keyboard", "from_n", "full_n", "full_radius_mm", "speed_counts_per_s", "zone", "label", "up", "down", "left", "right", "class", "executable", "from"]);
const IN_SIGHT_BESIDE = { long_press_ms: "hold", permissive_hold: "hold", hold_on_other_key_press: "hold", double_press_ms: "double", hard_press_n: "hard", hard_release_n: "hard", skip: "hard", skip_ms: "skip", dwell_mm: "dwell_ms" };
const EFFECTS = ["out", "tap", "double", "hold", "light", "hard"];

export class Form {
  /** @type {Field[]} */
  #fields = [];
  #shape = "";
  /** What a person opened and closed, by its name. @type {Map<string, boolean>} */
  #opened = new Map();
  /** Where the focus goes once what was asked for is there: the first of these that there is. @type {string[]} */
  #goTo = [];

  /** @param {import("./values.js").Values} values @param {import("./schema.js").Schema} schema */
  constructor(values, schema) {
    Object.assign(this, { values, schema });
    this.groups = el("div", { class: "groups" });
    this.state = el("p", { class: "warn" });
    this.lists = ["gamepad", "keyboard", "pointer"].map((device) => el("datalist", { id: `names-${device}` },
      ...controlsOf(device).filter(([name]) => schema.canBind(device, name)).map(([, value]) => el("option", { value }))));
    const explain = el("input", { type: "checkbox", checked: true, onchange: () => this.node.classList.toggle("unexplained", !explain.checked) });
    this.adders = el("div", { class: "commands adders" });
    this.set = el("fieldset", { class: "form-set" }, el("legend", { class: "unseen", text: "Settings of the profile" }), this.groups, el("h4", { text: "Add" }), this.adders);
    this.node = el("div", { class: "form" }, el("label", { class: "check" }, explain, "Explanations"), this.state, this.set, ...this.lists);
  }

  get #draft() {
    return this.values.draft;
  }

  /** Shows the draft; makes fields anew when tables or bindings came or went. */
  refresh() {
    const { document } = this.#draft;
    if (document === null) return;
    const broken = this.#draft.unreadable;
    this.set.disabled = broken;
    say(this.state, broken ? "The text cannot be read: mend it first. The fields show its last state." : "");
    const shape = shapeOf(document);
    if (shape !== this.#shape) this.#make(document, shape);
    for (const field of this.#fields) field.refresh();
    this.#follow();
  }

  /** Adds or removes something by `change`; says so, and the focus follows. */
  #apply(sentence, goTo, change) {
    this.#goTo = goTo;
    change();
    announce(sentence);
  }

  #follow() {
    const node = this.#goTo.map((selector) => this.node.querySelector(selector)).find((found) => found !== null);
    if (this.#goTo.length === 0) return;
    this.#goTo = [];
    for (let fold = node?.parentElement.closest("details"); fold; fold = fold.parentElement.closest("details")) fold.open = true;
    node?.focus();
  }

  #make(document, shape) {
    this.#shape = shape;
    this.#fields = [];
    const groups = [this.#group("profile", "The profile itself", [], document, null)];
    for (const table of Object.keys(this.schema.json.properties)) {
      const value = document[table];
      if (value === undefined || typeof value !== "object") continue;
      if (!Array.isArray(value)) groups.push(this.#group(table, capital(settingAt([table]).word), [table], value, (title) => this.#remove(table, 0, title)));
      else value.forEach((one, index) => groups.push(this.#group(nameOf([table, index]), titleOf(table, index, one), [table, index], one, (title) => this.#remove(table, index, title))));
    }
    this.groups.replaceChildren(...groups);
    const missing = Object.entries(TABLES).filter(([table, { many }]) => many || document[table] === undefined);
    this.adders.replaceChildren(...missing.map(([table, { name }]) => button(`+ ${name}`, () => this.#add(table, name), { "data-add": table })));
  }

  #add(table, name) {
    const path = TABLES[table].many ? [table, tablesOf(this.#draft.document, table).length] : [table];
    this.#apply(`Added: ${name}.`, [`[data-group="${nameOf(path)}"] [data-field]`, `[data-group="${nameOf(path)}"] summary`],
      () => this.#draft.replace(withTable(this.#draft.text, table)));
  }

  /** The one that follows takes its place; else the one before, else what adds one. */
  #remove(table, index, title) {
    const neighbours = [index, index - 1].map((at) => `[data-group="${nameOf([table, at])}"] > summary`);
    this.#apply(`Removed: ${title}.`, [...neighbours, `[data-add="${table}"]`], () => this.#draft.replace(withoutTable(this.#draft.text, table, index)));
  }

  /** A table's keys; those that are not written and seldom wanted are folded away. */
  #group(name, title, path, value, remove) {
    const keys = this.schema.keys(path).filter(({ kind }) => kind !== "fixed" && kind !== "list");
    const plain = keys.filter(({ kind }) => kind !== "table" && kind !== "effect");
    const seen = plain.filter(({ key, required }) => required || value[key] !== undefined || inSight(key, value));
    const folded = plain.filter((about) => !seen.includes(about));
    return this.#fold(name, "group", el("strong", { text: title }), true, [
      ...seen.map((about) => this.#field(path, about)),
      ...this.#inner(path, value, keys),
      this.#folded(`${name} more`, `More settings (${folded.length})`, path, folded),
      remove === null ? null : button(`Remove ${title}`, () => remove(title), { class: "remove" }),
    ]);
  }

  /** Something to open and close; it stays as it is when fields are made anew. */
  #fold(name, kind, title, open, children) {
    const node = el("details", { class: kind, "data-group": name, open: this.#opened.get(name) ?? open }, el("summary", {}, title), ...children);
    node.addEventListener("toggle", () => this.#opened.set(name, node.open));
    return node;
  }

  /** Keys that are folded away; nothing if there are none. */
  #folded(name, title, path, keys) {
    return keys.length === 0 ? null : this.#fold(name, "folded", title, false, keys.map((about) => this.#field(path, about)));
  }

  #field(path, about) {
    const field = new Field([...path, about.key], about, this.values);
    this.#fields.push(field);
    return field.node;
  }

  /** What lies within a table: effects of a button, bindings of directions, steps of a macro. */
  #inner(path, value, keys) {
    if (path[0] === "button") return this.#effects(path, value);
    if (path[0] === "macro") return tablesOf(value, "steps").map((step, index) => this.#part([...path, "steps", index], `Step ${index + 1}`, null));
    return keys.filter(({ kind }) => kind === "table" && path.length > 0).map(({ key }) => this.#bindings(path, key));
  }

  #part(path, title, remove) {
    const value = written(this.#draft.document, path) ?? {};
    const keys = this.schema.keys(path);
    const seen = keys.filter(({ key }) => value[key] !== undefined || key === "label");
    const folded = keys.filter((about) => !seen.includes(about));
    return el("fieldset", { class: "part", "data-part": nameOf(path) }, el("legend", { text: title }), ...seen.map((about) => this.#field(path, about)),
      this.#folded(nameOf(path), `More for ${title} (${folded.length})`, path, folded),
      remove === null ? null : button(`Remove ${title}`, remove, { class: "remove" }));
  }

  #effects(path, value) {
    const present = EFFECTS.filter((effect) => value[effect] !== undefined);
    const parts = present.map((effect) => this.#part([...path, effect], capital(settingAt([...path, effect]).word), () => this.#removeEffect(path, effect)));
    const fitting = present.length === 0 ? ["out", "tap"] : { out: [], tap: ["double", "hold"], light: ["hard"] }[present[0]] ?? [];
    const adders = fitting.filter((effect) => !present.includes(effect))
      .map((effect) => [effect, `+ ${settingAt([...path, effect]).word}`])
      .map(([effect, label]) => button(label, () => this.#addEffect(path, effect, value.press_n), { "aria-label": `${label} of button ${path[1] + 1}` }));
    return adders.length === 0 ? parts : [...parts, el("div", { class: "commands" }, ...adders)];
  }

  #addEffect(path, effect, press_n) {
    this.#apply(`Added: ${settingAt([...path, effect]).word}.`, [`[data-part="${nameOf([...path, effect])}"] [data-field]`],
      () => this.#draft.replace(withEffect(this.#draft.text, path[1], effect, press_n)));
  }

  #removeEffect(path, effect) {
    const others = EFFECTS.filter((other) => other !== effect).map((other) => `[data-part="${nameOf([...path, other])}"] [data-field]`);
    this.#apply(`Removed: ${settingAt([...path, effect]).word}.`, [...others, `[data-group="${nameOf(path)}"] > summary`], () => this.values.write([...path, effect], null));
  }

  #bindings(path, device) {
    const inner = [...path, device];
    return this.#folded(nameOf(inner), capital(settingAt(inner).word), inner, this.schema.keys(inner));
  }
}

function inSight(key, value) {
  return IN_SIGHT.has(key) || (key in IN_SIGHT_BESIDE && value[IN_SIGHT_BESIDE[key]] !== undefined);
}

function titleOf(table, index, one) {
  const labels = labelsOf(one);
  const force = table === "button" ? choiceInWords([table, index, "force"], one.force) : undefined;
  const which = labels === "" ? one.name ?? force : labels;
  return `${capital(settingAt([table]).word)} ${index + 1}${which === undefined ? "" : `: ${which}`}`;
}

/** What a table's parts do in the game: "jump / run". */
function labelsOf(one) {
  return [one, ...EFFECTS.map((effect) => one[effect])].map((part) => part?.label).filter((label) => typeof label === "string").join(" / ");
}

/** What decides which fields there are. */
function shapeOf(document) {
  const shape = (value, depth) => {
    if (Array.isArray(value)) return value.map((one) => shape(one, depth + 1));
    if (typeof value !== "object") return 0;
    return Object.entries(value).filter(([, inner]) => typeof inner === "object").map(([key, inner]) => [key, shape(inner, depth + 1)]);
  };
  const names = ["zone", "layer", "macro", "stick", "trigger", "button"].map((table) => tablesOf(document, table).map((one) => [one.name ?? one.force, labelsOf(one)]));
  return JSON.stringify([shape(document, 0), names]);
}
