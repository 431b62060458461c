// What went out: lanes of the last ten seconds, one for each control, and a table of the newest events.

import { colour } from "../common/colours.js";
import { el, number, row, say, scroller, table } from "../common/dom.js";
import { pressInWords } from "../common/announce.js";

const WINDOW_US = 10_000_000;
const LANE_PX = 22;
const NAME_PX = 112;
const NEWEST = 12;
const MOST_LANES = 12;
/** Controls that move without being pressed would fill the table. */
const MOVING = /^(REL_[XY]|ABS_(X|Y|Z|RX|RY|RZ)|REL_WHEEL_HI_RES|SYN_.*)$/;

/** The controls that an event lets down and up: the halves of a hat are two. */
function levels({ code, value, names: [below, above] }) {
  if (!code.startsWith("ABS_HAT")) return [{ control: above, down: value !== 0 }];
  return [{ control: below, down: value < 0 }, { control: above, down: value > 0 }];
}

export class EventLanes {
  /** @type {Map<string, { from_us: number, to_us: number | null }[]>} */
  #lanes = new Map();
  /** @type {{ t_us: number, what: string }[]} */
  #rejected = [];
  #newest = [];
  #fresh = true;
  #now_us = 0;

  constructor() {
    this.canvas = el("canvas", { class: "lanes", role: "img", "aria-label": "Controls that were down in the last ten seconds; the table below tells the newest." });
    this.context = this.canvas.getContext("2d");
    this.table = table("Newest events", ["Before", "What", "Now"]);
    this.node = el("div", { class: "events" }, this.canvas, scroller("Newest events", this.table.node));
  }

  /** Takes a frame's events and presses. */
  take({ t_us, events, presses }) {
    if (t_us < this.#now_us) this.#restart();
    this.#now_us = t_us;
    for (const event of events) if (!MOVING.test(event.code)) this.#event(event);
    for (const press of presses) if (press.press !== "accepted") this.#press(press);
  }

  /** Shows none. */
  clear() {
    this.#restart();
    this.draw();
  }

  #restart() {
    this.#lanes.clear();
    this.#rejected = [];
    this.#newest = [];
    this.#fresh = true;
  }

  #event(event) {
    for (const { control, down } of levels(event)) {
      const lane = this.#lanes.get(control) ?? [];
      const open = lane.at(-1)?.to_us === null ? lane.at(-1) : null;
      if (down === (open !== null)) continue;
      if (down) lane.push({ from_us: event.t_us, to_us: null });
      else open.to_us = event.t_us;
      this.#lanes.set(control, lane);
      this.#tell(event.t_us, control, down ? "pressed" : "let go");
    }
  }

  #press(press) {
    if (press.press === "rejected") this.#rejected.push({ t_us: press.t_us });
    this.#tell(press.t_us, pressInWords(press), press.press);
  }

  #tell(t_us, what, now) {
    this.#newest.unshift({ t_us, what, now });
    this.#newest.length = Math.min(this.#newest.length, NEWEST);
    this.#fresh = true;
  }

  draw() {
    const since = this.#now_us - WINDOW_US;
    for (const [control, lane] of this.#lanes) {
      while (lane.length > 0 && lane[0].to_us !== null && lane[0].to_us < since) lane.shift();
      if (lane.length === 0 && this.#lanes.size > MOST_LANES) this.#lanes.delete(control);
    }
    while (this.#rejected.length > 0 && this.#rejected[0].t_us < since) this.#rejected.shift();
    this.#drawLanes();
    this.#drawTable();
  }

  #drawTable() {
    if (this.#fresh) {
      this.#fresh = false;
      this.table.body.replaceChildren(...this.#newest.map(({ what, now }) => row(["", what, now])));
    }
    const rows = this.table.body.rows;
    for (let index = 0; index < rows.length; index += 1) {
      say(rows[index].cells[0], `${number((this.#now_us - this.#newest[index].t_us) / 1e6, 1)} s`);
    }
  }

  #fit(lanes) {
    const ratio = devicePixelRatio;
    const width = this.canvas.clientWidth;
    const height = Math.max(lanes, 3) * LANE_PX + 18;
    const [w, h] = [Math.round(width * ratio), Math.round(height * ratio)];
    if (this.canvas.width !== w || this.canvas.height !== h) {
      this.canvas.width = w;
      this.canvas.height = h;
      this.canvas.style.height = `${height}px`;
    }
    this.context.setTransform(ratio, 0, 0, ratio, 0, 0);
    this.context.clearRect(0, 0, width, height);
    return { width, height };
  }

  #drawLanes() {
    const names = [...this.#lanes.keys()].sort();
    const { width, height } = this.#fit(names.length + 1);
    const x = (t_us) => NAME_PX + Math.max(0, 1 - (this.#now_us - t_us) / WINDOW_US) * (width - NAME_PX - 4);
    this.#drawGrid(x, height);
    names.forEach((name, lane) => this.#drawLane(name, lane * LANE_PX, x));
    this.#drawRejected(names.length * LANE_PX, x);
  }

  #drawGrid(x, height) {
    const context = this.context;
    context.font = "11px system-ui, sans-serif";
    context.textBaseline = "middle";
    for (let back = 0; back <= 10; back += 2) {
      const at = x(this.#now_us - back * 1e6);
      context.fillStyle = colour("--line");
      context.fillRect(Math.round(at), 0, 1, height - 18);
      context.fillStyle = colour("--quiet");
      context.textAlign = back === 0 ? "right" : "center";
      context.fillText(back === 0 ? "now" : `−${back} s`, at, height - 8);
    }
  }

  #drawLane(name, top, x) {
    const context = this.context;
    const lane = this.#lanes.get(name);
    const down = lane.at(-1)?.to_us === null;
    context.textAlign = "left";
    context.font = `${down ? "bold " : ""}11px system-ui, sans-serif`;
    context.fillStyle = colour(down ? "--ink" : "--quiet");
    context.fillText(`${down ? "● " : ""}${name}`, 0, top + LANE_PX / 2, NAME_PX - 6);
    context.fillStyle = colour("--accent");
    for (const { from_us, to_us } of lane) {
      const from = x(from_us);
      context.fillRect(from, top + 4, Math.max(x(to_us ?? this.#now_us) - from, 2), LANE_PX - 8);
    }
  }

  #drawRejected(top, x) {
    if (this.#rejected.length === 0) return;
    const context = this.context;
    context.font = "11px system-ui, sans-serif";
    context.fillStyle = colour("--bad");
    context.textAlign = "left";
    context.fillText("rejected", 0, top + LANE_PX / 2);
    context.textAlign = "center";
    for (const { t_us } of this.#rejected) context.fillText("✕", x(t_us), top + LANE_PX / 2);
  }
}
