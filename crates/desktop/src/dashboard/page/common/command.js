// A command for a terminal, and a button that copies it.

import { announce } from "./announce.js";
import { button, el } from "./dom.js";

/** @param {string} name what it is for */
export function commandLine(name, command) {
  return el("p", { class: "command" }, el("code", { text: command }), copyButton("Copy", name, command));
}

/** A button that copies a text. */
export function copyButton(label, name, text) {
  return button(label, () => copyText(text), { "aria-label": `${label}: ${name}` });
}

async function copyText(text) {
  try {
    await navigator.clipboard.writeText(text);
    announce("It is copied.");
  } catch {
    announce("The browser does not allow copying: select the text instead.");
  }
}
