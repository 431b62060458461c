//! The pad's output without a decoder: the sum of the three z channels.
//!
//! The plate is held by the three modules, so their z channels share a press between them. The shares depend
//! a little on the place; at one place the sum is proportional to the force.

use tactpad_core::quantity::{CHANNELS, MODULES};

/// The sum of the z channels, in µV.
pub(super) fn sum_uv(uv: &[f64; CHANNELS]) -> f64 {
    (0..MODULES).map(|module| uv[3 * module + 2]).sum()
}

/// Whether a channel is a z channel.
pub(super) const fn is_z(channel: usize) -> bool {
    channel % 3 == 2
}
