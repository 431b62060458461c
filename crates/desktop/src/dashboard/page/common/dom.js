// Makes elements. Text from outside only ever becomes text, never markup.

const SVG = "http://www.w3.org/2000/svg";

/**
 * @param {Element} node
 * @param {Record<string, any>} properties `text`, `on*` for listeners, anything else is an attribute; null leaves it out
 * @param {(Node | string | null | undefined)[]} children
 */
function furnish(node, properties, children) {
  for (const [name, value] of Object.entries(properties)) {
    if (value === null || value === undefined || value === false) continue;
    if (name === "text") node.textContent = value;
    else if (name.startsWith("on")) node.addEventListener(name.slice(2), value);
    else node.setAttribute(name, value === true ? "" : String(value));
  }
  node.append(...children.filter((child) => child !== null && child !== undefined));
  return node;
}

/** An HTML element. @returns {HTMLElement} */
export function el(tag, properties = {}, ...children) {
  return furnish(document.createElement(tag), properties, children);
}

/** An SVG element. @returns {SVGElement} */
export function svg(tag, properties = {}, ...children) {
  return furnish(document.createElementNS(SVG, tag), properties, children);
}

/** Sets attributes that differ, so that an unchanged picture costs nothing. */
export function set(node, attributes) {
  for (const [name, value] of Object.entries(attributes)) {
    const text = String(value);
    if (node.getAttribute(name) !== text) node.setAttribute(name, text);
  }
}

/** Sets the text if it differs. */
export function say(node, text) {
  if (node.textContent !== text) node.textContent = text;
}

/** Tells the style sheet how high an element is: what sticks to an edge must not cover what has the focus. */
export function measured(node, name) {
  new ResizeObserver(() => document.documentElement.style.setProperty(name, `${node.offsetHeight}px`)).observe(node);
}

/** A button that does not submit. */
export function button(label, onclick, properties = {}) {
  return el("button", { type: "button", text: label, onclick, ...properties });
}

/** A table of a caption, column heads and a body that is filled later. */
export function table(caption, heads, properties = {}) {
  const body = el("tbody");
  const head = el("tr", {}, ...heads.map((text) => el("th", { scope: "col", text })));
  const node = el("table", properties, el("caption", { text: caption }), el("thead", {}, head), body);
  return { node, body };
}

/** A frame in which a wide table scrolls, also by keys. */
export function scroller(label, node) {
  return el("div", { class: "scroll", tabindex: 0, role: "region", "aria-label": label }, node);
}

/** A row of which the first cell is its head. */
export function row(cells) {
  const [first, ...rest] = cells;
  return el("tr", {}, el("th", { scope: "row", text: first }), ...rest.map((text) => el("td", { text })));
}

/** A number with so many digits behind the point, with a true minus sign. */
export function number(value, digits = 1) {
  if (value === null || value === undefined || !Number.isFinite(value)) return "–";
  const text = value.toFixed(digits);
  return Number(text) === 0 ? text.replace("-", "") : text.replace("-", "−");
}
