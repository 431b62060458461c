//! How fast the pointer moves for a place on the plate, or where it goes.

use super::curve::share;
use crate::pipeline::control::names::POINTER_PLACE_MAX;
use crate::pipeline::mapping::profile::{Pointer, PointerMode};
use crate::quantity::Contact;

/// A velocity of the pointer in whole counts per second: to the right, and down as screens count.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Velocity {
    pub(crate) right: i32,
    pub(crate) down: i32,
}

/// What becomes of the pointer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum PointerOutput {
    /// It moves.
    Moving(Velocity),
    /// It goes to this place of the screen, from the left and from the top, in 1 to [`POINTER_PLACE_MAX`].
    At([i32; 2]),
}

/// What becomes of it for a finite contact; `None` while the normal force is not enough. `held` says whether it was in the
/// step before.
///
/// The speed is continuous at the centre's edge, so the place needs no hysteresis as that of a direction does.
pub(crate) fn follow(
    pointer: &Pointer,
    held: Option<PointerOutput>,
    contact: &Contact,
) -> Option<PointerOutput> {
    let gate_n = if held.is_some() { pointer.release_force_n } else { pointer.min_force_n };
    (contact.fz_n >= gate_n).then(|| match pointer.mode {
        PointerMode::Relative => PointerOutput::Moving(velocity(pointer, contact)),
        PointerMode::Absolute => {
            PointerOutput::At([contact.x_mm, -contact.y_mm].map(|mm| place(pointer, mm)))
        }
    })
}

/// The place of the screen that is so far to the right of its middle, or below it, on the plate.
fn place(pointer: &Pointer, mm: f32) -> i32 {
    let share = share(mm, [-pointer.full_radius_mm, pointer.full_radius_mm], 1.0);
    1 + libm::roundf(share * (POINTER_PLACE_MAX - 1) as f32) as i32
}

fn velocity(pointer: &Pointer, contact: &Contact) -> Velocity {
    let radius_mm = libm::hypotf(contact.x_mm, contact.y_mm);
    let speed = speed_counts_per_s(pointer, radius_mm);
    if speed <= 0.0 {
        return Velocity { right: 0, down: 0 };
    }
    // The division comes first: a far-off place does not overflow, and one whose radius does is rest.
    let part = |mm: f32| libm::roundf(mm / radius_mm * speed) as i32;
    Velocity { right: part(contact.x_mm), down: part(-contact.y_mm) }
}

/// The speed at this distance from the centre, in counts per second.
fn speed_counts_per_s(pointer: &Pointer, radius_mm: f32) -> f32 {
    let ends_mm = [pointer.centre_radius_mm, pointer.full_radius_mm];
    pointer.speed_counts_per_s * share(radius_mm, ends_mm, pointer.curve)
}

#[cfg(test)]
mod tests {
    use super::*;

    const POINTER: Pointer = Pointer {
        mode: PointerMode::Relative,
        centre_radius_mm: 5.0,
        full_radius_mm: 25.0,
        speed_counts_per_s: 800.0,
        curve: 2.0,
        min_force_n: 0.3,
        release_force_n: 0.2,
    };

    fn at(x_mm: f32, y_mm: f32) -> (i32, i32) {
        let contact = Contact { x_mm, y_mm, fz_n: 1.0, ..Contact::default() };
        right_and_down(follow(&POINTER, None, &contact))
    }

    fn right_and_down(steered: Option<PointerOutput>) -> (i32, i32) {
        let Some(PointerOutput::Moving(Velocity { right, down })) = steered else { panic!("{steered:?}") };
        (right, down)
    }

    #[test]
    fn speed_grows_from_the_centres_edge_to_the_full_radius() {
        assert_eq!(at(0.0, 0.0), (0, 0));
        assert_eq!(at(5.0, 0.0), (0, 0));
        assert_eq!(at(10.0, 0.0), (50, 0), "a quarter of the way, squared");
        assert_eq!(at(15.0, 0.0), (200, 0), "half of the way, squared");
        assert_eq!(at(24.9, 0.0), (792, 0));
        assert_eq!(at(25.0, 0.0), (800, 0));
        assert_eq!(at(1e9, 0.0), (800, 0));
    }

    #[test]
    fn the_curve_is_the_power() {
        let at_half = |curve| {
            let contact = Contact { x_mm: 15.0, fz_n: 1.0, ..Contact::default() };
            right_and_down(follow(&Pointer { curve, ..POINTER }, None, &contact)).0
        };
        assert_eq!([1.0, 2.0, 3.0].map(at_half), [400, 200, 100]);
    }

    #[test]
    fn up_on_the_plate_is_up_on_the_screen() {
        assert_eq!(at(0.0, 25.0), (0, -800));
        assert_eq!(at(-25.0, 0.0), (-800, 0));
        assert_eq!(at(0.0, -25.0), (0, 800));
    }

    #[test]
    fn speed_is_the_same_in_every_direction() {
        // 3-4-5: 600 and 800 of 1000 thousandths.
        assert_eq!(at(15.0, -20.0), (480, 640));
        assert_eq!(at(-15.0, 20.0), (-480, -640));
        assert_eq!(at(f32::MAX, f32::MAX), (0, 0), "a radius beyond all numbers");
    }

    #[test]
    fn an_absolute_pointer_goes_to_the_edges_and_no_farther() {
        let pointer = Pointer { mode: PointerMode::Absolute, ..POINTER };
        let at =
            |x_mm, y_mm| follow(&pointer, None, &Contact { x_mm, y_mm, fz_n: 1.0, ..Contact::default() });
        assert_eq!(at(0.0, 0.0), Some(PointerOutput::At([16_384, 16_384])));
        assert_eq!(at(-25.0, 25.0), Some(PointerOutput::At([1, 1])));
        assert_eq!(at(f32::MAX, -26.0), Some(PointerOutput::At([32_767, 32_767])));
    }

    #[test]
    fn the_gate_has_a_hysteresis() {
        let moving = Some(PointerOutput::Moving(Velocity { right: 0, down: 0 }));
        let pressed = |held, fz_n| {
            let contact = Contact { x_mm: 20.0, fz_n, ..Contact::default() };
            follow(&POINTER, held, &contact).is_some()
        };
        assert_eq!([0.2999, 0.3].map(|fz_n| pressed(None, fz_n)), [false, true]);
        assert_eq!([0.1999, 0.2].map(|fz_n| pressed(moving, fz_n)), [false, true]);
    }
}
