// Saves profiles: over the file that was read, or under a new name; and asks when the file changed meanwhile.

import { get, request } from "../link/api.js";
import { ask } from "../common/ask.js";
import { el, say } from "../common/dom.js";

const NAME = /^[^./\\:]+$/;
const address = (name) => `/api/profile/${encodeURIComponent(name)}`;

/** Reads a profile. */
export const readProfile = (name) => get(address(name));

/**
 * Writes a text over that version, or as a new profile if it is null.
 * @returns {Promise<{ version: string, path: string }>}
 */
export function writeProfile(name, text, version) {
  const condition = version === null ? { "If-None-Match": "*" } : { "If-Match": version };
  return request("PUT", address(name), text, condition);
}

/** What to do with a file that changed meanwhile: "theirs", "overwrite" or null. */
export function askConflict() {
  return ask("The file was changed meanwhile", el("p", { text: "Load what is in the file now, or write your draft over it." }), [
    { label: "Load the file, drop my draft", answer: () => "theirs" },
    { label: "Overwrite the file with my draft", answer: () => "overwrite" },
  ]);
}

/** Whether a draft may be dropped. */
export function askDrop(name) {
  return ask("The draft is not saved", el("p", { text: `What you changed in ${name} will be gone.` }), [{ label: "Drop the draft", answer: () => true }]);
}

/** A new name, or null. */
export function askName(before, title = "Save as …") {
  const field = el("input", { type: "text", id: "new-name", value: before, class: "main" });
  const wrong = el("p", { class: "bad", role: "alert" });
  const body = el("div", {}, el("label", { for: "new-name", text: "Name, without a dot, slash, backslash or colon" }), el("p", {}, field), wrong);
  const answer = () => {
    const name = field.value.trim();
    if (NAME.test(name)) return name;
    say(wrong, "✕ A name has no dot, slash, backslash or colon, and is not empty.");
    field.focus();
    return undefined;
  };
  return ask(title, body, [{ label: title.replace(" …", ""), answer }]);
}
