//! How a profile divides the plate: how far each side counts, and zones.

use crate::pipeline::mapping::profile::angle::wrapped;
use crate::pipeline::mapping::profile::{ButtonPlace, Direction, Gain, ZONES_MAX, Zone};
use crate::pipeline::mapping::read::common::limits::{
    ANGLE_DEG, CENTRE_MM, GAIN, HYSTERESIS_DEG, INNER_RADIUS_MM, OUTER_RADIUS_MM, RADIUS_HYSTERESIS_MM,
    ZONE_DEG_MIN, ZONE_HYSTERESIS_MM, ZONE_MM_MIN,
};
use crate::pipeline::mapping::read::common::named;
use crate::toml_text::diag::{Findings, quoted};
use crate::toml_text::section::{Placed, Section};

const ZONE_KEYS: [&str; 8] = [
    "name",
    "from_deg",
    "to_deg",
    "inner_radius_mm",
    "outer_radius_mm",
    "hysteresis_deg",
    "hysteresis_mm",
    "radius_hysteresis_mm",
];

/// Reads the place of the hand's centre; none where a number is unusable.
pub(crate) fn read_centre(root: &Section<'_>, findings: &mut Findings<'_>) -> Option<[f32; 2]> {
    let [x, y] = ["centre_x_mm", "centre_y_mm"].map(|key| root.number(key, CENTRE_MM, findings));
    Some([x?.value, y?.value])
}

/// Reads `[gain]`; none where a number is unusable.
pub(crate) fn read_gain(table: &Section<'_>, findings: &mut Findings<'_>) -> Option<Gain> {
    let [up, down, left, right] =
        Direction::NAMES.map(|key| table.number(key, GAIN, findings).map(|gain| gain.value));
    Some(Gain { right: right?, left: left?, up: up?, down: down? })
}

/// Reads all `[[zone]]`s; what is unusable is left out and reported. With each the byte offset of its header.
pub(crate) fn read_zones(
    root: &Section<'_>,
    has_dpad: bool,
    findings: &mut Findings<'_>,
) -> (Vec<Zone>, Vec<usize>) {
    // One more than there can be, so that the first one too many is known by its place.
    let tables = root.tables("zone", &ZONE_KEYS, ZONES_MAX + 1, findings);
    named::check_count(&tables, "zone", ZONES_MAX, findings);
    let (mut zones, mut places) = (Vec::<Zone>::new(), Vec::new());
    for table in &tables {
        let is_taken = |name: &str| zones.iter().any(|zone| zone.name == name);
        let name = named::read(table, "zone", is_taken, findings);
        if let Some((name, at)) = name.as_ref().zip(table.place_of("name")).filter(|_| has_dpad) {
            check_name(name, at, findings);
        }
        // A broken one keeps its name, so that no button misses it.
        let shape = read_shape(table, findings).unwrap_or_else(whole_plate);
        places.extend(name.is_some().then_some(table.at));
        zones.extend(name.map(|name| Zone { name, ..shape }));
    }
    limit_hysteresis(&mut zones);
    (zones, places)
}

/// Reports a name that the D-pad has.
fn check_name(name: &str, at: usize, findings: &mut Findings<'_>) {
    if Direction::NAMES.contains(&name) {
        let message = format!("{} is a direction of [dpad]", quoted(name));
        findings.error(at, message, "give the zone another name");
    }
}

/// A zone that is everywhere.
fn whole_plate() -> Zone {
    Zone {
        name: String::new(),
        middle_deg: 0.0,
        half_width_deg: 180.0,
        inner_radius_mm: INNER_RADIUS_MM.default,
        outer_radius_mm: OUTER_RADIUS_MM.default,
        hysteresis_deg: HYSTERESIS_DEG.default,
        hysteresis_mm: ZONE_HYSTERESIS_MM.default,
        hysteresis_max_deg: 0.0,
        radius_hysteresis_mm: RADIUS_HYSTERESIS_MM.default,
    }
}

