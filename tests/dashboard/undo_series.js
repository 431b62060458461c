// Draws series of saves, undoes one of each, and compares with the series without that save. Gives the series that differ.
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

/** A save: what it touches, and what it makes of a text and the buttons in it. */
function drawn(random, { ids, zones }, fresh) {
  const id = ids[random(ids.length)];
  const number = (from) => from + random(900) / 100;
  const value = (touches, table, key, to) => ({ touches, of: async (state) => ({ ...state, text: await changed(state.text, table(state), key, to) }) });
  const ofButton = (...inner) => (state) => ["button", state.ids.indexOf(id), ...inner];
  const kinds = [
    () => value(`b${id}.press_n`, ofButton(), "press_n", number(10)),
    () => value(`b${id}.dwell_ms`, ofButton(), "dwell_ms", random(2) === 0 ? 100 + random(900) : null),
    () => value(`b${id}.label`, ofButton("out"), "label", `named ${fresh}`),
    () => value(`b${id}.hold`, ofButton("hold"), "gamepad", `BTN_${fresh}`),
    () => value("dpad.rotation_deg", () => ["dpad"], "rotation_deg", number(1)),
    () => value("access.rest_n", () => ["access"], "rest_n", number(1)),
    () => value("access.slow_ms", () => ["access"], "slow_ms", 100 + random(900)),
    () => ({ touches: `b${fresh}`, of: async (state) => ({ ...state, text: withText(state.text, button(fresh)), ids: [...state.ids, fresh] }) }),
    () => ({ touches: `b${id}`, of: async (state) => ({ ...state, text: withoutTable(state.text, "button", state.ids.indexOf(id)), ids: state.ids.filter((one) => one !== id) }) }),
    () => ({ touches: `z${fresh}`, of: async (state) => ({ ...state, text: withText(state.text, `[[zone]]\nname = "z${fresh}"\nfrom_deg = ${fresh}\n`), zones: [...state.zones, fresh] }) }),
    () => ({ touches: `z${zones[0]}`, of: async (state) => ({ ...state, text: withoutTable(state.text, "zone", state.zones.indexOf(zones[0])), zones: state.zones.filter((one) => one !== zones[0]) }) }),
  ];
  const can = kinds.slice(ids.length === 0 ? 4 : 0, zones.length === 0 ? -1 : undefined).filter((kind) => ids.length > 1 || kind !== kinds[8]);
  return can[random(can.length)]();
}

const sorted = (value) => (value === null || typeof value !== "object" ? value : Array.isArray(value) ? value.map(sorted) : Object.fromEntries(Object.keys(value).sort().map((key) => [key, sorted(value[key])])));
const documentOf = async (text) => JSON.stringify(sorted((await post("/api/draft", { text, changes: [] })).document));
const meet = (one, other) => one === other || one.startsWith(`${other}.`) || other.startsWith(`${one}.`);

async function series(seed) {
  const random = randomFrom(seed);
  let state = { text: BEGIN, ids: [1, 2, 3], zones: [] };
  const [saves, texts] = [[], [BEGIN]];
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
  }
  const taken = random(SAVES);
  const commutes = saves.slice(taken + 1).every(({ touches }) => !meet(touches, saves[taken].touches));
  let without = { text: BEGIN, ids: [1, 2, 3], zones: [] };
  for (const save of commutes ? saves.toSpliced(taken, 1) : saves) without = await save.of(without);
  const undo = await undone([...texts.slice(taken), state.text]);
  const isRight = undo !== null && await documentOf(undo.text) === await documentOf(without.text) && (!commutes || undo.stays.length === 0) && undo.done.length > 0 === commutes;
  return { isRight, commutes, told: `series ${seed}: ${saves.map(({ touches }) => touches).join(" ")}, without ${taken}: ${JSON.stringify(undo)} for ${without.text}` };
}

const all = [];
for (let seed = FIRST; seed < END; seed += 1) all.push(await series(seed));
return { commuting: all.filter(({ commutes }) => commutes).length, wrong: all.filter(({ isRight }) => !isRight).map(({ told }) => told) };
