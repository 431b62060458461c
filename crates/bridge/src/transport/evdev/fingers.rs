//! The fingers on a touchpad, by slots as the kernel numbers them: which one plays.

use std::collections::BTreeMap;

use tactpad_core::source::codes::{MT_SLOT, MT_TRACKING_ID};

/// Fingers that are followed.
const SLOTS: usize = 16;

/// What a finger is: [`PALM`], or something that may play.
const MT_TOOL_TYPE: u16 = 0x37;

/// A palm, by the kernel.
const PALM: i32 = 2;

/// One finger.
#[derive(Clone, Debug, Default)]
struct Slot {
    is_down: bool,
    /// Whether it came with the state that is being reported.
    is_new: bool,
    /// Whether it has been a palm since it came: that stays no finger, whatever it is called later.
    is_palm: bool,
    axes: BTreeMap<u16, i32>,
}

/// The fingers that are down.
#[derive(Clone, Debug)]
pub(super) struct Fingers {
    slots: Vec<Slot>,
    /// The slot that is reported on.
    at: usize,
    /// The finger that plays.
    playing: Option<usize>,
}

impl Fingers {
    /// None that are known; the kernel reports on slot `at`, and does not say so again.
    pub(super) fn new(at: i32) -> Self {
        Self { slots: vec![Slot::default(); SLOTS], at: index(at), playing: None }
    }

    /// Whether the kernel reports on this slot.
    pub(super) fn is_at(&self, slot: i32) -> bool {
        self.at == index(slot)
    }

    /// An axis of a finger has this value.
    pub(super) fn take(&mut self, axis: u16, value: i32) {
        if axis == MT_SLOT {
            self.at = index(value);
        } else if let Some(slot) = self.slots.get_mut(self.at) {
            if axis != MT_TRACKING_ID {
                slot.axes.insert(axis, value);
                return;
            }
            (slot.is_down, slot.is_new, slot.is_palm) = (value >= 0, value >= 0, false);
            // A finger that another one follows in one report has gone.
            self.playing = self.playing.filter(|playing| *playing != self.at);
        }
    }

    /// Nothing touches any more, known or not.
    pub(super) fn lift(&mut self) {
        self.slots.iter_mut().for_each(|slot| slot.is_down = false);
        self.playing = None;
    }

    /// The state is whole. A finger that comes to a pad without others plays; others do nothing, also when it has gone. Palms are not
    /// there.
    pub(super) fn settle(&mut self) {
        for slot in &mut self.slots {
            slot.is_palm |= slot.is_down && slot.axes.get(&MT_TOOL_TYPE) == Some(&PALM);
        }
        let is_finger = |slot: &Slot| slot.is_down && !slot.is_palm;
        self.playing = self.playing.filter(|playing| self.slots.get(*playing).is_some_and(is_finger));
        if self.playing.is_none() && !self.slots.iter().any(|slot| is_finger(slot) && !slot.is_new) {
            self.playing = self.slots.iter().position(is_finger);
        }
        self.slots.iter_mut().for_each(|slot| slot.is_new = false);
    }

    /// What was told of the finger that plays.
    pub(super) fn playing(&self) -> Option<&BTreeMap<u16, i32>> {
        self.slots.get(self.playing?).map(|slot| &slot.axes)
    }

    /// What was told of all that is down, palms among it, with its slot.
    pub(super) fn down(&self) -> impl Iterator<Item = (usize, &BTreeMap<u16, i32>)> {
        self.slots.iter().enumerate().filter(|(_, slot)| slot.is_down).map(|(k, slot)| (k, &slot.axes))
    }
}

/// A slot that the kernel names; beyond those that are followed where there is none.
fn index(slot: i32) -> usize {
    usize::try_from(slot).unwrap_or(SLOTS)
}
