// The view "Guides": step by step, as the program tells them. It knows no guide by itself.

import { announce } from "./common/announce.js";
import { get, post, withToken } from "./link/api.js";
import { commandLine } from "./common/command.js";
import { button, el, number, row, say, scroller, svg, table } from "./common/dom.js";
import { NumberField } from "./fields/number_field.js";
import { Plate } from "./picture/plate.js";
import { cueTone } from "./common/tones.js";

const STEPS = {
  todo: { sign: "○", word: "to do" },
  doing: { sign: "▶", word: "now" },
  done: { sign: "✓", word: "done" },
  failed: { sign: "✕", word: "failed" },
};
const STATES = { idle: "not started", running: "running", done: "done", failed: "failed" };

export class GuidesView {
  /** @type {Map<string, GuideCard>} */
  #cards = new Map();

  /** @param {(draft: { profile: string, text: string }) => void} openDraft */
  constructor(section, openDraft) {
    this.openDraft = openDraft;
    this.about = el("p", { class: "quiet" });
    this.failed = el("p", { class: "bad", role: "alert" });
    this.list = el("div", { class: "entries" });
    section.append(this.about, this.failed, this.list);
  }

  async show() {
    try {
      const { guides } = await get("/api/guides");
      say(this.about, guides.length === 0 ? "There are no guides." : "Each guide leads you step by step; no profile is saved before you say so.");
      for (const guide of guides) this.update(guide);
    } catch (error) {
      say(this.about, error.message);
    }
  }

  /** Takes the profile in play, as it is drawn. */
  setSketch({ sketch }) {
    this.sketch = sketch;
  }

  /** Shows none: whatever ran has ended with its bridge. */
  clear() {
    this.#cards.clear();
    this.list.replaceChildren();
    say(this.failed, "");
    say(this.about, "Guides need a bridge.");
  }

  /** Shows a guide as it is now. */
  update(guide) {
    if (!this.#cards.has(guide.id)) {
      this.#cards.set(guide.id, new GuideCard(guide, this));
      this.list.append(this.#cards.get(guide.id).node);
    }
    this.#cards.get(guide.id).draw(guide);
  }

  /** Does what was chosen, with the number that goes with it, if any does. */
  async act(id, action, value = null) {
    try {
      this.update(await post(`/api/guides/${encodeURIComponent(id)}`, { do: action, number: value }));
      say(this.failed, "");
    } catch (error) {
      say(this.failed, `✕ ${error.message}`);
    }
  }
}

/** One guide. What it is made of is rebuilt only when a state changes, so that the focus stays while a bar grows. */
class GuideCard {
  #shape = "";
  #spoken = "";

  constructor({ id, title, about }, view) {
    Object.assign(this, { id, view });
    this.state = el("span", { class: "tag" });
    this.steps = el("ol", { class: "steps" });
    this.actions = el("div", { class: "commands" });
    this.target = new LitPlate();
    this.result = el("div", { class: "result", hidden: true });
    this.node = el("article", { class: "card guide", "aria-labelledby": `guide-${id}` },
      el("h3", { id: `guide-${id}`, text: title }), el("p", { text: about }), this.state, this.steps, this.target.node, this.actions, this.result);
  }

