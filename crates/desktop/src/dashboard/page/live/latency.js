// How long each stage takes: a histogram with logarithmic bins for each, and a table of percentiles.

import { colour } from "../common/colours.js";
import { el, number, row, scroller, table } from "../common/dom.js";

const STAGES = { read: "read", decode: "decode", map: "map", write: "write", end_to_end: "end to end" };
const FROM_US = 0.5;
const TO_US = 100_000;
const HEIGHT_PX = 46;
const POLICIES = { filter: "filter of contacts", hold: "until a long, double or hard press is told", slow: "Slow Keys, dwell", tremor: "calming of tremor" };

const part = (us) => Math.log(Math.max(us, FROM_US) / FROM_US) / Math.log(TO_US / FROM_US);

/** Microseconds as people read them: 900 µs, 1.2 ms. */
export function duration(us) {
  if (us === null || us === undefined) return "–";
  return us < 1000 ? `${number(us, us < 10 ? 1 : 0)} µs` : `${number(us / 1000, us < 10_000 ? 2 : 1)} ms`;
}

export class Latency {
  constructor() {
    const { node, body } = table("Time of each stage", ["Stage", "p50", "p95", "p99", "max"], { class: "figures" });
    this.body = body;
    this.canvases = new Map(Object.entries(STAGES).map(([stage, name]) => [stage, el("canvas", { class: "histogram", role: "img", "aria-label": `Histogram of ${name}; the table has its figures.` })]));
    const charts = [...this.canvases].map(([stage, canvas]) => el("div", { class: "histogram-row" }, el("span", { text: STAGES[stage] }), canvas));
    this.policies = table("Delays that the profile asks for", ["Rule", "Time"], { class: "figures" });
    this.node = el("div", { class: "latency" }, el("div", { class: "histograms" }, ...charts, el("p", { class: "quiet small", text: "Logarithmic, from 1 µs to 100 ms; lines at 1, 10, 100 µs, 1 and 10 ms." })),
      scroller("Time of each stage", node), scroller("Delays that the profile asks for", this.policies.node));
  }

  draw({ stages_us, histogram_us, policy_ms }) {
    for (const [stage, canvas] of this.canvases) this.#histogram(canvas, histogram_us?.[stage] ?? []);
    this.body.replaceChildren(...Object.entries(STAGES)
      .filter(([stage]) => stages_us?.[stage])
      .map(([stage, name]) => row([name, ...["p50", "p95", "p99", "max"].map((of) => duration(stages_us[stage][of]))])));
    this.policies.body.replaceChildren(...Object.entries(policy_ms ?? {})
      .map(([rule, ms]) => row([POLICIES[rule] ?? rule, ms ? `${number(ms, ms < 10 ? 1 : 0)} ms` : "off"])));
  }

  #histogram(canvas, bins) {
    const ratio = devicePixelRatio;
    const width = canvas.clientWidth;
    if (width === 0) return;
    const [w, h] = [Math.round(width * ratio), Math.round(HEIGHT_PX * ratio)];
    if (canvas.width !== w || canvas.height !== h) Object.assign(canvas, { width: w, height: h });
    const context = canvas.getContext("2d");
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.clearRect(0, 0, width, HEIGHT_PX);
    context.fillStyle = colour("--line");
    for (const us of [1, 10, 100, 1000, 10_000]) context.fillRect(Math.round(part(us) * width), 0, 1, HEIGHT_PX);
    const highest = Math.max(1, ...bins.map(([, count]) => count));
    context.fillStyle = colour("--accent");
    let from = 0;
    for (const [upper_us, count] of bins) {
      const to = Math.min(part(upper_us), 1);
      const left = Math.max(from, to - 0.06) * width;
      // The root keeps single slow samples in sight beside thousands of fast ones.
      const high = count === 0 ? 0 : Math.max(1.5, Math.sqrt(count / highest) * (HEIGHT_PX - 2));
      context.fillRect(left, HEIGHT_PX - high, Math.max(to * width - left - 1, 1.5), high);
      from = to;
    }
  }
}
