//! Where sticks and triggers are: the gamepad's axes follow the place or the force of the contact.

use super::curve::share;
use crate::pipeline::mapping::profile::{Source, Stick, Trigger};
use crate::quantity::Contact;

/// The far end of a stick's axis.
const STICK_FULL: f32 = 32_767.0;
/// A stick moves in steps of this: 1/256 of the way. What is less is a finger's unrest.
const STICK_STEP: f32 = 128.0;
/// The far end of a trigger.
const TRIGGER_FULL: f32 = 255.0;

impl Stick {
    /// Where its axes are for a finite contact; `None` while the normal force is not enough. `is_held` says whether it was before.
    pub(crate) fn follow(&self, is_held: bool, contact: &Contact) -> Option<[i32; 2]> {
        let gate_n = if is_held { self.release_force_n } else { self.min_force_n };
        if contact.fz_n < gate_n {
            return None;
        }
        let (right, up) = match self.source {
            Source::Place => (contact.x_mm, contact.y_mm),
            Source::Shear => (contact.fx_n, contact.fy_n),
        };
        let way = libm::hypotf(right, up);
        let share = share(way, [self.rest, self.full], self.curve);
        let position = |part: f32| {
            if share <= 0.0 {
                return 0;
            }
            // The division comes first: a far-off place does not overflow.
            let steps = libm::roundf(part / way * share * STICK_FULL / STICK_STEP);
            (steps * STICK_STEP).clamp(-STICK_FULL - 1.0, STICK_FULL) as i32
        };
        Some([position(right), position(-up)])
    }
}

impl Trigger {
    /// Where it is at this normal force.
    pub(crate) fn position(&self, force_n: f32) -> i32 {
        let share = share(force_n, [self.from_n, self.full_n], self.curve);
        libm::roundf(share * TRIGGER_FULL) as i32
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pipeline::control::Code;
    use crate::pipeline::mapping::profile::Side;

    const STICK: Stick = Stick {
        side: Side::Left,
        source: Source::Place,
        rest: 4.0,
        full: 24.0,
        curve: 1.0,
        min_force_n: 0.3,
        release_force_n: 0.2,
    };

    fn at(x_mm: f32, y_mm: f32) -> [i32; 2] {
        STICK.follow(false, &Contact { x_mm, y_mm, fz_n: 1.0, ..Contact::default() }).unwrap()
    }

    #[test]
    fn a_stick_goes_from_rest_to_its_end() {
        assert_eq!(at(4.0, 0.0), [0, 0]);
        assert_eq!(at(14.0, 0.0), [16_384, 0]);
        assert_eq!(at(24.0, 0.0), [32_767, 0]);
        assert_eq!(at(-1e9, 0.0), [-32_768, 0]);
        assert_eq!(at(0.0, 14.0), [0, -16_384], "up on the plate is up on the stick");
        assert_eq!(at(f32::MAX, f32::MAX), [0, 0], "a radius beyond all numbers");
    }

    #[test]
    fn shear_moves_a_stick_as_far_as_it_is_strong() {
        let stick = Stick { source: Source::Shear, rest: 0.0, full: 2.0, ..STICK };
        let contact = Contact { fx_n: -1.0, fz_n: 1.0, x_mm: 20.0, ..Contact::default() };
        assert_eq!(stick.follow(false, &contact), Some([-16_384, 0]));
    }

    #[test]
    fn a_trigger_goes_with_the_force() {
        let trigger = Trigger { side: Side::Right, from_n: 1.0, full_n: 3.0, curve: 1.0, place: None };
        assert_eq!([0.5, 1.0, 2.0, 3.0, 50.0].map(|n| trigger.position(n)), [0, 0, 128, 255, 255]);
        assert_eq!(trigger.axis(), Code::Axis(5));
    }
}
