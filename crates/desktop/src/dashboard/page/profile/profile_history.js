// The history of a profile; and what is done with it as a whole: duplicate, rename, delete, export, import.

import { announce } from "../common/announce.js";
import { get, post, request, withToken } from "../link/api.js";
import { button, el, say } from "../common/dom.js";
import { askName, readProfile, writeProfile } from "./saving.js";
import { undoing } from "./undo_save.js";

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
   * @param {(changes: import("./draft.js").Change[], sentence: string) => void} editor.change changes values of the draft
   * @param {() => object} editor.document what the draft says
   * @param {(name: string) => Promise<void>} editor.open opens a profile, once its draft may be dropped
   * @param {() => Promise<boolean>} editor.mayDrop whether a draft may be dropped
   */
  constructor(editor) {
    this.editor = editor;
    this.message = el("p", { class: "editor-message", role: "status" });
    this.undo = el("p", {});
    this.history = el("ol", { class: "history" });
    this.saves = el("h4", { tabindex: "-1", text: "What was saved, and when" });
    this.rename = button("Rename …", () => this.#rename(), { id: "rename", class: "main" });
    this.remove = button("Delete", () => this.#delete(), { id: "delete", class: "main" });
    this.decoder = el("select", { id: "export-decoder", class: "main", onchange: () => this.#showExport() });
    this.decoderLabel = el("label", { class: "chooser", hidden: true }, "Decoder that goes along ", this.decoder);
    this.export = el("a", { class: "action", id: "export", download: "", text: "Export to a file", onclick: () => this.#exported() });
    this.file = el("input", { type: "file", id: "import", hidden: true, accept: ".tactpad,application/json", onchange: () => this.#import() });
    this.node = el("div", { class: "card" }, el("h3", { text: "History and files" }), this.message, this.undo,
      this.saves, this.history,
      el("h4", { text: "To another machine, and back" }),
      el("div", { class: "commands" }, this.export, this.decoderLabel, button("Import from a file …", () => this.file.click(), { id: "choose-import", class: "main" }), this.file),
      el("h4", { text: "This profile" }),
      el("div", { class: "commands" }, button("Duplicate …", () => this.#duplicate(), { id: "duplicate", class: "main" }), this.rename, this.remove));
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
      const path = `/history/${save.id}`;
      const before = index + 1 < saves.length ? `/history/${saves[index + 1].id}` : "/history/shipped";
      return this.#row(moment(save.at_ms), changesOf(save), path, own && save.changes.length > 0 ? before : null);
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

  #exported() {
    const sentence = `${this.export.download} is downloaded, with what is saved: on the other machine choose “Import from a file …” here.`;
    this.#tell(sentence);
    announce(sentence);
  }

  /** A save; `before` is where the text before it is, if it can be undone. */
  #row(title, changes, path, before) {
    const { name } = this.#profile;
    const undo = button("Undo this", () => this.#do(() => this.#undoSave(title, path, before)), { "aria-label": `Undo this: what was saved ${title}` });
    const open = button("Open as it was then", () => this.#do(async () => {
      const { text } = await get(place(name, path));
      this.editor.draft(text, `${name} is in the editor as it was after ${title}, without what was changed later: Save keeps it, Undo goes back.`);
    }), { "aria-label": `Open as it was then: ${title}` });
    return el("li", {}, el("span", {}, el("strong", { text: title }), " ", el("span", { class: "quiet", text: changes })), el("span", { class: "commands" }, before === null ? null : undo, open));
  }

  async #undoSave(title, path, before) {
    const { name } = this.#profile;
    const texts = await Promise.all([before, path].map((one) => get(place(name, one))));
    const [was, became] = await Promise.all(texts.map(({ text }) => post("/api/draft", { text, changes: [] })));
    const changes = undoing(was.document, became.document, this.editor.document());
    if (changes === null) return this.editor.draft(texts[0].text, `${name} is in the editor as it was before ${title}: Save keeps it, Undo goes back.`);
    if (changes.length === 0) return this.#tell("Nothing is left of it to undo: it was changed once more since.");
    this.editor.change(changes, `What was saved ${title} is undone in the editor: Save keeps it, Undo goes back.`);
  }

  #tell(sentence, ...more) {
    say(this.message, sentence);
    this.undo.replaceChildren(...more);
  }

  /** Does something that may be refused, which is told. */
  async #do(work) {
    try {
      await work();
    } catch (error) {
      this.#tell(`✕ ${error.message}`);
    }
  }

  #duplicate() {
    return this.#do(async () => {
      const { name } = this.#profile;
      const to = await askName(`${name}-2`, "Duplicate …");
      if (to === null || !(await this.editor.mayDrop())) return;
      await writeProfile(to, (await readProfile(name)).text, null);
      await this.editor.open(to);
      this.#tell(`${to} is a copy of ${name}.`);
    });
  }

  #rename() {
    return this.#do(async () => {
      const { name } = this.#profile;
      const to = await askName(name, "Rename …");
      if (to === null || to === name || !(await this.editor.mayDrop())) return;
      await post(place(name, "/rename"), { to });
      await this.editor.open(to);
      this.#tell(`${name} is ${to} from now on.`);
    });
  }

  #delete() {
    return this.#do(async () => {
      const { name, shipped } = this.#profile;
      if (!(await this.editor.mayDrop())) return;
      const { text } = await readProfile(name);
      await request("DELETE", place(name));
      await this.editor.open(shipped ? name : null);
      const sentence = `${name} is deleted${shipped ? ": the shipped one is here" : ""}.`;
      const undo = button("Bring it back", () => this.#do(async () => {
        await writeProfile(name, text, null);
        await this.editor.open(name);
        this.#tell(`${name} is back.`);
      }), { id: "undelete", class: "main" });
      this.#tell(sentence, undo);
      announce(sentence);
      undo.focus();
    });
  }

  #import() {
    return this.#do(async () => {
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
