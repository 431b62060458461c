//! In which zone of the plate a contact is.

use crate::pipeline::mapping::profile::Zone;
use crate::pipeline::mapping::profile::angle::along_deg;
use crate::quantity::Contact;

/// The number of the zone of a finite contact, given the one that was held before it. A held one goes on up to its hysteresis; of
/// several others the first counts.
pub(crate) fn follow(zones: &[Zone], held: Option<usize>, contact: &Contact) -> Option<usize> {
    let radius_mm = libm::hypotf(contact.x_mm, contact.y_mm);
    let angle_deg = libm::atan2f(contact.y_mm, contact.x_mm).to_degrees();
    let still =
        held.filter(|held| zones.get(*held).is_some_and(|zone| still_holds(zone, radius_mm, angle_deg)));
    still.or_else(|| zones.iter().position(|zone| zone.holds(radius_mm, 0.0, angle_deg, 0.0)))
}

fn still_holds(zone: &Zone, radius_mm: f32, angle_deg: f32) -> bool {
    let slack_deg =
        along_deg(zone.hysteresis_mm, radius_mm).max(zone.hysteresis_deg).min(zone.hysteresis_max_deg);
    zone.holds(radius_mm, zone.radius_hysteresis_mm, angle_deg, slack_deg)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn zone(from_deg: f32, to_deg: f32, [inner_radius_mm, outer_radius_mm]: [f32; 2]) -> Zone {
        Zone {
            name: String::new(),
            middle_deg: (from_deg + to_deg) / 2.0,
            half_width_deg: (to_deg - from_deg) / 2.0,
            inner_radius_mm,
            outer_radius_mm,
            hysteresis_deg: 8.0,
            hysteresis_mm: 2.5,
            hysteresis_max_deg: 30.0,
            radius_hysteresis_mm: 1.5,
        }
    }

    fn at(angle_deg: f32, radius_mm: f32) -> Contact {
        let (sin, cos) = (libm::sinf(angle_deg.to_radians()), libm::cosf(angle_deg.to_radians()));
        Contact { x_mm: radius_mm * cos, y_mm: radius_mm * sin, ..Contact::default() }
    }

    #[test]
    fn a_held_zone_reaches_along_the_arc_and_no_farther_than_its_limit() {
        let zones = [zone(0.0, 90.0, [5.0, 30.0]), zone(90.0, 180.0, [5.0, 30.0])];
        // 2.5 mm are 14.3° at 10 mm, 5.7° at 25 mm (there 8° are more), and 28.6° at 5 mm.
        for (radius_mm, slack_deg) in [(10.0, 14.32), (25.0, 8.0), (5.0, 28.65), (4.0, 30.0)] {
            let held = |off_deg: f32| follow(&zones, Some(0), &at(90.0 + slack_deg + off_deg, radius_mm));
            assert_eq!(held(-0.1), Some(0), "{radius_mm}");
            assert_ne!(held(0.1), Some(0), "{radius_mm}");
        }
    }

    #[test]
    fn rings_begin_and_end_and_the_first_of_two_counts() {
        let zones =
            [zone(-180.0, 180.0, [0.0, 8.0]), zone(-180.0, 180.0, [8.0, 20.0]), zone(0.0, 90.0, [0.0, 30.0])];
        for (radius_mm, held, wanted) in [
            (7.99, None, Some(0)),
            (8.01, None, Some(1)),
            (9.49, Some(0), Some(0)),
            (9.51, Some(0), Some(1)),
            (6.51, Some(1), Some(1)),
            (6.49, Some(1), Some(0)),
            (20.0, None, Some(2)),
            (30.0, None, None),
            (31.4, Some(2), Some(2)),
        ] {
            assert_eq!(follow(&zones, held, &at(45.0, radius_mm)), wanted, "{radius_mm} {held:?}");
        }
    }

    #[test]
    fn a_zone_across_the_seam_is_one() {
        let zones = [zone(150.0, 210.0, [0.0, 30.0])];
        for angle_deg in [150.1, 180.0, -180.0, -150.1] {
            assert_eq!(follow(&zones, None, &at(angle_deg, 20.0)), Some(0), "{angle_deg}");
        }
        assert_eq!(follow(&zones, None, &at(-149.0, 20.0)), None);
    }
}
