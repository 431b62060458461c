//! The reference firmware, compiled for this machine, talks to the bridge over a pseudo-terminal.
//!
//! A slice of 5 s runs with the other tests. The whole proof is a minute:
//! `TACTPAD_FIRMWARE_SECONDS=60 cargo test --release --test firmware -- --nocapture`.
#![cfg(all(feature = "live", target_os = "linux"))]

#[cfg(test)]
#[path = "support/c_compiler.rs"]
mod c_compiler;
#[cfg(test)]
#[path = "firmware/conversation.rs"]
mod conversation;
#[cfg(test)]
#[path = "firmware/host_pad.rs"]
mod host_pad;
#[cfg(test)]
#[path = "firmware/minute.rs"]
mod minute;
#[cfg(test)]
mod support;
