//! Difference of two profiles on one recording.

use serde::{Serialize, Serializer};

use super::scoring::down;
use tactpad_core::pipeline::control::names::{STICKS, TRIGGERS};
use tactpad_core::pipeline::control::{Code, OutputDevice, OutputEvent};
use tactpad_core::pipeline::mapping::profile::Binding;
use tactpad_core::time::StreamInstant;

/// Presses of one control that are no farther apart are the same press, earlier or later.
const SAME_US: u64 = 50_000;

/// A control from down to up.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Press {
    /// Stream time at which it went down.
    pub t_us: u64,
    /// How long it stayed.
    pub duration_us: u64,
    /// Whose control it is.
    #[serde(serialize_with = "as_name")]
    pub device: OutputDevice,
    /// The control.
    #[serde(serialize_with = "as_text")]
    pub code: Code,
    /// Where it was: 1 for keys, the side for axes.
    pub value: i32,
}

/// Whose press it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Side {
    /// Of the profile before.
    Old,
    /// Of the changed one.
    New,
}

/// A press that one profile gives and the other does not.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct UnmatchedPress {
    /// Which one.
    pub with: Side,
    /// The press.
    #[serde(flatten)]
    pub press: Press,
}

/// Presses that both profiles give, and those of one of them.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Difference {
    /// How many both give.
    pub both: usize,
    /// By how much the later one of them is later at most.
    pub shift_max_us: u64,
    /// Those of one profile, in order of time.
    pub only: Vec<UnmatchedPress>,
    /// How far the pointer went with each, old and new, to all sides together.
    pub pointer_counts: [u64; 2],
}

fn as_name<S: Serializer>(device: &OutputDevice, to: S) -> Result<S::Ok, S::Error> {
    to.serialize_str(device.name())
}

fn as_text<S: Serializer>(code: &Code, to: S) -> Result<S::Ok, S::Error> {
    to.collect_str(code)
}

impl Difference {
    /// Between the events of the profile before and of the changed one.
    pub fn between(old: &[OutputEvent], new: &[OutputEvent]) -> Self {
        let sides = [presses(old), presses(new)];
        let mut controls: Vec<Binding> = sides.iter().flatten().map(Press::control).collect();
        controls.sort_by_key(|it| (it.device, it.code, it.value));
        controls.dedup();
        let mut found = Self { pointer_counts: [counts(old), counts(new)], ..Self::default() };
        for control in controls {
            let [old, new] = sides.each_ref().map(|side| {
                side.iter().filter(|press| press.control() == control).copied().collect::<Vec<_>>()
            });
            found.compare(&old, &new);
        }
        found.only.sort_by_key(|only| (only.press.t_us, only.press.device, only.press.code));
        found
    }

    /// Compares the presses of one control.
    fn compare(&mut self, mut old: &[Press], mut new: &[Press]) {
        loop {
            match (old.split_first(), new.split_first()) {
                (Some((was, old_rest)), Some((is, new_rest))) if was.meets(is) => {
                    self.both += 1;
                    self.shift_max_us = self.shift_max_us.max(was.t_us.abs_diff(is.t_us));
                    (old, new) = (old_rest, new_rest);
                }
                (Some((was, rest)), is) if is.is_none_or(|(is, _)| was.t_us <= is.t_us) => {
                    self.only.push(UnmatchedPress { with: Side::Old, press: *was });
                    old = rest;
                }
                (_, Some((is, rest))) => {
                    self.only.push(UnmatchedPress { with: Side::New, press: *is });
                    new = rest;
                }
                (_, None) => return,
            }
        }
    }
}

impl Press {
    const fn control(&self) -> Binding {
        Binding { device: self.device, code: self.code, value: self.value }
    }

    /// Whether both can be one press: they overlap, or nearly so.
    const fn meets(&self, other: &Self) -> bool {
        self.t_us <= other.reach_us() && other.t_us <= self.reach_us()
    }

    const fn reach_us(&self) -> u64 {
        self.t_us.saturating_add(self.duration_us).saturating_add(SAME_US)
    }
}

