//! Causes in single channels and in what reads them.

pub(crate) mod channel_crosstalk;
pub(crate) mod channel_gain;
pub(crate) mod channel_offset;
pub(crate) mod channel_skew;
pub(crate) mod excitation_gain;
pub(crate) mod gauge_nonlinearity;
pub(crate) mod zero_drift;
