// The view "Doctor": what the program found on this machine, and the command that mends each finding.

import { get } from "./link/api.js";
import { commandLine, copyButton } from "./common/command.js";
import { button, el, say } from "./common/dom.js";

const STATES = {
  good: { sign: "✓", word: "in order", look: "good" },
  note: { sign: "⚠", word: "worth knowing", look: "warn" },
  bad: { sign: "✕", word: "in the way", look: "bad" },
};

export class DoctorView {
  /** @param {import("./live/live.js").LiveView} live knows what happens right now */
  constructor(section, live) {
    this.live = live;
    this.about = el("p");
    this.now = el("div");
    this.list = el("ul", { class: "entries" });
    section.append(el("p", {}, button("Look again", () => this.show())), el("div", { class: "card entry" }, el("h3", { text: "Right now" }), this.now), this.about, this.list);
  }

  async show() {
    this.now.replaceChildren(...this.live.sentences().map((text) => el("p", { text })));
    say(this.about, "Looking …");
    try {
      const { checks } = await get("/api/doctor");
      const [bad, notes] = ["bad", "note"].map((finding) => checks.filter((check) => check.finding === finding).length);
      say(this.about, `In the way on this machine: ${bad === 0 ? "nothing" : bad}. Worth knowing: ${notes === 0 ? "nothing" : notes}. Commands are for a terminal; who looks after this machine can run them.`);
      this.list.replaceChildren(...["bad", "note", "good"].flatMap((finding) => checks.filter((check) => check.finding === finding)).map(entry));
    } catch (error) {
      say(this.about, error.message);
    }
  }
}

function entry({ name, finding, message, mend }) {
  const { sign, word, look } = STATES[finding] ?? STATES.note;
  return el("li", { class: "card" },
    el("h3", {}, el("span", { class: look, text: `${sign} ${name}` }), `: ${word}`),
    el("p", { text: message }), mend === null ? copyButton("Copy what is found", name, `${name}: ${message}`) : commandLine(name, mend));
}
