// What there is to say at a field besides its explanation: by what stands in other fields, and by what the hand has pressed.

import { number } from "../common/dom.js";
import { choiceInWords, settingAt } from "../common/words.js";
import { letGoOf } from "./values.js";

/** Forces that a hand's press is compared with. */
const AGAINST_PRESS = new Set(["press_n", "hard_press_n", "min_force_n", "rest_n", "from_n", "full_n"]);
/** So little is no difference, in N. */
const SAME_N = 0.01;

/** @typedef {{ sentence: string, usual_n?: number }} Advice with a force that one press sets */

/** @param {(string | number)[]} path @param {import("./values.js").Values} values @returns {Advice} */
export function adviceAt(path, values) {
  return letGo(path, values) ?? resting(path, values) ?? { sentence: "" };
}

/** A let-go force that does not follow. */
function letGo(path, values) {
  const pressed = ["press_n", "hard_press_n", "min_force_n"].map((key) => [...path.slice(0, -1), key]).find((press) => letGoOf(press, 0)?.path.at(-1) === path.at(-1));
  if (pressed === undefined || !values.isWritten(path)) return null;
  const [press_n, release_n] = [values.at(pressed), values.at(path)];
  const { usual_n } = letGoOf(pressed, press_n) ?? {};
  if (!(Math.abs(usual_n - release_n) >= SAME_N)) return null;
  return { sentence: `It stays at ${release_n} N; the usual share of ${press_n} N is ${usual_n} N.`, usual_n };
}

/** What a resting hand means for touches. */
function resting(path, values) {
  const [rest_n, rest_ms] = [values.at(["access", "rest_n"]), values.at(["access", "rest_ms"])];
  if (rest_n === undefined) return null;
  if (path.at(-1) === "min_force_n" && values.at(path) < rest_n) return { sentence: `A resting hand is ignored, so a touch counts from ${rest_n} N on, above what rests.` };
  if (path.join(".") !== "access.rest_n") return null;
  const per_s = number((1000 * rest_n) / rest_ms, 2).replace(/\.?0+$/, "");
  return { sentence: `Now: what grows by less than ${per_s} N in a second rests. What comes quicker counts from ${rest_n} N on, above what rests, for directions, too. For a slower hand raise “${settingAt(["access", "rest_ms"]).word}”.` };
}

/** "your last press: 0.86 N" at a force that a press is compared with; null at any other field. @returns {((touch: import("../live/last_touch.js").LastTouch) => string) | null} */
export function pressedAt(path, values) {
  if (!AGAINST_PRESS.has(path.at(-1)) || path[0] === "stick" && path.at(-1) !== "min_force_n") return null;
  return (touch) => {
    const force = path[0] === "button" ? values.at(["button", path[1], "force"]) : "fz";
    const most_n = touch.along(force);
    return most_n === null ? "" : `your last ${force === "fz" ? "press" : choiceInWords(["button", "force"], force)}: ${number(most_n, 2)} N`;
  };
}
