//! Intents: what should be held at this moment.

use arrayvec::ArrayVec;

use crate::pipeline::control::{Code, OutputDevice};
use crate::pipeline::mapping::profile::CONTROLS_MAX;

/// The most that a profile can state at once: all its controls, and the pointer's two movements.
pub const LEVELS_MAX: usize = CONTROLS_MAX + 2;

/// One control that should be held at `value` now. A control that no level names is neutral.
///
/// A movement is held, too: as long as the level stands the pointer moves at that rate. The wheel turns by a notch where its level begins.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Level {
    /// The device it is held on.
    pub device: OutputDevice,
    /// The key or axis.
    pub code: Code,
    /// 1 for keys, a non-zero position for axes, a non-zero rate in counts per second for movements, −1 or 1 for the wheel.
    pub value: i32,
}

/// Everything that should be held now, each control at most once, in the profile's order.
pub type Intents = ArrayVec<Level, LEVELS_MAX>;
