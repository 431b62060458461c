// The form of all keys of a profile, made from the JSON Schema and the draft's document.

import { additionAsText, additionInWords, askAddition } from "./addition.js";
import { announce } from "../common/announce.js";
import { Chain } from "./chain.js";
import { button, el, say } from "../common/dom.js";
import { Field } from "./field.js";
import { nameOf } from "./schema.js";
import { TABLES, withEffect, withTable, withText, withoutTable } from "./templates.js";
import { reached } from "../picture/touch.js";
import { tablesOf, written } from "./values.js";
import { capital, choiceInWords, controlsOf, settingAt } from "../common/words.js";

/** Keys that stand in sight even while they are not written: handles and the usual choices. */
const IN_SIGHT = new Set(["release_n", "release_force_n", "min_force_n", "mode", "centre_radius_mm", "radius_hysteresis_mm", "rotation_deg",
  "diagonal_deg", "centre_x_mm", "centre_y_mm", "from_deg", "to_deg", "inner_radius_mm", "outer_radius_mm", "hysteresis_mm", "left_handed", "filter_samples",
  "min_press_ms", "slow_ms", "bounce_ms", "rest_n", "tremor_hz", "gamepad", "keyboard", "from_n", "full_n", "full_radius_mm", "speed_counts_per_s", "zone", "label", "up", "down", "left", "right", "class", "executable", "from"]);
/** Keys that need another one: they stand in sight beside it, and go with it. */
const IN_SIGHT_BESIDE = { long_press_ms: "hold", permissive_hold: "hold", hold_on_other_key_press: "hold", double_press_ms: "double", hard_press_n: "hard", hard_release_n: "hard", skip: "hard", skip_ms: "hard", dwell_mm: "dwell_ms" };
const EFFECTS = ["out", "tap", "double", "hold", "light", "hard"];
/** Settings of the profile that fit it to the hand. */
const OF_HAND = new Set(["left_handed", "centre_x_mm", "centre_y_mm", "filter_samples", "min_press_ms"]);
/** What people look for most stands first. */
const FIRST = new Set(["press_n", "rotation_deg", "rest_n", "tremor_hz"]);
/** What is inside of parts that say nothing by themselves. */
const HINTS = {
  hand: "left or right hand, its middle, smoothing, shortest press", access: "a resting hand, trembling, presses too slow or twice",
  gain: "a hand that reaches less far on one side", profile: "its name; gamepad or keyboard",
};
/** Which tables stand under which heading, in their order. */
const PLAYS = ["dpad", "button", "zone", "pointer", "stick", "trigger", "layer", "macro"];

export class Form {
  /** @type {Field[]} */
  #fields = [];
  /** @type {Chain[]} */
  #chains = [];
  #shape = "";
  /** What a person opened and closed, by its name. @type {Map<string, boolean>} */
  #opened = new Map();
  /** Where the focus goes once what was asked for is there: the first of these that there is. @type {string[]} */
  #goTo = [];

