// A dialog: a question, and answers to choose from.

import { button, el } from "./dom.js";

/** A dialog of a question and answers; gives the answer, or null. An answer that is undefined is still to be given. */
export function ask(title, body, answers) {
  const dialog = el("dialog", { class: "dialog", "aria-label": title });
  return new Promise((done) => {
    const close = (answer) => {
      if (answer === undefined) return;
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
