//! Conventions of the labels: their frame, their signs, their units, and which row they belong to.
//!
//! A table whose labels are meant otherwise looks like many faults of the wiring at once. So this is asked first: the readings alone tell the
//! contacts (`decoding`), and the map from these to the labels is the convention (`mapping`). Wiring faults break what nine readings
//! of five unknowns must obey, conventions do not. Where both explain the readings alike, as a frame that is turned by a third and cables that
//! are exchanged in a circle (`symmetry`), the fewest mistakes are taken (`detection`), and all are said (`findings`). Labels that stand still while the
//! contacts go on (`stuck`) are left out.

mod decoding;
mod detection;
mod findings;
mod mapping;
mod stuck;
mod symmetry;

pub use self::detection::{Conventions, LabelPart};
pub use self::findings::refusal;

use crate::effect::Effect;

/// Effects that are found here.
pub(super) const EFFECTS: [Effect; 5] =
    [Effect::LabelFrame, Effect::LabelSign, Effect::LabelUnit, Effect::LabelStuck, Effect::RowShift];

#[cfg(test)]
mod tests;
