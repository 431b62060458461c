//! The live bridge: reads the pad, stamps, drives the pipeline, writes events, records, answers.
//!
//! One thread, one loop (`running`): poll, one clock read, one read, the pipeline, one write, one clock read. A program
//! that plays opens a pad (`opening`) and a sink, says what people may ask for (`requests`) and who reads profiles for
//! it and tells people what happens (`host`), and makes a bridge of these (`parts`). Whoever shows what the bridge is
//! doing takes the `snapshot`.

#![cfg(target_os = "linux")]

mod answer;
pub mod changes;
pub mod clock;
pub mod control;
pub mod destination;
mod driver;
pub mod error;
pub mod front;
mod herald;
pub mod host;
mod keeper;
pub mod latency;
pub mod observer;
pub mod offer;
pub mod opening;
pub mod parts;
pub mod queue;
mod recorder;
pub mod request;
pub mod requests;
pub mod running;
mod sight;
mod signals;
pub mod sink;
pub mod snapshot;
pub mod state;
pub mod timing;
pub mod transport;
pub mod watchers;
pub mod weighing;
