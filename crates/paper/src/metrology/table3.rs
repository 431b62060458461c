//! The paper's Table 3: how far its decoders are off.
//!
//! Source: Wu et al., *Sensors* 2026, 26(4), 1378, Table 3. All but those that know the simulation only learnt from measured
//! contacts; where none are counted it is all 648.

use serde::Serialize;

/// Mean magnitudes of a decoder's errors, as published. The paper does not say over what.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PublishedErrors {
    /// Position.
    pub position_mae_mm: f64,
    /// Three-axis force.
    pub force_mae_n: f64,
}

/// "MLP (only simulation)".
pub const NETWORK_SIMULATED: PublishedErrors = errors(10.2, 0.51);
/// "N = 216 Fz".
pub const NETWORK_216: PublishedErrors = errors(3.51, 0.35);
/// "N = 216 Fz + 144 Fx and Fy".
pub const NETWORK_360: PublishedErrors = errors(2.87, 0.27);
/// "N = 216 Fz + 288 Fx and Fy".
pub const NETWORK_504: PublishedErrors = errors(2.38, 0.21);
/// "N = 648".
pub const NETWORK_648: PublishedErrors = errors(1.97, 0.17);
/// "KNN (K = 5, only sim data)".
pub const NEIGHBOURS_SIMULATED: PublishedErrors = errors(12.1, 0.69);
/// "KNN (K = 5, only real data)".
pub const NEIGHBOURS_648: PublishedErrors = errors(3.01, 0.38);
/// "Linear Regression (only sim data)".
pub const LINEAR_SIMULATED: PublishedErrors = errors(15.3, 0.75);
/// "Linear Regression (only real data)".
pub const LINEAR_648: PublishedErrors = errors(3.59, 0.43);

const fn errors(position_mae_mm: f64, force_mae_n: f64) -> PublishedErrors {
    PublishedErrors { position_mae_mm, force_mae_n }
}
