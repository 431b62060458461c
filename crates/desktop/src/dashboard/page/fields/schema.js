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

  /** Whether a binding of a device may be this control. */
  canBind(device, control) {
    const known = this.json.$defs[{ pointer: "pointer_button" }[device] ?? device].anyOf?.[0].enum;
    return known === undefined || known.includes(control);
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

/** Rounds away what floating point adds. */
export const tidy = (value) => Number(value.toFixed(4));
