// Values of a draft as it is in force: what is written, or what takes its place; and how far each may go.

import { near } from "../picture/geometry.js";
import { tidy } from "./schema.js";
import { capital, pathInWords, settingAt, valueInWords } from "../common/words.js";

/** What a press can do, by its keys: a button or key, the mouse, a layer, a macro, or what tactpad is asked. */
const KINDS = [["gamepad", "keyboard"], ["pointer"], ["layer"], ["macro"], ["bridge"]];
/** By so much a let-go force is lower than its press force at least. */
const GAP_N = 0.05;
/** Forces are written in steps of this. */
const STEP_N = 0.01;
const USUAL = { gamepad: "BTN_SOUTH", keyboard: "KEY_SPACE" };

/** What is written at a path of a document. */
export function written(document, path) {
  let value = document;
  for (const part of path) value = value?.[part];
  return value;
}

/** The tables of one name, however wrong the text may be. */
export function tablesOf(document, name) {
  return Array.isArray(document?.[name]) ? document[name] : [];
}

/** Values that follow from others when they are not written; the sketch has them. */
function derived(sketch, path) {
  const [table, second, third] = path;
  if (table === "dpad") return { release_force_n: sketch?.dpad?.release_force_n, diagonal_deg: sketch?.dpad?.diagonal_deg }[second];
  if (table === "button") return { release_n: sketch?.buttons[second]?.release_n, hard_release_n: sketch?.buttons[second]?.hard_release_n }[third];
  return undefined;
}

/** The let-go force of a press force: its path, and what it usually is; null for what has none. @returns {{ path: (string | number)[], usual_n: number } | null} */
export function letGoOf(path, press_n) {
  const { let_go } = settingAt(path);
  return let_go === undefined ? null : { path: [...path.slice(0, -1), let_go.key], usual_n: tidy(Math.round(let_go.share * press_n * 100) / 100) };
}

/** Where a let-go force has to follow its press force down: the change; `beside` gives what holds of the same table. @returns {import("../profile/draft.js").Change[]} */
export function letGoBelow(path, press_n, beside) {
  const usual = letGoOf(path, press_n);
  const key = usual?.path.at(-1);
  return usual !== null && beside(key) > press_n - GAP_N ? [{ table: path.slice(0, -1), key, value: usual.usual_n }] : [];
}

/** "A: jump, press force is 2.5 N now." */
function changeInWords(path, value, sketch) {
  if (path.join(".") === "dpad.rotation_deg") return `All directions are turned by ${value ?? 0}°.`;
  // Helps say by themselves what they do.
  if (path[0] === "access") return `${capital(settingAt(path).word)}: ${value === null ? "no more" : `${valueInWords(path, value)} now`}.`;
  return `${capital(pathInWords(path, sketch))} is ${value === null ? "as usual again" : `${valueInWords(path, value)} now`}.`;
}

export class Values {
  /** Whether the let-go force follows in a gesture, by what held when the gesture began. @type {WeakMap<object, boolean>} */
  #follows = new WeakMap();

  /**
   * @param {import("../profile/draft.js").Draft} draft
   * @param {import("./schema.js").Schema} schema
   * @param {(sentence: string) => void} tell is told what each change makes
   */
  constructor(draft, schema, tell) {
    Object.assign(this, { draft, schema, tell });
  }

  get mirrored() {
    return this.draft.document?.left_handed === true;
  }

  /** What is in force at a path. */
  at(path) {
    return written(this.draft.document, path) ?? derived(this.draft.sketch, path) ?? this.schema.describe(path).default;
  }

  isWritten(path) {
    return written(this.draft.document, path) !== undefined;
  }

  /** Changes one value, and what cannot stand beside it: another kind of effect goes, a let-go force follows its press force. */
  write(path, value, gesture = {}) {
    const [table, key] = [path.slice(0, -1), path.at(-1)];
    this.draft.change([{ table, key, value }, ...(value === null ? [] : [...this.#rivals(table, key), ...this.#letGo(path, value, gesture)])], gesture);
    this.tell(changeInWords(path, value, this.draft.sketch));
  }

  /** A let-go force at its usual share stays at it; any other follows only where it must. */
  #letGo(path, press_n, gesture) {
    const [table, usual] = [path.slice(0, -1), letGoOf(path, press_n)];
    if (usual === null || !this.isWritten(usual.path)) return [];
    if (!this.#follows.has(gesture)) this.#follows.set(gesture, Math.abs(letGoOf(path, this.at(path)).usual_n - this.at(usual.path)) < STEP_N);
    if (this.#follows.get(gesture)) return [{ table, key: usual.path.at(-1), value: usual.usual_n }];
    return letGoBelow(path, press_n, (beside) => written(this.draft.document, [...table, beside]));
  }

  #rivals(table, key) {
    const kind = KINDS.find((keys) => keys.includes(key));
    if (kind === undefined || table[0] !== "button") return [];
    const gone = KINDS.filter((it) => it !== kind).flat().filter((it) => this.isWritten([...table, it]));
    const missing = kind.filter((it) => it !== key && !this.isWritten([...table, it]));
    return [...gone.map((it) => ({ table, key: it, value: null })), ...missing.map((it) => ({ table, key: it, value: USUAL[it] }))];
  }

  /** Where a value may lie so that the profile stays valid. @returns {{ min: number, max: number }} */
  limits(path) {
    const { min = -1000, max = 1000 } = this.schema.describe(path);
    const key = path.at(-1);
    // Not every table that has the one key has the other.
    const beside = (name) => (this.schema.has([...path.slice(0, -1), name]) ? this.at([...path.slice(0, -1), name]) : NaN);
    const apart = 0.5;
    const upper = {
      release_n: () => beside("press_n") - GAP_N,
      hard_release_n: () => beside("hard_press_n") - GAP_N,
      release_force_n: () => beside("min_force_n") - GAP_N,
      radius_hysteresis_mm: () => (path[0] === "dpad" ? beside("centre_radius_mm") - apart : max),
      centre_radius_mm: () => (path[0] === "dpad" ? max : beside("full_radius_mm") - apart),
      inner_radius_mm: () => beside("outer_radius_mm") - 3,
      from_n: () => beside("full_n") - GAP_N,
    };
    const lower = {
      hard_press_n: () => beside("press_n") + GAP_N,
      centre_radius_mm: () => (path[0] === "dpad" ? beside("radius_hysteresis_mm") + apart : min),
      outer_radius_mm: () => beside("inner_radius_mm") + 3,
      full_radius_mm: () => beside("centre_radius_mm") + apart,
      full_n: () => beside("from_n") + GAP_N,
    };
    const known = (limit, otherwise) => (Number.isFinite(limit) ? tidy(limit) : otherwise);
    return { min: Math.max(min, known(lower[key]?.(), min)), max: Math.min(max, known(upper[key]?.(), max)) };
  }
}

/** Angles and places between the file and the plate as it is played: a left-handed profile is mirrored. */
export const mirror = {
  /** An angle of a zone's edge. It is its own inverse. */
  deg: (mirrored, deg) => (mirrored ? 180 - deg : deg),
  /** A place to the right, or a turn. It is its own inverse. */
  sign: (mirrored, value) => (mirrored ? -value : value),
};

/** The angle of the same direction that lies nearest to `before`, within the limits. */
export function sameTurn(deg, before, { min, max }) {
  let turned = near(deg, before);
  while (turned < min) turned += 360;
  while (turned > max) turned -= 360;
  return turned;
}
