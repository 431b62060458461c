//! Causes in what the pad is made of: friction, creep, temperature, age.

pub(crate) mod ageing;
pub(crate) mod creep;
pub(crate) mod hysteresis;
pub(crate) mod thermal_gain;
pub(crate) mod thermal_zero;
