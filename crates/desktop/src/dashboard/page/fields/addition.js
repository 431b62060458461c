// Asks what shall be added to press: how, where, what comes of it, and its name in the game.

import { ask } from "../common/ask.js";
import { el } from "../common/dom.js";
import { capital, choicesOf, controlsOf } from "../common/words.js";

const NEW_ZONES = {
  "upper right": [20, 70], "upper left": [110, 160], "lower left": [200, 250], "lower right": [290, 340],
};
/** What is looked for by another word. */
const KNOWN_AS = { BTN_START: "pause in most games" };
/** Asked of tactpad itself; the others are controls of a device. */
const ASKED = "bridge ";

const PUSHES = "To push up, down, left or right, the plate is pushed along itself, as a stick; it is not touched above, below or beside the middle.";

const choice = (label, options) => {
  const select = el("select", { class: "main" }, ...options.map(([value, text]) => el("option", { value, text })));
  return { select, node: el("label", { class: "chooser" }, label, select) };
};

/**
 * Asks for what a button needs.
 * @param {object} sketch of the draft
 * @param {import("./schema.js").Schema} schema
 * @returns {Promise<{ zone: { name: string, edges: number[] | null } | null, force: string, control: string, label: string } | null>}
 */
export async function askAddition(sketch, schema) {
  const taken = (force) => sketch.buttons.filter((one) => one.force === force && one.zone === null).flatMap(({ does }) => does.map(({ word }) => word)).join(", ");
  const how = choice("What your finger does", Object.entries(choicesOf(["button", "force"]))
    .map(([force, word]) => [force, taken(force) === "" ? capital(word) : `${capital(word)} (does ${taken(force)} already)`]));
  const directions = sketch.dpad === null ? [] : ["up", "down", "left", "right"];
  const own = [...sketch.zones.map(({ name }) => name), ...directions].map((name) => [name, `Only in the part ${name}`]);
  const where = choice("Where", [["", "Anywhere on the plate"], ...own, ...Object.keys(NEW_ZONES).filter((name) => !own.some(([it]) => it === name)).map((name) => [name, `In a new zone: ${name}`])]);
  const what = choice("What comes of it", [
    ...controlsOf(sketch.output).filter(([name]) => schema.canBind(sketch.output, name)).map(([name, word]) => [name, name in KNOWN_AS ? `${capital(word)} (${KNOWN_AS[name]})` : capital(word)]),
    ...Object.entries(choicesOf(["button", "out", "bridge"])).map(([command, word]) => [ASKED + command, `tactpad itself: ${word}`])]);
  how.select.setAttribute("aria-describedby", "about-pushes");
  const free = [...how.select.options].find(({ value }) => taken(value) === "");
  if (free) how.select.value = free.value;
  const label = el("input", { type: "text", class: "main", maxlength: 64, autocomplete: "off" });
  const body = el("div", { class: "asked" }, how.node, el("p", { class: "help", id: "about-pushes", text: PUSHES }), where.node, what.node, el("label", { class: "chooser" }, "Its name in the game, if you like", label));
  return ask("Add a button", body, [{ label: "Add", answer: () => ({
    zone: where.select.value === "" ? null : { name: where.select.value, edges: own.some(([name]) => name === where.select.value) ? null : NEW_ZONES[where.select.value] },
    force: how.select.value, control: what.select.value, label: label.value.trim() }) }]);
}

/** The tables of a profile for an answer. */
export function additionAsText({ zone, force, control, label }, output) {
  const asked = control.startsWith(ASKED) ? `bridge = ${JSON.stringify(control.slice(ASKED.length))}` : null;
  const [gamepad, keyboard] = output === "gamepad" ? [control, "KEY_SPACE"] : ["BTN_SOUTH", control];
  const keys = asked ?? `gamepad = ${JSON.stringify(gamepad)}, keyboard = ${JSON.stringify(keyboard)}`;
  const name = label === "" ? "" : `, label = ${JSON.stringify(label)}`;
  const edges = zone?.edges ? `[[zone]]\nname = ${JSON.stringify(zone.name)}\nfrom_deg = ${zone.edges[0]}\nto_deg = ${zone.edges[1]}\ninner_radius_mm = 15\n\n` : "";
  const inside = zone === null ? "" : `zone = ${JSON.stringify(zone.name)}\n`;
  return `${edges}[[button]]\nforce = ${JSON.stringify(force)}\npress_n = ${force === "fz" ? "2.0" : "1.0"}\n${inside}out = { ${keys}${name} }\n`;
}
