//! Numerical methods that know nothing of pads: linear systems, polynomials over the disc, oscillators, operators that
//! remember, random numbers, statistics.

pub mod chi_square;
pub mod dense;
pub mod linear;
pub mod memory;
pub mod oscillator;
pub mod principal;
pub mod products;
pub mod random;
pub mod simd;
pub mod statistics;
pub mod zernike;
