// The view "Profile": the plate and the forces with handles, the form, the text; all of them edit one draft.

import { announce } from "../common/announce.js";
import { get } from "../link/api.js";
import { button, el, measured, say, set } from "../common/dom.js";
import { Draft } from "./draft.js";
import { LastTouch } from "../live/last_touch.js";
import { ForceHandles } from "../picture/force_handles.js";
import { Form } from "../fields/form.js";
import { Finger, Plate } from "../picture/plate.js";
import { PlateBinding } from "../picture/plate_binding.js";
import { PlateHandles } from "../picture/plate_handles.js";
import { Preview } from "./preview.js";
import { ProfileHistory } from "./profile_history.js";
import { Rewind } from "./rewind.js";
import { askConflict, askDrop, askName, readProfile, writeProfile } from "./saving.js";
import { Schema } from "../fields/schema.js";
import { printSheet } from "./sheet.js";
import { TextPane, plural } from "./text.js";
import { Values } from "../fields/values.js";

const NOTHING_TOLD = { sentence: "" };
/** The button that goes back to what is saved. */
const DROP = "Drop what I changed";

export class ProfileView {
  #name = null;
  /** The version of the text that was read: what a save may be written over. */
  #version = null;
  #ready = null;
  /** A draft of a guide that is to be opened when the view comes into sight. */
  #opening = null;
  #reading = false;
  #previewed = false;
  #isPaused = false;
  #playing = "";
  /** The profile of which the message says that it was saved. */
  #saved = null;
  /** @type {import("./draft_store.js").DraftStore | null} */
  #draftStore = null;
  /** A draft that this browser has stored, to be opened first. @type {import("./draft_store.js").StoredDraft | null} */
  #found = null;
  #leaving = false;
  /** What is to be read once the draft was checked, and what is offered beside it. @type {{ sentence: string, offer?: HTMLElement, isSpoken?: boolean }} */
  #told = NOTHING_TOLD;

