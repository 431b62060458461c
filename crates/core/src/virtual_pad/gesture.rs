//! One gesture: what a finger does from touching the plate to leaving it, and what that means.

use arrayvec::ArrayVec;

use crate::pipeline::control::{Code, OutputDevice};
use crate::pipeline::mapping::profile::{Binding, ButtonPlace, KEYS_MAX, Keys};
use crate::quantity::Contact;

/// Two directions and one button.
pub(super) const HELD_MAX: usize = 3 * KEYS_MAX;

/// What is held, in the order in which a group of events states it: horizontal, vertical, button.
pub(super) type HeldKeys = ArrayVec<Binding, HELD_MAX>;

/// The finger moves to a contact, smoothly, and stays there.
#[derive(Clone, Debug)]
pub(super) struct Step {
    pub(super) contact: Contact,
    pub(super) ramp_us: u64,
    pub(super) stay_us: u64,
    /// What the player means to hold at the end of this step.
    pub(super) held: HeldKeys,
    /// What the player has tapped by making this step.
    pub(super) tapped: Option<Keys>,
    /// The button that the force is meant to press, by its place in the profile.
    pub(super) pressed: Option<usize>,
    /// Where the player means to touch: a zone or a direction; `None` if that does not matter.
    pub(super) place: Option<ButtonPlace>,
}

impl Step {
    fn tapped(&self) -> impl Iterator<Item = Binding> + use<> {
        self.tapped.into_iter().flat_map(|keys| keys.iter())
    }
}

/// One contact. Every step changes one thing only, so that the order of the events is certain.
#[derive(Clone, Debug)]
pub(super) struct Gesture {
    /// The last step is the lift: no force, then rest.
    pub(super) steps: Vec<Step>,
}

impl Gesture {
    /// From the first touch to the end of the rest after it.
    pub(super) fn duration_us(&self) -> u64 {
        self.steps.iter().fold(0, |sum, step| sum.saturating_add(step.ramp_us).saturating_add(step.stay_us))
    }

    /// From the first touch to the end of the lift.
    pub(super) fn contact_us(&self) -> u64 {
        self.duration_us().saturating_sub(self.steps.last().map_or(0, |lift| lift.stay_us))
    }

    /// Whether what is meant can be said: no control is wanted in two positions at once or turned over
    /// without a neutral moment, and nothing is tapped that is held.
    pub(super) fn is_consistent(&self) -> bool {
        let mut before = HeldKeys::new();
        self.steps.iter().all(|step| {
            let alone = |code: Code| step.held.iter().filter(|binding| binding.code == code).count() == 1;
            let kept =
                |binding: &Binding| before.iter().all(|b| b.code != binding.code || b.value == binding.value);
            let fine = step.held.iter().all(|binding| alone(binding.code) && kept(binding))
                && step.tapped().all(|tap| step.held.iter().chain(&before).all(|b| b.code != tap.code));
            before.clone_from(&step.held);
            fine
        })
    }

    /// The edges that the gesture means, in order: per step releases, presses, then the tap.
    pub(super) fn expect(&self, expected: &mut Vec<(OutputDevice, Code, i32)>) {
        let mut before = HeldKeys::new();
        for step in &self.steps {
            let released = before.iter().filter(|binding| !step.held.contains(binding));
            expected.extend(released.map(|binding| (binding.device, binding.code, 0)));
            let pressed = step.held.iter().copied().chain(step.tapped()).filter(|it| !before.contains(it));
            expected.extend(pressed.map(|binding| (binding.device, binding.code, binding.value)));
            expected.extend(step.tapped().map(|tap| (tap.device, tap.code, 0)));
            before.clone_from(&step.held);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::virtual_pad::fixture::{EAST, HAT_X, HAT_Y, SOUTH};

    const RIGHT: Binding = Binding { device: OutputDevice::Gamepad, code: HAT_X, value: 1 };
    const LEFT: Binding = Binding { device: OutputDevice::Gamepad, code: HAT_X, value: -1 };
    const UP: Binding = Binding { device: OutputDevice::Gamepad, code: HAT_Y, value: -1 };
    const JUMP: Binding = Binding { device: OutputDevice::Gamepad, code: SOUTH, value: 1 };

    fn step(held: &[Binding], tapped: Option<Binding>) -> Step {
        let tapped = tapped.map(|binding| Keys::new([binding]));
        let held = held.iter().copied().collect();
        Step {
            contact: Contact::default(),
            ramp_us: 40,
            stay_us: 100,
            held,
            tapped,
            pressed: None,
            place: None,
        }
    }

    fn expected(steps: Vec<Step>) -> Vec<(Code, i32)> {
        let mut edges = Vec::new();
        Gesture { steps }.expect(&mut edges);
        edges.into_iter().map(|(_, code, value)| (code, value)).collect()
    }

    #[test]
    fn edges_are_the_differences_between_steps() {
        let roll = vec![step(&[RIGHT], None), step(&[RIGHT, UP], None), step(&[UP], None), step(&[], None)];
        assert_eq!(expected(roll), [(HAT_X, 1), (HAT_Y, -1), (HAT_X, 0), (HAT_Y, 0)]);
        let turn = vec![step(&[RIGHT], None), step(&[UP], None), step(&[], None)];
        assert_eq!(expected(turn), [(HAT_X, 1), (HAT_X, 0), (HAT_Y, -1), (HAT_Y, 0)]);
    }

    #[test]
    fn a_tap_goes_down_and_up_within_its_step() {
        let tap = vec![step(&[RIGHT], None), step(&[RIGHT], Some(JUMP)), step(&[], None)];
        assert_eq!(expected(tap), [(HAT_X, 1), (SOUTH, 1), (SOUTH, 0), (HAT_X, 0)]);
    }

    #[test]
    fn what_cannot_be_said_is_not_consistent() {
        let consistent = |steps: &[Step]| Gesture { steps: steps.to_vec() }.is_consistent();
        assert!(consistent(&[step(&[RIGHT], None), step(&[], None), step(&[LEFT], None)]));
        assert!(!consistent(&[step(&[RIGHT], None), step(&[LEFT], None)]));
        assert!(!consistent(&[step(&[RIGHT, LEFT], None)]));
        assert!(consistent(&[step(&[UP], None), step(&[UP], Some(JUMP))]));
        assert!(!consistent(&[step(&[JUMP], None), step(&[], Some(JUMP))]));
        assert!(!consistent(&[step(
            &[JUMP, Binding { device: OutputDevice::Gamepad, code: EAST, value: 1 }],
            Some(JUMP)
        )]));
    }

    #[test]
    fn the_rest_is_not_part_of_the_contact() {
        let gesture = Gesture { steps: vec![step(&[RIGHT], None), step(&[], None)] };
        assert_eq!((gesture.duration_us(), gesture.contact_us()), (280, 180));
    }
}
