// The states of a text, to go back and forth in. Changes of one gesture are one step.

const MOST = 500;

export class History {
  #states = [""];
  #at = 0;
  #gesture = null;

  /** Begins anew with this text. */
  reset(text) {
    this.#states = [text];
    this.#at = 0;
    this.#gesture = null;
  }

  /** Keeps a text; the same gesture as before replaces what that gesture left. */
  record(text, gesture) {
    if (text === this.#states[this.#at]) return;
    const goesOn = gesture !== null && gesture === this.#gesture && this.#at > 0;
    this.#states.length = this.#at + 1;
    if (goesOn) this.#states[this.#at] = text;
    else this.#states.push(text);
    if (this.#states.length > MOST) this.#states.shift();
    this.#at = this.#states.length - 1;
    this.#gesture = gesture;
  }

  /** No later change belongs to the last gesture. */
  close() {
    this.#gesture = null;
  }

  get canUndo() {
    return this.#at > 0;
  }

  get canRedo() {
    return this.#at < this.#states.length - 1;
  }

  /** The state `steps` away from the present one, which it becomes; null if there is none. */
  move(steps) {
    const to = this.#at + steps;
    if (to < 0 || to >= this.#states.length) return null;
    this.#at = to;
    this.#gesture = null;
    return this.#states[to];
  }
}
