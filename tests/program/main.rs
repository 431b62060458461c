//! The program as its users see it: what verbs print, what they refuse, the figures and files that they write.

mod adapt;
mod adapt_play;
#[cfg(all(feature = "live", target_os = "linux"))]
mod bad_input;
#[cfg(all(feature = "live", target_os = "linux"))]
mod calibrate;
mod diagnose;
mod diagnose_play;
mod diagnose_report;
#[cfg(feature = "simulator")]
mod docs;
#[cfg(all(feature = "live", target_os = "linux"))]
mod hints;
#[cfg(target_os = "linux")]
mod large_tables;
mod networks;
mod paper;
mod plot;
#[cfg(all(feature = "live", target_os = "linux"))]
mod profiles;
mod ran;
#[cfg(all(feature = "live", target_os = "linux"))]
mod recorded;
mod simulate;
#[cfg(feature = "simulator")]
mod simulate_figures;
#[cfg(feature = "simulator")]
mod simulate_pad;
#[cfg(feature = "simulator")]
mod sizes;
#[path = "../support/mod.rs"]
mod support;
#[cfg(all(feature = "live", target_os = "linux"))]
mod terminal;
#[cfg(all(feature = "live", target_os = "linux"))]
mod tune;
mod twin_capture;
mod twin_verb;
#[cfg(all(feature = "live", target_os = "linux"))]
mod undisturbed;
mod vtk;
mod weigh;
mod written;
