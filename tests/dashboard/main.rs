//! The page of a running bridge: asked by plain requests, and used in a headless browser as people use it.
#![cfg(target_os = "linux")]
#![allow(clippy::unwrap_used, reason = "a test stops at the first surprise")]

mod access;
mod browser;
mod calibrate;
#[path = "../support/clock.rs"]
mod clock;
mod disturbance;
mod drawn_requests;
mod editor;
mod finger;
mod guides;
mod http;
mod leftovers;
mod live;
mod numbers;
mod openings;
mod pictures;
mod profile_history;
mod reconnection;
mod reports;
#[path = "../bridge/running.rs"]
#[expect(dead_code, reason = "other tests use the rest of it")]
mod running;
mod security;
mod shown;
#[path = "../support/mod.rs"]
mod support;
