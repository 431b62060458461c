// Asks what shall be added to press: how, where, what comes of it, and its name in the game.

import { ask } from "../common/ask.js";
import { el, say } from "../common/dom.js";
import { capital, choiceInWords, choicesOf, controlsInWords, controlsOf } from "../common/words.js";

const NEW_ZONES = {
  "upper right": [20, 70], "upper left": [110, 160], "lower left": [200, 250], "lower right": [290, 340],
};
/** What is looked for by another word. */
const KNOWN_AS = { BTN_START: "pause in most games" };
/** Asked of tactpad itself; the others are controls of a device. */
const ASKED = "bridge ";

const PUSHES = "To push up, down, left or right, the plate is pushed along itself, as a stick; it is not touched above, below or beside the middle.";
/** Where nothing is chosen yet. */
const UNCHOSEN = ["", "Choose …"];
/** Forces from which a press into the plate and a push count. */
const PRESS_N = { fz: 2 };
const PUSH_N = 1;
/** What stands beside a control for the other device, where nothing else is known. */
const BESIDE = { gamepad: "BTN_SOUTH", keyboard: "KEY_SPACE" };

const pressN = (force) => PRESS_N[force] ?? PUSH_N;

const choice = (label, options) => {
  const select = el("select", { class: "main" }, ...options.map(([value, text]) => el("option", { value, text })));
  return { select, node: el("label", { class: "chooser" }, label, select) };
};

/** What comes with a choice: the force that it counts from, and what stands beside it for the other device. */
function consequences({ force, control, beside }, output) {
  const other = output === "gamepad" ? "keyboard" : "gamepad";
  const from = force === "" ? [] : [`It counts from ${pressN(force)} N on (100 g on a kitchen scale is about 1 N); “Press force” changes that afterwards.`];
  const both = control === "" || control.startsWith(ASKED) ? [] : [`Whenever this profile is played on the ${other}, it is ${controlsInWords(other, beside ?? BESIDE[other])} there; “On the ${other}” changes that.`];
  return [...from, ...both].join(" ");
}

/**
 * Asks for what a button needs.
 * @param {object} sketch of the draft
 * @param {import("./schema.js").Schema} schema
 * @param {{ control: string, beside?: string, label?: string }} known what is to come of it, and what stands beside that for the other device
 * @returns {Promise<{ zone: { name: string, edges: number[] | null } | null, force: string, control: string, beside?: string, label: string } | null>}
 */
export function askAddition(sketch, schema, known = { control: "" }) {
  const taken = (force) => sketch.buttons.filter((one) => one.force === force && one.zone === null).flatMap(({ does }) => does.map(({ word }) => word)).join(", ");
  const how = choice("What your finger does", [UNCHOSEN, ...Object.entries(choicesOf(["button", "force"]))
    .map(([force, word]) => [force, taken(force) === "" ? capital(word) : `${capital(word)} (does ${taken(force)} already)`])]);
  const directions = sketch.dpad === null ? [] : ["up", "down", "left", "right"];
  const own = [...sketch.zones.map(({ name }) => name), ...directions].map((name) => [name, `Only in the part ${name}`]);
  const where = choice("Where", [["", "Anywhere on the plate"], ...own, ...Object.keys(NEW_ZONES).filter((name) => !own.some(([it]) => it === name)).map((name) => [name, `In a new zone: ${name}`])]);
  const what = choice("What comes of it", [UNCHOSEN,
    ...controlsOf(sketch.output).filter(([name]) => schema.canBind(sketch.output, name)).map(([name, word]) => [name, name in KNOWN_AS ? `${capital(word)} (${KNOWN_AS[name]})` : capital(word)]),
    ...Object.entries(choicesOf(["button", "out", "bridge"])).map(([command, word]) => [ASKED + command, `tactpad itself: ${word}`])]);
  how.select.setAttribute("aria-describedby", "about-pushes");
  what.select.value = known.control;
  const label = el("input", { type: "text", class: "main", maxlength: 64, autocomplete: "off", value: known.label ?? "" });
  const [comes, missing] = [el("p", { class: "help", id: "comes-of-it" }), el("p", { class: "bad", role: "alert" })];
  const answer = () => ({
    zone: where.select.value === "" ? null : { name: where.select.value, edges: own.some(([name]) => name === where.select.value) ? null : NEW_ZONES[where.select.value] },
    force: how.select.value, control: what.select.value, label: label.value.trim(), beside: what.select.value === known.control ? known.beside : undefined });
  const chosen = () => say(comes, consequences(answer(), sketch.output));
  for (const { select } of [how, what]) select.addEventListener("change", chosen);
  chosen();
  const body = el("div", { class: "asked" }, how.node, el("p", { class: "help", id: "about-pushes", text: PUSHES }), where.node, what.node, comes,
    el("label", { class: "chooser" }, "Its name in the game, if you like", label), missing);
  return ask("Add a button", body, [{ label: "Add", answer: () => {
    const open = [how, what].filter(({ select }) => select.value === "");
    if (open.length === 0) return answer();
    say(missing, `✕ Still to choose: ${open.map(({ node }) => `“${node.firstChild.textContent}”`).join(" and ")}.`);
    open[0].select.focus();
    return undefined;
  } }]);
}

/** "push down in the part left → Start: pause, from 1 N" */
export function additionInWords({ zone, force, control, label }, output) {
  const word = control.startsWith(ASKED) ? choiceInWords(["button", "out", "bridge"], control.slice(ASKED.length)) : controlsInWords(output, control);
  return `${choiceInWords(["button", "force"], force)}${zone === null ? "" : ` in ${zone.name}`} → ${word}${label === "" ? "" : `: ${label}`}, from ${pressN(force)} N`;
}

/** The tables of a profile for an answer. */
export function additionAsText({ zone, force, control, beside, label }, output) {
  const asked = control.startsWith(ASKED) ? `bridge = ${JSON.stringify(control.slice(ASKED.length))}` : null;
  const [gamepad, keyboard] = output === "gamepad" ? [control, beside ?? BESIDE.keyboard] : [beside ?? BESIDE.gamepad, control];
  const keys = asked ?? `gamepad = ${JSON.stringify(gamepad)}, keyboard = ${JSON.stringify(keyboard)}`;
  const name = label === "" ? "" : `, label = ${JSON.stringify(label)}`;
  const edges = zone?.edges ? `[[zone]]\nname = ${JSON.stringify(zone.name)}\nfrom_deg = ${zone.edges[0]}\nto_deg = ${zone.edges[1]}\ninner_radius_mm = 15\n\n` : "";
  const inside = zone === null ? "" : `zone = ${JSON.stringify(zone.name)}\n`;
  return `${edges}[[button]]\nforce = ${JSON.stringify(force)}\npress_n = ${pressN(force).toFixed(1)}\n${inside}out = { ${keys}${name} }\n`;
}
