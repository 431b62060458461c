//! The displays of a running bridge on a desktop: a page in the browser, and an icon in the tray (Linux).

#![cfg(target_os = "linux")]

#[cfg(feature = "dashboard")]
pub mod dashboard;
#[cfg(feature = "tray")]
pub mod tray;
