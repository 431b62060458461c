//! Fits a profile to a hand: from a recording and a table of what was meant when, to numbers of the profile with which more of what
//! was meant comes out.
//!
//! ```text
//! calls ─trace→ contacts over time ┐
//! CSV   ─labels→ what was meant    ├─scoring→ what came for each of them ─confusion→ a table for people
//! profile ─────────────────────────┘
//!
//! contacts where something was meant ─places→ centre and rotation of the hand ┐
//! each number of the profile ─knobs→ values to try ───────────────────────────┴─fitting→ the values with which most is right
//! ```
//!
//! `docs/tuning.md` says what counts as right, how late a profile decides, and how values are chosen. [`difference`] says what a
//! changed profile would have done to an old recording. [`force_range`] fits forces alone, to a person who only presses.

pub mod confusion;
pub mod delay;
pub mod difference;
pub mod fitting;
pub mod force_range;
pub mod knobs;
pub mod labels;
pub mod places;
pub mod scoring;
pub mod trace;
pub mod vocabulary;
pub mod words;
