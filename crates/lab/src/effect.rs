//! What a diagnosis can name: one row of a table for each effect.

use std::collections::BTreeSet;
use std::fmt;
use std::sync::{Mutex, PoisonError};

use serde::{Deserialize, Serialize, Serializer};

/// What kind of cause an effect is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum EffectFamily {
    /// Of channels, supply or reference: all of them are factors of what is read.
    Gain,
    /// Wires, converters, and what they pick up.
    Electrical,
    /// Plate, modules, bonds and frames, or whatever bears the load.
    Mechanical,
    /// What measures and writes down.
    Rig,
    /// What changes with time, temperature, load cycles or the loads before.
    Time,
    /// How what was written is meant.
    Labels,
}

/// What somebody's own simulation can vary.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct OwnEffect {
    name: &'static str,
    sentence: &'static str,
    family: EffectFamily,
}

impl OwnEffect {
    /// An effect of this name.
    pub fn new(name: &str, family: EffectFamily) -> Self {
        let sentence = interned(&format!("{name} is not as in the model"));
        Self { name: interned(name), sentence, family }
    }

    /// Its name.
    pub const fn name(self) -> &'static str {
        self.name
    }
}

/// The same text for as long as the program runs; each is kept once.
pub(crate) fn interned(text: &str) -> &'static str {
    static KEPT: Mutex<BTreeSet<&'static str>> = Mutex::new(BTreeSet::new());
    let mut kept = KEPT.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(known) = kept.get(text) {
        return known;
    }
    let text: &'static str = Box::leak(text.into());
    kept.insert(text);
    text
}

/// What becomes of a device's number by a finding's value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum DeviceChange {
    Add,
    Multiply,
    Replace,
}

use DeviceChange::{Add, Multiply, Replace};

/// A finding's number, and the device's number that it changes, by the names of
/// [`Parameter`](tactpad_core::pad::device::parameter::Parameter).
pub(crate) type DeviceNumber = (&'static str, &'static str, DeviceChange);

macro_rules! effects {
    ($($effect:ident: $name:literal, $title:literal, $sentence:literal $(=> $($number:expr),+)?;)*) => {
        /// A cause of a difference, a fault of a recording, or a change, by the name that reports give it.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        pub enum Effect {
            $(#[doc = $title] $effect,)*
            /// What somebody's own simulation can vary.
            Own(OwnEffect),
        }

        impl Effect {
            /// All of the table, in its order.
            pub const ALL: &[Self] = &[$(Self::$effect,)*];

            /// Its name in JSON and in arguments.
            pub const fn name(self) -> &'static str {
                match self { $(Self::$effect => $name,)* Self::Own(own) => own.name }
            }

            /// Its name for people.
            pub const fn title(self) -> &'static str {
                match self { $(Self::$effect => $title,)* Self::Own(own) => own.name }
            }

            /// The sentence that a finding makes of it.
            ///
            /// `{gain|too much|too little}` is how far the number lies from none, with the word of its sign; `{uv_per_c}` is the number
            /// with its own sign, `{x_mm|in x}` with a word behind it. Of numbers that `&` joins those are told that are not none within
            /// their intervals. Numbers without a unit are told in per cent.
            pub const fn sentence(self) -> &'static str {
                match self { $(Self::$effect => $sentence,)* Self::Own(own) => own.sentence }
            }

            /// The device's numbers that hold it; none where it is no number of a device file, or not one by itself.
            pub(crate) const fn device_numbers(self) -> &'static [DeviceNumber] {
                match self { $(Self::$effect => &[$($($number),+)?],)* Self::Own(_) => &[] }
            }
        }
    };
}

