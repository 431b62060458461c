// Meters of the three forces: a bar that follows the finger, and a row for everything that has thresholds on it.

import { el, number, say } from "../common/dom.js";

const FORCES = [
  { axis: "fz", name: "Press", meaning: "into the plate, Fz", sides: 1, least_n: 4 },
  { axis: "fx", name: "Push right", meaning: "− is left, Fx", sides: 2, least_n: 2 },
  { axis: "fy", name: "Push up", meaning: "− is down, Fy", sides: 2, least_n: 2 },
];

/** The shapes of thresholds; a name stands beside each, so that none is told by its look alone. */
export const MARKS = {
  press: { sign: "▲", name: "press" },
  release: { sign: "△", name: "let go" },
  hard_press: { sign: "◆", name: "hard" },
  hard_release: { sign: "◇", name: "let go of hard" },
  from: { sign: "△", name: "from" },
  full: { sign: "▲", name: "full" },
};

/**
 * What a sketch has on the forces, each with its thresholds.
 * @returns {{ name: string, force: string, path: string[], marks: { kind: string, key: string, force_n: number }[] }[]}
 */
export function thresholdRows(sketch) {
  const rows = [];
  const pair = (name, path, press_key, press_n, release_key, release_n) => rows.push({
    name, force: "fz", path,
    marks: [{ kind: "press", key: press_key, force_n: press_n }, { kind: "release", key: release_key, force_n: release_n }]
      .filter(({ force_n }) => force_n !== undefined),
  });
  if (sketch.dpad) pair("directions", ["dpad"], "min_force_n", sketch.dpad.min_force_n, "release_force_n", sketch.dpad.release_force_n);
  if (sketch.pointer) pair("pointer", ["pointer"], "min_force_n", sketch.pointer.min_force_n, "release_force_n", undefined);
  for (const [index, { word, from_n, full_n }] of sketch.triggers.entries()) {
    rows.push({ name: word, force: "fz", path: ["trigger", index], marks: [
      { kind: "from", key: "from_n", force_n: from_n }, { kind: "full", key: "full_n", force_n: full_n }] });
  }
  for (const button of sketch.buttons) rows.push(buttonRow(button));
  return rows;
}

function buttonRow(button) {
  const marks = ["press", "release", "hard_press", "hard_release"]
    .map((kind) => ({ kind, key: `${kind}_n`, force_n: button[`${kind}_n`] }))
    .filter(({ force_n }) => force_n !== null);
  const does = button.does.map(({ role, role_word, word }) => (role === "out" ? word : `${role_word} ${word}`)).join(", ");
  const where = button.zone === null ? "" : ` in ${button.zone}`;
  return { name: `button ${button.number}${where}: ${does}`, force: button.force, path: ["button", button.number - 1], marks };
}

function roundUp(force_n) {
  const steps = [1, 1.5, 2, 3, 4, 5, 6, 8, 10, 15, 20, 30, 40, 50, 60, 80];
  return steps.find((step) => step >= force_n) ?? 80;
}

/** One meter. Rows are added by `setRows`; the same meter carries marks or handles. */
class Meter {
  constructor({ axis, name, meaning, sides, least_n }) {
    Object.assign(this, { axis, sides, least_n, max_n: least_n });
    this.value = el("span", { class: "meter-value" });
    this.meaning = el("span", { class: "quiet" });
    this.words = meaning;
    this.fill = el("div", { class: "meter-fill" });
    this.cursor = el("div", { class: "meter-cursor" });
    this.scale = el("div", { class: "meter-scale" });
    this.rows = el("div", { class: "meter-rows" });
    this.describe(true);
    this.node = el("div", { class: `meter ${sides === 2 ? "two-sided" : ""}` },
      el("div", { class: "meter-head" }, el("strong", { text: name }), this.meaning, this.value),
      el("div", { class: "meter-body" }, el("div", { class: "meter-track" }, this.fill), this.rows, this.scale, el("div", { class: "meter-cursor-lane" }, this.cursor)));
    this.setForce(null);
  }

  /** Says whether the pad measures this force. */
  describe(is_measured) {
    say(this.meaning, is_measured ? this.words : "not measured by this pad");
  }

  /** The place of a force on the track, 0 to 1. */
  part(force_n) {
    const part = Math.min(Math.max(force_n / this.max_n, -1), 1);
    return this.sides === 2 ? 0.5 + part / 2 : Math.max(part, 0);
  }

  /** The force at a place of the track. */
  forceAt(part) {
    return this.sides === 2 ? (part - 0.5) * 2 * this.max_n : part * this.max_n;
  }

