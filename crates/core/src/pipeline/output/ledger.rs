//! The ledger: the only place that knows what is held, and the only one that emits.
//!
//! It compares what should be held (levels) with what is, and writes the difference as edges. So every down has its
//! up: empty levels release everything, and nothing can be forgotten by whoever stated it. Rates of the pointer it passes
//! through `motion`, so that one place emits and empty levels stop the pointer, too.

use arrayvec::ArrayVec;

use crate::pipeline::control::names::{STICKS, TRIGGERS};
use crate::pipeline::control::{Code, OutputDevice, OutputEvent};
use crate::pipeline::mapping::live::intent::{Intents, Level};
use crate::pipeline::mapping::profile::{CONTROLS_MAX, Profile};
use crate::pipeline::output::motion::{Motion, STEPS_MAX};
use crate::time::StreamInstant;

/// The most edges of one call: the pointer moved, everything released, everything else pressed.
pub const EDGES_MAX: usize = STEPS_MAX + 2 * CONTROLS_MAX;

/// A stick or trigger moves at most once in this time: no game looks more often, and a pad at 8 kHz would flood every reader.
const AXIS_SPACING_US: u64 = 4_000;

/// The edges of one call, simultaneous for a game: the pointer's steps, then releases, then presses. So a press or
/// release of the pointer's button counts where the pointer has arrived.
pub type Edges = ArrayVec<OutputEvent, EDGES_MAX>;

/// One control of the profile and what is held of it.
#[derive(Clone, Copy, Debug)]
struct Slot {
    device: OutputDevice,
    code: Code,
    held: i32,
    wanted: i32,
    since: StreamInstant,
}

/// Controls that are held, in the profile's order: horizontal direction, vertical direction, buttons, the pointer's way.
#[derive(Clone, Debug)]
pub struct Ledger {
    slots: ArrayVec<Slot, CONTROLS_MAX>,
    motion: Motion,
    min_press_us: u64,
}

impl Ledger {
    /// A ledger for the controls of `profile`, holding nothing.
    pub fn new(profile: &Profile) -> Self {
        let mut slots = ArrayVec::new();
        for binding in profile.bindings() {
            add_slot(&mut slots, binding.device, binding.code);
        }
        Self { slots, motion: Motion::new(), min_press_us: profile.min_press_us }
    }

    /// Writes the edges from what is held to `levels`, as far as the minimum press allows; the rest follows when it
    /// is due. A level of a control that the profile does not name is ignored. The pointer moves here only, with a sample.
    pub fn update(&mut self, at: StreamInstant, levels: &Intents, edges: &mut Edges) {
        self.motion.update(at, levels);
        for (device, code, value) in self.motion.take_steps().into_iter().flatten() {
            // At most STEPS_MAX, so there is always room.
            let _ = edges.try_push(OutputEvent { at, device, code, value });
        }
        for slot in &mut self.slots {
            slot.wanted = wanted(levels, slot);
        }
        self.settle(at, edges);
    }

    /// Writes the edges that the minimum press held back until now.
    ///
    /// A key goes down with the modifiers that are wanted with it, and no others: modifiers go down before other keys, and one that
    /// only the minimum press still holds goes up for the next key.
    pub fn settle(&mut self, at: StreamInstant, edges: &mut Edges) {
        let min_press_us = self.min_press_us;
        let due =
            |slot: &Slot| slot.held != slot.wanted && at.us_since(slot.since) >= slot.hold_us(min_press_us);
        let goes_down = |slot: &Slot| slot.held == 0 && slot.wanted != 0;
        let is_key_coming = self.slots.iter().any(|slot| goes_down(slot) && slot.code.takes_modifiers());
        let goes_up = |slot: &Slot| {
            slot.held != 0 && slot.wanted == 0 && (due(slot) || is_key_coming && slot.code.is_modifier())
        };
        for slot in self.slots.iter_mut().filter(|slot| goes_up(slot)) {
            slot.set(at, 0, edges);
        }
        for are_modifiers in [true, false] {
            let of_kind = self.slots.iter_mut().filter(|slot| slot.code.is_modifier() == are_modifiers);
            for slot in of_kind.filter(|slot| slot.wanted != 0 && (slot.held == 0 || due(slot))) {
                slot.set(at, slot.wanted, edges);
            }
        }
    }

    /// When the next edge that the minimum press holds back is due.
    pub fn next_due(&self) -> Option<StreamInstant> {
        let back = self.slots.iter().filter(|slot| slot.held != 0 && slot.held != slot.wanted);
        back.map(|slot| slot.since.plus_us(slot.hold_us(self.min_press_us))).min()
    }

