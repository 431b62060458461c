// The history of a profile; and what is done with it as a whole: duplicate, rename, delete, export, import.

import { announce } from "../common/announce.js";
import { ask } from "../common/ask.js";
import { get, post, request, withToken } from "../link/api.js";
import { button, el, say } from "../common/dom.js";
import { capital } from "../common/words.js";
import { askName, readProfile, writeProfile } from "./saving.js";
import { undone } from "./undo_save.js";

/** More phrases than this are counted. */
const TOLD_MAX = 6;
const DAY = new Intl.DateTimeFormat(undefined, { dateStyle: "medium" });
const TIME = new Intl.DateTimeFormat(undefined, { timeStyle: "short" });

/** "today, 9:05 PM", "yesterday, …", "27 Nov 2026, …" */
function moment(at_ms) {
  const days = ["today", "yesterday"];
  const ago = days.findIndex((_, back) => DAY.format(Date.now() - back * 86_400_000) === DAY.format(at_ms));
  return `${days[ago] ?? DAY.format(at_ms)}, ${TIME.format(at_ms)}`;
}

const place = (name, rest = "") => `/api/profile/${encodeURIComponent(name)}${rest}`;

export class ProfileHistory {
  /** @type {{ name: string, own: boolean, shipped: boolean } | null} */
  #profile = null;

