// Undoes what one save changed, and leaves alone what came before and after it.

/** All values of a document by their places: `["button",0,"press_n"]`. @returns {Map<string, any>} */
function leaves(value, path = [], into = new Map()) {
  if (value !== null && typeof value === "object") for (const [key, inner] of Object.entries(value)) leaves(inner, [...path, Array.isArray(value) ? Number(key) : key], into);
  else into.set(JSON.stringify(path), value);
  return into;
}

/** How many tables each list has. */
const shape = (document) => JSON.stringify(Object.entries(document).filter(([, value]) => Array.isArray(value)).map(([key, value]) => [key, value.length]).sort());

/**
 * What to change in a document so that a save is undone; null where tables came or went since, so that numbers no longer name the same.
 * @param {object} before the save @param {object} after it @param {object} present
 * @returns {import("./draft.js").Change[] | null}
 */
export function undoing(before, after, present) {
  if (new Set([before, after, present].map(shape)).size > 1) return null;
  const [was, became, is] = [before, after, present].map((document) => leaves(document));
  const places = [...new Set([...was.keys(), ...became.keys()])];
  // What was changed once more since stays.
  const changes = places.filter((place) => was.get(place) !== became.get(place) && is.get(place) === became.get(place)).map((place) => {
    const path = JSON.parse(place);
    return was.has(place) ? changeOf(path, was.get(place)) : changeOf(path.slice(0, missing(before, path)), null);
  });
  return [...new Map(changes.map((change) => [JSON.stringify(change), change])).values()];
}

const changeOf = (path, value) => ({ table: path.slice(0, -1), key: path.at(-1), value });

/** How much of a path there is to name the first table, or key, that a document lacks. */
function missing(document, path) {
  let inner = document;
  return 1 + path.findIndex((part) => (inner = inner[part]) === undefined);
}
