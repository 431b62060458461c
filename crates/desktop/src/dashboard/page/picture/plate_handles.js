// The handles on the plate of the editor: the hand's centre, directions, zones.

import { el, svg } from "../common/dom.js";
import { middleDeg, near, polar, seenFrom } from "./geometry.js";
import { Handle } from "./handles.js";
import { mirror, sameTurn, tablesOf } from "../fields/values.js";

const RIM_MM = 32.5;
const HIT_MM = 3.3;
const FAR_MM = 33;
const ARM_MM = 5;
/** A word that is pressed is dragged from here on. */
const DRAG_PX = 4;
/** The handle that turns directions leaves room for the word of the first. */
const BESIDE_WORD_DEG = 12;

export class PlateHandles {
  /** @type {Handle[]} */
  #handles = [];
  #shape = "";
  #shapes = new Set();
  /** The one that turns directions. @type {Handle | null} */
  #turning = null;
  /** How far beside the turn it is held. */
  #held_deg = BESIDE_WORD_DEG;
  /** Where a word was pressed that may be dragged. @type {PointerEvent | null} */
  #word = null;

  /** @param {import("./plate.js").Plate} plate @param {import("../fields/values.js").Values} values */
  constructor(plate, values) {
    this.plate = plate;
    this.values = values;
    this.legend = el("ul", { class: "legend", "aria-label": "Handles on the plate" });
    plate.node.addEventListener("pointerdown", (event) => this.#down(event));
    plate.node.addEventListener("pointermove", (event) => this.#moved(event));
  }

  /** A word of a direction is held like the square; a click on it is none. */
  #down(event) {
    const onWord = event.button === 0 && this.#turning !== null && event.target.closest("[data-direction]") && !this.plate.node.classList.contains("asks");
    this.#held_deg = onWord ? seenFrom(this.#centre, this.plate.at(event)).deg - this.#turn : BESIDE_WORD_DEG;
    this.#word = onWord ? event : null;
  }

  #moved(event) {
    if (this.#word === null || Math.hypot(event.clientX - this.#word.clientX, event.clientY - this.#word.clientY) < DRAG_PX) return;
    this.#word = null;
    if (event.buttons === 1) this.#turning.grab(event);
  }

  get #centre() {
    const { mirrored } = this.values;
    return [mirror.sign(mirrored, this.values.at(["centre_x_mm"])), this.values.at(["centre_y_mm"])];
  }

