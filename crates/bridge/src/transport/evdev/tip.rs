//! The tip of a pen: how hard it presses, worn or not.
//!
//! The tip of a worn pen is never quite free: it tells pressure in the air, and some tablets then say that it touches. Far above the
//! tablet that is not so, thus what it tells there as it comes into range is its zero.

use std::collections::BTreeMap;

use super::axis::AxisRange;

/// How high above the tablet a pen is.
const DISTANCE: u16 = 0x19;

/// From this share of its largest distance on a pen is in the air for certain.
const FAR_SHARE: f64 = 0.5;

/// More than this share of the full scale is no worn tip any more: such a pen is broken, and presses as it tells.
const WORN_SHARE_MAX: f64 = 0.2;

/// A worn tip touches from this share of the full scale above its zero on.
const TOUCH_SHARE: f64 = 0.01;

/// A tip that is in range, or not.
#[derive(Clone, Debug, Default)]
pub(super) struct Tip {
    was_near: bool,
    /// What it tells in the air, in its own units, if it is worn.
    zero: Option<i32>,
}

impl Tip {
    /// Takes a whole state: whether the pen is near, and what it tells.
    pub(super) fn settle(
        &mut self,
        is_near: bool,
        pressure: i32,
        range: &AxisRange,
        axes: &BTreeMap<u16, i32>,
        ranges: &BTreeMap<u16, AxisRange>,
    ) {
        let has_come = is_near && !self.was_near;
        self.was_near = is_near;
        if has_come {
            let distance = axes.get(&DISTANCE).zip(ranges.get(&DISTANCE));
            let is_far = distance.is_some_and(|(value, range)| range.share(*value) >= FAR_SHARE);
            let is_worn = pressure > range.minimum && range.share(pressure) <= WORN_SHARE_MAX;
            self.zero = (is_far && is_worn).then_some(pressure);
        } else if !is_near {
            self.zero = None;
        }
        // It never tells less than in the air.
        self.zero = self.zero.map(|zero| zero.min(pressure)).filter(|zero| *zero > range.minimum);
    }

    /// Whether a tip that tells this pressure touches, where the tablet says so.
    pub(super) fn touches(&self, pressure: i32, range: &AxisRange) -> bool {
        self.zero.is_none_or(|_| self.beyond_zero(range).share(pressure) > TOUCH_SHARE)
    }

    /// The range of its pressure without what it tells in the air.
    pub(super) fn beyond_zero(&self, range: &AxisRange) -> AxisRange {
        AxisRange { minimum: self.zero.unwrap_or(range.minimum), ..*range }
    }
}
