// Places and angles of the plate. Plate: millimetres, +y up, degrees counter-clockwise. Picture: +y down.

export const PLATE_RADIUS_MM = 30;

const radians = (deg) => (deg * Math.PI) / 180;

/** A place of the plate in the picture, from a centre, an angle and a distance. */
export function polar([centre_x, centre_y], deg, radius_mm) {
  return { x: centre_x + radius_mm * Math.cos(radians(deg)), y: -(centre_y + radius_mm * Math.sin(radians(deg))) };
}

/** Angle and distance of a place of the picture, seen from a centre of the plate. */
export function seenFrom([centre_x, centre_y], { x, y }) {
  const right = x - centre_x;
  const up = -y - centre_y;
  return { deg: (Math.atan2(up, right) * 180) / Math.PI, radius_mm: Math.hypot(right, up) };
}

/** The same angle, from `around` - 180 up to `around` + 180. */
export function near(deg, around) {
  return deg - 360 * Math.round((deg - around) / 360);
}

const place = ({ x, y }) => `${x.toFixed(3)} ${y.toFixed(3)}`;

function arc(centre, from_deg, to_deg, radius_mm, back) {
  const large = to_deg - from_deg > 180 ? 1 : 0;
  const end = polar(centre, back ? from_deg : to_deg, radius_mm);
  return `A${radius_mm} ${radius_mm} 0 ${large} ${back ? 1 : 0} ${place(end)}`;
}

/** The outline of a part of a ring; `to_deg` lies counter-clockwise of `from_deg`. */
export function sectorPath(centre, from_deg, to_deg, inner_mm, outer_mm) {
  let span = (((to_deg - from_deg) % 360) + 360) % 360;
  if (span === 0) return ringPath(centre, inner_mm, outer_mm);
  const to = from_deg + span;
  const start = `M${place(polar(centre, from_deg, outer_mm))}${arc(centre, from_deg, to, outer_mm, false)}`;
  if (inner_mm <= 0) return `${start}L${place(polar(centre, 0, 0))}Z`;
  return `${start}L${place(polar(centre, to, inner_mm))}${arc(centre, from_deg, to, inner_mm, true)}Z`;
}

function circlePath(centre, radius_mm) {
  const left = polar(centre, 180, radius_mm);
  const right = polar(centre, 0, radius_mm);
  const half = `A${radius_mm} ${radius_mm} 0 1 0`;
  return `M${place(right)}${half} ${place(left)}${half} ${place(right)}Z`;
}

/** The outline of a ring, or of a disc; to be filled even-odd. */
export function ringPath(centre, inner_mm, outer_mm) {
  return circlePath(centre, outer_mm) + (inner_mm > 0 ? circlePath(centre, inner_mm) : "");
}

/** The middle angle of a sector. */
export function middleDeg(from_deg, to_deg) {
  return from_deg + ((((to_deg - from_deg) % 360) + 360) % 360 || 360) / 2;
}
