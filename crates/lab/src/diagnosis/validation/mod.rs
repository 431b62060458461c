//! The worth of findings on rows that had no part in finding them.

pub(crate) mod ceiling;
pub(crate) mod gain;
pub(crate) mod mean_square;
pub(crate) mod rounded;