    /// Releases everything at once: fault, pause, panic, exit. The minimum press does not count here, and the pointer
    /// stays where it is.
    pub fn release_all(&mut self, at: StreamInstant, edges: &mut Edges) {
        self.motion.stop(at);
        for slot in &mut self.slots {
            slot.wanted = 0;
            slot.set(at, 0, edges);
        }
    }

    /// Goes over to the controls of `profile`: releases what it does not have, keeps what both have.
    pub fn change_profile(&mut self, at: StreamInstant, profile: &Profile, edges: &mut Edges) {
        let mut old = std::mem::replace(self, Self::new(profile));
        if profile.pointer.is_some() {
            self.motion = old.motion;
        }
        for slot in &mut old.slots {
            let same = |new: &&mut Slot| new.device == slot.device && new.code == slot.code;
            match self.slots.iter_mut().find(same) {
                Some(kept) => *kept = *slot,
                None => slot.set(at, 0, edges),
            }
        }
    }

    /// Controls that are held now, in the profile's order.
    pub fn held(&self) -> impl Iterator<Item = Level> + '_ {
        let held = self.slots.iter().filter(|slot| slot.held != 0);
        let held = held.map(|slot| Level { device: slot.device, code: slot.code, value: slot.held });
        held.chain(self.motion.rates().map(|(code, value)| Level {
            device: OutputDevice::Pointer,
            code,
            value,
        }))
    }
}

impl Slot {
    /// How long it stays where it is before it may change.
    fn hold_us(&self, min_press_us: u64) -> u64 {
        let is_analogue = self.device == OutputDevice::Gamepad
            && (STICKS.as_flattened().contains(&self.code) || TRIGGERS.contains(&self.code));
        match (is_analogue, self.wanted) {
            (false, _) => min_press_us,
            (true, 0) => 0,
            (true, _) => AXIS_SPACING_US,
        }
    }

    fn set(&mut self, at: StreamInstant, value: i32, edges: &mut Edges) {
        if self.held != value {
            self.held = value;
            self.since = at;
            if value == 0 && matches!(self.code, Code::Relative(_)) {
                // A notch of the wheel is done once it is told.
                return;
            }
            // One edge per slot and call at most, so there is always room.
            let _ = edges.try_push(OutputEvent { at, device: self.device, code: self.code, value });
        }
    }
}

fn wanted(levels: &Intents, slot: &Slot) -> i32 {
    let level = levels.iter().find(|level| level.device == slot.device && level.code == slot.code);
    level.map_or(0, |level| level.value)
}

