// The way of the finger in the last second, thinned out so that drawing it stays cheap.

const KEPT_US = 1_000_000;
const BETWEEN_US = 8_000;

export class Trace {
  /** @type {number[][]} points [t_us, x_mm, y_mm], a lift is [t_us] */
  #points = [];

  /** Takes what came since the last frame. */
  take(points) {
    for (const point of points) {
      const last = this.#points.at(-1);
      if (last !== undefined && point[0] < last[0]) this.#points = [];
      const lift = point.length === 1;
      const lifted = last === undefined || last.length === 1;
      if (lift ? lifted : !lifted && point[0] - last[0] < BETWEEN_US) continue;
      this.#points.push(lift ? point : point.slice(0, 3));
    }
  }

  /** Forgets everything. */
  clear() {
    this.#points = [];
  }

  /** Forgets what is older than a second at this time. */
  forget(t_us) {
    let old = 0;
    while (old < this.#points.length && this.#points[old][0] < t_us - KEPT_US) old += 1;
    if (old > 0) this.#points.splice(0, old);
    this.now_us = t_us;
  }

  /** The outline of one of `parts` equal parts of the second; part 0 is the oldest. */
  path(part, parts) {
    const from_us = this.now_us - KEPT_US * (1 - part / parts);
    const to_us = this.now_us - KEPT_US * (1 - (part + 1) / parts);
    let d = "";
    let down = false;
    for (const [t_us, x_mm, y_mm] of this.#points) {
      if (t_us < from_us) continue;
      const lift = x_mm === undefined;
      if (!lift) d += `${down ? "L" : "M"}${x_mm.toFixed(2)} ${(-y_mm).toFixed(2)}`;
      down = !lift;
      if (t_us > to_us) break;
    }
    return d;
  }
}
