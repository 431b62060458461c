//! From a pad's measured contacts to its own influence field: the simulator's field, corrected by the pad's own parameters.
//!
//! Channel k reads
//!
//! ```text
//! y = z + Σₗ (1 + X)ₖₗ Σₐ Fₐ (gₗ Eₗₐ + Dₗₐ)(x, y),    E = G + Σⱼ pⱼ ∂G/∂pⱼ
//! ```
//!
//! G is the simulator's field of the nominal pad, or of one nearer to what is found where the tangent does not reach (`fit`), g the channels' gains, p the modules' poses and stiffnesses, X the crosstalk, z the zeros.
//! The background D is a smooth polynomial for each channel and force: the discrepancy that no physical parameter explains. Every
//! parameter has a Gaussian prior, centred on the nominal pad (or on another pad's calibration), so that 20 contacts say what
//! they can and leave the others where they were. The posterior's maximum is found by Gauss and Newton's method, its covariance
//! by the Laplace approximation. Hyperparameters are found from the contacts themselves: the background's size, thresholds and
//! relaxation times by the evidence, the noise from the residuals. The whole model, with hysteresis, creep and temperature,
//! stands at `model`.
//!
//! `model` has the parameters and their prior, `noise` the covariance of the residuals, `problem` the residuals and normal equations of all,
//! [`fit`] the search for the maximum, [`result`] the numbers and checks of it. [`data`] are the contacts, [`screening`] a look at them before
//! the fit. [`change`] holds recordings of one pad without labels against each other.
//!
//! Source: C. M. Bishop, Pattern Recognition and Machine Learning, section 3.5 (evidence); the model of a discrepancy
//! beside physical parameters is M. C. Kennedy, A. O'Hagan, J. R. Statist. Soc. B 63 (2001) 425.

pub mod change;
pub mod data;
pub mod fit;
mod model;
mod noise;
mod problem;
pub mod regression;
pub mod result;
pub mod screening;
