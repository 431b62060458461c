// The view "Reports": what diagnoses came to; each opens in a tab of its own.

import { get, withToken } from "./link/api.js";
import { button, el, say } from "./common/dom.js";

export class ReportsView {
  constructor(section) {
    this.about = el("p", { class: "quiet" });
    this.list = el("ul", { class: "entries" });
    section.append(el("p", {}, button("Look again", () => this.show())), this.about, this.list);
  }

  async show() {
    try {
      const { reports } = await get("/api/reports");
      const hint = "There are no reports yet: `tactpad diagnose --measured M.csv --report FOLDER` writes one.";
      say(this.about, reports.length === 0 ? hint : "Reports that were written on this machine, the newest first.");
      this.list.replaceChildren(...reports.map(entry));
    } catch (error) {
      say(this.about, error.message);
    }
  }
}

function entry({ id, name, folder, modified_s, verdict, summary }) {
  const written = new Date(1000 * modified_s).toLocaleString();
  return el("li", { class: "card" },
    el("h3", { text: name }),
    el("p", {}, el("strong", { class: "tag", text: verdict.replaceAll("_", " ") }), " ", el("span", { class: "quiet", text: `${written}, ${folder}` })),
    el("p", { text: summary }),
    el("a", { class: "action", href: withToken(`/report/${id}`), target: "_blank", rel: "noopener", text: `Open ${name} (new tab)` }));
}
