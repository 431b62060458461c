//! The laboratory of tactpad: decoders fitted to what a pad has measured, and causes named of what it measures otherwise
//! than its model. All of it is computed offline; nothing here runs while a game is played.

pub mod ageing;
pub mod bench;
pub mod calibration;
pub mod contacts;
pub mod diagnosis;
pub mod effect;
pub mod evaluation;
pub mod play;
pub mod rig;
pub mod tangent;
pub mod tuning;