/// The presses of an event log, in order of their begin. One that never ends lasts as long as the log.
pub fn presses(events: &[OutputEvent]) -> Vec<Press> {
    let mut presses: Vec<Press> = Vec::new();
    let mut open: Vec<usize> = Vec::new();
    let end = events.last().map_or(StreamInstant::default(), |event| event.at);
    let close = |press: &mut Press, at: StreamInstant| {
        press.duration_us = at.us_since(StreamInstant::from_us(press.t_us));
    };
    for event in events.iter().filter(|event| is_pressed(event.code)) {
        open.retain(|index| match presses.get_mut(*index) {
            Some(press) if (press.device, press.code) == (event.device, event.code) => {
                close(press, event.at);
                false
            }
            _ => true,
        });
        if let Some(Binding { device, code, value }) = down(event) {
            open.push(presses.len());
            presses.push(Press { t_us: event.at.as_us(), duration_us: 0, device, code, value });
        }
    }
    for index in open {
        if let Some(press) = presses.get_mut(index) {
            close(press, end);
        }
    }
    presses
}

/// Whether a control is pressed, and not moved as the pointer, a stick or a trigger.
fn is_pressed(code: Code) -> bool {
    !matches!(code, Code::Relative(_)) && !STICKS.as_flattened().contains(&code) && !TRIGGERS.contains(&code)
}

/// How far the pointer goes, to all sides together.
fn counts(events: &[OutputEvent]) -> u64 {
    let moves = events.iter().filter(|event| matches!(event.code, Code::Relative(_)));
    moves.map(|event| u64::from(event.value.unsigned_abs())).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    const SOUTH: Code = Code::Key(0x130);
    const HAT: Code = Code::Axis(0x10);

    fn events(all: &[(u64, Code, i32)]) -> Vec<OutputEvent> {
        let event = |&(ms, code, value): &(u64, Code, i32)| OutputEvent {
            at: StreamInstant::from_us(1_000 * ms),
            device: OutputDevice::Gamepad,
            code,
            value,
        };
        all.iter().map(event).collect()
    }

    fn only(old: &[(u64, Code, i32)], new: &[(u64, Code, i32)]) -> Vec<(Side, u64, u64, i32)> {
        let found = Difference::between(&events(old), &events(new));
        let shown = |it: &UnmatchedPress| {
            (it.with, it.press.t_us / 1_000, it.press.duration_us / 1_000, it.press.value)
        };
        found.only.iter().map(shown).collect()
    }

    #[test]
    fn what_only_one_gives_is_told_in_order_of_time() {
        let old = [(0, SOUTH, 1), (40, SOUTH, 0), (500, SOUTH, 1), (600, SOUTH, 0)];
        let new = [(3, SOUTH, 1), (43, SOUTH, 0), (200, HAT, 1), (260, HAT, -1), (300, HAT, 0)];
        let told = [(Side::New, 200, 60, 1), (Side::New, 260, 40, -1), (Side::Old, 500, 100, 1)];
        assert_eq!(only(&old, &new), told);
        let found = Difference::between(&events(&old), &events(&new));
        assert_eq!((found.both, found.shift_max_us), (1, 3_000));
    }

    #[test]
    fn sticks_and_triggers_move_and_are_not_pressed() {
        let moves = [(0, STICKS[0][0], 900), (4, STICKS[1][1], -700), (8, TRIGGERS[0], 30), (9, SOUTH, 1)];
        assert_eq!(only(&[], &moves), [(Side::New, 9, 0, 1)]);
    }

    #[test]
    fn presses_are_the_same_up_to_their_distance() {
        let press = |from| [(from, SOUTH, 1), (from + 10, SOUTH, 0)];
        assert_eq!(only(&press(0), &press(60)), []);
        assert_eq!(only(&press(0), &press(61)), [(Side::Old, 0, 10, 1), (Side::New, 61, 10, 1)]);
    }

    #[test]
    fn a_press_that_falls_apart_is_told() {
        let old = [(0, SOUTH, 1), (1_000, SOUTH, 0)];
        let new = [(0, SOUTH, 1), (300, SOUTH, 0), (400, SOUTH, 1), (1_000, SOUTH, 0)];
        assert_eq!(only(&old, &new), [(Side::New, 400, 600, 1)]);
        assert_eq!(only(&old, &[(0, SOUTH, 1)]), [], "the log ends in it");
    }
}