/// A zone but for its name.
fn read_shape(table: &Section<'_>, findings: &mut Findings<'_>) -> Option<Zone> {
    let (middle_deg, half_width_deg) = read_sector(table, findings)?;
    let inner = table.number("inner_radius_mm", INNER_RADIUS_MM, findings);
    let outer = table.number("outer_radius_mm", OUTER_RADIUS_MM, findings);
    let hysteresis_deg = table.number("hysteresis_deg", HYSTERESIS_DEG, findings);
    let hysteresis_mm = table.number("hysteresis_mm", ZONE_HYSTERESIS_MM, findings);
    let radius_hysteresis_mm = table.number("radius_hysteresis_mm", RADIUS_HYSTERESIS_MM, findings);
    let (inner, outer) = (inner?, outer?);
    if outer.value - inner.value < ZONE_MM_MIN {
        let message = format!(
            "{} is {} mm wide from \"inner_radius_mm\" ({}) to \"outer_radius_mm\" ({})",
            table.title,
            outer.value - inner.value,
            inner.value,
            outer.value
        );
        findings.error(outer.at.max(inner.at), message, format!("make it {ZONE_MM_MIN} mm wide at least"));
    }
    Some(Zone {
        middle_deg,
        half_width_deg,
        inner_radius_mm: inner.value,
        outer_radius_mm: outer.value,
        hysteresis_deg: hysteresis_deg?.value,
        hysteresis_mm: hysteresis_mm?.value,
        radius_hysteresis_mm: radius_hysteresis_mm?.value,
        ..whole_plate()
    })
}

/// The middle and half the width of a sector from `from_deg` counter-clockwise to `to_deg`; of the whole circle where neither is
/// written.
fn read_sector(table: &Section<'_>, findings: &mut Findings<'_>) -> Option<(f32, f32)> {
    let [from, to] = ["from_deg", "to_deg"].map(|key| table.place_of(key));
    if from.is_none() && to.is_none() {
        return Some((0.0, 180.0));
    }
    let help = "a sector goes counter-clockwise from \"from_deg\" to \"to_deg\"; leave both out for a ring";
    table.require("from_deg", help, findings);
    table.require("to_deg", help, findings);
    let [from, to] = ["from_deg", "to_deg"]
        .map(|key| table.place_of(key).and_then(|_| table.number(key, ANGLE_DEG, findings)));
    let (Placed { value: from_deg, .. }, Placed { value: to_deg, at }) = (from?, to?);
    let width_deg = (to_deg - from_deg).rem_euclid(360.0);
    if width_deg < ZONE_DEG_MIN {
        let message = format!("{} is {width_deg}° wide from {from_deg}° to {to_deg}°", table.title);
        findings.error(at, message, format!("make it {ZONE_DEG_MIN}° wide at least"));
        return None;
    }
    Some((wrapped((from_deg + width_deg / 2.0).rem_euclid(360.0)), width_deg / 2.0))
}

/// No zone may reach farther than half of any other one, neither around nor in or out.
fn limit_hysteresis(zones: &mut [Zone]) {
    let sizes: Vec<[f32; 2]> = zones
        .iter()
        .map(|zone| [zone.half_width_deg, (zone.outer_radius_mm - zone.inner_radius_mm) / 2.0])
        .collect();
    for (at, zone) in zones.iter_mut().enumerate() {
        let others = sizes.iter().enumerate().filter(|(other, _)| *other != at).map(|(_, size)| size);
        let [half_deg, half_mm] =
            others.fold([180.0, 40.0], |[a, b]: [f32; 2], [deg, mm]| [a.min(*deg), b.min(*mm)]);
        zone.hysteresis_max_deg = half_deg;
        zone.radius_hysteresis_mm = zone.radius_hysteresis_mm.min(half_mm);
    }
}

/// The place that a button asks for by its name; none (and a finding) where there is no such place.
pub(crate) fn find(
    asked: Placed<&str>,
    zones: &[Zone],
    has_dpad: bool,
    findings: &mut Findings<'_>,
) -> Option<ButtonPlace> {
    let own = if has_dpad { &Direction::ALL[..] } else { &[] };
    let zones = zones.iter().map(|zone| zone.name.as_str());
    let known: Vec<&str> = own.iter().map(|it| it.name()).chain(zones).collect();
    let number = named::find(asked, "zone", &known, findings)?;
    Some(
        own.get(number)
            .map_or(ButtonPlace::Zone(number - own.len().min(number)), |it| ButtonPlace::Direction(*it)),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_zone_reaches_beyond_half_of_another() {
        let zone = |half_width_deg: f32, [inner_radius_mm, outer_radius_mm]: [f32; 2]| Zone {
            name: String::new(),
            middle_deg: 0.0,
            half_width_deg,
            inner_radius_mm,
            outer_radius_mm,
            hysteresis_deg: 8.0,
            hysteresis_mm: 2.5,
            hysteresis_max_deg: 0.0,
            radius_hysteresis_mm: 5.0,
        };
        let mut zones = vec![zone(20.0, [0.0, 30.0]), zone(60.0, [10.0, 14.0])];
        limit_hysteresis(&mut zones);
        assert_eq!(zones[0].hysteresis_max_deg, 60.0);
        assert_eq!(zones[0].radius_hysteresis_mm, 2.0);
        assert_eq!(zones[1].hysteresis_max_deg, 20.0);
        assert_eq!(zones[1].radius_hysteresis_mm, 5.0);
    }
}