  constructor(section) {
    this.section = section;
    measured(document.getElementById("preview-notice"), "--notice-height");
    this.draft = new Draft();
    this.preview = new Preview(this.draft, (sentence) => this.#tell(sentence));
    this.#makeBar();
    this.body = el("div");
    section.append(this.bar, this.body);
    measured(this.bar, "--bar-height");
    section.addEventListener("keydown", (event) => this.#shortcut(event));
    addEventListener("beforeunload", (event) => this.draft.dirty && !this.#leaving && event.preventDefault());
    this.draft.addEventListener("text", () => this.text?.showText());
    for (const change of ["text", "typed", "checked"]) this.draft.addEventListener(change, () => this.#storeDraft());
    this.draft.addEventListener("checked", () => this.#checked());
    this.draft.addEventListener("failed", ({ detail }) => this.#tell(detail));
  }

  #makeBar() {
    this.choice = el("select", { id: "profile-open", class: "main", onchange: () => this.#open(this.choice.value) });
    this.undo = button("Undo", () => this.draft.move(-1), { id: "undo", class: "main", "aria-keyshortcuts": "Control+Z" });
    this.redo = button("Redo", () => this.draft.move(1), { id: "redo", class: "main", "aria-keyshortcuts": "Control+Y" });
    this.save = button("Save", () => this.#save(), { id: "save", class: "main primary", "aria-keyshortcuts": "Control+S" });
    this.revert = button(DROP, () => this.#revert(), { id: "revert", class: "main" });
    this.saves = button("Earlier saves", () => this.profileHistory?.reveal(), { id: "saves", class: "main" });
    this.live = el("input", { type: "checkbox", id: "preview", checked: true, onchange: () => this.#playChanges(this.live.checked) });
    this.state = el("span", { id: "draft-state" });
    this.message = el("p", { class: "editor-message", role: "status" });
    this.offered = el("span", { class: "offered" });
    this.bar = el("div", { class: "card bar-of-commands" }, el("div", { class: "commands" },
      el("label", { class: "chooser" }, "Profile to edit ", this.choice), this.undo, this.redo, this.save, this.revert, this.saves,
      button("Save as …", () => this.#saveAs(), { id: "save-as", class: "main" }), button("Print …", () => this.#print(), { id: "print", class: "main" }), button("Export", () => this.#answer(this.profileHistory?.exportNow() ?? ""), { id: "export-now", class: "main" }), el("label", { class: "check main" }, this.live, "Play changes at once"), this.state, this.message, this.offered));
  }

  /** Makes what needs the schema, once. */
  async #prepare() {
    const schema = new Schema(await get("/api/schema"));
    // A field or a handle says by itself what it is now.
    this.values = new Values(this.draft, schema, (sentence) => { this.#told = { sentence, isSpoken: false }; });
    this.plate = new Plate("Plate with the handles of the profile that is edited");
    this.finger = new Finger(this.plate, "editor-contact");
    this.plateHandles = new PlateHandles(this.plate, this.values);
    this.plateBinding = new PlateBinding(this.plate, this.values, (group) => this.form.pick(group));
    this.forceHandles = new ForceHandles(this.values);
    this.form = new Form(this.values, schema, (part) => this.plate.pick(part), (sentence, offer) => { this.#told = { sentence, offer }; });
    this.text = new TextPane(this.draft);
    this.rewind = new Rewind(this.draft);
    this.profileHistory = new ProfileHistory({
      draft: (text, sentence) => this.#showDraft(sentence, text),
      draftUnplayed: (text, sentence) => {
        this.#playChanges(false);
        this.#showDraft(sentence, text);
      },
      hush: () => this.#tell(""),
      text: () => this.draft.text,
      open: (name) => this.#reopen(name),
      mayDrop: async () => !this.draft.dirty || await askDrop(this.#name) === true,
    });
    this.lastTouch = new LastTouch();
    this.touched = el("p", { class: "small" });
    const hint = el("p", { class: "quiet hint", text: "Drag a handle, or go to it with Tab and move it with arrow keys. Each has a field among the settings." });
    this.body.replaceChildren(el("div", { class: "editor-grid" },
      el("div", { class: "area-sketch" }, el("div", { class: "card" }, el("h3", { text: "Plate" }), this.plate.node, this.plateHandles.legend, this.plateBinding.node), el("div", { class: "card" }, el("h3", { text: "Forces" }), this.forceHandles.node, this.touched, hint)),
      el("div", { class: "area-form" }, el("div", { class: "card" }, el("h3", { text: "Settings" }), this.form.node)),
      el("div", { class: "area-text" }, this.text.node, this.rewind.node, this.profileHistory.node)));
  }

  /** The view comes into sight. */
  async show() {
    try {
      this.#ready ??= this.#prepare();
      await this.#ready;
      const playing = await this.#list();
      if (this.#found !== null) await this.#openFound();
      if (this.#opening !== null) await this.#openWaiting();
      else if (this.#name === null && !this.#reading) await this.#load(playing);
    } catch (error) {
      this.#ready = null;
      this.#tell(error.message);
    }
  }

  async #list() {
    const { profiles, playing } = await get("/api/profiles");
    this.choice.replaceChildren(...profiles.map(({ name, own }) => el("option", { value: name, text: own ? `${name} (yours)` : name })));
    this.choice.value = this.#name ?? playing;
    this.profiles = profiles;
    return playing;
  }

  /** Shows the history of the profile that is open. */
  async #showHistory() {
    const profile = this.profiles.find(({ name }) => name === this.#name);
    if (profile !== undefined) await this.profileHistory.show(profile).catch((error) => this.#tell(error.message));
  }

  #showDraft(sentence, text) {
    this.#told = { sentence };
    announce(sentence);
    this.draft.replace(text, sentence.split(". ")[0]);
  }

  /** Answers a button of the bar. */
  #answer(sentence) {
    this.#tell(sentence);
    announce(sentence);
  }

  /** Opens a profile of this name, or the one in play with null, whatever becomes of the draft; the list is another one. */
  async #reopen(name) {
    this.#name = name;
    const playing = await this.#list();
    await this.#load(name ?? playing);
  }

  async #open(name) {
    if (this.draft.dirty && !(await askDrop(this.#name))) {
      this.choice.value = this.#name;
      return;
    }
    await this.#load(name).catch((error) => this.#tell(error.message));
  }

  async #load(name, text = undefined) {
    this.#reading = true;
    const profile = await readProfile(name).finally(() => { this.#reading = false; });
    this.#opened(name, profile.version, profile.text, text);
    await this.#showHistory();
  }

  #opened(name, version, saved, text) {
    this.#name = name;
    this.#version = version;
    this.choice.value = name;
    this.plateHandles.forget();
    this.forceHandles.forget();
    this.draft.load(saved, text);
  }

  /** Opens a draft that a guide has made; nothing else is shown before it. */
  openDraft(draft) {
    this.#opening = draft;
    location.hash = "#profile";
  }

  async #openWaiting() {
    const { profile, text } = this.#opening;
    this.#opening = null;
    if (this.draft.dirty && !(await askDrop(this.#name))) return;
    await this.#load(profile, text);
  }

  /** Takes the store of drafts that are not saved, and the draft that it found. */
  setDraftStore(store, found) {
    this.#draftStore = store;
    this.#found = found;
    showStored(found);
  }

  #storeDraft() {
    if (this.#name === null || this.#reading) return;
    const { dirty, text } = this.draft;
    this.#draftStore?.store(dirty ? { profile: this.#name, version: this.#version, text, at_ms: Date.now() } : null);
  }

  /** Opens the stored draft as it was left. It is not played: it may be why the bridge was ended. */
  async #openFound() {
    const { profile, version, text, at_ms } = this.#found;
    this.#found = null;
    showStored(null);
    this.#playChanges(false);
    const saved = await readProfile(profile).catch(() => null);
    this.#opened(profile, version, saved?.text ?? "", text);
    const changed = saved?.version === version ? "" : " The file was changed meanwhile: Save asks before it writes.";
    const sentence = `Your draft of ${profile} is here as you left it at ${new Date(at_ms).toLocaleTimeString()}. It is not played before you tick “Play changes at once”; “${DROP}” drops it.${changed}`;
    this.#told = { sentence };
    announce(sentence);
    await this.#showHistory();
  }

  /** The bridge is there again. */
  again() {
    if (this.#name === null) return;
    this.preview.again();
    this.draft.again();
  }

  /** There is no bridge. */
  clear() {
    this.finger?.draw(null, null, null);
    this.forceHandles?.forces.draw(null);
    this.#previewed = false;
    document.getElementById("preview-notice").replaceChildren();
  }

  /** The page goes elsewhere by itself: everything is stored, and nobody is asked. */
  leave() {
    this.#leaving = true;
    return this.#draftStore?.flush();
  }

  #tell(sentence, { offer = undefined, isSpoken = true } = {}) {
    this.#saved = null;
    set(this.message, { "aria-live": isSpoken ? "polite" : "off" });
    say(this.message, sentence);
    this.offered.replaceChildren(...(offer === undefined ? [] : [offer]));
  }

  /** What became of the text that was saved, as long as nothing else is told. */
  #tellSaved(saved) {
    this.#tell(saved !== this.#playing ? "Saved. To play it, choose it on the page Live." : this.#isPaused ? "Saved. tactpad is paused: Go on plays it." : "Saved, and in play.");
    this.#saved = saved;
  }

  #checked() {
    const focus = document.activeElement?.closest?.("[data-handle], [data-field]");
    this.#tell(this.#told.sentence, this.#told);
    // What was changed meanwhile has the same answer.
    if (!this.draft.isUnchecked) this.#told = NOTHING_TOLD;
    this.text.showDiagnostics();
    this.plate.setSketch(this.draft.sketch);
    this.plateHandles.refresh();
    this.forceHandles.refresh();
    this.form.refresh();
    refocus(focus);
    this.preview.follow();
    this.#showState();
  }

  #showState() {
    const { dirty, history, valid } = this.draft;
    this.#offer(this.undo, history.canUndo, `Takes back: ${history.last || "the last change"}. What is saved stays until Save`);
    this.#offer(this.redo, history.canRedo, `Brings back: ${history.next || "what Undo took"}`);
    this.#offer(this.save, dirty && valid);
    this.#offer(this.revert, dirty);
    this.section.classList.toggle("stale", this.draft.stale);
    say(this.state, `${dirty ? "● not saved" : "✓ saved"}${valid ? "" : ", ✕ has errors: see the profile's text"}`);
  }

  #revert() {
    if (!this.draft.dirty) return;
    this.#showDraft("What you changed is dropped: Undo brings it back.", this.draft.saved);
  }

  #playChanges(allowed) {
    this.live.checked = allowed;
    this.preview.enabled = allowed;
    this.preview.follow();
  }

  /** A button that has nothing to do keeps the focus, else keys would lead nowhere after its last use. */
  #offer(button, can, title = "") {
    set(button, { "aria-disabled": !can, title: can ? title : "" });
  }

  #shortcut(event) {
    if (!(event.ctrlKey || event.metaKey) || event.altKey) return;
    const key = event.key.toLowerCase();
    const action = { s: () => this.#save(), y: () => this.draft.move(1), z: () => this.draft.move(event.shiftKey ? 1 : -1) }[key];
    if (action === undefined) return;
    event.preventDefault();
    action();
  }

  async #save() {
    if (this.#name === null || !this.draft.dirty) return;
    await this.#write(this.#name, this.#version);
  }

  async #write(name, version) {
    const { text } = this.draft;
    try {
      const answer = await writeProfile(name, text, version);
      this.#name = name;
      this.#version = answer.version;
      this.draft.markSaved(text);
      this.#playing = await this.#list();
      this.#tellSaved(name);
      this.message.title = answer.path;
      await this.#showHistory();
    } catch (error) {
      await this.#notSaved(error, name, version);
    }
  }

  async #notSaved(error, name, version) {
    location.hash = "#profile";
    if (error.status === 422) {
      const count = error.body.diagnostics.filter(({ severity }) => severity === "error").length;
      return this.#tell(`Not saved: the text has ${plural(count, "error")}.`);
    }
    if (error.status !== 412 || version === null) return this.#tell(`Not saved: ${error.message}`);
    const answer = await askConflict();
    if (answer === "theirs") await this.#load(name);
    if (answer === "overwrite") await this.#write(name, (await readProfile(name)).version);
  }

  async #print() {
    await printSheet(this.draft.text).then((given) => given && this.#tell("The sheet was given to the browser's print window."), (error) => this.#tell(`Not printed: ${error.message}`));
  }

  async #saveAs() {
    const name = await askName(`${this.#name}-2`);
    if (name !== null) await this.#write(name, null);
  }

  /** Takes a frame, drawn or not. */
  take(frame) {
    this.plateBinding?.take(frame);
    this.lastTouch?.take(frame);
  }

  /** Follows the finger. */
  draw(frame) {
    if (this.text === undefined || frame === undefined) return;
    this.finger.draw(frame.contact, frame.uncertainty, null);
    this.forceHandles.forces.draw(frame.contact);
    this.form.follow(frame);
    this.form.showPress(this.lastTouch);
    say(this.touched, this.#isPaused ? "tactpad is paused: nothing is pressed until Go on." : this.lastTouch.sentence(this.draft.sketch));
  }

  /** Says at the foot of every view when a draft is played. */
  setStatus({ status: { preview, state } }) {
    this.#isPaused = state === "paused";
    if (this.#saved !== null) this.#tellSaved(this.#saved);
    if (preview === this.#previewed) return;
    this.#previewed = preview;
    const notice = document.getElementById("preview-notice");
    const sentence = "What you changed is in play, and not saved yet.";
    const ends = [button("Save", () => this.#save(), { class: "main primary" }), button(DROP, () => this.#revert(), { class: "main" })];
    notice.replaceChildren(...(preview ? [el("span", { text: `◐ ${sentence}` }), ...ends] : []));
    announce(preview ? sentence : "The saved profile is played.");
  }
}

/** Says in every view that a draft is kept. */
function showStored(found) {
  const notice = document.getElementById("draft-notice");
  if (found !== null) announce(`A draft of ${found.profile} that was not saved is kept.`);
  notice.replaceChildren(...(found === null ? [] : [el("span", { text: `● A draft of ${found.profile} that was not saved is kept.` }), " ",
    el("a", { class: "action", href: "#profile", text: "Open the draft" })]));
}

/** Gives the focus back to a handle or field that was made anew. */
function refocus(before) {
  if (!before || before.isConnected) return;
  const name = before.dataset.handle === undefined ? `[data-field="${before.dataset.field}"]` : `[data-handle="${before.dataset.handle}"]`;
  document.querySelector(name)?.focus();
}
