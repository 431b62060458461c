// The picture of the plate: the disc, directions, zones, rings, names and the centre of the hand.

import { set, svg } from "../common/dom.js";
import { PLATE_RADIUS_MM, ringPath, sectorPath } from "./geometry.js";

const FAR_MM = 80;
const LINE_EM = 1.2;
let plates = 0;

export class Plate {
  /** @param {string} label what the picture shows, for those who do not see it */
  constructor(label) {
    const clip = `plate-${plates++}`;
    this.layers = {};
    /** @type {string | null} */
    this.picked = null;
    const layer = (name, clipped) => {
      this.layers[name] = svg("g", { class: `plate-${name}`, "clip-path": clipped ? `url(#${clip})` : null });
      return this.layers[name];
    };
    this.node = svg("svg", { class: "plate", viewBox: "-38 -36 76 72", role: "group", "aria-label": label },
      svg("defs", {}, svg("clipPath", { id: clip }, svg("circle", { r: PLATE_RADIUS_MM }))),
      svg("circle", { class: "plate-disc", r: PLATE_RADIUS_MM }),
      layer("sectors", true), layer("zones", true), layer("rings", true),
      svg("circle", { class: "plate-rim", r: PLATE_RADIUS_MM }),
      layer("names", false), layer("centre", false), layer("finger", false), layer("handles", false));
  }

  /** Lights a part of the profile: "dpad", the name of a zone, or none. */
  pick(part) {
    this.picked = part;
    for (const node of this.node.querySelectorAll("[data-part]")) node.classList.toggle("picked", node.dataset.part === part);
  }

  /** Draws a profile's parts; null draws an empty plate. */
  setSketch(sketch) {
    for (const name of ["sectors", "zones", "rings", "names", "centre"]) this.layers[name].replaceChildren();
    if (sketch === null) return;
    const centre = sketch.centre_mm;
    if (sketch.dpad) this.#drawDirections(centre, sketch.dpad);
    sketch.zones.forEach((zone) => this.#drawZone(centre, zone));
    if (sketch.pointer) this.#drawPair(centre, sketch.pointer.centre_radius_mm, sketch.pointer.full_radius_mm, "pointer", sketch.pointer.word_at_mm);
    for (const stick of sketch.sticks) {
      if (stick.from === "place") this.#drawPair(centre, stick.centre, stick.full, stick.word, stick.word_at_mm);
    }
    this.#drawCentre(centre);
    this.pick(this.picked);
  }

  #drawDirections(centre, dpad) {
    for (const [index, sector] of dpad.sectors.entries()) {
      const { from_deg, to_deg, directions, word, word_at_mm } = sector;
      const kind = directions.length === 1 ? "plain" : "diagonal";
      this.layers.sectors.append(svg("path", {
        class: `sector ${kind}`,
        d: sectorPath(centre, from_deg, to_deg, dpad.centre_radius_mm, FAR_MM),
        "data-sector": index,
        "data-part": "dpad",
      }));
      this.#name(word_at_mm, word).dataset.direction = index;
    }
    this.#ring(centre, dpad.centre_radius_mm, "starts");
    this.#ring(centre, dpad.release_radius_mm, "ends");
  }

  #drawZone(centre, { name, name_at_mm, from_deg, to_deg, inner_radius_mm, outer_radius_mm }) {
    const whole = from_deg === null || to_deg === null;
    const d = whole
      ? ringPath(centre, inner_radius_mm, outer_radius_mm)
      : sectorPath(centre, from_deg, to_deg, inner_radius_mm, outer_radius_mm);
    this.layers.zones.append(svg("path", { class: "zone", d, "fill-rule": "evenodd", "data-part": name }));
    this.#name(name_at_mm, name, "zone-name");
  }

  #drawPair(centre, inner_mm, outer_mm, name, at_mm) {
    this.#ring(centre, inner_mm, "ends");
    this.#ring(centre, outer_mm, "starts");
    this.#name(at_mm, name);
  }

  #ring([x, y], radius_mm, kind) {
    this.layers.rings.append(svg("circle", { class: `ring ${kind}`, cx: x, cy: -y, r: radius_mm }));
  }

  #name([x, y], text, kind = "") {
    // What a control does in the game stands in a line of its own.
    const lines = text.split(": ");
    const above = ((lines.length - 1) * LINE_EM) / 2;
    const node = svg("text", { class: `plate-name ${kind}` }, ...lines.map((line, index) => (
      svg("tspan", { x, y: -y, dy: `${index * LINE_EM - above}em`, text: index + 1 < lines.length ? `${line}: ` : line }))));
    this.layers.names.append(node);
    return node;
  }

  #drawCentre([x, y]) {
    const d = `M${x - 1.5} ${-y}h3M${x} ${-y - 1.5}v3`;
    this.layers.centre.append(svg("path", { class: "hand-centre", d }));
  }

  /** Where an event of the pointer lies in the picture, in millimetres. */
  at(event) {
    const matrix = this.node.getScreenCTM();
    const point = new DOMPoint(event.clientX, event.clientY).matrixTransform(matrix.inverse());
    return { x: point.x, y: point.y };
  }
}

/** The finger on a plate: dot, ellipse of twice the standard deviation, shear and the way of the last second. */
export class Finger {
  static #SHEAR_MM_PER_N = 6;

  /** @param {Plate} plate @param {string} id of the dot */
  constructor(plate, id) {
    this.trail = [0.15, 0.3, 0.5, 0.8].map((opacity) => svg("path", { class: "trail", opacity }));
    this.ellipse = svg("ellipse", { class: "uncertainty" });
    this.shear = svg("path", { class: "shear" });
    this.dot = svg("circle", { id, class: "contact", r: 0.9, cx: 0, cy: 0 });
    this.all = svg("g", {}, this.ellipse, this.shear, this.dot);
    plate.layers.finger.append(...this.trail, this.all);
    this.draw(null, null, null);
  }

  /** @param {object | null} contact @param {object | null} uncertainty @param {import("./trace.js").Trace | null} trace */
  draw(contact, uncertainty, trace) {
    this.trail.forEach((path, part) => set(path, { d: trace === null ? "" : trace.path(part, this.trail.length) }));
    set(this.all, { visibility: contact === null ? "hidden" : "visible" });
    if (contact === null) return;
    const x = contact.x_mm.toFixed(3);
    const y = (-contact.y_mm).toFixed(3);
    set(this.dot, { cx: x, cy: y });
    set(this.ellipse, { cx: x, cy: y, rx: 2 * (uncertainty?.x_mm ?? 0), ry: 2 * (uncertainty?.y_mm ?? 0) });
    set(this.shear, { d: arrow(contact, Finger.#SHEAR_MM_PER_N) });
  }
}

function arrow({ x_mm, y_mm, fx_n, fy_n }, mm_per_n) {
  const dx = fx_n * mm_per_n;
  const dy = -fy_n * mm_per_n;
  const long = Math.hypot(dx, dy);
  if (long < 0.8) return "";
  const [ux, uy] = [dx / long, dy / long];
  const tip = `${(x_mm + dx).toFixed(2)} ${(-y_mm + dy).toFixed(2)}`;
  const barb = (side) => `M${tip}l${(-1.6 * ux + side * uy).toFixed(2)} ${(-1.6 * uy - side * ux).toFixed(2)}`;
  return `M${x_mm.toFixed(2)} ${(-y_mm).toFixed(2)}L${tip}${barb(0.9)}${barb(-0.9)}`;
}
