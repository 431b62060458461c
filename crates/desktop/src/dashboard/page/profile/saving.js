// Saves profiles: over the file that was read, or under a new name; and asks when the file changed meanwhile.

import { get, request } from "../link/api.js";
import { button, el, say } from "../common/dom.js";

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

/** A dialog of a question and answers; gives the answer, or null. */
function ask(title, body, answers) {
  const dialog = el("dialog", { class: "dialog", "aria-label": title });
  return new Promise((done) => {
    const close = (answer) => {
      dialog.close();
      dialog.remove();
      done(answer);
    };
    dialog.append(el("h3", { text: title }), body, el("div", { class: "commands" },
      ...answers.map(({ label, answer }) => button(label, () => close(answer()), { class: answers.length === 1 ? "main primary" : "main" })),
      button("Cancel", () => close(null), { class: "main" })));
    // Enter in a field does what the first button does.
    dialog.addEventListener("keydown", (event) => {
      if (event.key !== "Enter" || event.target.tagName !== "INPUT") return;
      event.preventDefault();
      close(answers[0].answer());
    });
    dialog.addEventListener("cancel", (event) => {
      event.preventDefault();
      close(null);
    });
    document.body.append(dialog);
    dialog.showModal();
  });
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
export async function askName(before, title = "Save as …") {
  const field = el("input", { type: "text", id: "new-name", value: before, class: "main" });
  const wrong = el("p", { class: "bad", role: "alert" });
  const body = el("div", {}, el("label", { for: "new-name", text: "Name, without a dot, slash, backslash or colon" }), el("p", {}, field), wrong);
  for (;;) {
    const name = await ask(title, body, [{ label: title.replace(" …", ""), answer: () => field.value.trim() }]);
    if (name === null || NAME.test(name)) return name;
    say(wrong, "✕ A name has no dot, slash, backslash or colon, and is not empty.");
  }
}
