// The states of a text, to go back and forth in. Changes of one gesture are one step.

const MOST = 500;

export class History {
  #states = [""];
  /** What made each state out of the one before it, in words. */
  #made = [""];
  #at = 0;
  #gesture = null;

  /** Begins anew with this text. */
  reset(text) {
    this.#states = [text];
    this.#made = [""];
    this.#at = 0;
    this.#gesture = null;
  }

  /** Keeps a text and what made it; the same gesture as before replaces what that gesture left. */
  record(text, gesture, made = "") {
    if (text === this.#states[this.#at]) return;
    const goesOn = gesture !== null && gesture === this.#gesture && this.#at > 0;
    for (const all of [this.#states, this.#made]) all.length = this.#at + (goesOn ? 0 : 1);
    this.#states.push(text);
    this.#made.push(made);
    if (this.#states.length > MOST) for (const all of [this.#states, this.#made]) all.shift();
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

  /** What a step back takes away, in words; "" where nobody said. */
  get last() {
    return this.#made[this.#at];
  }

  /** What a step forth brings back. */
  get next() {
    return this.#made[this.#at + 1] ?? "";
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
