// Plays the draft while it is edited: at most one request in 40 ms, the latest text wins.

import { request } from "../link/api.js";

const BETWEEN_MS = 40;

export class Preview {
  /** The text that was sent last, or null while the file is played. */
  #sent = null;
  /** The text that shall be played, or null for the file. */
  #wanted = null;
  #running = false;
  enabled = true;

  /** @param {import("./draft.js").Draft} draft @param {(sentence: string) => void} failed */
  constructor(draft, failed) {
    this.draft = draft;
    this.failed = failed;
  }

  /** Follows the draft: what cannot be played leaves the last one that could. */
  follow() {
    if (!this.enabled || !this.draft.dirty) this.#want(null);
    else if (this.draft.valid) this.#want(this.draft.text);
  }

  /** The connection was lost, and with it the preview; it begins anew. */
  again() {
    this.#sent = null;
    this.follow();
  }

  #want(text) {
    this.#wanted = text;
    if (!this.#running) this.#run();
  }

  async #run() {
    this.#running = true;
    while (this.#wanted !== this.#sent) {
      const text = this.#wanted;
      this.#sent = text;
      try {
        await (text === null ? request("DELETE", "/api/preview") : request("POST", "/api/preview", { text }));
      } catch (error) {
        this.failed(error.message);
      }
      await new Promise((done) => setTimeout(done, BETWEEN_MS));
    }
    this.#running = false;
  }
}
