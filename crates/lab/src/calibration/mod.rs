//! From a pad's measured contacts to its own influence field: the simulator's field, corrected by the pad's own parameters.
//!
//! Channel k reads s = z + gₖ Σₐ Fₐ Eₖₐ(x, y) + Σₗ Xₖₗ Σₐ Fₐ Eₗₐ(x, y), where
//!
//! ```text
//! E = G + Σⱼ pⱼ ∂G/∂pⱼ + background
//! ```
//!
//! G is the simulator's field of the nominal pad, or of one nearer to what is found where the tangent does not reach (`linearised`,
//! `flaws`), g the channels' gains, p the modules' poses and stiffnesses, X the crosstalk, z the zeros.
//! The background is a smooth polynomial for each channel and force: the discrepancy that no physical parameter explains. Every
//! parameter has a Gaussian prior, centred on the nominal pad (or on another pad's calibration), so that 20 contacts say what
//! they can and leave the others where they were. The posterior's maximum is found by Gauss and Newton's method, its covariance
//! by the Laplace approximation. Hyperparameters are found from the contacts themselves: the background's size, thresholds and
//! relaxation times by the evidence, the noise from the residuals. The whole model, with hysteresis, creep and temperature,
//! stands at `model`.
//!
//! Source: C. M. Bishop, Pattern Recognition and Machine Learning, section 3.5 (evidence); the model of a discrepancy
//! beside physical parameters is M. C. Kennedy, A. O'Hagan, J. R. Statist. Soc. B 63 (2001) 425.

pub mod change;
pub mod contacts;
pub mod earlier;
mod effort;
mod evidence;
mod field_error;
pub mod fit;
mod flaws;
mod hyperparameters;
mod jumps;
pub mod known;
mod lasting;
mod linearised;
mod model;
mod moments;
mod noise;
mod noise_model;
mod normal_equations;
pub mod numbers;
pub mod open;
pub mod physical;
mod plate;
mod posterior;
pub mod predictive;
mod prepared;
mod prior;
mod prior_deviations;
mod problem;
pub mod regression;
mod residual;
pub mod rig;
pub mod screening;
pub mod search;
pub mod thermal_fit;
