// Undoes what one save changed, and leaves alone what came before and after it.

import { post } from "../link/api.js";
import { pathInWords, valueInWords } from "../common/words.js";
import { withTableBack, withoutTable } from "../fields/templates.js";
import { letGoBelow } from "../fields/values.js";

/** @typedef {{ what: string, is: string, had: string | null }} Done what is as it was again, and what had come of it since */
/** @typedef {{ what: string, went: number | undefined }} Refused what is there no more, and in which later text it went, if that is known */

/** What tells tables of a list apart: without it alike, they are the same only if more than half of the rest is. */
const TELLING = ["force", "name", "stick", "trigger"];
/** Tables that come and go with any of their values. */
const HELPS = new Set(["access", "gain"]);

/** All values of a table by their places: `["out","label"]`. @returns {Map<string, any>} */
function leaves(value, path = [], into = new Map()) {
  if (value !== null && typeof value === "object") for (const [key, inner] of Object.entries(value)) leaves(inner, [...path, Array.isArray(value) ? Number(key) : key], into);
  else if (value !== undefined) into.set(JSON.stringify(path), value);
  return into;
}

const isAlike = (one, other) => {
  const [ones, others] = [leaves(one), leaves(other)];
  return ones.size === others.size && [...ones].every(([place, value]) => others.get(place) === value);
};

/** How many values two tables share; 0 if they are two different ones. */
function shared(one, other) {
  const [ones, others] = [leaves(one), leaves(other)];
  const same = [...ones].filter(([place, value]) => others.get(place) === value).length;
  const differs = TELLING.some((key) => one[key] !== other[key]);
  return 2 * same >= Math.min(ones.size, others.size) + (differs ? 1 : 0) ? same : 0;
}

/** What each table of a list is in the next list: its number there, or undefined. Most values alike, in order. */
function matched(from, to) {
  const best = Array.from({ length: from.length + 1 }, () => new Array(to.length + 1).fill(0));
  const pair = (one, other) => shared(from[one], to[other]);
  for (let one = from.length - 1; one >= 0; one -= 1) {
    for (let other = to.length - 1; other >= 0; other -= 1) {
      const both = pair(one, other);
      best[one][other] = Math.max(best[one + 1][other], best[one][other + 1], both === 0 ? 0 : both + best[one + 1][other + 1]);
    }
  }
  const found = from.map(() => undefined);
  for (let one = 0, other = 0; one < from.length && other < to.length;) {
    const both = pair(one, other);
    if (both > 0 && best[one][other] === both + best[one + 1][other + 1]) found[one++] = other++;
    else if (best[one][other] === best[one + 1][other]) one += 1;
    else other += 1;
  }
  return found;
}

/** What each table of the first list is in the last one, from save to save; and in which list it was there no more. */
function followed([first, ...others]) {
  let [before, now] = [first, first.map((_, index) => index)];
  const went = [];
  others.forEach((list, step) => {
    const next = matched(before, list);
    now = now.map((at, index) => {
      if (at !== undefined && next[at] === undefined) went[index] = step;
      return next[at];
    });
    before = list;
  });
  return { now, went };
}

/** What is to be done to a document so that a save is undone; `document` is what comes of it. */
class Undoing {
  /** @type {import("./draft.js").Change[]} values, by the numbers that tables have before any comes or goes */
  changes = [];
  /** Tables that come back from the older text (`from` is their number there) or go, the last place first. @type {{ key: string, at: number, from?: number }[]} */
  tables = [];
  /** @type {Done[]} */
  done = [];
  /** @type {Refused[]} */
  refused = [];

  /** @param {object} before the save @param {object} after it @param {object[]} later documents, the present one last @param {object | null} sketch of the present one */
  constructor(before, after, later, sketch) {
    this.document = structuredClone(later.at(-1));
    this.sketch = sketch;
    const all = [before, after, ...later];
    for (const key of new Set([...Object.keys(before), ...Object.keys(after)])) {
      if (all.some((document) => Array.isArray(document[key]))) this.#list(key, all.map((document) => document[key] ?? []));
      else this.#one(key, before[key], after[key]);
    }
    this.#keepLetGo();
    this.#moveTables(before);
  }

