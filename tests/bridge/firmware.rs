//! The reference firmware, compiled for this machine, talks to the bridge over a pseudo-terminal.
//!
//! A slice of 5 s runs with the other tests. The whole proof is a minute:
//! `TACTPAD_FIRMWARE_SECONDS=60 cargo test --release --test bridge firmware::minute -- --nocapture`.

#[cfg(test)]
mod conversation;
#[cfg(test)]
mod host_pad;
#[cfg(test)]
mod minute;