/// Adds a control once, however many bindings name it.
fn add_slot(slots: &mut ArrayVec<Slot, CONTROLS_MAX>, device: OutputDevice, code: Code) {
    if slots.iter().all(|slot| (slot.device, slot.code) != (device, code)) {
        // A profile names at most CONTROLS_MAX controls, so there is always room.
        let _ = slots.try_push(Slot { device, code, held: 0, wanted: 0, since: StreamInstant::default() });
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::pipeline::mapping::read::check::{self, OutputChoice};
    use crate::pipeline::mapping::read::shipped;

    const RIGHT: (u16, i32) = (0x10, 1);
    const LEFT: (u16, i32) = (0x10, -1);
    const UP: (u16, i32) = (0x11, -1);
    const SOUTH: (u16, i32) = (0x130, 1);

    fn profile(name: &str) -> Profile {
        check::read(shipped::text(name).unwrap(), OutputChoice::AsWritten).0.unwrap()
    }

    fn code(number: u16) -> Code {
        if number < 0x100 { Code::Axis(number) } else { Code::Key(number) }
    }

    fn intents(levels: &[(u16, i32)]) -> Intents {
        let level = |&(number, value)| Level { device: OutputDevice::Gamepad, code: code(number), value };
        levels.iter().map(level).collect()
    }

    /// Runs levels at times (µs) through the ledger of `super-mario`; the edges as (time, number, value).
    fn edges(steps: &[(u64, &[(u16, i32)])]) -> Vec<(u64, u16, i32)> {
        let mut ledger = Ledger::new(&profile("super-mario"));
        let mut all = Vec::new();
        for (us, levels) in steps {
            let mut edges = Edges::new();
            ledger.update(StreamInstant::from_us(*us), &intents(levels), &mut edges);
            all.extend(edges.iter().map(|edge| {
                let (Code::Key(number) | Code::Axis(number) | Code::Relative(number)) = edge.code;
                (edge.at.as_us(), number, edge.value)
            }));
        }
        all
    }

    #[test]
    fn only_differences_are_emitted() {
        let steps: [(u64, &[_]); 4] =
            [(0, &[RIGHT]), (50_000, &[RIGHT]), (60_000, &[RIGHT, SOUTH]), (200_000, &[])];
        assert_eq!(
            edges(&steps),
            [(0, 0x10, 1), (60_000, 0x130, 1), (200_000, 0x10, 0), (200_000, 0x130, 0)]
        );
    }

    #[test]
    fn a_tap_stays_down_for_the_minimum_press() {
        let steps: [(u64, &[_]); 4] = [(0, &[SOUTH]), (1_000, &[]), (39_999, &[]), (40_000, &[])];
        assert_eq!(edges(&steps), [(0, 0x130, 1), (40_000, 0x130, 0)]);
    }

    #[test]
    fn releases_come_before_presses() {
        assert_eq!(edges(&[(0, &[RIGHT]), (50_000, &[UP])])[1..], [(50_000, 0x10, 0), (50_000, 0x11, -1)]);
    }

    #[test]
    fn a_hat_does_not_change_sides_before_the_minimum_press() {
        let steps: [(u64, &[_]); 3] = [(0, &[RIGHT]), (10_000, &[LEFT]), (40_000, &[LEFT])];
        assert_eq!(edges(&steps), [(0, 0x10, 1), (40_000, 0x10, -1)]);
    }

    #[test]
    fn what_is_held_back_is_due_and_settles() {
        let mut ledger = Ledger::new(&profile("super-mario"));
        let (mut edges, start) = (Edges::new(), StreamInstant::from_us(100));
        ledger.update(start, &intents(&[SOUTH]), &mut edges);
        assert_eq!(ledger.next_due(), None);
        ledger.update(start.plus_us(1), &intents(&[]), &mut edges);
        let due = start.plus_us(40_000);
        assert_eq!(ledger.next_due(), Some(due));
        edges.clear();
        ledger.settle(due, &mut edges);
        assert_eq!((edges[0].at, edges[0].value, ledger.next_due()), (due, 0, None));
    }

    #[test]
    fn a_profile_change_releases_only_what_differs() {
        let mut other = profile("super-mario");
        other.buttons.clear();
        let mut ledger = Ledger::new(&profile("super-mario"));
        let mut edges = Edges::new();
        ledger.update(StreamInstant::default(), &intents(&[RIGHT, SOUTH]), &mut edges);
        edges.clear();
        ledger.change_profile(StreamInstant::from_us(1), &other, &mut edges);
        assert_eq!(
            edges.iter().map(|edge| (edge.code, edge.value)).collect::<Vec<_>>(),
            [(Code::Key(0x130), 0)]
        );
        assert_eq!(ledger.held().count(), 1);
    }

    #[test]
    fn the_pointer_arrives_before_its_button_changes() {
        let mut ledger = Ledger::new(&profile("pointer"));
        let level = |code, value| Level { device: OutputDevice::Pointer, code, value };
        let (right, left) = (level(Code::Relative(0), 2_000), level(Code::Key(0x110), 1));
        let mut edges = Edges::new();
        for (ms, levels) in [(0, &[right][..]), (1, &[right, left]), (50, &[left]), (60, &[])] {
            let levels = levels.iter().copied().collect();
            ledger.update(StreamInstant::from_us(ms * 1_000), &levels, &mut edges);
        }
        let seen: Vec<_> =
            edges.iter().map(|e| (e.at.as_us() / 1_000, e.code.to_string(), e.value)).collect();
        let expected = [(1, "REL_X", 2), (1, "BTN_LEFT", 1), (50, "REL_X", 40), (60, "BTN_LEFT", 0)];
        assert_eq!(seen, expected.map(|(ms, code, value)| (ms, code.to_owned(), value)));
    }

    #[test]
    fn the_wheel_turns_by_a_notch_where_a_press_begins() {
        let text = "schema = 1\nname = \"W\"\noutput = \"gamepad\"\n\
                    [[button]]\nforce = \"fy\"\npress_n = 1\nout = { pointer = \"REL_WHEEL+\" }\n\
                    [[button]]\nforce = \"-fy\"\npress_n = 1\nout = { pointer = \"REL_WHEEL-\" }\n";
        let (profile, found) = check::read(text, OutputChoice::AsWritten);
        assert_eq!(found, []);
        let mut ledger = Ledger::new(&profile.unwrap());
        let mut edges = Edges::new();
        let notch = |value| Level { device: OutputDevice::Pointer, code: Code::Relative(8), value };
        for (ms, levels) in
            [(0, &[notch(1)][..]), (10, &[notch(1)]), (50, &[]), (60, &[notch(-1)]), (200, &[])]
        {
            ledger.update(StreamInstant::from_us(ms * 1_000), &levels.iter().copied().collect(), &mut edges);
        }
        ledger.release_all(StreamInstant::from_us(300_000), &mut edges);
        let seen: Vec<_> =
            edges.iter().map(|e| (e.at.as_us() / 1_000, e.code.to_string(), e.value)).collect();
        assert_eq!(seen, [(0, "REL_WHEEL".to_owned(), 1), (60, "REL_WHEEL".to_owned(), -1)]);
        assert_eq!(ledger.held().count(), 0);
    }

    #[test]
    fn a_key_goes_down_with_the_modifiers_that_are_wanted_with_it() {
        let text = "schema = 1\nname = \"M\"\noutput = \"keyboard\"\n\
                    [[button]]\nforce = \"fy\"\npress_n = 1\ntap = { gamepad = \"BTN_A\", keyboard = \"9\" }\n\
                    [[button]]\nforce = \"fx\"\npress_n = 1\ntap = { gamepad = \"BTN_A\", keyboard = \"9+LEFTSHIFT\" }\n\
                    [[button]]\nforce = \"fz\"\npress_n = 1\ntap = { gamepad = \"BTN_B\", keyboard = \"LEFTBRACE\" }\n";
        let mut ledger = Ledger::new(&check::read(text, OutputChoice::AsWritten).0.unwrap());
        let key = |code| Level { device: OutputDevice::Keyboard, code: Code::Key(code), value: 1 };
        let (nine, shift, brace) = (key(10), key(42), key(26));
        let mut edges = Edges::new();
        for (ms, levels) in [(0, &[nine, shift][..]), (1, &[]), (20, &[brace]), (21, &[]), (60, &[])] {
            let levels = levels.iter().copied().collect();
            ledger.update(StreamInstant::from_us(ms * 1_000), &levels, &mut edges);
        }
        let seen: Vec<_> =
            edges.iter().map(|e| (e.at.as_us() / 1_000, e.code.to_string(), e.value)).collect();
        let expected = [
            (0, "KEY_LEFTSHIFT", 1),
            (0, "KEY_9", 1),
            (20, "KEY_LEFTSHIFT", 0),
            (20, "KEY_LEFTBRACE", 1),
            (60, "KEY_9", 0),
            (60, "KEY_LEFTBRACE", 0),
        ];
        assert_eq!(seen, expected.map(|(ms, code, value)| (ms, code.to_owned(), value)));
    }

    #[test]
    fn levels_of_unknown_controls_are_ignored() {
        assert_eq!(edges(&[(0, &[(0x13a, 1)])]), []);
    }

    proptest! {
        #[test]
        fn every_down_has_its_up(
            steps in prop::collection::vec((0_u64..60_000, prop::collection::vec((0_u16..3, -1_i32..2), 0..6)), 0..60)
        ) {
            let mut ledger = Ledger::new(&profile("super-mario"));
            let mut held = std::collections::BTreeMap::new();
            let mut at = StreamInstant::default();
            let mut follow = |edges: &Edges| {
                for edge in edges {
                    let before = held.insert(edge.code, edge.value).unwrap_or(0);
                    prop_assert_ne!(before, edge.value, "an edge that changes nothing");
                }
                prop_assert!(held.values().filter(|&&value| value != 0).count() <= 3);
                Ok(())
            };
            for (wait_us, levels) in steps {
                at = at.plus_us(wait_us);
                let numbers = [0x10, 0x11, 0x130];
                let level = |&(i, value): &(u16, i32)| (numbers[usize::from(i)], value);
                let levels: Vec<_> = levels.iter().map(level).filter(|&(_, value)| value != 0).collect();
                let mut edges = Edges::new();
                ledger.update(at, &intents(&levels), &mut edges);
                follow(&edges)?;
            }
            let mut edges = Edges::new();
            ledger.release_all(at, &mut edges);
            follow(&edges)?;
            prop_assert!(held.values().all(|&value| value == 0));
        }
    }
}
