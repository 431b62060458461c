//! The catalogue of causes: each file is one cause, with its physics, numbers, bounds, and what data it needs.
//!
//! A cause says how it changes the [`Chain`]; derivatives and refits follow from that. To add one, add its file and a line in
//! [`CATALOGUE`].

pub(crate) mod cause;
mod channel;
pub(crate) mod material;
mod module;
mod rig;

use self::cause::Cause;

/// All causes, in the order of reports.
pub(super) const CATALOGUE: [&dyn Cause; 29] = [
    &channel::channel_gain::ChannelGain,
    &channel::channel_offset::ChannelOffset,
    &channel::channel_crosstalk::ChannelCrosstalk,
    &channel::gauge_nonlinearity::GaugeNonlinearity,
    &channel::channel_skew::ChannelSkew,
    &module::module_displaced::ModuleDisplaced,
    &module::module_rotated::ModuleRotated,
    &module::module_tilted::ModuleTilted,
    &module::module_stiffness::ModuleStiffness,
    &module::module_debonded::ModuleDebonded,
    &module::module_frame_open::ModuleFrameOpen,
    &module::module_crosstalk::ModuleCrosstalk,
    &module::plate_stiffness::PlateStiffness,
    &channel::excitation_gain::ExcitationGain,
    &material::thermal_zero::ThermalZero,
    &material::thermal_gain::ThermalGain,
    &channel::zero_drift::ZeroDrift,
    &material::hysteresis::Hysteresis,
    &material::creep::Creep,
    &material::ageing::Ageing,
    &rig::reference_tilt::ReferenceTilt,
    &rig::reference_gain::ReferenceGain,
    &rig::reference_zero::ReferenceZero,
    &rig::stage_offset::StageOffset,
    &rig::stage_rotation::StageRotation,
    &rig::stage_scale::StageScale,
    &rig::contact_height::ContactHeight,
    &rig::contact_size::ContactSize,
    &rig::time_lag::TimeLag,
];
