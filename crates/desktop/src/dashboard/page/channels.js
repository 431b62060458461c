// The nine strain channels: a bar, a number in microvolts, and the health of each in words.

import { el, number, say, table } from "./dom.js";

const NAMES = ["m0x", "m0y", "m0z", "m1x", "m1y", "m1z", "m2x", "m2y", "m2z"];
const PLACES = ["0°", "120°", "240°"];
const LEAST_UV = 50;
const NUMBERS_MS = 100;

function scaleFor(values) {
  const highest = Math.max(LEAST_UV, ...values.map(Math.abs));
  const decade = 10 ** Math.floor(Math.log10(highest));
  return [1, 2, 5, 10].map((step) => step * decade).find((scale) => scale >= highest);
}

export class Channels {
  #scale_uv = LEAST_UV;
  #numbers_ms = 0;

  constructor() {
    const { node, body } = table("Strain channels", ["Channel", "Place", "Signal", "µV", "Health"], { class: "channels" });
    this.node = node;
    this.rows = NAMES.map((name, index) => {
      const fill = el("div", { class: "meter-fill" });
      const value = el("td", { class: "figure" });
      const health = el("td");
      const place = index % 3 === 0 ? el("td", { rowspan: 3, text: PLACES[index / 3] }) : null;
      body.append(el("tr", { class: index % 3 === 0 ? "first" : null }, el("th", { scope: "row", text: name }), place,
        el("td", { class: "bar-cell" }, el("div", { class: "bar" }, fill)), value, health));
      return { name, fill, value, health };
    });
    this.note = el("p", { class: "quiet small" });
  }

  /** @param {number[] | null} values_uv @param {{ channel?: string } | null} warning @param {string | null} sentence */
  draw(values_uv, warning, sentence) {
    if (values_uv !== null) this.#scale_uv = Math.max(this.#scale_uv, scaleFor(values_uv));
    const now = performance.now();
    const numbers = now - this.#numbers_ms >= NUMBERS_MS;
    if (numbers) this.#numbers_ms = now;
    for (const [index, row] of this.rows.entries()) {
      const value = values_uv === null ? null : values_uv[index];
      const part = (value ?? 0) / this.#scale_uv / 2;
      row.fill.style.transform = `translateX(${(0.5 + Math.min(part, 0)) * 100}%) scaleX(${Math.abs(part)})`;
      if (numbers) this.#words(row, value, warning?.channel === row.name ? sentence ?? warning.kind : null);
    }
    if (numbers) say(this.note, `Bars reach from −${this.#scale_uv} to +${this.#scale_uv} µV.`);
  }

  #words(row, value, fault) {
    say(row.value, number(value, 1));
    const words = fault ?? (value === null ? "no signal yet" : "ok");
    say(row.health, fault === null ? words : `⚠ ${words}`);
    row.health.className = fault === null ? (value === null ? "quiet" : "good") : "bad";
  }
}
