// "What would this have done?": the last minute of play, once as it is saved and once with the draft.

import { announce } from "../common/announce.js";
import { post } from "../link/api.js";
import { button, el, number, row, scroller, table } from "../common/dom.js";

const MOST = 50;

export class Rewind {
  /** @param {import("./draft.js").Draft} draft */
  constructor(draft) {
    this.draft = draft;
    this.answer = el("div", { class: "rewind-answer" });
    this.node = el("div", { class: "card" }, el("h3", { text: "The last minute" }),
      button("What would this have done?", () => this.#ask(), { id: "rewind", class: "main" }), this.answer);
  }

  async #ask() {
    this.answer.replaceChildren(el("p", { text: "Playing the last minute again …" }));
    try {
      this.#show(await post("/api/rewind", { text: this.draft.text, saved: this.draft.saved }));
    } catch (error) {
      const first = error.body?.diagnostics?.[0]?.message;
      this.#say(first ? `The draft has an error: ${first}` : error.message);
    }
  }

  #say(sentence) {
    this.answer.replaceChildren(el("p", { text: sentence }));
    announce(sentence);
  }

  #show({ ok, seconds, now, draft, names, only_now, only_draft, error, diagnostics }) {
    if (ok === false) return this.#say(error ?? diagnostics?.[0]?.message ?? "It could not be played.");
    const difference = draft.downs - now.downs;
    const sentence = `In the last ${number(seconds, 0)} s the draft would have pressed ${draft.downs} times in place of ${now.downs}${difference === 0 ? "" : ` (${difference > 0 ? "+" : "−"}${Math.abs(difference)})`}.`;
    const counts = table("Presses of each control", ["Control", "As saved", "With the draft", "Difference"], { class: "figures" });
    const codes = [...new Set([...Object.keys(now.presses), ...Object.keys(draft.presses)])].sort();
    counts.body.append(...codes.map((code) => {
      const [before, after] = [now.presses[code] ?? 0, draft.presses[code] ?? 0];
      return row([names[code] ?? code, before, after, after === before ? "same" : `${after > before ? "+" : "−"}${Math.abs(after - before)}`]);
    }));
    this.answer.replaceChildren(el("p", { text: sentence }), scroller("Presses of each control", counts.node),
      list("Only as saved", only_now, names), list("Only with the draft", only_draft, names));
    announce(sentence);
  }
}

function list(title, presses, names) {
  if (presses.length === 0) return el("p", { class: "quiet", text: `${title}: none.` });
  const { node, body } = table(`${title}: ${presses.length}`, ["Control", "At"], { class: "figures" });
  body.append(...presses.slice(0, MOST).map(({ control, at_s }) => row([names[control] ?? control, `${number(at_s, 1)} s`])));
  return el("details", {}, el("summary", { text: `${title}: ${presses.length}` }), node);
}
