// The live socket: one listener list per kind of message, a ping each second, and a new try each second after a loss.

import { get, liveAddress } from "./api.js";
import { FrameAges, HostClock } from "./clock.js";

const AGAIN_MS = 1000;
const PING_MS = 1000;

export class Live {
  /** @type {Map<string, ((message: any) => void)[]>} */
  #listeners = new Map();
  #socket = null;
  #clock = new HostClock();
  #stopped = false;
  ages = new FrameAges();

  /** Calls `listener` with each message of this kind; "open" and "lost" are told, too. */
  on(kind, listener) {
    this.#listeners.set(kind, [...(this.#listeners.get(kind) ?? []), listener]);
  }

  start() {
    setInterval(() => this.#ping(), PING_MS);
    this.#open();
  }

  /** No further tries: the token is not known. */
  stop() {
    this.#stopped = true;
    this.#socket?.close();
  }

  #tell(kind, message) {
    for (const listener of this.#listeners.get(kind) ?? []) listener(message);
  }

  #open() {
    if (this.#stopped) return;
    const socket = new WebSocket(liveAddress());
    this.#socket = socket;
    socket.addEventListener("open", () => this.#opened());
    socket.addEventListener("message", (event) => this.#take(JSON.parse(event.data)));
    socket.addEventListener("close", () => this.#lost());
  }

  #opened() {
    this.#clock.reset();
    this.#ping();
    this.#tell("open", null);
  }

  #lost() {
    this.#tell("lost", null);
    if (this.#stopped) return;
    // A socket does not say why it was refused; a request does.
    get("/api/status").catch(() => {});
    setTimeout(() => this.#open(), AGAIN_MS);
  }

  #ping() {
    if (this.#socket?.readyState === WebSocket.OPEN) this.#socket.send(JSON.stringify(this.#clock.ping()));
  }

  #take(message) {
    if (message.kind === "pong") this.#clock.pong(message);
    if (message.kind === "frame") {
      this.ages.take(this.#clock.ageMs(message.host_us));
      document.documentElement.dataset.updates = String(this.ages.count);
    }
    this.#tell(message.kind, message);
  }
}
