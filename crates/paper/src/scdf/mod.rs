//! The paper's decoder, made as the paper makes it: learnt from simulated contacts ([`simulation`]), then adapted to a
//! pad with a few measured ones ([`adaptation`]); [`drawing`] shows what was learnt, [`schematic`] the network itself.
//!
//! The paper does not say how large its network is, and its errors on simulated contacts do not tell: all that were tried
//! do better. [`HIDDEN`] did best; `docs/network.md` has the trials.
//!
//! Source: Wu et al., *Sensors* 2026, 26(4), 1378, sections 2.5 and 2.6 (SCDF: strain-node contact-state decoding
//! framework).

pub mod adaptation;
pub mod drawing;
pub mod schematic;
pub mod simulation;

/// Neurons between the channels and the contact.
pub const HIDDEN: &[usize] = &[128, 128, 64];

/// Adam's rate in stage I; the paper's.
const RATE: f32 = 1e-3;

/// The paper's "mini-batch"; it does not say how many.
pub const BATCH: usize = 128;

/// "Training converged within 300 epochs."
pub const EPOCHS_MAX: usize = 300;

/// One example in ten is held out for validation, in both stages.
const VALIDATION_PART: usize = 10;
