// The history of a profile; and what is done with it as a whole: duplicate, rename, delete, export, import.

import { announce } from "../common/announce.js";
import { get, post, request, withToken } from "../link/api.js";
import { button, el, say } from "../common/dom.js";
import { askName, readProfile, writeProfile } from "./saving.js";

const place = (name, rest = "") => `/api/profile/${encodeURIComponent(name)}${rest}`;

export class ProfileHistory {
  /** @type {{ name: string, own: boolean, shipped: boolean } | null} */
  #profile = null;

  /**
   * @param {object} editor
   * @param {(text: string, sentence: string) => void} editor.draft shows a text as a draft
   * @param {(name: string) => Promise<void>} editor.open opens a profile, once its draft may be dropped
   * @param {() => Promise<boolean>} editor.mayDrop whether a draft may be dropped
   */
  constructor(editor) {
    this.editor = editor;
    this.message = el("p", { class: "editor-message", role: "status" });
    this.undo = el("p", {});
    this.history = el("ol", { class: "history" });
    this.rename = button("Rename …", () => this.#rename(), { id: "rename", class: "main" });
    this.remove = button("Delete", () => this.#delete(), { id: "delete", class: "main" });
    this.decoder = el("select", { id: "export-decoder", class: "main", onchange: () => this.#showExport() });
    this.decoderLabel = el("label", { class: "chooser", hidden: true }, "Decoder that goes along ", this.decoder);
    this.export = el("a", { class: "action", id: "export", download: "", text: "Export to a file" });
    this.file = el("input", { type: "file", id: "import", hidden: true, accept: ".tactpad,application/json", onchange: () => this.#import() });
    this.node = el("div", { class: "card" }, el("h3", { text: "History and files" }),
      el("div", { class: "commands" }, button("Duplicate …", () => this.#duplicate(), { id: "duplicate", class: "main" }), this.rename, this.remove, this.decoderLabel, this.export,
        button("Import from a file …", () => this.file.click(), { id: "choose-import", class: "main" }), this.file),
      this.message, this.undo, el("h4", { text: "History" }), this.history);
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
    const rows = saves.map((save) => this.#row(new Date(save.at_ms).toLocaleString(), changesOf(save, own), `/history/${save.id}`));
    if (shipped && own) rows.push(this.#row("as shipped", "the profile inside the program", "/history/shipped"));
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

  #row(title, changes, path) {
    const { name } = this.#profile;
    const open = button("Open", () => this.#do(async () => {
      const { text } = await get(place(name, path));
      this.editor.draft(text, `${name} ${title} is in the editor as a draft: Save keeps it, Undo goes back.`);
    }), { "aria-label": `Open the save ${title}` });
    return el("li", {}, el("span", {}, el("strong", { text: title }), " ", el("span", { class: "quiet", text: changes })), open);
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

/** What a save changed; the newest of a profile that is there is what stands in it. */
function changesOf({ number, changes }, own) {
  const words = changes.length === 0 ? "the oldest that is kept" : changes.join("; ");
  return number === 1 && own ? `as it is now: ${words}` : words;
}

/** The name in an exported file. */
function nameIn(document) {
  try {
    return String(JSON.parse(document).name ?? "");
  } catch {
    return "";
  }
}
