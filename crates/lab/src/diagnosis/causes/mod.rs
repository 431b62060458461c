//! The catalogue of causes: each file is one cause, with its physics, numbers, bounds, and what data it needs.
//!
//! A cause says how it changes the [`Chain`]; derivatives and refits follow from that. To add one, add its file and a line in
//! [`CATALOGUE`].

mod ageing;
mod channel_crosstalk;
mod channel_gain;
mod channel_offset;
mod channel_skew;
mod contact_height;
mod contact_size;
pub(super) mod creep;
mod excitation_gain;
mod gauge_nonlinearity;
pub(super) mod hysteresis;
mod module_crosstalk;
mod module_debonded;
mod module_displaced;
mod module_frame_open;
mod module_rotated;
mod module_stiffness;
mod module_tilted;
mod plate_stiffness;
mod reference_gain;
mod reference_tilt;
mod reference_zero;
mod stage_offset;
mod stage_rotation;
mod stage_scale;
mod thermal_gain;
mod thermal_zero;
mod time_lag;
mod zero_drift;

use super::cause::Cause;

/// All causes, in the order of reports.
pub(super) const CATALOGUE: [&dyn Cause; 29] = [
    &channel_gain::ChannelGain,
    &channel_offset::ChannelOffset,
    &channel_crosstalk::ChannelCrosstalk,
    &gauge_nonlinearity::GaugeNonlinearity,
    &channel_skew::ChannelSkew,
    &module_displaced::ModuleDisplaced,
    &module_rotated::ModuleRotated,
    &module_tilted::ModuleTilted,
    &module_stiffness::ModuleStiffness,
    &module_debonded::ModuleDebonded,
    &module_frame_open::ModuleFrameOpen,
    &module_crosstalk::ModuleCrosstalk,
    &plate_stiffness::PlateStiffness,
    &excitation_gain::ExcitationGain,
    &thermal_zero::ThermalZero,
    &thermal_gain::ThermalGain,
    &zero_drift::ZeroDrift,
    &hysteresis::Hysteresis,
    &creep::Creep,
    &ageing::Ageing,
    &reference_tilt::ReferenceTilt,
    &reference_gain::ReferenceGain,
    &reference_zero::ReferenceZero,
    &stage_offset::StageOffset,
    &stage_rotation::StageRotation,
    &stage_scale::StageScale,
    &contact_height::ContactHeight,
    &contact_size::ContactSize,
    &time_lag::TimeLag,
];
