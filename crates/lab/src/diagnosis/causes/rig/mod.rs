//! Causes in the rig that measures, and in what it writes down.

pub(crate) mod contact_height;
pub(crate) mod contact_size;
pub(crate) mod reference_gain;
pub(crate) mod reference_tilt;
pub(crate) mod reference_zero;
pub(crate) mod stage_offset;
pub(crate) mod stage_rotation;
pub(crate) mod stage_scale;
pub(crate) mod time_lag;
