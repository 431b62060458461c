//! Fits a profile's normal forces to a person who only presses: lightly in the first half of a recording, hard in the second.
//!
//! ```text
//! contacts over time ─peaks→ the highest force of each press ─range→ what is light and what is hard for this hand ┐
//! profile ─levels→ the normal forces that it asks for ─────────────────────────────────────────────────────────────┴─fit→ a profile
//! ```
//!
//! Nothing says what was meant, so only forces are fitted, and they are not tried one by one: a recording of 30 s has some dozen
//! presses, too few to compare values by what comes out. `docs/tuning.md` says the rules and their reasons.

pub mod fit;
pub mod levels;
pub mod peaks;
pub mod range;
