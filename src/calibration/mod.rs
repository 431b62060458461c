//! From a pad's measured contacts to its own influence field: the simulator's field, corrected by what a pad differs in.
//!
//! Channel k reads s = z + gₖ Σₐ Fₐ Eₖₐ(x, y) + Σₗ Xₖₗ Σₐ Fₐ Eₗₐ(x, y), where
//!
//! ```text
//! E = G + Σⱼ pⱼ ∂G/∂pⱼ + background
//! ```
//!
//! G is the simulator's field, g the channels' gains, p the modules' poses and stiffnesses, X the crosstalk, z the zeros.
//! The background is a smooth polynomial for each channel and force: what a pad has and no named number explains. Every
//! number has a prior, centred on the nominal pad (or on another pad's calibration), so that 20 contacts say what they
//! can and leave the rest where it was. The size of the background and the channels' noise are found from the contacts
//! themselves: the background by the evidence, the noise from what is left over.
//!
//! Source: C. M. Bishop, Pattern Recognition and Machine Learning, section 3.5 (evidence); the model of a discrepancy
//! beside physical parameters is M. C. Kennedy, A. O'Hagan, J. R. Statist. Soc. B 63 (2001) 425.

mod before;
mod contacts;
pub mod fit;
mod model;
mod noise;
mod plate;
mod prepared;
mod problem;
pub mod regression;
mod scatter;
mod spread;
pub mod warmth;