effects! {
    ChannelGain: "channel_gain", "wrong gain", "{target} reads {gain|too much|too little}"
        => ("gain", "module.{module}.gain.{axis}", Multiply);
    ModuleGain: "module_gain", "module gain", "{target} reads {gain|too much|too little}";
    ChannelOffset: "channel_offset", "offset", "{target} reads {offset_uv} without load"
        => ("offset_uv", "module.{module}.offset_uv.{axis}", Add);
    NoiseExcess: "noise_excess", "too much noise", "{target} is {factor|noisier|quieter} than it should be";
    LabelFrame: "label_frame", "another frame", "{target} stand in another frame than the pad's: {map}";
    LabelSign: "label_sign", "other signs", "the signs of {with} are not those of a finger on the plate: {map}";
    LabelUnit: "label_unit", "another unit", "the unit of {with} is another: {factor} of the one that is expected";
    LabelStuck: "label_stuck", "stuck label", "{target} stands still in {rows}, while the contacts go on";
    LabelRounded: "label_rounded", "rounded label", "{target} is rounded to {step}";
    RowShift: "row_shift", "rows out of step", "{target} are {rows|late|early}";
    ChannelDead: "channel_dead", "dead channel", "{target} is dead";
    ChannelPolarity: "channel_polarity", "reversed channel", "{target} has the wrong sign";
    ChannelsSwapped: "channels_swapped", "swapped channels", "{target} and {with} have changed places";
    ChannelCrosstalk: "channel_crosstalk", "crosstalk between channels", "{target} takes up {share} of {with}";
    GaugeNonlinearity: "gauge_nonlinearity", "bent response", "the response of {target} is bent by {second_order_percent_fs}";
    AdcClipping: "adc_clipping", "clipping", "{target} is clipped at {limit_uv}";
    ChannelIntermittent: "channel_intermittent", "intermittent connection",
        "{target} reads {gain|too much|too little} in {share_of_rows} of the rows, and goes there and back";
    ChannelSkew: "channel_skew", "channel out of step", "{target} is read {skew_us|late|early}"
        => ("skew_us", "sampling.skew_us.{channel}", Add);
    MainsPickup: "mains_pickup", "mains pickup", "{target} takes up {amplitude_uv} of the mains at {frequency_hz}";
    ModuleDisplaced: "module_displaced", "module out of place",
        "{target} stands {radial_mm|too far out|too far in&tangential_mm|too far counter-clockwise|too far clockwise}"
        => ("radial_mm", "module.{module}.radial_mm", Add),
           ("tangential_mm", "module.{module}.tangential_mm", Add);
    ModuleRotated: "module_rotated", "turned module", "{target} is turned {deg|counter-clockwise|clockwise}"
        => ("deg", "module.{module}.rotation_deg", Add);
    ModuleTilted: "module_tilted", "tilted module",
        "{target} is tilted by {tangential_deg|along the tangent&radial_deg|along the radius}"
        => ("tangential_deg", "module.{module}.tilt_tangential_deg", Add),
           ("radial_deg", "module.{module}.tilt_radial_deg", Add);
    ModuleStiffness: "module_stiffness", "wrong stiffness of a module",
        "the frame of {target} is {factor|stiffer|softer} than in the model"
        => ("factor", "module.{module}.frame_e_factor", Multiply);
    ModuleDebonded: "module_debonded", "bond come off", "the bond of {target} is off over {area_share} of its area";
    ModuleFrameOpen: "module_frame_open", "open frame",
        "the frame of {target} is open over {area_share} of its area, on its {side} side";
    ModuleCrosstalk: "module_crosstalk", "crosstalk between modules", "{target} takes up {share} of {with}";
    PlateStiffness: "plate_stiffness", "wrong stiffness of the plate",
        "the plate is {factor|stiffer|softer} than in the model"
        => ("factor", "material.plate.e_mpa", Multiply);
    ExcitationGain: "excitation_gain", "wrong excitation", "every channel reads {gain|too much|too little}"
        => ("gain", "module.{module}.gain.{axis}", Multiply);
    ThermalZero: "thermal_zero", "zero moving with temperature", "the zero of {target} moves by {uv_per_c}"
        => ("uv_per_c", "thermal.zero_uv_per_c.{channel}", Add);
    ThermalGain: "thermal_gain", "gain changing with temperature", "the gain of {target} changes by {per_c}"
        => ("per_c", "thermal.gain_per_c.{channel}", Add);
    ZeroDrift: "zero_drift", "drifting zero", "the zero of {target} drifts by {uv_per_h}"
        => ("uv_per_h", "noise.drift_uv_per_h.{channel}", Add);
    Hysteresis: "hysteresis", "hysteresis", "{target} keeps {share_of_full_scale} of full scale after a load";
    Creep: "creep", "creep", "{target} creeps by {share_at_20s} within 20 s";
    Ageing: "ageing", "ageing", "{target} has lost {share_at_end} of its signal by the last cycle"
        => ("share_at_end", "ageing.share.{channel}", Add);
    ReferenceTilt: "reference_tilt", "force reference askew",
        "the force reference stands askew by {x_deg|about x&y_deg|about y}"
        => ("x_deg", "rig.reference_tilt_x_deg", Add),
           ("y_deg", "rig.reference_tilt_y_deg", Add);
    ReferenceGain: "reference_gain", "wrong gain of the force reference",
        "the force reference writes {gain|too much|too little}"
        => ("gain", "rig.reference_gain", Multiply);
    ReferenceZero: "reference_zero", "offset of the force reference",
        "the zero of the force reference is off by {fx_n|in x&fy_n|in y&fz_n|in z}"
        => ("fx_n", "rig.reference_zero_n.x", Add),
           ("fy_n", "rig.reference_zero_n.y", Add),
           ("fz_n", "rig.reference_zero_n.z", Add);
    StageOffset: "stage_offset", "stage out of place", "the stage is off by {x_mm|in x&y_mm|in y&z_mm|in z}"
        => ("x_mm", "rig.stage_x_mm", Add),
           ("y_mm", "rig.stage_y_mm", Add);
    StageRotation: "stage_rotation", "turned stage", "the stage is turned {deg|counter-clockwise|clockwise}"
        => ("deg", "rig.stage_rotation_deg", Add);
    StageScale: "stage_scale", "wrong scale of the stage", "true distances are {scale|longer|shorter} than the stage writes"
        => ("scale", "rig.stage_scale", Multiply);
    ContactHeight: "contact_height", "height of the contact", "the forces act {mm|above|below} the plate’s surface";
    ContactSize: "contact_size", "size of the contact", "the contact has a radius of {radius_mm}"
        => ("radius_mm", "contact.patch_radius_mm", Replace);
    TimeLag: "time_lag", "labels out of step", "the labels are {ms|late|early}"
        => ("ms", "rig.label_lag_ms", Add);
    Unlisted: "unlisted_cause", "a part of something that is not in the catalogue", "something else is wrong";
}