  #one(key, before, after) {
    const gone = typeof before === "object" && after === undefined;
    if (gone && this.document[key] === undefined) this.#back(key, before, { at: 0, from: 0 });
    else this.#values([key], before, after, this.document[key]);
  }

  #list(key, [before, after, ...later]) {
    const became = matched(before, after);
    const { now, went } = followed([after, ...later]);
    const isAt = (index) => now[became[index]];
    before.forEach((one, index) => {
      if (became[index] === undefined) {
        const ahead = before.slice(0, index).map((_, other) => isAt(other)).findLast((at) => at !== undefined);
        this.#back(key, one, { at: ahead === undefined ? 0 : ahead + 1, from: index });
      } else if (!isAlike(one, after[became[index]])) {
        if (isAt(index) === undefined) this.refused.push({ what: tableInWords(key, became[index], after[became[index]]), went: went[became[index]] });
        else this.#values([key, isAt(index)], one, after[became[index]], later.at(-1)[isAt(index)]);
      }
    });
    after.forEach((one, index) => {
      const at = now[index];
      if (became.includes(index) || at === undefined) return;
      this.tables.push({ key, at });
      this.done.push({ what: tableInWords(key, at, one), is: "is gone again", had: isAlike(one, later.at(-1)[at]) ? null : "had been changed since" });
    });
  }

  #back(key, one, { at, from }) {
    this.tables.push({ key, at, from });
    this.done.push({ what: tableInWords(key, this.document[key] === undefined ? null : at, one), is: "is back", had: null });
  }

  /** Values of a table at `path`. */
  #values(path, before, after, present) {
    const [was, became, is] = [before, after, present].map((table) => leaves(table));
    for (const place of new Set([...was.keys(), ...became.keys()])) {
      const [old, now, inner] = [was.get(place), is.get(place), JSON.parse(place)];
      if (old === became.get(place) || old === now) continue;
      const gone = this.#goneTable(path, inner, after, present);
      if (gone !== null) this.#refuse({ what: this.#words(gone), went: undefined });
      else this.#write([...path, ...inner], now, old, { before, depth: path.length, isSame: now === became.get(place) });
    }
  }

  /** The table that a value belonged to, if it is there no more and cannot come with one value. */
  #goneTable(path, inner, after, present) {
    const table = path[0] === "button" && inner.length > 1 ? inner.slice(0, 1) : path.length === 1 && !HELPS.has(path[0]) ? [] : null;
    return table !== null && typeof at(after, table) === "object" && at(present, table) === undefined ? [...path, ...table] : null;
  }

  #refuse(refused) {
    if (!this.refused.some(({ what }) => what === refused.what)) this.refused.push(refused);
  }

  #words(path) {
    return pathInWords(path, this.sketch);
  }

  /** A table that is left empty, and was not there before, goes too. */
  #write(path, now, value, { before, depth, isSame }) {
    const [what, had] = [this.#words(path), now === undefined ? "had been taken away since" : `had become ${valueInWords(path, now)} since`];
    this.done.push({ what, is: value === undefined ? "is gone again" : `is ${valueInWords(path, value)} again`, had: isSame ? null : had });
    this.#set(path, value);
    for (let end = path.length - 1; value === undefined && end >= depth; end -= 1) {
      const [table, older] = [at(this.document, path.slice(0, end)), at(before, path.slice(depth, end))];
      if (older === undefined && Object.keys(table).length === 0) this.#set(path.slice(0, end), undefined);
    }
  }

  /** A let-go force follows its press force down. */
  #keepLetGo() {
    for (const { table, key, value } of [...this.changes]) {
      for (const change of letGoBelow([...table, key], value, (beside) => at(this.document, [...table, beside]))) {
        const path = [...table, change.key];
        this.done.push({ what: this.#words(path), is: `is ${valueInWords(path, change.value)}`, had: null });
        this.#set(path, change.value);
      }
    }
  }

  #set(path, value) {
    const [table, key] = [path.slice(0, -1), path.at(-1)];
    this.changes.push({ table, key, value: value ?? null });
    let inner = this.document;
    for (const part of table) inner = inner[part] ??= {};
    if (value === undefined) delete inner[key];
    else inner[key] = value;
  }

  /** From the last place to the first, so that no number becomes another's; at one place what goes is first. */
  #moveTables(before) {
    this.tables.sort((one, other) => other.at - one.at || (other.from ?? Infinity) - (one.from ?? Infinity));
    for (const { key, at, from } of this.tables) {
      if (from !== undefined && !Array.isArray(before[key])) this.document[key] = before[key];
      else (this.document[key] ??= []).splice(at, from === undefined ? 1 : 0, ...(from === undefined ? [] : [before[key][from]]));
      if (this.document[key].length === 0) delete this.document[key];
    }
  }
}

const at = (document, path) => path.reduce((inner, part) => inner?.[part], document);

/** "button 2, pause" */
function tableInWords(key, index, one) {
  const name = one.name ?? [...leaves(one)].find(([place]) => place.endsWith('"label"]'))?.[1];
  return `${pathInWords(Number.isInteger(index) ? [key, index] : [key])}${name === undefined ? "" : `, ${name},`}`;
}

const read = (text, changes = []) => post("/api/draft", { text, changes });

/**
 * Undoes a save in a text.
 * @param {string[]} texts before the save, after it, after each later one, and the present one
 * @returns {Promise<{ text: string, done: Done[], refused: Refused[] } | null>} null where only the whole older text would do
 */
export async function undone(texts) {
  const all = await Promise.all(texts.map((text) => read(text)));
  const [documents, now] = [all.map(({ document }) => document), all.at(-1)];
  if (documents.includes(null)) return null;
  const [before, after, ...later] = documents;
  const { changes, tables, done, refused, document } = new Undoing(before, after, later, now.sketch);
  let { text } = await read(texts.at(-1), changes);
  for (const { key, at, from } of tables) text = from === undefined ? withoutTable(text, key, at) : withTableBack(text, key, at, texts[0], from);
  const came = await read(text);
  // Whoever wrote the text may have written it in a way that is not known here; and what came since may not go with what was before.
  return isAlike(came.document, document) && (came.ok || !now.ok || !all[0].ok) ? { text, done, refused } : null;
}
