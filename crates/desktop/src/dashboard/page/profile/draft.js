// The draft of a profile. Its text is the only truth: fields and handles ask the program to change the text.

import { post } from "../link/api.js";
import { pathInWords } from "../common/words.js";
import { History } from "./history.js";

/** @typedef {{ table: (string | number)[], key: string, value: number | string | boolean | null }} Change */

const place = ({ table, key }) => JSON.stringify([table, key]);

/**
 * Tells by events: "text" (the text is another one, not by typing), "typed", "checked" (diagnostics, document, sketch are new),
 * "failed" (a sentence in `detail`).
 */
export class Draft extends EventTarget {
  text = "";
  saved = "";
  diagnostics = [];
  /** The last document and sketch that could be read; `stale` says that the text has changed to what cannot. */
  document = null;
  sketch = null;
  stale = false;
  /** Whether not even the document could be read. */
  unreadable = false;
  history = new History();
  /** @type {Map<string, Change>} */
  #waiting = new Map();
  #gesture = null;
  #unchecked = false;
  #running = false;
  #epoch = 0;

  /** Whether there is something to save. */
  get dirty() {
    return this.text !== this.saved;
  }

  get valid() {
    return !this.stale && !this.diagnostics.some(({ severity }) => severity === "error");
  }

  /** Starts anew with a file's text, and a draft of it if there is one. */
  load(saved, text = saved) {
    this.#drop();
    Object.assign(this, { saved, text, diagnostics: [], document: null, sketch: null, stale: true });
    this.history.reset(saved);
    this.history.record(text, null);
    this.#told("text");
    this.#check();
  }

  /** The text was saved as it is. */
  markSaved(text) {
    this.saved = text;
    this.#told("checked");
  }

  /** Somebody typed. */
  type(text, gesture) {
    this.text = text;
    this.history.record(text, gesture, "what was typed into the text");
    this.#told("typed");
    this.#check();
  }

  /** Looks at the text once more: the program may not have answered. */
  again() {
    this.#check();
  }

  /** Another whole text in one step; `made` says what made it. */
  replace(text, made = "") {
    this.#drop();
    this.text = text;
    this.history.record(text, null, made);
    this.#told("text");
    this.#check();
  }

  /** Goes back (-1) or forth (1). */
  move(steps) {
    const text = this.history.move(steps);
    if (text === null) return false;
    this.#drop();
    this.text = text;
    this.#told("text");
    this.#check();
    return true;
  }

  /** Whether a change of this key is still to be made: what the draft says of it is old. @param {(string | number)[]} path */
  waitsFor(path) {
    return this.#waiting.has(place({ table: path.slice(0, -1), key: path.at(-1) }));
  }

  /** Changes values; changes of one `gesture` are one step back. @param {Change[]} changes */
  change(changes, gesture = {}) {
    for (const change of changes) this.#waiting.set(place(change), change);
    this.#gesture = gesture;
    this.#check();
  }

  /** Whether changes or words are still to be looked at. */
  get isUnchecked() {
    return this.#unchecked;
  }

  #drop() {
    this.#epoch += 1;
    this.#waiting.clear();
  }

  #told(what, detail = null) {
    this.dispatchEvent(new CustomEvent(what, { detail }));
  }

  #check() {
    this.#unchecked = true;
    if (!this.#running) this.#run();
  }

  /** One request at a time; what comes meanwhile goes with the next one, the latest value of each key. */
  async #run() {
    this.#running = true;
    while (this.#unchecked) {
      this.#unchecked = false;
      const request = { text: this.text, changes: [...this.#waiting.values()] };
      const [epoch, gesture] = [this.#epoch, this.#gesture];
      this.#waiting.clear();
      try {
        const answer = await post("/api/draft", request);
        if (epoch === this.#epoch) this.#take(answer, request, gesture);
        else this.#unchecked = true;
      } catch (error) {
        this.#told("failed", error.message);
      }
    }
    this.#running = false;
  }

  #take(answer, { text, changes }, gesture) {
    if (this.text !== text) {
      // Somebody typed meanwhile: the changes go onto the new text.
      for (const change of changes) if (!this.#waiting.has(place(change))) this.#waiting.set(place(change), change);
      this.#unchecked = true;
      return;
    }
    if (!answer.error && answer.text !== text) {
      this.text = answer.text;
      this.history.record(this.text, gesture, changes.length === 0 ? "" : pathInWords([...changes[0].table, changes[0].key], this.sketch));
      this.#told("text");
    }
    this.diagnostics = answer.diagnostics ?? [];
    this.stale = !answer.sketch;
    this.unreadable = !answer.document;
    if (answer.document) this.document = answer.document;
    if (answer.sketch) this.sketch = answer.sketch;
    this.#told("checked");
    if (answer.error) this.#told("failed", answer.error);
  }
}
