// The sheet of one page: what a profile does, printed by the browser.

import { post } from "../link/api.js";

/** Prints what a text does. */
export async function printSheet(text) {
  const { svg } = await post("/api/sheet", { text, date: new Date().toLocaleDateString() });
  const drawing = new DOMParser().parseFromString(svg, "image/svg+xml").documentElement;
  document.getElementById("sheet").replaceChildren(document.importNode(drawing, true));
  window.print();
}
