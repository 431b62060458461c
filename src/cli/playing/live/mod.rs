//! The live verbs: those that need ports, virtual devices and a clock.

#[cfg(feature = "tray")]
pub(crate) mod alone;
pub(super) mod bench;
pub(super) mod calibrate;
#[cfg(feature = "dashboard")]
mod calibrated;
mod chosen;
pub(super) mod ctl;
pub(super) mod demo;
mod described;
pub(super) mod devices;
mod displays;
pub(super) mod doctor;
mod figures;
mod files;
mod follower;
pub(crate) mod guardian;
mod guided_pad;
mod keeping;
mod kept_play;
mod last_choice;
pub(super) mod latency;
mod left_keys;
mod output;
#[cfg(feature = "dashboard")]
mod page;
#[cfg(feature = "dashboard")]
mod page_memory;
mod playing;
#[cfg(feature = "dashboard")]
mod practising;
mod profile_reader;
mod profile_selection;
pub(super) mod record;
#[cfg(feature = "dashboard")]
mod reported;
pub(super) mod run;
mod runtime;
mod screen;
pub(super) mod setup;
mod sound;
#[cfg(feature = "tray")]
mod tray_profiles;
mod wired;
