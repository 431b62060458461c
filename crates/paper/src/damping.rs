//! How fast a pad's ringing dies: no figure of this pad, but what such bonds have.

/// ζ that is taken. Nearly all strain energy of a moving pad is in its polymers: polyimide, glue, circuit. A motion's ζ is half the
/// loss factor of what it strains, and thermosets and polyimides have loss factors of 0.02 to 0.1. A finger that stays on
/// the plate adds to it; nothing was measured.
///
/// Source: L. Cremer, M. Heckl, Structure-Borne Sound (1988), chapter III; A. D. Nashif, D. I. G. Jones, J. P. Henderson, Vibration Damping
/// (1985), chapter 2.
pub const DAMPING_RATIO: f64 = 0.02;

/// Between what it lies.
pub const DAMPING_RANGE: [f64; 2] = [0.01, 0.05];
