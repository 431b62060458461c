//! The direction that is held: which sector the contact has chosen, with hystereses.

use crate::pipeline::mapping::profile::angle::{along_deg, wrapped};
use crate::pipeline::mapping::profile::sector::{Sector, half_width_deg, sector_at};
use crate::pipeline::mapping::profile::{Dpad, DpadMode};
use crate::quantity::Contact;

/// The direction of a finite contact, given the one that was held before it.
///
/// The gate (force and distance from the centre) has a start and an end threshold; see [`Dpad`].
pub(crate) fn follow(dpad: &Dpad, held: Option<Sector>, contact: &Contact) -> Option<Sector> {
    let radius_mm = libm::hypotf(contact.x_mm, contact.y_mm);
    let open = match held {
        None => contact.fz_n >= dpad.min_force_n && radius_mm >= dpad.centre_radius_mm,
        Some(_) => {
            contact.fz_n >= dpad.release_force_n
                && radius_mm >= dpad.centre_radius_mm - dpad.radius_hysteresis_mm
        }
    };
    let angle_deg = libm::atan2f(contact.y_mm, contact.x_mm).to_degrees() - dpad.rotation_deg;
    open.then(|| turn(dpad, held, wrapped(angle_deg), radius_mm))
}

/// The sector for an angle from −180° to 180° at a distance from the centre, given the one held before.
fn turn(dpad: &Dpad, held: Option<Sector>, angle_deg: f32, radius_mm: f32) -> Sector {
    let here = sector_at(dpad, angle_deg);
    // A diagonal may be left over from a profile with other zones.
    let Some(held) = held.filter(|held| dpad.mode == DpadMode::EightWay || !held.is_diagonal()) else {
        return settled(dpad, here, angle_deg);
    };
    if held.distance_deg(angle_deg) <= half_width_deg(dpad, held) + slack_deg(dpad, held, radius_mm) {
        return held;
    }
    // A diagonal on the far side of the plate is not beside the held direction: there it would steer
    // backwards.
    let beside = held.distance_deg(angle_deg) < 90.0;
    if dpad.mode == DpadMode::FourWaySticky && here.is_diagonal() && beside {
        return held;
    }
    settled(dpad, here, angle_deg)
}

/// What a touch that starts in `zone` means.
fn settled(dpad: &Dpad, zone: Sector, angle_deg: f32) -> Sector {
    match dpad.mode {
        DpadMode::EightWay => zone,
        DpadMode::FourWay | DpadMode::FourWaySticky => Sector::nearest_cardinal(angle_deg),
    }
}

