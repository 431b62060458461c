//! Plays that are compared, the changes that are asked for, and what comes of it.

use crate::calibration::data::contacts::{Fitted, Maps};
use tactpad_core::tables::recording::Recording;
use tactpad_numeric::linear::Reduced;

/// Estimate of the changes before a play.
#[derive(Clone, Debug)]
pub struct PlayEstimate {
    /// S and s of the changes: the nine channels' gains, as shares of themselves, and then the maps.
    pub changes: Reduced,
    /// By how much the contrasts within the plays exceed chance: mean χ² for each degree of freedom, 1 at least.
    pub inflation: f64,
    /// Contacts of the earlier play, none where it is a decoder's, and of the later one.
    pub contacts: [usize; 2],
}

/// Plays, one after the other.
#[derive(Clone, Copy, Debug)]
pub struct Plays<'p> {
    /// All rows.
    pub recording: &'p Recording,
    /// Their contacts.
    pub fitted: &'p [Fitted],
    /// The later play's first row: 0 where there is no earlier one.
    pub later: usize,
}

/// Maps at a place in mm: µV/N per unit of each change.
pub type Changes<'m> = &'m (dyn Fn([f64; 2]) -> Vec<Maps> + Sync);
