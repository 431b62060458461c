// The view "Live": state, plate, held controls and forces for who plays; below a fold what is measured.

import { announcePress } from "../common/announce.js";
import { Channels } from "./channels.js";
import { el, number, say, scroller, table } from "../common/dom.js";
import { EventLanes } from "./events.js";
import { LastTouch } from "./last_touch.js";
import { Latency } from "./latency.js";
import { Forces } from "../picture/meter.js";
import { Finger, Plate } from "../picture/plate.js";
import { rememberFold } from "../common/settings.js";
import { beyondGames, stateInWords, Status } from "./status.js";

const FIGURES_MS = 100;
// A pad that cannot tell how sure a force is has this deviation: as much as the whole scale.
const UNKNOWN_N = 5;
const QUANTITIES = [["to the right, x", "x_mm", "mm", 1], ["upwards, y", "y_mm", "mm", 1], ["push right, Fx", "fx_n", "N", 2], ["push up, Fy", "fy_n", "N", 2], ["press, Fz", "fz_n", "N", 2]];

/** Place and force as numbers, each with its standard deviation. */
class Readout {
  #last_ms = 0;

  constructor() {
    const { node, body } = table("Finger", ["Quantity", "Value", "±"], { class: "figures" });
    this.node = node;
    this.rows = QUANTITIES.map(([name, key, unit, digits]) => {
      const value = el("td");
      const sigma = el("td");
      const line = el("tr", {}, el("th", { scope: "row", text: name }), value, sigma);
      body.append(line);
      return { key, unit, digits, value, sigma, line };
    });
  }

  /** Leaves out what the pad does not measure. */
  describe(has_shear) {
    for (const { key, line } of this.rows) line.hidden = !has_shear && (key === "fx_n" || key === "fy_n");
  }

  clear() {
    this.#last_ms = 0;
    this.draw(null, null);
  }

  draw(contact, uncertainty) {
    const now = performance.now();
    if (now - this.#last_ms < FIGURES_MS) return;
    this.#last_ms = now;
    for (const { key, unit, digits, value, sigma } of this.rows) {
      say(value, contact === null ? "–" : `${number(contact[key], digits)} ${unit}`);
      const is_told = contact !== null && uncertainty && !(unit === "N" && uncertainty[key] >= UNKNOWN_N);
      say(sigma, is_told ? number(uncertainty[key], digits) : "–");
    }
  }
}

function card(title, ...children) {
  return el("div", { class: "card" }, el("h3", { text: title }), ...children);
}

export class LiveView {
  /** @param {import("../picture/trace.js").Trace} trace */
  constructor(section, trace) {
    this.trace = trace;
    this.plate = new Plate("Plate of the pad with the profile in play and the finger");
    this.finger = new Finger(this.plate, "contact");
    this.forces = new Forces();
    this.readout = new Readout();
    this.held = el("ul", { class: "chips", "aria-label": "Held controls" });
    this.lastTouch = new LastTouch();
    this.touched = el("p", { class: "quiet small", id: "last-touch" });
    this.title = el("span", { class: "quiet" });
    this.freshness = el("p", { class: "quiet freshness", id: "freshness" });
    this.status = new Status();
    this.channels = new Channels();
    this.channelsCard = card("Channels", scroller("Channels", this.channels.node), this.channels.note);
    this.scale = el("p", { class: "quiet small", id: "scale", hidden: true });
    this.lanes = new EventLanes();
    this.latency = new Latency();
    const column = (...cards) => el("div", { class: "live-column" }, ...cards);
    this.fold = el("details", { class: "measurements", id: "measurements" },
      el("summary", { class: "main" }, el("strong", { text: "Measurements" }), " ", el("span", { class: "quiet", text: "numbers, events, channels, latency, counters" })),
      el("div", { class: "live-grid" },
        column(card("Pad", this.status.setup, scroller("Finger", this.readout.node), this.scale, this.freshness), this.channelsCard),
        column(card("Events", this.lanes.node), card("Counters", this.status.counters)),
        column(card("Latency", this.latency.node))));
    this.#drawHeld({ held: [], held_names: [] });
    rememberFold(this.fold, "measurements");
    this.fold.addEventListener("toggle", () => this.#drawMeasured());
    section.append(this.status.node, el("div", { class: "live-grid" },
      column(card("Plate", this.title, this.plate.node)),
      column(card("Held now", this.held, this.touched, el("p", {}, el("a", { class: "action", href: "#doctor", text: "Nothing happens? See why" }))), card("Forces", this.forces.node))), this.fold);
  }

  setSketch({ profile, sketch }) {
    this.sketch = sketch;
    say(this.title, `${profile}, for a ${sketch.output}`);
    this.plate.setSketch(sketch);
    this.forces.setSketch(sketch);
  }

  /** Takes a frame, drawn or not. */
  take(frame) {
    this.frame = frame;
    this.lanes.take(frame);
    this.lastTouch.take(frame);
    for (const press of frame.presses) announcePress(press);
  }

  /** Takes a status. */
  setStatus(message) {
    if (this.message?.status.described?.title !== message.status.described?.title) this.#describe(message.status.described);
    this.message = message;
    this.status.draw(message);
  }

  /** Fits the view to a described pad; null is a strain pad. */
  #describe(pad) {
    const has_shear = pad?.has_shear ?? true;
    this.readout.describe(has_shear);
    this.forces.describe(has_shear);
    this.channels.describe(pad);
    this.channelsCard.hidden = pad?.channels.length === 0;
    this.scale.hidden = pad === null;
    say(this.scale, pad === null ? "" : `${pad.title}: ${pad.scale_sentence}.`);
  }

