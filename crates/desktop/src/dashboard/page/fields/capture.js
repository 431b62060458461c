// "Press a key …": listens for one key, with those held beside it, or for one button of a gamepad. Escape leaves it.

import { announce } from "../common/announce.js";
import { button } from "../common/dom.js";
import { isModifier, keyName, padNames } from "./keys.js";
import { controlsInWords } from "../common/words.js";

const LABELS = { keyboard: "Press a key …", gamepad: "Press a button …" };
const HINTS = { keyboard: "A key is a place: its name is that of a US keyboard, whatever it types in your layout" };
const ASKS = { keyboard: "Press a key now: its place counts. Escape leaves it as it is.", gamepad: "Press a button of a gamepad now. Escape leaves it as it is." };

/**
 * A button that asks for a key or a gamepad's button.
 * @param {"keyboard" | "gamepad"} device
 * @param {string} of what it is for
 * @param {(names: string) => void} take
 */
export function captureButton(device, of, take) {
  const node = button(LABELS[device], () => new Capture(node, [device], (taken) => taken !== null && take(taken.names)), { class: "capture", "aria-label": `${LABELS[device]} for ${of}`, title: HINTS[device] ?? null });
  return node;
}

export class Capture {
  #ended = false;
  #modifiers = [];

  /**
   * Listens on these devices as long as `node` has the focus.
   * @param {("keyboard" | "gamepad")[]} devices
   * @param {(taken: { device: string, names: string } | null) => void} take is told what came, or that it was left
   */
  constructor(node, devices, take) {
    Object.assign(this, { node, devices, take, label: node.textContent });
    this.down = (event) => this.#keyDown(event);
    this.up = (event) => this.#keyUp(event);
    this.leave = () => this.#end(null);
    addEventListener("keydown", this.down, true);
    addEventListener("keyup", this.up, true);
    node.addEventListener("blur", this.leave);
    node.textContent = "Listening – Esc leaves";
    node.classList.add("listening");
    if (devices.length === 1) announce(ASKS[devices[0]]);
    if (devices.includes("gamepad")) this.#poll(padNames());
  }

  #keyDown(event) {
    event.preventDefault();
    event.stopPropagation();
    if (event.repeat) return;
    if (event.code === "Escape") return this.#end(null);
    const name = keyName(event.code);
    if (!this.devices.includes("keyboard") || name === null) return;
    if (isModifier(event.code)) this.#modifiers.push(name);
    else this.#end("keyboard", [...this.#modifiers.slice(0, 3), name].join("+"));
  }

  /** A key that is held beside others counts by itself when it goes up alone. */
  #keyUp(event) {
    event.preventDefault();
    event.stopPropagation();
    const name = keyName(event.code);
    if (this.#modifiers.includes(name)) this.#end("keyboard", this.#modifiers.slice(0, 4).join("+"));
  }

  /** Only what goes down from now on counts. */
  #poll(before) {
    if (this.#ended) return;
    const now = padNames();
    const fresh = [...now].find((name) => !before.has(name));
    if (fresh !== undefined) this.#end("gamepad", fresh);
    else requestAnimationFrame(() => this.#poll(now));
  }

  #end(device, names = null) {
    if (this.#ended) return;
    this.#ended = true;
    removeEventListener("keydown", this.down, true);
    removeEventListener("keyup", this.up, true);
    this.node.removeEventListener("blur", this.leave);
    this.node.textContent = this.label;
    this.node.classList.remove("listening");
    announce(device === null ? "Nothing was changed." : `${controlsInWords(device, names)} is taken.`);
    this.take(device === null ? null : { device, names });
  }
}
