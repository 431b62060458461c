// The line of a part of a profile: what the hand does, what comes of it, with how much force; and a mark of what is pressed now.

import { el, say } from "../common/dom.js";
import { capital, choiceInWords, settingAt } from "../common/words.js";
import { written } from "./values.js";

/** A short press is seen so long, in milliseconds. */
const SEEN_MS = 600;

/** @typedef {{ hand: string, gives: string[], amount: string }} Line each of `gives` in a line of its own */

const amount = (place, value) => `${Number(value.toFixed(2))} ${settingAt(place).unit}`;

/** Each part of a sketch that does something, by the tables of profiles; with the force that ignores a resting hand. @type {Record<string, (part: any, rest_n: number) => Line>} */
const LINES = {
  dpad: ({ sectors, rotation_deg, min_force_n }, rest_n) => ({
    hand: "touch beside the middle", gives: [`${sectors.filter(({ directions }) => directions.length === 1).map(({ word }) => word).join(", ")}, and where they lie${rotation_deg === 0 ? "" : `: turned by ${rotation_deg}°`}`],
    amount: amount(["dpad", "min_force_n"], Math.max(min_force_n, rest_n)) }),
  pointer: ({ min_force_n }, rest_n) => ({ hand: "touch beside the middle", gives: ["mouse pointer"], amount: amount(["pointer", "min_force_n"], Math.max(min_force_n, rest_n)) }),
  stick: ({ from, word }) => ({ hand: from === "place" ? "touch beside the middle" : "push sideways", gives: [word], amount: "" }),
  trigger: ({ word, full_n }) => ({ hand: "press into the plate", gives: [word], amount: amount(["trigger", "full_n"], full_n) }),
  button: ({ force, zone, layer, does, press_n }) => ({
    hand: `${choiceInWords(["button", "force"], force)}${zone === null ? "" : ` in ${zone}`}${layer === null ? "" : `, ${layer}`}`,
    gives: does.map(({ role_word, word }) => (role_word === settingAt(["button", "out"]).word ? word : `${role_word}: ${word}`)), amount: amount(["button", "press_n"], press_n) }),
};
const SKETCHED = { button: "buttons", stick: "sticks", trigger: "triggers" };

/** The line of a table; null for one that does nothing by itself, or of a text that cannot be played. @returns {Line | null} */
function lineOf({ sketch, document }, [table, index]) {
  const part = sketch?.[SKETCHED[table] ?? table];
  const one = index === undefined ? part : part?.[index];
  return one && table in LINES ? LINES[table](one, written(document, ["access", "rest_n"]) ?? 0) : null;
}

/** Settings that a table writes, as they read: "slow presses 300 ms". */
function settingsOf(path, value) {
  return Object.entries(value ?? {}).filter(([, one]) => typeof one === "number").map(([key, one]) => `${settingAt([...path, key]).word} ${amount([...path, key], one)}`);
}

export class Chain {
  #shown = "";
  #seen_ms = -Infinity;
  #look = "";

  /**
   * @param {(string | number)[]} path of the table
   * @param {string} title where there is no line
   * @param {string} hint where nothing is set
   * @param {import("../profile/draft.js").Draft} draft
   */
  constructor(path, title, hint, draft) {
    Object.assign(this, { path, title, hint, draft });
    this.hand = el("strong", { class: "chain-hand" });
    this.gives = el("span", { class: "chain-gives" });
    this.amount = el("span", { class: "chain-amount" });
    this.node = el("span", { class: "chain" }, this.hand, this.gives, this.amount, el("span", { class: "chain-mark", "aria-hidden": "true" }));
    this.refresh();
  }

  /** Shows what the draft says. */
  refresh() {
    const line = lineOf(this.draft, this.path);
    const settings = line === null && this.path.length === 1 ? settingsOf(this.path, written(this.draft.document, this.path)) : [];
    const { hand, gives, amount: force } = line ?? { hand: this.title, gives: settings.length === 0 ? [this.hint] : settings, amount: "" };
    this.words = line === null ? [] : wordsOf(this.draft.sketch, this.path);
    const shown = JSON.stringify([hand, gives, force]);
    if (shown === this.#shown) return;
    this.#shown = shown;
    say(this.hand, capital(hand));
    this.gives.replaceChildren(...gives.map((what) => el("span", { class: line === null ? "quiet" : null, text: line === null ? `${what} ` : ` → ${what} ` })));
    say(this.amount, force);
  }

  /** Marks how much of its force is there, and whether it is held. @param {number} share @param {string[]} held_names */
  mark(share, held_names) {
    const now_ms = performance.now();
    if (this.words.some((word) => held_names.includes(word))) this.#seen_ms = now_ms;
    const look = [Math.min(Math.max(share, 0), 1).toFixed(2), now_ms - this.#seen_ms < SEEN_MS];
    // Each frame asks; what looks the same costs nothing.
    if (look.join() === this.#look) return;
    this.#look = look.join();
    this.node.style.setProperty("--share", look[0]);
    this.node.classList.toggle("held", look[1]);
  }
}

/** What is held where a table plays. */
function wordsOf(sketch, [table, index]) {
  if (table === "button") return sketch.buttons[index].does.map(({ word }) => word);
  return table === "dpad" ? sketch.dpad.sectors.map(({ word }) => word) : [];
}
