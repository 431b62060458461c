// The sheet of one page: what a profile does. It is shown, and printed by the browser.

import { ask } from "../common/ask.js";
import { el } from "../common/dom.js";
import { post } from "../link/api.js";

/** Shows what a text does, and prints it if that is wanted: whether it was given to the browser. */
export async function printSheet(text) {
  const { svg } = await post("/api/sheet", { text, date: new Date().toLocaleDateString() });
  const drawing = new DOMParser().parseFromString(svg, "image/svg+xml").documentElement;
  const shown = el("div", { class: "sheet-shown", role: "img", "aria-label": "The sheet" }, document.importNode(drawing, true));
  if (!(await ask("The sheet", shown, [{ label: "Print", answer: () => true }]))) return false;
  document.getElementById("sheet").replaceChildren(document.importNode(drawing, true));
  window.print();
  return true;
}
