//! The page that shows a running bridge in a browser, and changes its profiles.
//!
//! ```text
//! calls ─observer→ shadow: the same pipeline once more ─feed→ websocket ─→ the page
//!                  ├ replay_buffer: the last minute ─rewind→ the presses of another profile
//!                  └ call_subscribers ─→ a calibration, which gets each call from its start on
//! the page ─api→ requests on the bridge, profiles of the host
//! ```
//!
//! It is served on the loopback interface alone. Each request is looked at by `guard.rs`: its host, its origin, its token; by
//! the handshake in `handshake.rs` a page finds the bridge that starts after the one that gave it. The live path does
//! nothing for the page but hand over its calls ([`tactpad_bridge::observer`]); the page's own pipeline makes them again on another thread, so the
//! page sees each event, and each stage is timed, without an instrument in the live path.

mod api;
mod app_state;
mod assets;
mod call_subscribers;
mod draft;
mod feed;
mod frame;
mod guard;
mod guides;
mod handshake;
pub mod host;
mod listener;
pub mod practice;
mod refusal;
mod replay_buffer;
mod rewind;
mod ring;
pub mod server;
mod shadow;
mod stale_comments;
pub mod user_key;
mod websocket;
mod words;
