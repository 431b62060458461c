// The view "Reports": what diagnoses came to; each opens in a tab of its own.

import { get } from "./api.js";
import { button, el, say } from "./dom.js";

export class ReportsView {
  constructor(section) {
    this.about = el("p", { class: "quiet" });
    this.list = el("ul", { class: "entries" });
    section.append(el("p", {}, button("Look again", () => this.show())), this.about, this.list);
  }

  async show() {
    try {
      const { folder, reports } = await get("/api/reports");
      say(this.about, reports.length === 0 ? `There are no reports in ${folder} yet.` : `Reports in ${folder}:`);
      this.list.replaceChildren(...reports.map(entry));
    } catch (error) {
      say(this.about, error.message);
    }
  }
}

/** The address, if it is one of this program; anything else is not followed. */
function own(address) {
  const url = new URL(address, location.href);
  return url.origin === location.origin ? url.href : null;
}

function entry({ name, modified, verdict, summary, address }) {
  const href = own(address);
  return el("li", { class: "card" },
    el("h3", { text: name }),
    el("p", {}, el("strong", { class: "tag", text: verdict }), " ", el("span", { class: "quiet", text: modified })),
    el("p", { text: summary }),
    href === null ? null : el("a", { class: "action", href, target: "_blank", rel: "noopener", text: `Open ${name} (new tab)` }));
}
