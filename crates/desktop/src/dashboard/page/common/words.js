// The plain words of controls and settings, which the program tells; names of files stand behind them.

import { get } from "../link/api.js";

let table = { settings: {}, choices: {}, controls: { gamepad: [], keyboard: [], pointer: [] } };
let asked = false;

/** Asks the program, once. */
export async function loadWords() {
  if (!asked) table = await get("/api/words");
  asked = true;
}

/** The name of a path among settings: numbers of tables in lists are left out; any kind of press, or any device, is a `*`. */
function find(from, path) {
  const keys = path.filter((part) => typeof part === "string");
  return from[keys.join(".")] ?? from[keys.with(Math.min(1, keys.length - 1), "*").join(".")];
}

/** The word, unit and arrow-key step of a setting. @param {(string | number)[]} path */
export function settingAt(path) {
  return find(table.settings, path) ?? { word: String(path.at(-1)), unit: "", step: 0.05 };
}

/** "button 1, press force"; by a sketch, where there is one, "A: jump, press force". @param {(string | number)[]} path */
export function pathInWords(path, sketch = null) {
  const parts = path.map((part, index) => (typeof part === "number" ? ` ${part + 1}` : `${index === 0 ? "" : ", "}${settingAt(path.slice(0, index + 1)).word}`));
  const name = path[0] === "button" ? buttonInWords(sketch, path[1]) : "";
  return name === "" ? parts.join("") : [name, ...parts.slice(2)].join("");
}

/** A button by what it does: "A: jump / B: run"; "" where nobody knows. */
const buttonInWords = (sketch, index) => [...new Set(sketch?.buttons[index]?.does.map(({ word }) => word))].join(" / ");

/** The first letter as a capital, for titles. */
export const capital = (words) => words[0].toUpperCase() + words.slice(1);

/** What can stand for a setting, with its words. @returns {Record<string, string>} */
export const choicesOf = (path) => find(table.choices, path) ?? {};

/** The word of what stands for a setting. */
export const choiceInWords = (path, written) => choicesOf(path)[written] ?? written;

/** What stands in a file for a word of a setting. */
export function choiceWritten(path, word) {
  const choices = Object.entries(choicesOf(path));
  return choices.find(([, known]) => same(known, word))?.[0] ?? word;
}

const same = (one, other) => one.toLowerCase() === other.toLowerCase();

/** The words of a device's controls, by how bindings write them. @returns {[string, string][]} */
export const controlsOf = (device) => table.controls[device] ?? [];

/** A binding's controls: names with + between them; a + right behind an axis is its side. */
function partsOf(written) {
  const parts = [];
  for (const part of written.split("+")) {
    if (part === "" && parts.length > 0) parts.push(`${parts.pop()}+`);
    else parts.push(part.trim());
  }
  return parts;
}

/** "left Ctrl + C" of "KEY_LEFTCTRL+KEY_C"; a name that is no control's stays. */
export function controlsInWords(device, written) {
  const word = (name) => controlsOf(device).find(([known]) => same(known, name) || same(known, `KEY_${name}`))?.[1] ?? name;
  return partsOf(written).map(word).join(" + ");
}

/** The binding of "left Ctrl + C"; names of files are taken, too. */
export function controlsWritten(device, words) {
  const known = controlsOf(device);
  const isWritten = partsOf(words).every((name) => known.some(([it]) => same(it, name)));
  if (isWritten) return words;
  return words.split("+").map((word) => known.find(([, it]) => same(it, word.trim()))?.[0] ?? word.trim()).join("+");
}

/** What bindings are for. */
export const DEVICES = new Set(["gamepad", "keyboard", "pointer"]);

/** How a value reads: "2 N", "yes", "left Ctrl + C". @param {(string | number)[]} path */
export function valueInWords(path, value) {
  if (typeof value === "boolean") return value ? "yes" : "no";
  if (typeof value === "number") return `${value} ${settingAt(path).unit}`.trimEnd();
  const device = path.slice(1).find((part) => DEVICES.has(part));
  return device === undefined ? choiceInWords(path, String(value)) : controlsInWords(device, String(value));
}
