//! The page that shows a running bridge in a browser, and changes its profiles.
//!
//! ```text
//! calls ─observer→ shadow: the same pipeline once more ─feed→ websocket ─→ the page
//!                  ├ the last minute ─rewind→ what another profile would have done
//!                  └ ears ─→ a calibration, which hears each call from its begin on
//! the page ─api→ requests on the bridge, profiles of the library
//! ```
//!
//! It is served on the loopback interface alone. Each request is looked at by `guard.rs`: its host, its origin, its token. The live path does
//! nothing for the page but hand over its calls ([`tactpad_bridge::observer`]); the page's own pipeline makes them again on another thread, so the
//! page sees each event, and each stage is timed, without an instrument in the live path.

mod api;
mod assets;
mod draft;
mod ears;
mod feed;
mod frame;
mod guard;
mod guides;
pub mod library;
mod live;
mod office;
mod past;
mod refusal;
mod rewind;
mod ring;
pub mod server;
mod shadow;
