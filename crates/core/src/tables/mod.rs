//! Tables of contacts: measured ones, plans to measure by, and the paper's dataset.

pub mod convention;
pub mod dataset;
pub mod measured;
pub mod plans;
pub mod recording;
pub mod units;
