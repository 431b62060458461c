//! What a desktop shows of a running bridge: a page in the browser, and an icon among those of the desktop (Linux).

#![cfg(target_os = "linux")]

#[cfg(feature = "dashboard")]
pub mod dashboard;
#[cfg(feature = "tray")]
pub mod tray;