/// How far a held sector reaches into its neighbours: the larger of an angle and an arc, and half of a neighbour at most.
fn slack_deg(dpad: &Dpad, held: Sector, radius_mm: f32) -> f32 {
    let neighbour = match dpad.mode {
        DpadMode::EightWay => held.next(),
        DpadMode::FourWay | DpadMode::FourWaySticky => held,
    };
    dpad.hysteresis_deg.max(along_deg(dpad.hysteresis_mm, radius_mm).min(half_width_deg(dpad, neighbour)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pipeline::control::{Code, OutputDevice};
    use crate::pipeline::mapping::profile::{Binding, Keys};

    const RIGHT_UP: Sector = Sector(1);

    fn dpad(mode: DpadMode, diagonal_deg: f32) -> Dpad {
        let unused = Keys::new([Binding { device: OutputDevice::Gamepad, code: Code::Key(1), value: 1 }]);
        Dpad {
            mode,
            centre_radius_mm: 8.0,
            radius_hysteresis_mm: 1.5,
            diagonal_deg,
            hysteresis_deg: if mode == DpadMode::FourWaySticky { 0.0 } else { 8.0 },
            hysteresis_mm: 0.0,
            rotation_deg: 0.0,
            min_force_n: 0.5,
            release_force_n: 0.25,
            up: unused,
            down: unused,
            left: unused,
            right: unused,
        }
    }

    #[test]
    fn fresh_touches_take_the_zone_of_their_angle() {
        let four = dpad(DpadMode::FourWay, 45.0);
        let eight = dpad(DpadMode::EightWay, 40.0);
        let sticky = dpad(DpadMode::FourWaySticky, 40.0);
        for (angle, in_four, in_eight) in [
            (0.0, 0, 0),
            (25.0, 0, 0),
            (25.1, 0, 1),
            (45.0, 0, 1),
            (45.1, 2, 1),
            (64.9, 2, 1),
            (65.0, 2, 2),
            (115.0, 2, 2),
            (115.1, 2, 3),
            (134.9, 2, 3),
            (135.0, 4, 3),
            (155.0, 4, 4),
            (180.0, 4, 4),
            (-180.0, 4, 4),
            (-154.9, 4, 5),
            (-135.0, 4, 5),
            (-134.9, 6, 5),
            (-90.0, 6, 6),
            (-45.1, 6, 7),
            (-45.0, 0, 7),
            (-25.1, 0, 7),
            (-25.0, 0, 0),
        ] {
            assert_eq!(turn(&four, None, angle, 20.0), Sector(in_four), "4way at {angle}");
            assert_eq!(turn(&eight, None, angle, 20.0), Sector(in_eight), "8way at {angle}");
            assert_eq!(turn(&sticky, None, angle, 20.0), Sector(in_four), "sticky at {angle}");
        }
    }

    #[test]
    fn a_held_direction_changes_only_past_the_hysteresis() {
        let four = dpad(DpadMode::FourWay, 45.0);
        assert_eq!(turn(&four, Some(Sector::RIGHT), 53.0, 20.0), Sector::RIGHT, "exactly 8° past the edge");
        assert_eq!(turn(&four, Some(Sector::RIGHT), 53.1, 20.0), Sector::UP);
        assert_eq!(turn(&four, Some(Sector::UP), 37.0, 20.0), Sector::UP);
        assert_eq!(turn(&four, Some(Sector::UP), 36.9, 20.0), Sector::RIGHT);
        assert_eq!(turn(&four, Some(Sector::LEFT), -127.0, 20.0), Sector::LEFT, "across the ±180° seam");
        assert_eq!(turn(&four, Some(Sector::LEFT), -126.9, 20.0), Sector::DOWN);
        let eight = dpad(DpadMode::EightWay, 40.0);
        assert_eq!(turn(&eight, Some(Sector::RIGHT), 33.0, 20.0), Sector::RIGHT);
        assert_eq!(turn(&eight, Some(Sector::RIGHT), 33.1, 20.0), RIGHT_UP);
        assert_eq!(turn(&eight, Some(RIGHT_UP), 17.0, 20.0), RIGHT_UP);
        assert_eq!(turn(&eight, Some(RIGHT_UP), 16.9, 20.0), Sector::RIGHT);
    }

    #[test]
    fn sticky_diagonals_keep_the_last_direction_beside_them() {
        let sticky = dpad(DpadMode::FourWaySticky, 40.0);
        assert_eq!(turn(&sticky, Some(Sector::RIGHT), 64.9, 20.0), Sector::RIGHT);
        assert_eq!(turn(&sticky, Some(Sector::RIGHT), 65.0, 20.0), Sector::UP);
        assert_eq!(turn(&sticky, Some(Sector::UP), 25.1, 20.0), Sector::UP);
        assert_eq!(turn(&sticky, Some(Sector::UP), 25.0, 20.0), Sector::RIGHT);
        assert_eq!(
            turn(&sticky, Some(Sector::RIGHT), 130.0, 20.0),
            Sector::UP,
            "a diagonal that is not beside right"
        );
        let narrow = dpad(DpadMode::FourWaySticky, 6.0);
        assert_eq!(turn(&narrow, Some(Sector::RIGHT), 47.9, 20.0), Sector::RIGHT);
        assert_eq!(turn(&narrow, Some(Sector::RIGHT), 48.1, 20.0), Sector::UP);
    }

    #[test]
    fn a_diagonal_left_over_from_another_profile_settles() {
        assert_eq!(turn(&dpad(DpadMode::FourWay, 45.0), Some(RIGHT_UP), 46.0, 20.0), Sector::UP);
        assert_eq!(turn(&dpad(DpadMode::FourWaySticky, 30.0), Some(RIGHT_UP), 44.0, 20.0), Sector::RIGHT);
        assert_eq!(turn(&dpad(DpadMode::EightWay, 45.0), Some(RIGHT_UP), 70.0, 20.0), RIGHT_UP);
    }

    #[test]
    fn the_gate_starts_high_and_ends_low() {
        let dpad = dpad(DpadMode::FourWay, 45.0);
        let at = |x_mm, fz_n| Contact { x_mm, fz_n, ..Contact::default() };
        for (held, x_mm, fz_n, open) in [
            (None, 8.0, 0.5, true),
            (None, 7.99, 0.5, false),
            (None, 8.0, 0.49, false),
            (Some(Sector::RIGHT), 6.5, 0.25, true),
            (Some(Sector::RIGHT), 6.49, 0.25, false),
            (Some(Sector::RIGHT), 6.5, 0.249, false),
        ] {
            assert_eq!(follow(&dpad, held, &at(x_mm, fz_n)).is_some(), open, "{held:?} {x_mm} mm {fz_n} N");
        }
    }

    #[test]
    fn rotation_turns_the_zones_counter_clockwise() {
        for rotation_deg in [-180.0, -90.0, 90.0, 180.0] {
            let dpad = Dpad { rotation_deg, ..dpad(DpadMode::FourWay, 45.0) };
            let (x_mm, y_mm) =
                (20.0 * libm::cosf(rotation_deg.to_radians()), 20.0 * libm::sinf(rotation_deg.to_radians()));
            let contact = Contact { x_mm, y_mm, fz_n: 1.0, ..Contact::default() };
            assert_eq!(follow(&dpad, None, &contact), Some(Sector::RIGHT), "{rotation_deg}");
        }
    }

    #[test]
    fn along_the_arc_a_direction_reaches_as_far_at_any_radius_and_half_a_neighbour_at_most() {
        let four = Dpad { hysteresis_mm: 2.5, ..dpad(DpadMode::FourWay, 45.0) };
        let eight = Dpad { hysteresis_mm: 2.5, ..dpad(DpadMode::EightWay, 40.0) };
        // 2.5 mm are 14.3° at 10 mm and 7.2° at 20 mm, where 8° are more; at 3 mm they are 47.7°.
        for (radius_mm, slack_deg) in [(10.0, 14.32), (20.0, 8.0), (3.0, 45.0)] {
            assert_eq!(turn(&four, Some(Sector::RIGHT), 45.0 + slack_deg - 0.1, radius_mm), Sector::RIGHT);
            assert_eq!(turn(&four, Some(Sector::RIGHT), 45.0 + slack_deg + 0.1, radius_mm), Sector::UP);
        }
        // Half of the diagonal zone is 20°, half of a plain one 25°.
        assert_eq!(turn(&eight, Some(Sector::RIGHT), 44.9, 3.0), Sector::RIGHT);
        assert_eq!(turn(&eight, Some(Sector::RIGHT), 45.1, 3.0), RIGHT_UP);
        assert_eq!(turn(&eight, Some(RIGHT_UP), 0.1, 3.0), RIGHT_UP);
        assert_eq!(turn(&eight, Some(RIGHT_UP), -0.1, 3.0), Sector::RIGHT);
    }
}
