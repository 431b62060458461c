//! From contacts to what should be held now.
//!
//! The mapping states *levels*; it never emits. `output::ledger` turns levels into edges.
//!
//! A profile's text becomes a [`profile::Profile`] in `binding` → `conflict` → `check`; each of these uses only
//! those before it. The live part is `sector`, `steer` and `press`, put together by `engine`.

mod binding;
pub mod check;
mod conflict;
pub mod engine;
pub mod intent;
mod limits;
mod press;
pub mod profile;
pub mod read;
mod sector;
pub mod shipped;
mod steer;
