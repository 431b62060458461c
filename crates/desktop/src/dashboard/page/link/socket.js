// The live socket: one listener list per kind of message, a ping each second, and after a loss a handshake each second until the program is there.

import { liveAddress, setConnected, setToken } from "./api.js";
import { FrameAges, HostClock } from "./clock.js";
import { handshake } from "./handshake.js";

const AGAIN_MS = 1000;
const PING_MS = 1000;
/** So many pings without a message, which come four times as often: the program stands still. Counting pings lets a machine sleep. */
const SILENT_PINGS = 4;

export class Live {
  /** @type {Map<string, ((message: any) => void)[]>} */
  #listeners = new Map();
  #socket = null;
  #clock = new HostClock();
  #silentPings = 0;
  #heard = false;
  /** Why there is no answer: "lost" or "stalled". */
  #gone = "lost";
  ages = new FrameAges();

  /** Calls `listener` with each message of this kind; "open", "lost" (its end is closed), "stalled" (no answer), "shut" (it is there, and lets no page in) and
   * "moved" are told, too. */
  on(kind, listener) {
    this.#listeners.set(kind, [...(this.#listeners.get(kind) ?? []), listener]);
  }

  start() {
    setInterval(() => this.#tick(), PING_MS);
    this.#open();
  }

  #tell(kind, message) {
    for (const listener of this.#listeners.get(kind) ?? []) listener(message);
  }

  #open() {
    const socket = new WebSocket(liveAddress());
    this.#socket = socket;
    this.#heard = false;
    this.#silentPings = 0;
    socket.addEventListener("open", () => this.#opened(socket));
    socket.addEventListener("message", (event) => socket === this.#socket && this.#take(JSON.parse(event.data)));
    socket.addEventListener("close", () => this.#lost(socket, this.#heard ? "lost" : "shut"));
  }

  #opened(socket) {
    if (socket !== this.#socket) return;
    this.#heard = true;
    this.#clock.reset();
    this.#ping();
    this.#tell("open", null);
  }

  /** Nothing is asked any more before the program has proven itself. */
  #lost(socket, how) {
    if (socket !== this.#socket) return;
    this.#socket = null;
    this.#gone = how === "stalled" ? how : "lost";
    setConnected(false);
    this.#tell(how, null);
    setTimeout(() => this.#seek(), AGAIN_MS);
  }

  /** Tries the handshake each second, until it is the program that answers. */
  async #seek() {
    const answer = await handshake({ isFresh: false });
    if (answer === null) {
      this.#tell(this.#gone, null);
      setTimeout(() => this.#seek(), AGAIN_MS);
    } else if (answer.origin !== location.origin) {
      this.#tell("moved", answer.origin);
    } else {
      setToken(answer.token);
      setConnected(true);
      this.#open();
    }
  }

  #tick() {
    if (this.#socket?.readyState !== WebSocket.OPEN) return;
    this.#silentPings += 1;
    if (this.#silentPings > SILENT_PINGS) {
      const silent = this.#socket;
      // A program that stands still does not close its end.
      silent.close();
      this.#lost(silent, "stalled");
    } else this.#ping();
  }

  #ping() {
    if (this.#socket?.readyState === WebSocket.OPEN) this.#socket.send(JSON.stringify(this.#clock.ping()));
  }

  #take(message) {
    this.#silentPings = 0;
    if (message.kind === "pong") this.#clock.pong(message);
    if (message.kind === "frame") {
      this.ages.take(this.#clock.ageMs(message.host_us));
      document.documentElement.dataset.updates = String(this.ages.count);
    }
    this.#tell(message.kind, message);
  }
}
