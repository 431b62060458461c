// Draws series of saves, undoes one of each, and compares with the series without that save; where a later save touched the same, with
// the end of the series and what was before. Gives the series that differ.
const [{ undone }, { withText, withoutTable }, { post }] = await Promise.all(["profile/undo_save.js", "fields/templates.js", "link/api.js"].map((file) => import(`/page/${file}`)));

const BEGIN = `schema = 1
name = "Series"
output = "gamepad"
min_press_ms = 40 # for games that look once per frame

[dpad]
mode = "4way"
rotation_deg = 0.0 # turn this if the pad lies askew

# The first button.
${button(1)}
# Another one.
${button(2)}
${button(3)}`;
const SAVES = 9;

function button(id) {
  return `[[button]]\nforce = "fz"\npress_n = 2.0\nrelease_n = ${(1 + id / 100).toFixed(2)}\nout = { gamepad = "BTN_SOUTH", keyboard = "KEY_SPACE", label = "b${id}" }\n`;
}

function randomFrom(seed) {
  let state = seed;
  return (below) => {
    state = (Math.imul(state, 1664525) + 1013904223) >>> 0;
    return Math.floor((state / 2 ** 32) * below);
  };
}

const changed = async (text, table, key, value) => (await post("/api/draft", { text, changes: [{ table, key, value }] })).text;

/** A save: what it touches, what it makes of a text and the buttons in it, and `back`, which makes of a document what was before. */
function drawn(random, { ids, zones }, fresh) {
  const id = ids[random(ids.length)];
  const number = (from) => from + random(900) / 100;
  const value = (touches, table, key, to) => ({
    touches,
    of: async (state) => ({ ...state, text: await changed(state.text, table(state), key, to) }),
    back: (document, state, before, older) => {
      // A button that is gone cannot have its value back.
      if (table(state).includes(-1)) return false;
      put(document, [...table(state), key], at(before, [...table(older), key]));
      return true;
    },
  });
  const tables = (name, index) => ({ back: (document, state) => (index(state) < 0 ? false : document[name].splice(index(state), 1).length > 0) });
  const ofButton = (...inner) => (state) => ["button", state.ids.indexOf(id), ...inner];
  const kinds = [
    () => value(`b${id}.press_n`, ofButton(), "press_n", number(10)),
    () => value(`b${id}.dwell_ms`, ofButton(), "dwell_ms", random(2) === 0 ? 100 + random(900) : null),
    () => value(`b${id}.label`, ofButton("out"), "label", `named ${fresh}`),
    () => value(`b${id}.hold`, ofButton("hold"), "gamepad", `BTN_${fresh}`),
    () => value("dpad.rotation_deg", () => ["dpad"], "rotation_deg", number(1)),
    () => value("access.rest_n", () => ["access"], "rest_n", number(1)),
    () => value("access.slow_ms", () => ["access"], "slow_ms", 100 + random(900)),
    () => ({ touches: `b${fresh}`, ...tables("button", (state) => state.ids.indexOf(fresh)), of: async (state) => ({ ...state, text: withText(state.text, button(fresh)), ids: [...state.ids, fresh] }) }),
    () => ({ touches: `b${id}`, of: async (state) => ({ ...state, text: withoutTable(state.text, "button", state.ids.indexOf(id)), ids: state.ids.filter((one) => one !== id) }) }),
    () => ({ touches: `z${fresh}`, ...tables("zone", (state) => state.zones.indexOf(fresh)), of: async (state) => ({ ...state, text: withText(state.text, `[[zone]]\nname = "z${fresh}"\nfrom_deg = ${fresh}\n`), zones: [...state.zones, fresh] }) }),
    () => ({ touches: `z${zones[0]}`, of: async (state) => ({ ...state, text: withoutTable(state.text, "zone", state.zones.indexOf(zones[0])), zones: state.zones.filter((one) => one !== zones[0]) }) }),
  ];
  const can = kinds.slice(ids.length === 0 ? 4 : 0, zones.length === 0 ? -1 : undefined).filter((kind) => ids.length > 1 || kind !== kinds[8]);
  return can[random(can.length)]();
}

const sorted = (value) => (value === null || typeof value !== "object" ? value : Array.isArray(value) ? value.map(sorted) : Object.fromEntries(Object.keys(value).sort().map((key) => [key, sorted(value[key])])));
const documentOf = async (text) => (await post("/api/draft", { text, changes: [] })).document;
const same = (one, other) => JSON.stringify(sorted(one)) === JSON.stringify(sorted(other));
const at = (document, path) => path.reduce((inner, part) => inner?.[part], document);

/** Sets a value; without one the key goes, and the tables that are empty then, up to the document or a list's table. */
function put(document, path, value) {
  const [table, key] = [path.slice(0, -1), path.at(-1)];
  if (value !== undefined) return Object.assign(at(document, table), { [key]: value });
  delete at(document, table)?.[key];
  if (table.length > 0 && Object.keys(at(document, table) ?? {}).length === 0) put(document, table, undefined);
}
const meet = (one, other) => one === other || one.startsWith(`${other}.`) || other.startsWith(`${one}.`);

async function series(seed) {
  const random = randomFrom(seed);
  let state = { text: BEGIN, ids: [1, 2, 3], zones: [] };
  const [saves, texts, states] = [[], [BEGIN], [state]];
  for (let number = 0; number < SAVES; number += 1) {
    let [save, next] = [null, state];
    // A save that changes nothing is none.
    while (next.text === state.text) {
      save = drawn(random, state, 10 + number);
      next = await save.of(state);
    }
    state = next;
    saves.push(save);
    texts.push(state.text);
    states.push(state);
  }
  const taken = random(SAVES);
  const commutes = saves.slice(taken + 1).every(({ touches }) => !meet(touches, saves[taken].touches));
  const undo = await undone([...texts.slice(taken), state.text]);
  const expected = await (commutes ? withoutSave(saves, taken) : withBefore(saves[taken], await documentOf(state.text), state, await documentOf(texts[taken]), states[taken]));
  const isRight = undo !== null && same(await documentOf(undo.text), expected.document) && undo.done.length > 0 === expected.isUndone && (!commutes || undo.refused.length === 0);
  return { isRight, commutes, isUndone: expected.isUndone, told: `series ${seed}: ${saves.map(({ touches }) => touches).join(" ")}, without ${taken}: ${JSON.stringify(undo)} for ${JSON.stringify(expected.document)}` };
}

/** The series as if a save had never been. */
async function withoutSave(saves, taken) {
  let without = { text: BEGIN, ids: [1, 2, 3], zones: [] };
  for (const save of saves.toSpliced(taken, 1)) without = await save.of(without);
  return { document: await documentOf(without.text), isUndone: true };
}

/** The end of the series with what was there before a save. */
function withBefore(save, document, state, before, older) {
  const was = JSON.stringify(document);
  const isThere = save.back(document, state, before, older);
  return { document, isUndone: isThere && JSON.stringify(document) !== was };
}

const all = [];
for (let seed = FIRST; seed < END; seed += 1) all.push(await series(seed));
return { commuting: all.filter(({ commutes }) => commutes).length, again: all.filter(({ commutes, isUndone }) => !commutes && isUndone).length, wrong: all.filter(({ isRight }) => !isRight).map(({ told }) => told) };
