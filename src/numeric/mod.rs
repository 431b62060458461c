//! Numerical methods that know nothing of pads: symmetric systems, polynomials over the disc, random numbers,
//! statistics.

pub mod linear;
pub mod random;
pub mod statistics;
pub mod zernike;
