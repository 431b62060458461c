//! All decoders on one pad: the paper's Table 3, with what the paper does not compare.
//!
//! The twin's pad carries out the paper's plan, and each of the [`entries`] learns from a part of it. Then the same pad
//! makes contacts that no decoder has seen ([`unseen`]), and presses the six regions of the paper's Figure 11
//! ([`regions`]). What comes of it is drawn by [`drawing`] and [`maps`]; [`trials`] does it all.
//!
//! Rows are drawn as `adapt --rows` draws them, and seeds are passed on as they are: each row can be made again with
//! `train`, `twin`, `adapt` and `evaluate`.

mod carried_out;
pub mod drawing;
pub mod entries;
pub mod fitting;
pub mod maps;
pub mod regions;
pub mod trials;
pub mod unseen;

use tactpad_core::pad::device::Device;
use tactpad_core::pad::field::PadField;

/// A pad with its field.
#[derive(Clone, Copy, Debug)]
pub struct Pad<'p> {
    /// The pad.
    pub device: &'p Device,
    /// Its influence field.
    pub field: &'p PadField,
}

/// The pad that is decoded.
#[derive(Clone, Copy, Debug)]
pub struct Subject<'p> {
    /// As designed: what decoders know without a measurement.
    pub designed: Pad<'p>,
    /// As it is: what the twin measures.
    pub actual: Pad<'p>,
    /// Draws all that is random.
    pub seed: u64,
}