  /**
   * @param {object} editor
   * @param {(text: string, sentence: string) => void} editor.draft shows a text as a draft
   * @param {(text: string, sentence: string) => void} editor.draftUnplayed the same, and does not play it
   * @param {() => void} editor.hush takes away what the bar says
   * @param {() => string} editor.text of the draft
   * @param {(name: string) => Promise<void>} editor.open opens a profile, once its draft may be dropped
   * @param {() => Promise<boolean>} editor.mayDrop whether a draft may be dropped
   */
  constructor(editor) {
    this.editor = editor;
    this.message = el("p", { class: "editor-message" });
    this.undo = el("p", {});
    this.answer = el("div", { class: "answer" }, this.message, this.undo);
    this.history = el("ol", { class: "history" });
    this.saves = el("h4", { tabindex: "-1", text: "What was saved, and when" });
    const about = el("p", { class: "quiet small", text: "“Undo this” takes back one save and leaves all others. “Open as saved here” shows the profile as it was after that save: what was changed later goes." });
    this.rename = button("Rename …", ({ target }) => this.#rename(target), { id: "rename", class: "main" });
    this.remove = button("Delete", ({ target }) => this.#delete(target), { id: "delete", class: "main" });
    this.decoder = el("select", { id: "export-decoder", class: "main", onchange: () => this.#showExport() });
    this.decoderLabel = el("label", { class: "chooser", hidden: true }, "Decoder that goes along ", this.decoder);
    this.export = el("a", { class: "action", id: "export", download: "", text: "Export to a file", onclick: ({ target }) => this.#answerAt(target, this.#exported()) });
    this.file = el("input", { type: "file", id: "import", hidden: true, accept: ".tactpad,application/json", onchange: () => this.#import() });
    this.node = el("div", { class: "card" }, el("h3", { text: "History and files" }), this.answer, this.saves, about, this.history,
      el("h4", { text: "To another machine, and back" }),
      el("div", { class: "commands" }, this.export, this.decoderLabel, button("Import from a file …", () => this.file.click(), { id: "choose-import", class: "main" }), this.file),
      el("h4", { text: "This profile" }),
      el("div", { class: "commands" }, button("Duplicate …", ({ target }) => this.#duplicate(target), { id: "duplicate", class: "main" }), this.rename, this.remove));
  }

  /** Goes to the list of saves. */
  reveal() {
    this.saves.scrollIntoView();
    this.saves.focus();
  }

  /** Shows the history of the profile that is open. */
  async show(profile) {
    if (profile.name !== this.#profile?.name) this.#tell("");
    this.#profile = profile;
    const { name, own, shipped } = profile;
    for (const one of [this.rename, this.remove]) one.disabled = !own;
    await this.#listDecoders();
    this.#showExport();
    const { saves } = await get(place(name, "/history"));
    const rows = saves.map((save, index) => {
      const before = index + 1 < saves.length ? `/history/${saves[index + 1].id}` : "/history/shipped";
      return this.#row(moment(save.at_ms), changesOf(save), `/history/${save.id}`, own && save.changes.length > 0 ? { before, later: saves.slice(0, index).reverse() } : null);
    });
    if (shipped && own) rows.push(this.#row("as shipped", "the profile inside the program", "/history/shipped", null));
    this.history.replaceChildren(...(rows.length === 0 ? [el("li", { class: "quiet", text: "None yet: the first save begins them." })] : rows));
  }

  async #listDecoders() {
    const { decoders } = await get("/api/decoders");
    const chosen = this.decoder.value;
    this.decoder.replaceChildren(el("option", { value: "", text: "none" }), ...decoders.map((name) => el("option", { value: name, text: name })));
    this.decoder.value = decoders.includes(chosen) ? chosen : "";
    this.decoderLabel.hidden = decoders.length === 0;
  }

  #showExport() {
    const { name } = this.#profile;
    const decoder = this.decoder.value === "" ? "" : `/${encodeURIComponent(this.decoder.value)}`;
    this.export.href = withToken(place(name, `/export${decoder}`));
    this.export.download = `${name}.tactpad`;
  }

  /** What to do with the file that the browser gets. */
  #exported() {
    const sentence = `${this.export.download} is downloaded, with what is saved: on the other machine choose “Import from a file …” at the end of the page Profile.`;
    return sentence;
  }

  /** Exports what is saved; says what to do with it. */
  exportNow() {
    el("a", { href: this.export.href, download: this.export.download }).click();
    return this.#exported();
  }

  /** From now on answers stand below the row of this button. */
  #answerAt(button, sentence = "") {
    button.closest(".commands").after(this.answer);
    this.#tell(sentence);
  }

  /** A save; `around` says where the text before it is, and which saves came later, if it can be undone. */
  #row(title, changes, path, around) {
    const { name } = this.#profile;
    const undo = button("Undo this", ({ target }) => this.#do(target, () => this.#undoSave(title, path, around)), { "aria-label": `Undo this: what was saved ${title}` });
    const isShipped = path.endsWith("/shipped");
    const label = isShipped ? "Open as shipped" : "Open as saved here";
    const open = button(label, ({ target }) => this.#do(target, async () => {
      const { text } = await get(place(name, path));
      this.editor.draft(text, `${name} is in the editor ${isShipped ? title : `as it was saved ${title}`}. What was changed later is not in it. Save keeps it, Undo takes it back.`);
    }), { "aria-label": isShipped ? label : `${label}: ${title}`, title: "What was changed later is not in it" });
    return el("li", {}, el("span", {}, el("strong", { text: title }), " ", el("span", { class: "quiet", text: changes })), el("span", { class: "commands" }, around === null ? null : undo, open));
  }

  async #undoSave(title, path, { before, later }) {
    const { name } = this.#profile;
    const paths = [before, path, ...later.map(({ id }) => `/history/${id}`)];
    const saved = await Promise.all(paths.map((one) => get(place(name, one))));
    const texts = [...saved.map(({ text }) => text), this.editor.text()];
    const undo = await undone(texts);
    if (undo === null) return this.#offerWhole(title, texts[0], later);
    const refused = undo.refused.map((one) => ` Not undone: ${refusal(one, later)}`).join("");
    if (undo.done.length > 0) this.editor.draft(undo.text, `${doneInWords(undo.done, title)} Save keeps it, Undo takes it back.${refused}`);
    else this.#tell(refused === "" ? `It is as before ${title} already.` : refused.trim());
  }

  /** The whole older profile, if a person wants that, is not played by itself. */
  async #offerWhole(title, text, later) {
    const { name } = this.#profile;
    const gone = later.map((save) => `${moment(save.at_ms)}: ${changesOf(save)}`);
    const body = el("div", {}, el("p", { text: "Only the whole profile can be opened as it was before. With it goes what was changed later:" }),
      el("ul", {}, ...[...gone, "what is not saved yet"].map((text) => el("li", { text }))));
    if (await ask("This cannot be undone by itself", body, [{ label: "Open the older profile", answer: () => true }]) === null) return;
    this.editor.draftUnplayed(text, `${name} is in the editor as it was before ${title}. It is not played before you tick “Play changes at once”. Save keeps it, Undo takes it back.`);
  }

  #tell(sentence, ...more) {
    say(this.message, sentence);
    if (sentence !== "") announce(sentence);
    this.undo.replaceChildren(...more);
  }

  /** Does something for a button that may be refused, which is told there; what the bar said is old then. */
  async #do(button, work) {
    this.#answerAt(button);
    this.editor.hush();
    try {
      await work();
    } catch (error) {
      this.#tell(`✕ ${error.message}`);
    }
  }

  #duplicate(button) {
    return this.#do(button, async () => {
      const { name } = this.#profile;
      const to = await askName(`${name}-2`, "Duplicate …");
      if (to === null || !(await this.editor.mayDrop())) return;
      await writeProfile(to, (await readProfile(name)).text, null);
      await this.editor.open(to);
      this.#tell(`${to} is a copy of ${name}.`);
    });
  }

