//! The program as its users see it: what verbs print, what they refuse, the figures and files that they write.

mod adapt;
mod adapt_play;
#[cfg(target_os = "linux")]
mod bad_input;
#[cfg(target_os = "linux")]
mod calibrate;
mod conventions;
mod diagnose;
mod diagnose_play;
mod diagnose_report;
mod docs;
mod driven_load;
mod forms;
#[cfg(target_os = "linux")]
mod hints;
#[cfg(target_os = "linux")]
mod large_tables;
mod made;
mod networks;
mod paper;
mod plot;
#[cfg(target_os = "linux")]
mod profile_history;
#[cfg(target_os = "linux")]
mod profiles;
mod protocol;
mod ran;
#[cfg(target_os = "linux")]
mod recorded;
#[cfg(target_os = "linux")]
mod service;
#[cfg(target_os = "linux")]
mod setup;
mod simulate;
mod simulate_figures;
mod simulate_pad;
mod sizes;
mod sources;
#[path = "../support/mod.rs"]
mod support;
#[cfg(target_os = "linux")]
mod terminal;
#[cfg(target_os = "linux")]
mod tune;
mod twin_capture;
mod twin_verb;
#[cfg(target_os = "linux")]
mod undisturbed;
mod version;
mod vtk;
mod weigh;
mod written;
