//! The paper's studies with tactpad's own pad: where modules should stand, figures of merit, the comparison of decoders,
//! and the paper's network.
//!
//! Source: Wu et al., *Sensors* 2026, 26(4), 1378.

pub mod ablation;
pub mod damping;
pub mod layout;
pub mod metrology;
pub mod scdf;
