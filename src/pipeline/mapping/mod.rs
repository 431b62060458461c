//! From contacts to what should be held now.
//!
//! The mapping states *levels*; it never emits. `output::ledger` turns levels into edges.
//!
//! A profile's text becomes a [`profile::Profile`] in `binding` → `conflict` → `button` → `check`; each of these uses only
//! those before it. The live part is `sector`, `steer`, `press` and
//! `effect`, put together by `engine`.

mod binding;
mod button;
pub mod check;
mod conflict;
mod effect;
pub mod engine;
pub mod intent;
mod limits;
mod press;
pub mod profile;
pub mod read;
mod sector;
pub mod shipped;
mod steer;
