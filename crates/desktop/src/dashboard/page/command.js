// A command for a terminal, and a button that copies it.

import { announce } from "./announce.js";
import { button, el } from "./dom.js";

/** @param {string} name what it is for */
export function commandLine(name, command) {
  const copy = button("Copy", () => copyText(command), { "aria-label": `Copy the command for ${name}` });
  return el("p", { class: "command" }, el("code", { text: command }), copy);
}

async function copyText(text) {
  try {
    await navigator.clipboard.writeText(text);
    announce("The command is copied.");
  } catch {
    announce("The browser does not allow copying: select the command instead.");
  }
}