impl Effect {
    /// What kind of cause it is; none where that is not known.
    pub const fn family(self) -> Option<EffectFamily> {
        use EffectFamily::{Electrical, Gain, Labels, Mechanical, Rig, Time};
        Some(match self {
            Self::ChannelGain | Self::ModuleGain | Self::ExcitationGain | Self::ReferenceGain => Gain,
            Self::ChannelOffset
            | Self::NoiseExcess
            | Self::ChannelDead
            | Self::ChannelPolarity
            | Self::ChannelsSwapped
            | Self::ChannelCrosstalk
            | Self::GaugeNonlinearity
            | Self::AdcClipping
            | Self::ChannelIntermittent
            | Self::ChannelSkew
            | Self::MainsPickup => Electrical,
            Self::ModuleDisplaced
            | Self::ModuleRotated
            | Self::ModuleTilted
            | Self::ModuleStiffness
            | Self::ModuleDebonded
            | Self::ModuleFrameOpen
            | Self::ModuleCrosstalk
            | Self::PlateStiffness => Mechanical,
            Self::ThermalZero
            | Self::ThermalGain
            | Self::ZeroDrift
            | Self::Hysteresis
            | Self::Creep
            | Self::Ageing => Time,
            Self::ReferenceTilt
            | Self::ReferenceZero
            | Self::StageOffset
            | Self::StageRotation
            | Self::StageScale
            | Self::ContactHeight
            | Self::ContactSize
            | Self::TimeLag => Rig,
            Self::LabelFrame
            | Self::LabelSign
            | Self::LabelUnit
            | Self::LabelStuck
            | Self::LabelRounded
            | Self::RowShift => Labels,
            Self::Own(own) => own.family,
            Self::Unlisted => return None,
        })
    }

    /// The effect of this name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.iter().copied().find(|effect| effect.name() == name)
    }
}

impl fmt::Display for Effect {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

impl Serialize for Effect {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.name())
    }
}
