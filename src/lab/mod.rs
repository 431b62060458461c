//! The laboratory: what is computed offline from tables, pads and decoders. Nothing here runs while a game is played.

pub mod ablation;
pub mod ageing;
pub mod calibration;
pub mod contacts;
pub mod damping;
pub mod diagnosis;
pub mod evaluation;
pub mod field_cache;
pub mod layout;
pub mod metrology;
pub mod play;
pub mod rig;
pub mod scdf;
pub mod tangent;
pub mod tuning;