  draw(guide) {
    const shape = JSON.stringify([guide.state, guide.steps.map(({ id, state, actions, links }) => [id, state, actions, links]), guide.result]);
    if (shape !== this.#shape) this.#rebuild(guide, shape);
    guide.steps.forEach((step, index) => this.#feedback(step, this.parts[index]));
    this.target.draw(this.view.sketch ?? null, guide.steps.find(({ state }) => state === "doing")?.target ?? null);
    this.#speak(guide);
  }

  #rebuild(guide, shape) {
    const focused = document.activeElement?.textContent;
    const inside = this.actions.contains(document.activeElement) || this.steps.contains(document.activeElement);
    this.#shape = shape;
    say(this.state, STATES[guide.state] ?? guide.state);
    this.parts = guide.steps.map((step) => this.#step(step));
    this.steps.replaceChildren(...this.parts.map(({ node }) => node));
    const running = guide.state === "running";
    this.actions.replaceChildren(...(running
      ? [button("Stop", () => this.view.act(this.id, "stop"), { class: "main" })]
      : [button(guide.state === "idle" ? "Start" : "Start again", () => this.view.act(this.id, "start"), { class: "main primary" })]));
    this.#showResult(guide.result);
    if (inside) ([...this.node.querySelectorAll("button")].find((it) => it.textContent === focused) ?? this.actions.querySelector("button"))?.focus();
  }

  #step({ title, text, state, actions, links }) {
    const { sign, word } = STEPS[state] ?? STEPS.todo;
    const bar = el("progress", { max: 1, "aria-label": `Progress of ${title}` });
    const detail = el("span");
    const cue = el("p", { class: "cue", hidden: true });
    const doing = state === "doing";
    const node = el("li", { class: `step ${state}`, "aria-current": doing ? "step" : null },
      el("p", {}, el("span", { class: "step-sign", text: `${sign} ${word}` }), " ", el("strong", { text: title })),
      doing || state === "failed" ? el("p", { text }) : null,
      cue, el("p", { class: "feedback" }, bar, " ", detail),
      el("div", { class: "commands" }, ...(doing ? links : []).map(fileLink)),
      el("div", { class: "commands" }, ...(doing ? actions : []).map((action) => this.#action(action))));
    return { node, bar, detail, cue };
  }

  /** A button; where the action takes a number, the field stands before it. */
  #action({ do: name, label, number: asked }) {
    if (asked === null) return button(label, () => this.view.act(this.id, name), { class: "main" });
    const { least: min, largest: max } = asked;
    const choose = () => {
      const value = field.read();
      if (value !== null) this.view.act(this.id, name, value);
    };
    const field = new NumberField({ unit: asked.unit, whole: false, step: 1, limits: () => ({ min, max }), blank: "", start: () => min, take: () => {}, enter: choose });
    return el("div", { class: "asked" }, el("div", { class: "commands" }, el("label", { class: "chooser" }, asked.label, field.node), button(label, choose)), field.range, field.error);
  }

  #feedback({ progress, detail, cue, state }, part) {
    part.cue.hidden = !cue;
    say(part.cue, cue ?? "");
    part.bar.hidden = progress === null || state !== "doing";
    if (progress !== null) part.bar.value = progress;
    const share = progress !== null && state === "doing" ? `${number(progress * 100, 0)} %` : "";
    say(part.detail, [share, detail ?? ""].filter((text) => text !== "").join(" – "));
  }

  #showResult(result) {
    this.result.hidden = result === null;
    if (result === null) return;
    this.result.replaceChildren(el("h4", { text: "Result" }), el("p", { text: result.text }),
      ...(result.table === null ? [] : [numbers(result.table)]),
      ...result.commands.flatMap(({ label, text }) => [el("p", { text: `${label}:` }), commandLine(label, text)]),
      ...(result.draft === null ? [] : [button(`Open ${result.draft.profile} with it in the editor`, () => this.view.openDraft(result.draft), { class: "main primary" })]));
  }

  #speak({ state, steps, result }) {
    const step = steps.find((one) => one.state === "doing");
    const text = state === "running" && step ? step.cue ?? `${step.title}. ${step.text}` : result?.text ?? "";
    const before = this.#spoken;
    this.#spoken = `${state} ${text}`;
    const changed = this.#spoken !== before && before !== "";
    if (changed && text !== "") announce(text);
    if (changed && step?.cue) cueTone();
  }
}

const LIT_MM = 9;
const ARROW = "M-6 0H6M2-4L6 0L2 4";

/** The plate on which the place is lit that is to be pressed. */
class LitPlate {
  #shape = "";

  constructor() {
    this.plate = new Plate("Plate with the place that is to be pressed");
    this.node = el("div", { class: "lit-plate", hidden: true }, this.plate.node);
  }

  draw(sketch, target) {
    const shape = JSON.stringify([sketch, target]);
    if (shape === this.#shape) return;
    this.#shape = shape;
    this.node.hidden = target === null;
    if (target === null) return;
    this.plate.setSketch(sketch);
    const { at_mm: [x, y], push: [right, up] } = target;
    const deg = (Math.atan2(-up, right) * 180) / Math.PI;
    this.plate.layers.finger.replaceChildren(svg("circle", { class: "lit", cx: x, cy: -y, r: LIT_MM }),
      ...(right === 0 && up === 0 ? [] : [svg("path", { class: "lit-push", d: ARROW, transform: `translate(${x} ${-y}) rotate(${deg})` })]));
  }
}

/** A file of the program to keep. */
function fileLink({ path, label }) {
  return el("a", { class: "action", href: withToken(path), download: path.split("/").at(-1), text: label });
}

function numbers({ caption, heads, rows }) {
  const { node, body } = table(caption, heads, { class: "figures" });
  body.append(...rows.map(row));
  return scroller(caption, node);
}
