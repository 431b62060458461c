// What a touch reaches of a profile: zones, directions, and how much of the force that a button needs.

import { seenFrom } from "./geometry.js";

const within = (deg, from_deg, to_deg) => (((deg - from_deg) % 360) + 360) % 360 <= (((to_deg - from_deg) % 360) + 360) % 360;

/** The names of zones, and the directions, that a place of the picture lies in. */
export function partsAt(sketch, at) {
  const { deg, radius_mm } = seenFrom(sketch.centre_mm, at);
  const zones = sketch.zones.filter(({ from_deg, to_deg, inner_radius_mm, outer_radius_mm }) => (
    radius_mm >= inner_radius_mm && radius_mm <= outer_radius_mm && (from_deg === null || within(deg, from_deg, to_deg))));
  const counts = sketch.dpad !== null && radius_mm >= sketch.dpad.centre_radius_mm;
  const sectors = counts ? sketch.dpad.sectors.filter(({ from_deg, to_deg }) => within(deg, from_deg, to_deg)) : [];
  return { zones: zones.map(({ name }) => name), directions: sectors.flatMap((sector) => sector.directions) };
}

/** How much of the force that a button needs is there: from 1 on it counts. */
export function share({ force, press_n }, pressed) {
  const axis = force.replace("-", "");
  return (force.startsWith("-") ? -1 : 1) * pressed[`${axis}_n`] / press_n;
}

/** Buttons that count where a finger is, each with its share of the force. @returns {[number, object][]} */
export function reached(sketch, contact) {
  const { zones, directions } = partsAt(sketch, { x: contact.x_mm, y: -contact.y_mm });
  const here = sketch.buttons.filter(({ zone }) => zone === null || zones.includes(zone) || directions.includes(zone));
  return here.map((button) => [share(button, contact), button]);
}
