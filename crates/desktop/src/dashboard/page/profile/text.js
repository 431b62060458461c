// The text of a profile with line numbers, and what the program says of it.

import { el, say } from "../common/dom.js";

const SEVERITIES = { error: { sign: "✕", look: "bad" }, warning: { sign: "⚠", look: "warn" } };
const TYPING_MS = 1000;

export class TextPane {
  #gesture = null;
  #typed_ms = -Infinity;
  #shown = null;

  /** @param {import("./draft.js").Draft} draft */
  constructor(draft) {
    this.draft = draft;
    this.area = el("textarea", { id: "profile-text", wrap: "off", spellcheck: "false", autocomplete: "off", autocapitalize: "off", rows: 30,
      "aria-label": "Text of the profile", "aria-describedby": "diagnostics-count", oninput: () => this.#typed() });
    this.numbers = el("pre", { class: "line-numbers", "aria-hidden": "true" });
    this.count = el("span", { id: "diagnostics-count", class: "quiet" });
    this.heading = el("h4", { text: "What is wrong with it" });
    this.list = el("ul", { id: "diagnostics", class: "diagnostics" });
    this.area.addEventListener("scroll", () => { this.numbers.scrollTop = this.area.scrollTop; });
    this.node = el("details", { class: "card text-pane" }, el("summary", {}, el("strong", { text: "The profile's text" }), " ", this.count),
      el("div", { class: "text-frame" }, this.numbers, this.area), this.heading, this.list);
  }

  #typed() {
    const now = performance.now();
    if (now - this.#typed_ms > TYPING_MS) this.#gesture = {};
    this.#typed_ms = now;
    this.draft.type(this.area.value, this.#gesture);
    this.#number();
  }

  #number() {
    const lines = this.area.value.split("\n").length;
    if (lines === this.lines) return;
    this.lines = lines;
    this.numbers.textContent = Array.from({ length: lines }, (_, index) => index + 1).join("\n");
    this.numbers.scrollTop = this.area.scrollTop;
  }

  /** Shows the draft's text; the caret and the place that is seen stay. */
  showText() {
    this.#typed_ms = -Infinity;
    if (this.area.value === this.draft.text) return;
    const { selectionStart, selectionEnd, scrollTop } = this.area;
    this.area.value = this.draft.text;
    this.area.setSelectionRange(selectionStart, selectionEnd);
    this.area.scrollTop = scrollTop;
    this.#number();
  }

  /** Shows the draft's diagnostics. */
  showDiagnostics() {
    const { diagnostics } = this.draft;
    const shape = JSON.stringify(diagnostics);
    if (shape === this.#shown) return;
    this.#shown = shape;
    const errors = diagnostics.filter(({ severity }) => severity === "error").length;
    this.area.setAttribute("aria-invalid", String(errors > 0));
    if (errors > 0) this.node.open = true;
    say(this.count, diagnostics.length === 0 ? "✓ Nothing is wrong." : `${plural(errors, "error")}, ${plural(diagnostics.length - errors, "warning")}.`);
    this.heading.hidden = diagnostics.length === 0;
    this.list.replaceChildren(...diagnostics.map((one) => this.#diagnostic(one)));
  }

  #diagnostic({ severity, message, line, column, help }) {
    const { sign, look } = SEVERITIES[severity] ?? SEVERITIES.error;
    const place = line === null || line === undefined ? "" : `${line}:${column}`;
    return el("li", {}, el("button", { type: "button", class: "diagnostic", onclick: () => this.goTo(line ?? 1, column ?? 1) },
      el("span", { class: look, text: `${sign} ${severity}` }), " ", el("span", { class: "code quiet", text: place }), " ", el("span", { text: message })),
      help ? el("p", { class: "diagnostic-help", text: `help: ${help}` }) : null);
  }

  /** Moves the caret to a place of the text and into sight. */
  goTo(line, column) {
    const lines = this.area.value.split("\n");
    const before = lines.slice(0, line - 1).reduce((sum, one) => sum + one.length + 1, 0);
    const at = Math.min(before + column - 1, before + (lines[line - 1]?.length ?? 0));
    this.area.focus();
    this.area.setSelectionRange(at, at);
    const high = this.area.scrollHeight / Math.max(lines.length, 1);
    this.area.scrollTop = Math.max(0, (line - 5) * high);
  }
}

/** "1 error", "2 errors". */
export const plural = (count, what) => `${count} ${what}${count === 1 ? "" : "s"}`;
