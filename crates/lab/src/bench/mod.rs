//! First measurements of a new pad: what its inputs do at rest, what a known weight makes of them, and which channel each of them carries.
//!
//! An *input* is what the pad sends in a channel's place. On a pad that is wired as it should be, inputs are channels.

pub mod deed;
pub mod guide;
pub mod order;
pub mod report;
pub mod rest;
pub mod samples;
pub mod touch;
