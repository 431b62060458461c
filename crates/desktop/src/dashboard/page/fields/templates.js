// Adds and removes whole tables and bindings of a profile, in its text.

const BINDING = '{ gamepad = "BTN_SOUTH", keyboard = "KEY_SPACE" }';

/** What can be added; `many` tables may stand more than once. */
export const TABLES = {
  zone: { many: true, name: "a zone", text: '[[zone]]\nname = "NAME"\nfrom_deg = 45\nto_deg = 135\ninner_radius_mm = 10\n' },
  dpad: { many: false, name: "directions", text: "[dpad]\n" },
  pointer: { many: false, name: "the mouse pointer", text: "[pointer]\n" },
  stick: { many: true, name: "a stick", text: '[[stick]]\nstick = "left"\n' },
  trigger: { many: true, name: "a trigger", text: '[[trigger]]\ntrigger = "right"\n' },
  layer: { many: true, name: "a layer", text: '[[layer]]\nname = "NAME"\n' },
  macro: { many: true, name: "a macro", text: '[[macro]]\nname = "NAME"\nsteps = [\n  { gamepad = "BTN_SOUTH", keyboard = "KEY_SPACE" },\n]\n' },
  program: { many: true, name: "a program it is for", text: '[[program]]\nclass = "CLASS"\n' },
};

/** A name that no table of this kind has yet. */
function freshName(text, table) {
  for (let number = 1; ; number += 1) if (!text.includes(`"${table} ${number}"`)) return `${table} ${number}`;
}

/** The text with one more table at its end. */
export const withTable = (text, table) => withText(text, TABLES[table].text.replace("NAME", freshName(text, table)));

/** The text with more tables at its end. */
export const withText = (text, addition) => `${text.trimEnd()}\n\n${addition}`;

const HEADER = /^\s*\[\[?\s*([\w.]+)\s*\]/;

/**
 * The lines of a table, from its header to the next one's, tables within it included.
 * @returns {{ from: number, to: number } | null}
 */
function span(lines, table, index) {
  let from = -1;
  let seen = -1;
  for (let at = 0; at < lines.length; at += 1) {
    const name = HEADER.exec(lines[at])?.[1];
    if (name === undefined) continue;
    if (from >= 0 && !name.startsWith(`${table}.`)) return { from, to: at };
    if (name === table && (seen += 1) === index) from = at;
  }
  return from < 0 ? null : { from, to: lines.length };
}

const isComment = (line) => line !== undefined && /^\s*#/.test(line);
const isBlank = (line) => line !== undefined && line.trim() === "";

/** Without the comment that belongs to what follows. */
function trimmed(lines, { from, to }) {
  let end = to;
  while (end > from + 1 && (isComment(lines[end - 1]) || isBlank(lines[end - 1]))) end -= 1;
  return { from, to: end };
}

/** The lines of a table with the comment right above it; null if there is none. */
function withComment(lines, table, index) {
  const found = span(lines, table, index);
  if (found === null) return null;
  let { from, to } = trimmed(lines, found);
  while (from > 0 && isComment(lines[from - 1])) from -= 1;
  return { from, to };
}

/** The text without a table, and without the comment right above it. */
export function withoutTable(text, table, index = 0) {
  const lines = text.split("\n");
  const found = withComment(lines, table, index);
  if (found === null) return text;
  let { from, to } = found;
  while (isBlank(lines[to]) && (from === 0 || isBlank(lines[from - 1]))) to += 1;
  lines.splice(from, to - from);
  return lines.join("\n");
}

/** The text with a table of an older text, at this place among those of its name. */
export function withTableBack(text, table, at, older, index) {
  const [lines, olderLines] = [text.split("\n"), older.split("\n")];
  const found = withComment(olderLines, table, index);
  if (found === null) return text;
  const back = olderLines.slice(found.from, found.to);
  const [ahead, behind] = [withComment(lines, table, at - 1), withComment(lines, table, at)];
  if (ahead !== null) lines.splice(ahead.to, 0, "", ...back);
  else if (behind !== null) lines.splice(behind.from, 0, ...back, "");
  else return withText(text, `${back.join("\n")}\n`);
  return lines.join("\n");
}

/** The text with a line at the end of a table's own keys. */
export function withLine(text, table, index, line) {
  const lines = text.split("\n");
  const found = span(lines, table, index);
  if (found === null) return text;
  const inner = lines.findIndex((one, at) => at > found.from && at < found.to && HEADER.test(one));
  const { to } = trimmed(lines, { from: found.from, to: inner < 0 ? found.to : inner });
  lines.splice(to, 0, line);
  return lines.join("\n");
}

/** A button's text with one more effect, such as "hold"; "hard" needs its force. */
export function withEffect(text, index, effect, press_n) {
  const lines = [`${effect} = ${BINDING}`];
  if (effect === "hard") lines.push(`hard_press_n = ${Number((press_n * 2).toFixed(2))}`);
  return lines.reduce((result, line) => withLine(result, "button", index, line), text);
}