  setScale(rows) {
    const highest_n = Math.max(0, ...rows.flatMap((row) => row.marks.map((mark) => mark.force_n)));
    const max_n = Math.max(this.least_n, roundUp(highest_n * 1.25));
    if (max_n === this.max_n && this.scale.hasChildNodes()) return;
    this.max_n = max_n;
    const ends = this.sides === 2 ? [-1, -0.5, 0, 0.5, 1] : [0, 0.25, 0.5, 0.75, 1];
    this.scale.replaceChildren(...ends.map((end) => {
      const tick = el("span", { text: `${number(end * this.max_n, this.max_n < 4 && end % 0.5 !== 0 ? 2 : 1)}${end === 1 ? " N" : ""}` });
      tick.style.left = `${this.part(end * this.max_n) * 100}%`;
      return tick;
    }));
  }

  placeSpans(rows) {
    rows.forEach((row, index) => {
      const parts = row.marks.map((mark) => this.part(signed(row, mark.force_n)));
      const { style } = this.spans[index];
      style.left = `${Math.min(...parts) * 100}%`;
      style.width = `${(Math.max(...parts) - Math.min(...parts)) * 100}%`;
      say(this.figures[index], row.marks.map(({ kind, force_n }) => `${MARKS[kind].sign} ${MARKS[kind].name} ${number(force_n, 2)} N`).join("  "));
    });
  }

  setForce(force_n) {
    say(this.value, force_n === null ? "–" : `${number(force_n, 2)} N`);
    const from = this.part(0);
    const to = this.part(force_n ?? 0);
    this.fill.style.transform = `translateX(${Math.min(from, to) * 100}%) scaleX(${Math.abs(to - from)})`;
    this.cursor.style.transform = `translateX(${to * 100}%)`;
    this.cursor.hidden = force_n === null;
  }
}

const ownRows = (meter, rows) => rows.filter((row) => row.force.replace("-", "") === meter.axis);

/** A threshold of `row` as a force with its sign, and back. */
export function signed(row, force_n) {
  return row.force.startsWith("-") ? -force_n : force_n;
}

export class Forces {
  /** @param {(meter: Meter, row: object, mark: object) => HTMLElement} makeMark */
  constructor(makeMark = plainMark) {
    this.makeMark = makeMark;
    this.has_shear = true;
    this.meters = FORCES.map((force) => new Meter(force));
    this.node = el("div", { class: "meters" }, ...this.meters.map((meter) => meter.node),
      el("p", { class: "quiet small", text: "N is newton: 100 g that lie on the pad press with about 1 N." }));
  }

  /** Leaves out the forces that the pad does not measure, unless the profile asks for them. */
  describe(has_shear) {
    this.has_shear = has_shear;
    for (const meter of this.meters) {
      const is_measured = has_shear || meter.axis === "fz";
      meter.describe(is_measured);
      meter.node.hidden = !is_measured && !meter.rows.hasChildNodes();
    }
  }

  /** Shows the thresholds of a sketch. */
  setSketch(sketch) {
    const rows = sketch === null ? [] : thresholdRows(sketch);
    for (const meter of this.meters) {
      const own = ownRows(meter, rows);
      meter.setScale(own);
      meter.spans = own.map(() => el("div", { class: "meter-span" }));
      meter.figures = own.map(() => el("span", { class: "meter-figures" }));
      meter.rows.replaceChildren(...own.map((row, index) => el("div", { class: "meter-row" },
        el("p", { class: "meter-row-head" }, el("span", { text: row.name }), meter.figures[index]),
        el("div", { class: "meter-line" }, meter.spans[index], ...row.marks.map((mark) => this.makeMark(meter, row, mark))))));
      meter.placeSpans(own);
      meter.node.classList.toggle("bare", own.length === 0);
    }
    this.describe(this.has_shear);
  }

  /** Fits scales and spans to a sketch that has the same thresholds at other forces. */
  rescale(sketch) {
    const rows = thresholdRows(sketch);
    for (const meter of this.meters) {
      const own = ownRows(meter, rows);
      meter.setScale(own);
      meter.placeSpans(own);
    }
  }

  /** Follows the finger; null means that there is none. */
  draw(contact) {
    for (const meter of this.meters) {
      const is_measured = this.has_shear || meter.axis === "fz";
      meter.setForce(contact === null || !is_measured ? null : contact[`${meter.axis}_n`]);
    }
  }
}

function plainMark(meter, row, { kind, force_n }) {
  const { sign, name } = MARKS[kind];
  const mark = el("span", { class: `mark ${kind}`, "aria-hidden": "true", title: `${row.name}: ${name} ${number(force_n, 2)} N`, text: sign });
  mark.style.left = `${meter.part(signed(row, force_n)) * 100}%`;
  return mark;
}
