// The channels: a bar, a number, and the health of each in words. A strain pad has nine, in microvolts; a described one those of its cells, in
// newtons on the pad.

import { el, number, say, table } from "../common/dom.js";

const NAMES = ["m0x", "m0y", "m0z", "m1x", "m1y", "m1z", "m2x", "m2y", "m2z"];
const PLACES = ["0°", "120°", "240°"];
const LEAST_UV = 50;
const NUMBERS_MS = 100;

function scaleFor(values, least) {
  const highest = Math.max(least, ...values.map(Math.abs));
  const decade = 10 ** Math.floor(Math.log10(highest));
  return [1, 2, 5, 10].map((step) => step * decade).find((scale) => scale >= highest);
}

export class Channels {
  #scale = 0;
  #least = LEAST_UV;
  #numbers_ms = 0;
  #per_uv = 1;
  #unit = "µV";

  constructor() {
    this.node = el("div");
    this.note = el("p", { class: "quiet small" });
    this.describe(null);
  }

  /** Shows the channels of this pad; null is a strain pad. */
  describe(pad) {
    const names = pad === null ? NAMES : pad.channels;
    this.#unit = pad === null ? "µV" : pad.n_per_uv === null ? "" : "N";
    this.#per_uv = pad === null ? 1 : pad.n_per_uv ?? 1e-3;
    this.#least = pad === null ? LEAST_UV : LEAST_UV * this.#per_uv;
    this.#scale = this.#least;
    const heads = pad === null ? ["Channel", "Place", "Signal", "µV", "Health"] : ["Channel", "Signal", this.#unit || "Value", "Health"];
    const { node, body } = table(pad === null ? "Strain channels" : "Channels of the pad", heads, { class: "channels" });
    this.node.replaceChildren(node);
    this.rows = names.map((name, index) => {
      const fill = el("div", { class: "meter-fill" });
      const value = el("td", { class: "figure" });
      const health = el("td");
      const first = pad === null && index % 3 === 0;
      const place = first ? el("td", { rowspan: 3, text: PLACES[index / 3] }) : null;
      body.append(el("tr", { class: first ? "first" : null }, el("th", { scope: "row", text: name }), place,
        el("td", { class: "bar-cell" }, el("div", { class: "bar" }, fill)), value, health));
      return { name, fill, value, health };
    });
  }

  /** Shows none. */
  clear() {
    this.#numbers_ms = 0;
    this.draw(null, null, null);
  }

  /** @param {number[] | null} values_uv @param {{ channel?: string } | null} warning @param {string | null} sentence */
  draw(values_uv, warning, sentence) {
    const values = values_uv === null ? null : values_uv.slice(0, this.rows.length).map((value_uv) => value_uv * this.#per_uv);
    if (values !== null) this.#scale = Math.max(this.#scale, scaleFor(values, this.#least));
    const now = performance.now();
    const numbers = now - this.#numbers_ms >= NUMBERS_MS;
    if (numbers) this.#numbers_ms = now;
    for (const [index, row] of this.rows.entries()) {
      const value = values === null ? null : values[index];
      const part = (value ?? 0) / this.#scale / 2;
      row.fill.style.transform = `translateX(${(0.5 + Math.min(part, 0)) * 100}%) scaleX(${Math.abs(part)})`;
      if (numbers) this.#words(row, value, warning?.channel === row.name ? sentence ?? warning.kind : null);
    }
    if (numbers) say(this.note, `Bars reach from −${number(this.#scale, 0)} to +${number(this.#scale, 0)} ${this.#unit}.`);
  }

  #words(row, value, fault) {
    say(row.value, number(value, 1));
    const words = fault ?? (value === null ? "no signal yet" : "ok");
    say(row.health, fault === null ? words : `⚠ ${words}`);
    row.health.className = fault === null ? (value === null ? "quiet" : "good") : "bad";
  }
}
