// Colours of the style sheet for canvases, which cannot name them.

import { onTheme } from "./settings.js";

const known = new Map();
onTheme(() => known.clear());

/** The present colour of a custom property such as "--accent". */
export function colour(name) {
  if (!known.has(name)) {
    const probe = document.getElementById("announcer");
    probe.style.color = `var(${name})`;
    known.set(name, getComputedStyle(probe).color);
    probe.style.color = "";
  }
  return known.get(name);
}
