// The last touch in a sentence: how strong it was, and what came of it or what was missing.

import { REASONS } from "../common/announce.js";
import { number } from "../common/dom.js";
import { reached, share } from "../picture/touch.js";

/** What a finger does, by how profiles name it. */
const FORCES = ["fz", "fx", "-fx", "fy", "-fy"];
/** A push of less than this is none. */
const LEAST_N = 0.05;

export class LastTouch {
  /** Where it was strongest. @type {object | null} */
  #most = null;
  /** How strong each force became, in N. @type {Map<string, number>} */
  #most_n = new Map();
  #came = new Set();
  /** Words of what was rejected, each with its reason. */
  #rejected = new Map();
  #isOver = true;

  /** Takes a frame. */
  take({ trace, contact, held_names, presses }) {
    for (const [, x_mm, y_mm, fx_n, fy_n, fz_n] of trace.filter((point) => point.length > 1)) {
      if (this.#isOver) this.clear();
      this.#isOver = false;
      const point = { x_mm, y_mm, fx_n, fy_n, fz_n };
      const force = (one) => Math.max(one.fz_n, Math.abs(one.fx_n), Math.abs(one.fy_n));
      if (this.#most === null || force(point) > force(this.#most)) this.#most = point;
      for (const one of FORCES) this.#most_n.set(one, Math.max(this.#most_n.get(one) ?? 0, share({ force: one, press_n: 1 }, point)));
    }
    for (const name of held_names) this.#came.add(name);
    for (const { press, name, direction, button, reason } of presses) {
      const who = name ?? direction ?? `button ${button}`;
      if (press === "rejected") this.#rejected.set(who, REASONS[reason] ?? reason);
      if (press === "accepted" && name) this.#came.add(name);
    }
    if (contact === null) this.#isOver = true;
  }

  /** Forgets it. */
  clear() {
    this.#most = null;
    this.#most_n.clear();
    this.#came.clear();
    this.#rejected.clear();
  }

  /** How strong it became along a force, as profiles name it; null if it was not felt. */
  along(force) {
    const most_n = this.#most_n.get(force) ?? 0;
    return most_n < LEAST_N ? null : most_n;
  }

  /** What there is to say of it, by the profile in play. */
  sentence(sketch) {
    if (this.#most === null) return "No touch was felt since this page was opened.";
    const begin = `The last touch pressed with ${number(this.#most.fz_n, 2)} N`;
    if (this.#came.size > 0) return `${begin} and gave ${[...this.#came].join(", ")}.`;
    if (this.#rejected.size > 0) return `${begin}: ${[...this.#rejected].map(([who, why]) => `${who} was rejected, ${why}`).join("; ")}.`;
    const [share, nearest] = (sketch === null ? [] : reached(sketch, this.#most)).sort(([one], [other]) => other - one)[0] ?? [0, null];
    return nearest === null || share >= 1 ? `${begin} and gave nothing.` : `${begin} and gave nothing: ${nearest.word} needs ${number(nearest.press_n, 2)} N there.`;
  }
}
