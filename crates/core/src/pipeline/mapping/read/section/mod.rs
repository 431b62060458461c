//! The tables of a profile's text, one file for each kind; a button's kinds of press are in `effects` and `stages`.

pub(crate) mod access;
pub(crate) mod axes;
pub(crate) mod button;
pub(crate) mod dpad;
pub(crate) mod effects;
pub(crate) mod layers;
pub(crate) mod macros;
pub(crate) mod plate;
pub(crate) mod programs;
pub(crate) mod reach;
pub(crate) mod stages;
