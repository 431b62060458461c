//! Guides: lists of steps with a state, that lead people through something. The page shows them and knows none by itself.

mod at_home;
mod cue_sequence;
mod cues;
mod first_run;
mod force_range;
pub(super) mod guide;
pub(super) mod list;
mod permutation_test;
mod pieces;
mod recording;
