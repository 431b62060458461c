// "Change what a place presses": first the place, in the picture or on the pad, then the key or the gamepad's button.

import { Capture } from "../fields/capture.js";
import { partsAt, reached } from "./touch.js";
import { announce } from "../common/announce.js";
import { button, el, say } from "../common/dom.js";
import { controlsInWords } from "../common/words.js";

const UNCHANGED = "Nothing was changed.";
const LABEL = "Give a place another button …";
const WHICH = "Which one?";
const WHERE = "First the place: click it in the picture, or press there on the pad. It stays where it is, and gets another key or button. Cancel or Escape ends this.";
/** What turns on, moves, and leaves is the page's, not the game's. */
const FREE_KEYS = new Set(["Tab", "Shift"]);

const ofButton = ({ number, does }) => does.map(({ role, role_word, word }) => ({
  name: does.length === 1 ? word : `${role_word} ${word}`, path: (device) => ["button", number - 1, role, device] }));

const ofDirection = (direction) => ({ name: direction, path: (device) => ["dpad", device, direction] });

/** The part of the profile that a binding is of: "dpad", "button.0". */
const groupOf = ({ path }) => path("").slice(0, path("")[0] === "dpad" ? 1 : 2).join(".");

/**
 * What can be bound at a place of the picture. With a force it is what this press would do, else all that counts there.
 * @returns {{ name: string, path: (device: string) => (string | number)[] }[]}
 */
export function bindingsAt(sketch, at, pressed = null) {
  const { zones, directions } = partsAt(sketch, at);
  if (pressed !== null) {
    const strongest = reached(sketch, pressed).filter(([of]) => of >= 1).sort(([one], [other]) => other - one)[0];
    if (strongest !== undefined) return ofButton(strongest[1]);
  }
  const here = sketch.buttons.filter(({ zone }) => zone !== null && (zones.includes(zone) || directions.includes(zone)));
  const own = [...here.flatMap(ofButton), ...directions.map(ofDirection)];
  return own.length > 0 ? own : sketch.buttons.filter(({ zone }) => zone === null).flatMap(ofButton);
}

export class PlateBinding {
  /** What the pad felt most of since it was touched. */
  #pressed = null;
  #state = "off";

  /**
   * @param {import("./plate.js").Plate} plate
   * @param {import("../fields/values.js").Values} values
   * @param {(group: string) => void} pick is told which part of the profile was pressed in the picture while nothing is to be bound
   */
  constructor(plate, values, pick) {
    Object.assign(this, { plate, values, pick });
    this.start = button(LABEL, () => (this.#state === "off" ? this.#ask() : this.#leave()), { id: "bind", class: "main" });
    this.said = el("p", { class: "small" });
    this.choices = el("div", { class: "commands" });
    this.node = el("div", { class: "binding" }, this.start, this.said, this.choices);
    // What was said is soon no longer so.
    values.draft.addEventListener("text", () => this.said.textContent === UNCHANGED && say(this.said, ""));
    plate.node.addEventListener("click", (event) => this.#clicked(event));
    addEventListener("keydown", (event) => this.#key(event), true);
  }

  #clicked(event) {
    if (this.#sketch === null || event.target.closest(".handle")) return;
    const found = bindingsAt(this.#sketch, this.plate.at(event));
    if (this.#state === "where" || this.#state === "which") this.#found(found, WHICH);
    else if (this.#state === "off" && found.length > 0) this.pick(groupOf(found[0]));
  }

  get #sketch() {
    return this.values.draft.sketch;
  }

  /** Whoever goes to another view is asked no more. */
  get #asks() {
    if (this.#state === "where" && !this.node.checkVisibility()) this.#go("off", "");
    return this.#state === "where";
  }

  #go(state, sentence) {
    this.#state = state;
    this.#pressed = null;
    say(this.start, state === "off" ? LABEL : "Cancel");
    this.plate.node.classList.toggle("asks", state === "where");
    this.choices.replaceChildren();
    say(this.said, sentence);
  }

  #ask() {
    if (this.#sketch === null) return;
    this.#go("where", WHERE);
    announce(WHERE);
  }

  #leave(sentence = UNCHANGED) {
    this.#go("off", sentence);
    announce(sentence);
    this.start.focus();
  }

  /** What the pad types into this page while it is pressed is no answer. */
  #key(event) {
    if (!this.#asks || FREE_KEYS.has(event.key)) return;
    event.preventDefault();
    event.stopPropagation();
    if (event.key === "Escape") this.#leave();
  }

  /** Follows the pad, frame by frame: a press is over once nothing is held any more. */
  take({ trace, contact, held }) {
    if (!this.#asks) return;
    for (const [, x_mm, y_mm, fx_n, fy_n, fz_n] of trace.filter((point) => point.length > 1)) {
      const most = Math.max(fz_n, Math.abs(fx_n), Math.abs(fy_n));
      if (this.#pressed === null || most > this.#pressed.most) this.#pressed = { x_mm, y_mm, fx_n, fy_n, fz_n, most };
    }
    if (contact !== null || this.#pressed === null || held.length > 0) return;
    this.#found(bindingsAt(this.#sketch, { x: this.#pressed.x_mm, y: -this.#pressed.y_mm }, this.#pressed), "The pad was pressed there. Change this one?");
  }

  /** A click was meant; a press on the pad may be anybody's, and is asked about. */
  #found(bindings, question) {
    if (bindings.length === 0) return this.#leave("Nothing is bound there: add a button or directions among the settings.");
    if (bindings.length === 1 && question === WHICH) return this.#listen(bindings[0]);
    this.#go("which", question);
    this.choices.replaceChildren(...bindings.map((binding) => button(binding.name, () => this.#listen(binding), { class: "main" })));
    announce(`${question} ${bindings.map(({ name }) => name).join(", ")}.`);
    this.choices.querySelector("button").focus();
  }

  #listen(binding) {
    this.#go("key", `${binding.name}: press its key, or its button on a gamepad. Escape leaves it as it is.`);
    announce(this.said.textContent);
    this.start.focus();
    new Capture(this.start, ["keyboard", "gamepad"], (taken) => this.#take(binding, taken));
  }

  #take({ name, path }, taken) {
    if (taken === null) return this.#leave();
    const { device, names } = taken;
    this.values.write(path(device), names, {});
    const { output } = this.#sketch;
    const other = device === output ? "" : ` This profile plays the ${output}: there it stays as it was.`;
    this.#go("off", `${name} is ${controlsInWords(device, names)} on the ${device} now.${other}`);
  }
}
