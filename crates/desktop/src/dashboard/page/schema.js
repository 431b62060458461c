// The language of profiles as its JSON Schema tells it: kinds of keys, ranges, defaults, explanations.

/** @typedef {(string | number)[]} Path of a table or a key, such as ["button", 0, "press_n"] */

const REFERENCES = { gamepad: "gamepad", keyboard: "keyboard", pointer_button: "pointer", effect: "effect" };

/** The path of a name such as "button.0.press_n". @returns {Path} */
export const pathOf = (name) => name.split(".").map((part) => (/^\d+$/.test(part) ? Number(part) : part));

/** The name of a path. */
export const nameOf = (path) => path.join(".");

export class Schema {
  constructor(json) {
    this.json = json;
  }

  #resolve(node) {
    if (node?.$ref === undefined) return node;
    const name = node.$ref.split("/").at(-1);
    const target = this.json.$defs[name];
    return { ...target, ...node, properties: { ...target.properties, ...node.properties }, reference: name };
  }

  /** What stands at a path, with its reference resolved. @param {Path} path */
  at(path) {
    let node = this.json;
    for (const part of path) node = this.#resolve(typeof part === "number" ? node?.items : node?.properties?.[part]);
    return node;
  }

  /** Whether there is such a key. @param {Path} path */
  has(path) {
    return this.at(path) !== undefined;
  }

  /** The keys of a table with what the schema says of each. @param {Path} path */
  keys(path) {
    const table = this.at(path);
    const required = new Set(table?.required ?? []);
    return Object.keys(table?.properties ?? {})
      .filter((key) => table.properties[key] !== false)
      .map((key) => ({ key, required: required.has(key), ...this.describe([...path, key]) }));
  }

  /**
   * What a field needs to know of a key.
   * @param {Path} path
   */
  describe(path) {
    const node = this.at(path);
    const named = node.enum ?? node.anyOf?.find((choice) => choice.enum)?.enum ?? null;
    return {
      kind: kindOf(node),
      options: named,
      min: node.minimum,
      max: node.maximum,
      default: node.default,
      help: node.description ?? "",
    };
  }
}

function kindOf(node) {
  if (node.reference in REFERENCES) return REFERENCES[node.reference];
  if (node.const !== undefined) return "fixed";
  if (node.enum) return "choice";
  if (node.type === "array") return "list";
  if (node.type === "object" || node.properties && Object.keys(node.properties).length > 0) return "table";
  return node.type ?? "string";
}

const UNITS = { _mm: "mm", _n: "N", _deg: "°", _ms: "ms", _hz: "Hz", _samples: "samples", _per_s: "per s" };

/** The unit that a key's name ends with. */
export function unitOf(key) {
  const end = Object.keys(UNITS).find((suffix) => key.endsWith(suffix));
  return end === undefined ? "" : UNITS[end];
}

const STEPS = { mm: 0.5, N: 0.05, "°": 1, ms: 10, Hz: 0.1 };

/** By how much one step of a key changes it. */
export function stepOf(key, kind) {
  const unit = unitOf(key);
  if (kind === "integer") return unit === "ms" ? 10 : 1;
  return STEPS[unit] ?? 0.05;
}

/** Rounds away what floating point adds. */
export const tidy = (value) => Number(value.toFixed(4));
