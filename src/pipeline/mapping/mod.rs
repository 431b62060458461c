//! From contacts to what should be held now.
//!
//! The mapping states *levels*; it never emits. `output::ledger` turns levels into edges.
//!
//! A profile's text becomes a [`profile::Profile`] in `binding` → `conflict`, `plate`, `stages`, `access` → `dpad`, `button` →
//! `check`; each of these uses only those before it. The live part is where a contact is (`tremor` → `sector`, `zone`, `steer`) and
//! what goes on at a button (`gate` → `accept` → `press`, `stage` → `effect`, together in `touched`), put together by `engine`.

pub mod accept;
mod access;
mod angle;
mod binding;
mod button;
pub mod check;
mod conflict;
mod dpad;
mod effect;
pub mod engine;
mod gate;
pub mod intent;
mod keys;
mod limits;
mod place;
mod plate;
mod press;
pub mod profile;
pub mod read;
mod sector;
pub mod shipped;
mod stage;
mod stages;
mod steer;
mod touched;
mod tremor;
mod zone;
