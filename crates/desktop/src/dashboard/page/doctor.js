// The view "Doctor": what the program found on this machine, and the command that mends each finding.

import { get } from "./link/api.js";
import { commandLine, copyButton } from "./common/command.js";
import { button, el, say } from "./common/dom.js";

const STATES = {
  good: { sign: "✓", word: "good", look: "good" },
  note: { sign: "⚠", word: "note", look: "warn" },
  bad: { sign: "✕", word: "bad", look: "bad" },
};

export class DoctorView {
  constructor(section) {
    this.about = el("p");
    this.list = el("ul", { class: "entries" });
    section.append(el("p", {}, button("Look again", () => this.show())), this.about, this.list);
  }

  async show() {
    say(this.about, "Looking …");
    try {
      const { checks } = await get("/api/doctor");
      const [bad, notes] = ["bad", "note"].map((finding) => checks.filter((check) => check.finding === finding).length);
      say(this.about, `${bad === 0 ? "Nothing stands in the way" : `${bad} of ${checks.length} findings stand in the way`}; ${notes} worth knowing.`);
      this.list.replaceChildren(...checks.map(entry));
    } catch (error) {
      say(this.about, error.message);
    }
  }
}

function entry({ name, finding, message, mend }) {
  const { sign, word, look } = STATES[finding] ?? STATES.note;
  return el("li", { class: "card" },
    el("h3", {}, el("span", { class: look, text: `${sign} ${word}` }), ` ${name}`),
    el("p", { text: message }), mend === null ? copyButton("Copy what is found", name, `${name}: ${message}`) : commandLine(name, mend));
}
