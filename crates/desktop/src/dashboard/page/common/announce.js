// Speaks to screen readers: at most one sentence a second, with counts in place of repetitions.

import { announces } from "./settings.js";

const BETWEEN_MS = 1000;
/** Whoever reads the page later finds no sentence that is true no more. */
const STAYS_MS = 10_000;
/** Why a press does not count. */
export const REASONS = { slow: "too short", bounce: "too soon after the last", dwell: "not at rest" };

const region = () => document.getElementById("announcer");
/** @type {Map<string, number>} */
const counts = new Map();
let sentences = [];
let last_ms = -Infinity;
let timer = null;
let clearing = null;

function flush() {
  timer = null;
  const parts = [...sentences];
  // What was pressed before people switched this off is not spoken after it.
  if (!announces()) counts.clear();
  for (const [what, count] of counts) parts.push(count === 1 ? what : `${what}, ${count} times`);
  sentences = [];
  counts.clear();
  if (parts.length === 0) return;
  last_ms = performance.now();
  // A text that is repeated word for word is not spoken again, so it alternates with a blank behind it.
  const text = parts.join(". ");
  region().textContent = region().textContent === text ? `${text}\u00a0` : text;
  clearTimeout(clearing);
  clearing = setTimeout(() => { region().textContent = ""; }, STAYS_MS);
}

function schedule() {
  if (timer === null) timer = setTimeout(flush, Math.max(0, last_ms + BETWEEN_MS - performance.now()));
}

/** Says a sentence, whatever was chosen for presses: it answers something that a person did. */
export function announce(sentence) {
  sentences.push(sentence.replace(/\.$/, ""));
  schedule();
}

/** Says what became of a press, if presses are to be spoken. */
export function announcePress(press) {
  if (!announces()) return;
  const what = pressInWords(press);
  counts.set(what, (counts.get(what) ?? 0) + 1);
  schedule();
}

/** "A: jump accepted", "left rejected: too short", "hand at rest". */
export function pressInWords({ button, direction, name, press, reason }) {
  if (press === "rest") return "hand at rest";
  const who = name ?? direction ?? `button ${button}`;
  return press === "rejected" ? `${who} rejected: ${REASONS[reason] ?? reason}` : `${who} accepted`;
}
