//! The covariance of what no cause explains, the normal equations beside it, and regression on labels.

pub(crate) mod basis;
pub(crate) mod channel_rows;
pub(crate) mod covariance;
pub(crate) mod equations;
pub(crate) mod regression;
pub(crate) mod system;
pub(crate) mod whitening;
