// What the program says of itself: state, pad, decoder, output, profile, counters; and the buttons that command it.

import { announce } from "../common/announce.js";
import { get, post } from "../link/api.js";
import { button, el, number, row, say, scroller, set, table } from "../common/dom.js";
import { capital } from "../common/words.js";
import { duration } from "./latency.js";

const SIGNS = { playing: "▶", paused: "❚❚", taring: "◌", unweighed: "◌", weighing: "◌", waiting: "…", loaded: "⚠", doubtful: "⚠", denied: "✕", unclear: "⚠", silent: "⚠", faulty: "✕", refused: "✕" };
const GOOD = new Set(["playing"]);
const BAD = new Set(["denied", "faulty", "refused"]);

/** What a player sees of the profile, and what tells how it is played. */
const PLAYED = [["profile", "Profile"], ["profile_reason", "Chosen"], ["layer", "Layer"]];
const SETUP = [["pad", "Pad"], ["decoder", "Decoder"], ["output", "Output"]];

/** Sends a command and says what came of it. */
export async function command(path, done, body = {}) {
  try {
    await post(path, body);
    failure("");
    announce(done);
    return true;
  } catch (error) {
    failure(error.message);
    return false;
  }
}

/** Shows a sentence about a command that failed, until one is obeyed. */
export function failure(sentence) {
  say(document.getElementById("failure"), sentence === "" ? "" : `✕ ${sentence}`);
}

/** Where presses go that reach no game; null where they reach one. @param {string} output */
export const beyondGames = (output) => (output === "no output" ? "nowhere" : output.startsWith("event log") ? "to an event log" : null);

/** What keeps presses back, and what to do. */
export function stateInWords({ state, sentence }) {
  const why = capital(state === "paused" ? "paused: press Go on" : sentence ?? state);
  return why.includes("nothing is pressed") ? `${why}.` : `${why}. Until then nothing is pressed.`;
}

export class Status {
  #state = null;

  constructor() {
    this.sign = el("span", { class: "state-sign", "aria-hidden": "true" });
    this.word = el("strong", { id: "state", text: "loading" });
    this.reach = el("span", { id: "reach" });
    this.sentence = el("p", { class: "state-sentence", hidden: true });
    this.lines = new Map([...PLAYED, ...SETUP].map(([key]) => [key, el("dd")]));
    this.setup = this.#list(SETUP);
    this.error = el("p", { class: "bad", hidden: true });
    this.choice = el("select", { id: "profile-choice", class: "main", onchange: () => this.#choose() }, el("option", { text: "loading" }));
    this.pause = button("Pause", () => this.#pause(), { id: "pause", class: "main" });
    document.getElementById("now").append(el("p", { class: "state warn" }, this.sign, this.word, this.reach), this.pause);
    this.node = el("div", { class: "card status", hidden: true },
      el("h3", { class: "unseen", text: "State" }),
      this.sentence,
      el("div", { class: "commands" },
        el("label", { class: "chooser" }, "Profile in play ", this.choice),
        button("Next profile", () => this.#next(), { id: "next-profile", class: "main" }),
        el("a", { class: "action", href: "#profile", text: "Change its settings" }),
        button("Measure the zero", () => command("/api/tare", "Measuring the zero: leave the pad alone."), { id: "tare", class: "main" }),
        button("Release everything", () => command("/api/panic", "Everything is released."), { id: "panic", class: "main" })),
      this.#list(PLAYED), this.error);
    this.#makeCounters();
  }

  #list(lines) {
    return el("dl", { class: "lines" }, ...lines.map(([key, name]) => el("div", {}, el("dt", { text: name }), this.lines.get(key))));
  }

  #makeCounters() {
    const { node, body } = table("Counters", ["What", "Count"], { class: "figures" });
    this.counters = scroller("Counters", node);
    this.countersBody = body;
  }

  /** Asks which profiles there are. */
  async listProfiles() {
    try {
      const { profiles, playing } = await get("/api/profiles");
      this.choice.replaceChildren(...profiles.map(({ name, own }) => el("option", { value: name, text: own ? `${name} (yours)` : name })));
      this.choice.value = playing;
    } catch (error) {
      // That there is no answer is told already.
      if (error.status !== 0) failure(error.message);
    }
  }

  #choose() {
    command("/api/play", `${this.choice.value} is played.`, { name: this.choice.value });
  }

  /** The one below in the list; the first follows the last. */
  #next() {
    const { options, selectedIndex } = this.choice;
    if (options.length === 0) return;
    this.choice.selectedIndex = (selectedIndex + 1) % options.length;
    this.#choose();
  }

  #pause() {
    const paused = this.#state === "paused";
    command(paused ? "/api/resume" : "/api/pause", paused ? "It goes on." : "Paused.");
  }

  /** Shows a status message. */
  draw({ status }) {
    this.node.hidden = false;
    if (status.state !== this.#state) this.#changed(status);
    this.#explain(GOOD.has(status.state) ? "" : stateInWords(status));
    for (const [key, node] of this.lines) {
      const text = status[key] ?? (key === "pad" ? status.described?.title : null) ?? null;
      say(node, text ?? "–");
      set(node.parentElement, { "data-empty": text === null });
    }
    if (document.activeElement !== this.choice && status.profile_id) this.choice.value = status.profile_id;
    this.error.hidden = !status.profile_error;
    say(this.error, status.profile_error ? `✕ ${status.profile_error}` : "");
    this.#count(status);
  }

  /** Nothing is known any more. */
  clear() {
    this.#state = null;
    say(this.sign, "✕");
    say(this.word, "not connected");
    say(this.reach, "");
    this.#explain("");
    this.sign.parentElement.className = "state bad";
    for (const node of this.lines.values()) say(node, "–");
    say(this.pause, "Pause");
    this.error.hidden = true;
    this.countersBody.replaceChildren();
  }

  #explain(sentence) {
    this.sentence.hidden = sentence === "";
    say(this.sentence, sentence);
  }

  #changed({ state, sentence, output }) {
    if (this.#state !== null) announce(sentence ?? state);
    this.#state = state;
    say(this.word, state);
    say(this.sign, SIGNS[state] ?? "?");
    const isForNothing = GOOD.has(state) && beyondGames(output) !== null;
    say(this.reach, isForNothing ? "reaches no game" : "");
    this.sign.parentElement.className = `state ${isForNothing ? "warn" : GOOD.has(state) ? "good" : BAD.has(state) ? "bad" : "warn"}`;
    say(this.pause, state === "paused" ? "Go on" : "Pause");
  }

  #count({ presses, health, latency_us }) {
    const counts = [["presses accepted", presses?.accepted], ["presses rejected", presses?.rejected], ...Object.entries(health ?? {})]
      .filter(([, count]) => count !== undefined)
      .map(([name, count]) => [name.replaceAll("_", " "), number(count, 0)]);
    if (latency_us) counts.push(["latency p95", duration(latency_us.p95)]);
    if (this.countersBody.rows.length !== counts.length) this.countersBody.replaceChildren(...counts.map(row));
    counts.forEach(([name, count], index) => {
      const cells = this.countersBody.rows[index].cells;
      say(cells[0], name);
      say(cells[1], count);
    });
  }
}
