//! How sure the diagnosis and what compares recordings are: one level, one power, one size of what a model may be wrong by. Who differs says
//! so where he does.

/// How often anything may be found where nothing is wrong: the family-wise level.
pub const LEVEL: f64 = 0.03;
/// Share of measurements like this one in which a cause of the stated size is found.
pub const POWER: f64 = 0.9;
/// The normal quantile below which a share of [`POWER`] lies.
pub const POWER_QUANTILE: f64 = 1.281_552;
/// Quantile of a normal number: 95 % lie within.
pub const WITHIN_95: f64 = 1.959_964;
/// Largest background, as a share of a channel's root mean square.
pub const BACKGROUND_MAX: f64 = 0.03;
/// A field is known no better than the largest background that is left beside it, and so are signatures that are made of it.
pub const SIGNATURE_ERROR: f64 = BACKGROUND_MAX;
/// Root mean square of what a model itself gets wrong, smooth as well and the same way. The pad's simulator: 0.44 % against an independent
/// solution.
pub const MODEL_ERROR: f64 = 0.005;
/// Largest smooth remainder that is not a finding.
pub const REMAINDER_MAX: f64 = BACKGROUND_MAX + MODEL_ERROR;