  /**
   * @param {import("./values.js").Values} values
   * @param {import("./schema.js").Schema} schema
   * @param {(part: string | null) => void} light is told which part of the plate belongs to what was opened: "dpad", or a zone
   * @param {(sentence: string, offer?: HTMLElement) => void} tell is told what is to be read once the draft was changed, and what is offered beside it
   */
  constructor(values, schema, light, tell) {
    Object.assign(this, { values, schema, light, tell });
    this.groups = el("div", { class: "groups" });
    this.state = el("p", { class: "warn" });
    this.lists = ["gamepad", "keyboard", "pointer"].map((device) => el("datalist", { id: `names-${device}` },
      ...controlsOf(device).filter(([name]) => schema.canBind(device, name)).map(([, value]) => el("option", { value }))));
    const explain = el("input", { type: "checkbox", checked: true, onchange: () => this.node.classList.toggle("unexplained", !explain.checked) });
    this.adders = el("div", { class: "commands adders" });
    this.forHand = el("div", { class: "groups" });
    this.ofProfile = el("div", { class: "groups" });
    const part = (title, ...nodes) => [el("h4", { text: title }), ...nodes];
    this.set = el("fieldset", { class: "form-set" }, el("legend", { class: "unseen", text: "Settings of the profile" }),
      ...part("What your hand does → what comes of it", this.groups, this.adders), ...part("How it fits your hand", this.forHand), ...part("The profile itself", this.ofProfile));
    this.node = el("div", { class: "form" }, this.state, this.set, el("label", { class: "check" }, explain, "Explanations"), ...this.lists);
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
    for (const chain of this.#chains) chain.refresh();
    this.#follow();
  }

  /** Adds or removes something by `change`; says so, and the focus follows. */
  #apply(sentence, goTo, change, { opened = null, offer = undefined } = {}) {
    this.#goTo = goTo;
    if (opened !== null) this.#opened.set(opened, true);
    this.tell(sentence, offer);
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
    this.#chains = [];
    this.groups.replaceChildren(...PLAYS.flatMap((table) => this.#tables(document, table)));
    this.forHand.replaceChildren(this.#group("hand", "Hand and pace", [], document, null, ({ key }) => OF_HAND.has(key)),
      ...["access", "gain"].map((table) => this.#group(table, capital(settingAt([table]).word), [table], document[table] ?? {}, null)));
    this.ofProfile.replaceChildren(this.#group("profile", "Name and output", [], document, null, ({ key }) => !OF_HAND.has(key)), ...this.#tables(document, "program"));
    const missing = Object.entries(TABLES).filter(([table, { many }]) => many || document[table] === undefined);
    this.adders.replaceChildren(button("+ Add a button …", () => this.#addButton(undefined), { "data-add": "button" }),
      this.#fold("adders", "folded", "Add something else", false, [el("div", { class: "commands" }, ...missing.map(([table, { name }]) => button(`+ ${name}`, () => this.#add(table, name), { "data-add": table })))]));
  }

  /** The groups of a table, or of all tables of a list. */
  #tables(document, table) {
    const value = document[table];
    if (value === undefined || typeof value !== "object") return [];
    if (!Array.isArray(value)) return [this.#group(table, capital(settingAt([table]).word), [table], value, (title) => this.#remove(table, 0, title))];
    return value.map((one, index) => this.#group(nameOf([table, index]), titleOf(table, index, one), [table, index], one, (title) => this.#remove(table, index, title)));
  }

  /** Opens the part of this name alone, and goes there. */
  pick(name) {
    for (const group of this.node.querySelectorAll(".group")) group.open = group.dataset.group === name;
    const summary = this.node.querySelector(`[data-group="${name}"] > summary`);
    summary?.focus();
    summary?.scrollIntoView({ block: "nearest" });
  }

  /** Shows beside forces how strong the last press was. @param {import("../live/last_touch.js").LastTouch} touch */
  showPress(touch) {
    for (const field of this.#fields) field.showPress(touch);
  }

  /** Marks what a frame presses. */
  follow({ contact, held_names }) {
    const { sketch } = this.#draft;
    if (sketch === null || this.#draft.stale) return;
    const shares = new Map(contact === null ? [] : reached(sketch, contact).map(([share, { number }]) => [`button.${number - 1}`, share]));
    if (contact !== null && sketch.dpad !== null) shares.set("dpad", contact.fz_n / sketch.dpad.min_force_n);
    for (const chain of this.#chains) chain.mark(shares.get(nameOf(chain.path)) ?? 0, held_names);
  }

  /** @param {object} known what is to come of it, if that is known */
  async #addButton(known) {
    const { sketch } = this.#draft;
    if (sketch === null) return;
    const answer = await askAddition(sketch, this.schema, known);
    if (answer === null) return;
    const group = nameOf(["button", tablesOf(this.#draft.document, "button").length]);
    const sentence = `Added: ${additionInWords(answer, sketch.output)}.`;
    this.#apply(sentence, [`[data-group="${group}"] > summary`], () => this.#draft.replace(withText(this.#draft.text, additionAsText(answer, sketch.output)), sentence), { opened: group });
  }

  #add(table, name) {
    const path = TABLES[table].many ? [table, tablesOf(this.#draft.document, table).length] : [table];
    this.#apply(`Added: ${name}.`, [`[data-group="${nameOf(path)}"] [data-field]`, `[data-group="${nameOf(path)}"] summary`],
      () => this.#draft.replace(withTable(this.#draft.text, table), `Added: ${name}`));
  }

  /** The one that follows takes its place; else the one before, else what adds one. */
  #remove(table, index, title) {
    const neighbours = [index, index - 1].map((at) => `[data-group="${nameOf([table, at])}"] > summary`);
    this.#apply(`Removed: ${title}.`, [...neighbours, `[data-add="${table}"]`], () => this.#draft.replace(withoutTable(this.#draft.text, table, index), `Removed: ${title}`));
  }

  /** A table's keys; those that are not written and seldom wanted are folded away. */
  #group(name, title, path, value, remove, belongs = () => true) {
    const keys = this.schema.keys(path).filter((about) => about.kind !== "fixed" && about.kind !== "list" && belongs(about));
    const plain = keys.filter(({ kind }) => kind !== "table" && kind !== "effect");
    const seen = plain.filter(({ key, required }) => required || value[key] !== undefined || inSight(key, value))
      .sort((one, other) => FIRST.has(other.key) - FIRST.has(one.key));
    const folded = plain.filter((about) => !seen.includes(about));
    const chain = new Chain(path, title, HINTS[name] ?? "", this.#draft);
    this.#chains.push(chain);
    return this.#fold(name, "group", chain.node, false, [
      ...seen.map((about) => this.#field(path, about)),
      ...this.#inner(path, value, keys),
      this.#folded(`${name} more`, `More settings (${folded.length})`, path, folded),
      remove === null ? null : button(`Remove ${title}`, () => remove(title), { class: "remove" }),
    ]);
  }

  /** Something to open and close; it stays as it is when fields are made anew. */
  #fold(name, kind, title, open, children) {
    const node = el("details", { class: kind, "data-group": name, open: this.#opened.get(name) ?? open }, el("summary", {}, title), ...children);
    node.addEventListener("toggle", () => {
      this.#opened.set(name, node.open);
      if (kind !== "group" || !node.isConnected) return;
      const open = node.open ? node : [...this.node.querySelectorAll(".group[open]")].at(-1);
      this.light(open === undefined ? null : this.#partOf(open.dataset.group));
    });
    return node;
  }

  #partOf(name) {
    const [table, index] = name.split(".");
    const one = tablesOf(this.#draft.document, table)[index];
    return table === "zone" ? one?.name : table === "button" ? one?.zone : name;
  }

  /** Keys that are folded away; nothing if there are none. */
  #folded(name, title, path, keys) {
    return keys.length === 0 ? null : this.#fold(name, "folded", title, false, keys.map((about) => this.#field(path, about)));
  }

  /** Names of other tables are chosen among those that there are. */
  #named(path, about) {
    const { document } = this.#draft;
    const names = (table) => tablesOf(document, table).map(({ name }) => name).filter((name) => typeof name === "string");
    const directions = document.dpad === undefined ? [] : ["up", "down", "left", "right"];
    const options = { zone: [...names("zone"), ...directions], layer: names("layer"), macro: names("macro") }[about.key];
    if (options === undefined || about.kind !== "string" || path.length === 0) return about;
    const value = written(document, [...path, about.key]);
    const none = path.length === 2 ? { zone: "everywhere", layer: "in all" }[about.key] : "none";
    return { ...about, kind: "choice", none, options: [...new Set([...options, value].filter((one) => one !== undefined))] };
  }

  #field(path, plain) {
    const about = this.#named(path, plain);
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
    return el("fieldset", { class: "part", "data-part": nameOf(path) }, el("legend", { text: title }),
      remove === null ? null : button(`Turn off the ${title.toLowerCase()}`, remove), ...seen.map((about) => this.#field(path, about)),
      this.#folded(nameOf(path), `More for ${title} (${folded.length})`, path, folded));
  }

  #effects(path, value) {
    const present = EFFECTS.filter((effect) => value[effect] !== undefined);
    const wordOf = (effect) => settingAt([...path, effect === "tap" && value.hold === undefined ? "out" : effect]).word;
    const parts = present.map((effect) => this.#part([...path, effect], capital(wordOf(effect)), present.length === 1 ? null : () => this.#removeEffect(path, effect)));
    const fitting = present.length === 0 ? ["out", "tap"] : { out: [], tap: ["double", "hold"], light: ["hard"] }[present[0]] ?? [];
    const adders = fitting.filter((effect) => !present.includes(effect))
      .map((effect) => [effect, `+ ${settingAt([...path, effect]).word}`])
      .map(([effect, label]) => button(label, () => this.#addEffect(path, effect, value.press_n), { "aria-label": `${label} of button ${path[1] + 1}` }));
    return adders.length === 0 ? parts : [...parts, el("div", { class: "commands" }, ...adders)];
  }

  #addEffect(path, effect, press_n) {
    this.#apply(`Added: ${settingAt([...path, effect]).word}.`, [`[data-part="${nameOf([...path, effect])}"] [data-field]`],
      () => this.#draft.replace(withEffect(this.#draft.text, path[1], effect, press_n), `Added: ${settingAt([...path, effect]).word}`));
  }

  /** What is set for it alone goes with it. */
  #removeEffect(path, effect) {
    const alone = Object.keys(IN_SIGHT_BESIDE).filter((key) => IN_SIGHT_BESIDE[key] === effect && this.values.isWritten([...path, key]));
    const others = EFFECTS.filter((other) => other !== effect).map((other) => `[data-part="${nameOf([...path, other])}"] [data-field]`);
    const gone = this.#onNoButton(path, effect);
    const sentence = `The ${settingAt([...path, effect]).word} is turned off${gone === null ? "" : `: ${gone} is on no button now. Undo brings it back`}.`;
    this.#apply(sentence, [...others, `[data-group="${nameOf(path)}"] > summary`], () => this.#draft.change([effect, ...alone].map((key) => ({ table: path, key, value: null }))),
      { offer: gone === null ? undefined : this.#elsewhere(gone, written(this.#draft.document, [...path, effect])) });
  }

  /** What is on no button without this kind of press, in words; null for what is on another one. */
  #onNoButton(path, effect) {
    const { sketch } = this.#draft;
    const all = sketch?.buttons.flatMap(({ number, does }) => does.map((one) => ({ ...one, isIt: number - 1 === path[1] && one.role === effect }))) ?? [];
    const gone = all.find(({ isIt }) => isIt);
    const isElsewhere = all.some(({ isIt, keys }) => !isIt && keys === gone?.keys);
    return gone === undefined || isElsewhere ? null : gone.word;
  }

  /** A button that puts what was turned off on another press. */
  #elsewhere(word, { label, ...bound }) {
    const { output } = this.#draft.sketch;
    const known = { control: bound[output], beside: bound[output === "gamepad" ? "keyboard" : "gamepad"], label };
    return controlsOf(output).some(([name]) => name === known.control) ? button(`Put ${word} elsewhere …`, () => this.#addButton(known), { class: "main" }) : undefined;
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