  /** Draws the last frame. */
  draw() {
    if (this.frame === undefined) return;
    const { contact, uncertainty } = this.frame;
    this.finger.draw(contact, uncertainty, this.trace);
    this.forces.draw(contact);
    this.#drawHeld(this.frame);
    this.#drawMeasured();
  }

  /** What nobody sees costs nothing. */
  #drawMeasured() {
    if (!this.fold.open || this.frame === undefined) return;
    const { contact, uncertainty, channels_uv } = this.frame;
    this.readout.draw(contact, uncertainty);
    this.lanes.draw();
    this.channels.draw(channels_uv, this.message?.status.warning ?? null, this.message?.status.warning_sentence ?? null);
  }

  /** Draws what changes four times a second. */
  drawSlow(ages) {
    say(this.touched, this.message?.status.state === "paused" ? "" : this.lastTouch.sentence(this.sketch ?? null));
    if (!this.fold.open) return;
    if (this.message !== undefined) this.latency.draw(this.message);
    const age_ms = ages.p95();
    const missed = this.frame?.missed ? `, ${this.frame.missed} missed` : "";
    say(this.freshness, `${ages.perSecond()} updates per second; picture ${age_ms === null ? "–" : number(age_ms, 1)} ms old (p95)${missed}`);
  }

  /** Shows nothing: there is no bridge. */
  clear() {
    this.frame = undefined;
    this.message = undefined;
    this.lastTouch.clear();
    for (const node of [this.title, this.touched]) say(node, "");
    this.plate.setSketch(null);
    this.forces.setSketch(null);
    this.finger.draw(null, null, this.trace);
    this.forces.draw(null);
    this.readout.clear();
    this.#drawHeld({ held: [], held_names: [] });
    this.lanes.clear();
    this.channels.clear();
    this.latency.draw({});
    say(this.freshness, "no updates");
    this.status.clear();
  }

  /** What there is to say right now to who wonders why nothing happens. */
  sentences() {
    const { state, sentence, output } = this.message?.status ?? {};
    if (state === undefined) return ["tactpad does not answer."];
    const beyond = beyondGames(output);
    const plays = state === "playing" ? `tactpad plays${beyond === null ? ": what is pressed goes on" : "; no game gets it"}.` : stateInWords({ state, sentence });
    const help = state === "waiting" ? ["If it is plugged in, try another cable and another socket of this machine."] : [];
    return [plays, ...help, this.lastTouch.sentence(this.sketch ?? null), `What is pressed goes ${beyond ?? `to: ${output}`}.`];
  }

  #drawHeld({ held, held_names }) {
    const text = held_names.join(" ");
    if (text === this.heldText) return;
    this.heldText = text;
    const chips = held_names.map((name, index) => el("li", {}, name, el("code", { class: "code-name", text: held[index] })));
    this.held.replaceChildren(...(chips.length === 0 ? [el("li", { class: "none", text: "nothing" })] : chips));
  }
}