  #rename(button) {
    return this.#do(button, async () => {
      const { name } = this.#profile;
      const to = await askName(name, "Rename …");
      if (to === null || to === name || !(await this.editor.mayDrop())) return;
      await post(place(name, "/rename"), { to });
      await this.editor.open(to);
      this.#tell(`${name} is ${to} from now on.`);
    });
  }

  #delete(asked) {
    return this.#do(asked, async () => {
      const { name, shipped } = this.#profile;
      if (!(await this.editor.mayDrop())) return;
      const { text } = await readProfile(name);
      await request("DELETE", place(name));
      await this.editor.open(shipped ? name : null);
      const sentence = `${name} is deleted${shipped ? ": the shipped one is here" : ""}.`;
      const undo = button("Bring it back", () => this.#do(asked, async () => {
        await writeProfile(name, text, null);
        await this.editor.open(name);
        this.#tell(`${name} is back.`);
      }), { id: "undelete", class: "main" });
      this.#tell(sentence, undo);
      undo.focus();
    });
  }

  #import() {
    return this.#do(this.export, async () => {
      const document = await this.file.files[0].text();
      this.file.value = "";
      if (!(await this.editor.mayDrop())) return;
      const name = await askName(nameIn(document), "Import as …");
      if (name === null) return;
      const { decoder } = await post("/api/import", { document, name });
      await this.editor.open(name);
      this.#tell(`${name} is imported.${decoder === null ? "" : ` Its decoder is ${decoder}: tactpad run --decoder takes it.`}`);
    });
  }
}

/** "A: jump, press force is 2 N again, as before yesterday, 7:00. It had become 2.5 N since." */
function doneInWords(done, title) {
  const since = done.filter(({ had }) => had !== null).map(({ what, had }) => ` ${done.length === 1 ? "It" : capital(what)} ${had}.`);
  return `${capital(inShort(done.map(({ what, is }) => `${what} ${is}`)).join("; "))}, as before ${title}.${inShort(since).join("")}`;
}

/** Why a part of a save cannot be undone, and what to do. */
function refusal({ what, went }, later) {
  if (went === undefined) return `${what} is there no more. First undo the save that took it away, then this one.`;
  if (went === later.length) return `${what} was removed, and that is not saved yet. First press Undo at the top, then Undo this once more.`;
  return `${what} was removed ${moment(later[went].at_ms)}. First press Undo this there, then here.`;
}

/** Few enough to be read. */
function inShort(phrases) {
  return phrases.length <= TOLD_MAX ? phrases : [...phrases.slice(0, TOLD_MAX), `and ${phrases.length - TOLD_MAX} more`];
}

/** What a save changed. */
function changesOf({ changes }) {
  return changes.length === 0 ? "the oldest that is kept" : changes.join("; ");
}

/** The name in an exported file. */
function nameIn(document) {
  try {
    return String(JSON.parse(document).name ?? "");
  } catch {
    return "";
  }
}
