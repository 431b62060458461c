// The thresholds on the force meters of the editor, as handles.

import { el } from "../common/dom.js";
import { Handle } from "./handles.js";
import { Forces, MARKS, signed, thresholdRows } from "./meter.js";

export class ForceHandles {
  /** @type {Handle[]} */
  #handles = [];
  #shape = "";

  /** @param {import("../fields/values.js").Values} values */
  constructor(values) {
    this.values = values;
    this.forces = new Forces((meter, row, mark) => this.#mark(meter, row, mark));
    this.forces.node.classList.add("editable");
    this.legend = el("ul", { class: "legend", "aria-label": "Thresholds on the forces" });
    this.node = el("div", {}, this.forces.node, this.legend);
  }

  /** Shows the thresholds of the draft. The scale stays while a hand holds a handle. */
  refresh() {
    const { sketch } = this.values.draft;
    if (sketch === null) return;
    const shape = JSON.stringify([sketch.dpad === null, sketch.pointer === null, sketch.triggers.length, sketch.buttons.map(({ force, hard_press_n }) => [force, hard_press_n === null]), thresholdRows(sketch).map(({ name }) => name)]);
    if (shape !== this.#shape) this.#make(sketch, shape);
    else if (!this.#handles.some((handle) => handle.dragged)) this.forces.rescale(sketch);
    for (const handle of this.#handles) handle.refresh();
  }

  /** Makes all handles anew the next time: another profile. */
  forget() {
    this.#shape = "";
    this.#handles = [];
    this.forces.setSketch(null);
  }

  #make(sketch, shape) {
    this.#shape = shape;
    this.#handles = [];
    this.forces.setSketch(sketch);
    const kinds = new Set(thresholdRows(sketch).flatMap(({ marks }) => marks.map(({ kind }) => kind)));
    this.legend.replaceChildren(...[...kinds].map((kind) => el("li", {}, el("span", { class: "sign", "aria-hidden": "true", text: MARKS[kind].sign }), MARKS[kind].name)));
  }

  #mark(meter, row, { kind, key }) {
    const { sign, name } = MARKS[kind];
    const text = el("span", { class: "handle-number", "aria-hidden": "true" });
    const element = el("div", { class: `mark ${kind}` }, el("span", { "aria-hidden": "true", text: sign }), text);
    const place = (value) => {
      element.style.left = `${meter.part(signed(row, value)) * 100}%`;
      text.textContent = String(value);
    };
    const valueAt = (event) => {
      const { left, width } = meter.rows.getBoundingClientRect();
      return signed(row, meter.forceAt((event.clientX - left) / width));
    };
    const path = [...row.path, key];
    this.#handles.push(new Handle(element, { path, label: `${row.name}, ${name} force`, place, valueAt }, this.values));
    return element;
  }
}
