//! From contacts to what should be held now.
//!
//! The mapping states *levels*; it never emits. `output::ledger` turns levels into edges.
//!
//! A profile's text becomes a [`profile::Profile`] in `binding` → `conflict`, `named` → `plate`, `stages`, `access`, `macros`, `effects` →
//! `dpad`, `layers`, `analogues`, `button` → `check`; each of these uses only those before it. The live part is what a touch is and where
//! (`rest` → `tremor` → `sector` → `directed`, `zone`, `steer`, `analogue`) and what goes on at a button (`gate` → `accept` → `press`, `stage` →
//! `effect`, together in `touched`). `verdict` is what people are told of it. What that comes to is collected in `stated`, where macros (`running`) have the last word. `engine`
//! puts it all together.

pub mod accept;
mod access;
mod action;
mod analogue;
mod analogues;
mod angle;
mod binding;
mod button;
pub mod check;
mod conflict;
mod curve;
mod directed;
mod dpad;
mod effect;
mod effects;
pub mod engine;
mod gate;
pub mod intent;
mod keys;
mod layers;
mod limits;
mod macros;
mod named;
mod place;
mod plate;
mod press;
pub mod profile;
pub mod program;
pub mod read;
mod rest;
mod running;
mod sector;
pub mod shipped;
pub mod sketch;
mod stage;
mod stages;
pub mod stated;
mod steer;
mod touched;
mod tremor;
pub mod verdict;
mod zone;
