//! The reference firmware, compiled for this machine, talks to the bridge over a pseudo-terminal.
//!
//! A slice of 5 s runs with the other tests, in a guest in virtual time. The whole proof is a minute of real time:
//! `cargo test --release --test bridge firmware::minute -- --ignored --nocapture`.

#[cfg(test)]
mod conversation;
#[cfg(test)]
mod host_pad;
#[cfg(test)]
mod minute;
