//! The look that all figures share: lengths in CSS pixels (1/96 inch), few greys.

use super::colour::Rgb;
use super::figure::{Ink, Stroke};

/// Text that is read first.
pub(super) const TEXT: Ink = Ink::opaque(Rgb::new(0x1f, 0x24, 0x2b));
/// Numbers at axes, notes.
pub(super) const QUIET: Ink = Ink::opaque(Rgb::new(0x52, 0x5b, 0x66));

/// Lines of axes and frames.
pub(super) const AXIS: Stroke = Stroke::solid(Rgb::new(0x7b, 0x84, 0x8f), 0.8);
/// Lines behind the values.
pub(super) const GRID: Stroke = Stroke::solid(Rgb::new(0xe6, 0xe8, 0xeb), 0.8);

pub(super) const TITLE_SIZE: f64 = 13.0;
pub(super) const LABEL_SIZE: f64 = 11.0;
pub(super) const NUMBER_SIZE: f64 = 10.0;
pub(super) const SMALL_SIZE: f64 = 8.0;

/// From the baseline to the middle of a digit, as a share of the size.
pub(super) const HALF_DIGIT: f64 = 0.36;
pub(super) const TICK: f64 = 4.0;
pub(super) const MARGIN: f64 = 12.0;
