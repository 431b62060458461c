//! The live bridge: reads the pad, stamps, drives the pipeline, writes events, records, answers.
//!
//! One thread, one loop (`event_loop`): poll, one clock read, one read, the pipeline, one write, one clock read. A program
//! that plays opens a pad (`opening`) and a sink, says what people may ask for (`requests`) and who reads profiles for
//! it and tells people what happens (`host`), and makes a bridge of these (`bridge_parts`). Whoever shows what the bridge is
//! doing takes the `snapshot`.

#![cfg(target_os = "linux")]

mod answer;
pub mod bridge_parts;
pub mod changes;
pub mod clock;
pub mod control;
pub mod destination;
mod driver;
pub mod error;
pub mod event_loop;
pub mod foreground;
pub mod host;
pub mod latency;
mod notifier;
pub mod observer;
pub mod opening;
mod pad_connection;
pub mod profile_update;
pub mod queue;
mod recorder;
pub mod request;
pub mod requests;
mod signals;
pub mod sink;
pub mod snapshot;
mod snapshot_builder;
pub mod state;
pub mod timing;
pub mod transport;
pub mod watchers;
pub mod weighing;