  get #turn() {
    return mirror.sign(this.values.mirrored, this.values.at(["dpad", "rotation_deg"]));
  }

  /** Shows the draft's values; makes handles anew when the profile has other parts. */
  refresh() {
    const { document } = this.values.draft;
    if (document === null) return;
    const shape = JSON.stringify([document.dpad?.mode ?? typeof document.dpad, typeof document.pointer,
      tablesOf(document, "stick").map(({ from }) => from), tablesOf(document, "zone").map(({ name, from_deg }) => [name, from_deg !== undefined])]);
    if (shape !== this.#shape) this.#make(document, shape);
    for (const handle of this.#handles) handle.refresh();
  }

  /** Makes all handles anew the next time: another profile. */
  forget() {
    this.#shape = "";
    this.#handles = [];
    this.plate.layers.handles.replaceChildren();
  }

  #make(document, shape) {
    this.#shape = shape;
    this.#handles = [];
    this.#turning = null;
    this.plate.layers.handles.replaceChildren();
    this.#shapes = new Set();
    this.#makeCentre();
    if (document.dpad !== undefined) this.#makeDirections(document.dpad.mode ?? "4way");
    tablesOf(document, "zone").forEach((zone, index) => this.#makeZone(zone, index));
    if (document.pointer !== undefined) this.#makePair(["pointer"], "Pointer", 20);
    tablesOf(document, "stick").forEach(({ stick, from }, index) => {
      if (from !== "shear") this.#makePair(["stick", index], `${stick} stick`, 150 + 15 * index);
    });
    this.legend.replaceChildren(...LEGEND.filter(([shape]) => this.#shapes.has(shape)).map(([shape, words]) => (
      el("li", {}, svg("svg", { viewBox: "-2.2 -2.2 4.4 4.4", "aria-hidden": "true" }, svg("path", { class: "handle-shape", d: shape })), words))));
  }

  /** The two radii of what moves with the place: where it rests, and where it is at its end. */
  #makePair(table, name, deg) {
    for (const [key, what] of [["centre_radius_mm", "rests up to here"], ["full_radius_mm", "at its end from here"]]) {
      this.#add([...table, key], `${name}: ${what}`, RING,
        (value) => polar(this.#centre, deg, value), (point) => seenFrom(this.#centre, point).radius_mm);
    }
  }

  /** One handle of a shape, where `at` says for a value; `read` gives the value at a place of the picture. */
  #add(path, label, shape, at, read) {
    this.#shapes.add(shape);
    const element = svg("g", {}, svg("circle", { class: "handle-hit", r: HIT_MM }), svg("path", { class: "handle-shape", d: shape }), svg("title", { text: label }));
    this.plate.layers.handles.append(element);
    const place = (value) => {
      const { x, y } = at(value);
      element.setAttribute("transform", `translate(${x.toFixed(3)} ${y.toFixed(3)})`);
    };
    const valueAt = (event) => read(this.plate.at(event));
    this.#handles.push(new Handle(element, { path, label, place, valueAt }, this.values));
  }

  #makeCentre() {
    const { values } = this;
    const y = () => -values.at(["centre_y_mm"]);
    const x = () => this.#centre[0];
    this.#add(["centre_x_mm"], "Centre of the hand, to the right", ARROWS_X,
      (value) => ({ x: mirror.sign(values.mirrored, value) + ARM_MM, y: y() }),
      (point) => mirror.sign(values.mirrored, point.x - ARM_MM));
    this.#add(["centre_y_mm"], "Centre of the hand, upwards", ARROWS_Y,
      (value) => ({ x: x(), y: -value - ARM_MM }),
      (point) => -point.y - ARM_MM);
  }

  #makeDirections(mode) {
    const { values } = this;
    const path = (key) => ["dpad", key];
    const radius = () => values.at(path("centre_radius_mm"));
    this.#add(path("centre_radius_mm"), "Radius where directions start", RING,
      (value) => polar(this.#centre, -60, value), (point) => seenFrom(this.#centre, point).radius_mm);
    this.#add(path("radius_hysteresis_mm"), "By how much closer directions end", RING,
      (value) => polar(this.#centre, 225, radius() - value), (point) => radius() - seenFrom(this.#centre, point).radius_mm);
    this.#add(path("rotation_deg"), "Turn of all directions", TURN,
      (value) => onRim(this.#centre, mirror.sign(values.mirrored, value) + BESIDE_WORD_DEG),
      (point) => mirror.sign(values.mirrored, near(seenFrom(this.#centre, point).deg - this.#held_deg, this.#turn)));
    this.#turning = this.#handles.at(-1);
    if (mode === "4way") return;
    this.#add(path("diagonal_deg"), "Width of the diagonals", DIAMOND,
      (value) => onRim(this.#centre, this.#turn + 45 + value / 2),
      (point) => 2 * Math.abs(near(seenFrom(this.#centre, point).deg, this.#turn + 45) - this.#turn - 45));
  }

  #makeZone({ name, from_deg }, index) {
    const path = (key) => ["zone", index, key];
    if (from_deg !== undefined) {
      this.#makeEdge(path("from_deg"), `Zone ${name}: first edge`);
      this.#makeEdge(path("to_deg"), `Zone ${name}: second edge`);
    }
    this.#makeRadius(path("inner_radius_mm"), `Zone ${name}: inner radius`, index);
    this.#makeRadius(path("outer_radius_mm"), `Zone ${name}: outer radius`, index);
  }

  #makeEdge(path, label) {
    const { values } = this;
    const middle = () => Math.min(28, (values.at([...path.slice(0, 2), "inner_radius_mm"]) + Math.min(30, values.at([...path.slice(0, 2), "outer_radius_mm"]))) / 2 + 4);
    this.#add(path, label, DIAMOND,
      (value) => polar(this.#centre, mirror.deg(values.mirrored, value), middle()),
      (point) => sameTurn(mirror.deg(values.mirrored, seenFrom(this.#centre, point).deg), values.at(path), values.limits(path)));
  }

  #makeRadius(path, label, index) {
    const { values } = this;
    const zone = (key) => values.at(["zone", index, key]);
    const deg = () => (zone("from_deg") === undefined ? 60 + 20 * index : mirror.deg(values.mirrored, middleDeg(zone("from_deg"), zone("to_deg"))));
    this.#add(path, label, RING,
      (value) => polar(this.#centre, deg(), Math.min(value, FAR_MM)),
      (point) => seenFrom(this.#centre, point).radius_mm);
  }
}

const DIAMOND = "M0-1.5L1.5 0L0 1.5L-1.5 0Z";
const RING = "M1.2 0A1.2 1.2 0 1 0-1.2 0A1.2 1.2 0 1 0 1.2 0Z";
const TURN = "M-1.3-1.3H1.3V1.3H-1.3Z";
const ARROWS_X = "M-1.9 0L-.5-1.2V1.2ZM1.9 0L.5-1.2V1.2Z";
const ARROWS_Y = "M0-1.9L-1.2-.5H1.2ZM0 1.9L-1.2 .5H1.2Z";
/** What each shape changes. */
const LEGEND = [[ARROWS_X, "where the hand has its middle"], [RING, "how far out"], [DIAMOND, "how wide around the plate"], [TURN, "turns all directions. Drag a word: all turn together; one alone cannot be moved"]];

/** Just outside of the plate in a direction from the hand's centre. */
function onRim(centre, deg) {
  const far = polar(centre, deg, 1);
  const [dx, dy] = [far.x - centre[0], far.y + centre[1]];
  const [cx, cy] = [centre[0], -centre[1]];
  const along = cx * dx + cy * dy;
  const reach = -along + Math.sqrt(Math.max(along * along - (cx * cx + cy * cy) + RIM_MM * RIM_MM, 0));
  return { x: cx + dx * reach, y: cy + dy * reach };
}
