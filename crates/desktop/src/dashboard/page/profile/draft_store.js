// The store of drafts that are not saved, in this browser: one of each tab, by profile and version.
//
// They are encrypted, as whoever answers at this address later can read what is stored for it. Their key comes from the program. When the page
// moves to another address, they go along in its fragment, behind the view's name, which no server sees.

import { hex } from "../link/handshake.js";

const ENTRY = "tactpad-draft-";
const TAB = "tactpad-tab";
const FRAGMENT = "&drafts=";
const NAME = /^[0-9a-f]{32}$/;
const NONCE_BYTES = 12;
const FRAGMENT_DRAFTS_MAX = 8;

/** @typedef {{ profile: string, version: string | null, text: string, at_ms: number }} StoredDraft */

const toText = (bytes) => btoa(Array.from(bytes, (byte) => String.fromCharCode(byte)).join("")).replaceAll("+", "-").replaceAll("/", "_").replaceAll("=", "");
const toBytes = (text) => Uint8Array.from(atob(text.replaceAll("-", "+").replaceAll("_", "/")), (letter) => letter.charCodeAt(0));
const names = () => Object.keys(localStorage).filter((entry) => entry.startsWith(ENTRY)).map((entry) => entry.slice(ENTRY.length));

/** Holds a draft's name as long as this tab lives; says whether no other tab has it. */
function claim(name) {
  return new Promise((done) => {
    navigator.locks.request(ENTRY + name, { ifAvailable: true }, (lock) => {
      done(lock !== null);
      return lock === null ? undefined : new Promise(() => {});
    });
  });
}

export class DraftStore {
  #key;
  /** The name of this tab's entry. */
  #name = "";
  /** The draft that is to be stored next, null if none is; undefined if nothing waits. @type {StoredDraft | null | undefined} */
  #next = undefined;
  #writing = Promise.resolve();

  /**
   * Takes drafts out of the fragment, and becomes the owner of one entry: this tab's, else the newest that no open tab has.
   * @param {CryptoKey} key
   * @returns {Promise<{ store: DraftStore, found: StoredDraft | null }>}
   */
  static async open(key) {
    const store = new DraftStore();
    store.#key = key;
    await store.#takeFragment();
    const found = await store.#adopt();
    return { store, found };
  }

  async #takeFragment() {
    const [view, drafts] = location.hash.split(FRAGMENT);
    if (drafts === undefined) return;
    const entries = drafts.split(",").slice(0, FRAGMENT_DRAFTS_MAX).map((entry) => entry.split("."));
    for (const [name, cipher] of entries) {
      if (NAME.test(name) && await this.#read(cipher) !== null) localStorage.setItem(ENTRY + name, cipher);
    }
    if (NAME.test(entries[0]?.[0])) sessionStorage.setItem(TAB, entries[0][0]);
    history.replaceState(null, "", view);
  }

  async #adopt() {
    const own = sessionStorage.getItem(TAB);
    const all = await Promise.all(names().map(async (name) => ({ name, draft: await this.#read(localStorage.getItem(ENTRY + name)) })));
    const readable = all.filter(({ draft }) => draft !== null).sort((a, b) => (b.name === own) - (a.name === own) || b.draft.at_ms - a.draft.at_ms);
    for (const { name, draft } of readable) if (await claim(name)) return this.#become(name, draft);
    const name = own !== null && await claim(own) ? own : hex(crypto.getRandomValues(new Uint8Array(16)));
    if (name !== own) await claim(name);
    return this.#become(name, null);
  }

  #become(name, draft) {
    this.#name = name;
    sessionStorage.setItem(TAB, name);
    return draft;
  }

  /** What an entry says, or null if it is not one of this user's. @returns {Promise<StoredDraft | null>} */
  async #read(cipher) {
    try {
      const bytes = toBytes(cipher);
      const plain = await crypto.subtle.decrypt({ name: "AES-GCM", iv: bytes.slice(0, NONCE_BYTES) }, this.#key, bytes.slice(NONCE_BYTES));
      return JSON.parse(new TextDecoder().decode(plain));
    } catch {
      return null;
    }
  }

  /** Stores this draft in place of the one before; null removes it. The newest one wins. */
  store(draft) {
    const waits = this.#next !== undefined;
    this.#next = draft;
    if (!waits) this.#writing = this.#writing.then(() => this.#write());
  }

  async #write() {
    const draft = this.#next;
    this.#next = undefined;
    try {
      if (draft === null) return localStorage.removeItem(ENTRY + this.#name);
      const iv = crypto.getRandomValues(new Uint8Array(NONCE_BYTES));
      const plain = new TextEncoder().encode(JSON.stringify(draft));
      const cipher = new Uint8Array(await crypto.subtle.encrypt({ name: "AES-GCM", iv }, this.#key, plain));
      localStorage.setItem(ENTRY + this.#name, toText(new Uint8Array([...iv, ...cipher])));
    } catch {
      // A browser that stores nothing, or has no room: the draft is in this page alone.
    }
  }

  /** Waits until everything is stored that was given. */
  flush() {
    return this.#writing;
  }
}

/** Takes this tab's draft, and those that no open tab has, out of the store, as the fragment of an address. */
export async function takeAsFragment() {
  const { held } = await navigator.locks.query();
  const open = new Set(held.map(({ name }) => name));
  const own = sessionStorage.getItem(TAB);
  const free = names().filter((name) => name !== own && !open.has(ENTRY + name));
  const going = [own, ...free].filter((name) => name !== null && localStorage.getItem(ENTRY + name) !== null).slice(0, FRAGMENT_DRAFTS_MAX);
  const entries = going.map((name) => `${name}.${localStorage.getItem(ENTRY + name)}`);
  for (const name of going) localStorage.removeItem(ENTRY + name);
  const passing = location.hash.split(FRAGMENT)[1];
  const all = passing === undefined ? entries : [passing, ...entries];
  return all.length === 0 ? "" : `${FRAGMENT}${all.join(",")}`;
}
