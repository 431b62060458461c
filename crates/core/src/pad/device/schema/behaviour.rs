//! The numbers of a [`Behaviour`]: keys, units, ranges.
//!
//! Most ranges begin at zero, which is none of the fault, so they cannot tell every wrong unit. They end where a pad or
//! a rig would not be faulty but broken; `models/README.md` says how large such faults are.

use std::slice;

use super::{AXES, Access, DEG, Effect, Key, MM, NEWTON, PATCH, RATIO, TILT_DEG, Table, UV};
use crate::pad::device::behaviour::{Behaviour, Crosstalk, ModuleCrosstalk, OnChannels};
use crate::pad::device::unit::Unit;
use crate::quantity::CHANNEL_NAMES;
use tactpad_numeric::memory::{PlayOperator, Relaxation};

const SECOND: Unit = Unit::Second;

/// Correlation times: from a sample to a session.
const CORRELATION_S: (f64, f64) = (0.001, 1_000.0);
const STAGE_MM: (f64, f64) = (-10.0, 10.0);
const SCATTER_MM: (f64, f64) = (0.0, 5.0);
const SCATTER_SHARE: (f64, f64) = (0.0, 0.5);
/// Half a signal in another channel is no leak but a wrong wire.
const LEAK: (f64, f64) = (-0.5, 0.5);

macro_rules! number {
    ($table:ident.$key:ident, $unit:expr, $range:expr, $meaning:literal) => {
        Key::<Behaviour>::new(stringify!($key), $unit, $range, one!($table.$key), $meaning)
            .with(Effect::Behaviour)
    };
}

macro_rules! channels {
    ($table:ident.$key:ident, $unit:expr, $range:expr, $meaning:literal) => {
        Key::<Behaviour>::new(stringify!($key), $unit, $range, list!($table.$key), $meaning)
            .listed(&CHANNEL_NAMES)
            .with(Effect::Behaviour)
    };
}

macro_rules! entry {
    ($record:ty, $key:ident, $unit:expr, $range:expr, $meaning:literal) => {
        Key::<$record>::new(stringify!($key), $unit, $range, one!($key), $meaning).with(Effect::Behaviour)
    };
}

macro_rules! law {
    ($law:ty, $key:ident, $field:ident, $unit:expr, $range:expr, $meaning:literal) => {
        Key::<OnChannels<$law>>::new(stringify!($key), $unit, $range, one!(law.$field), $meaning)
            .with(Effect::Behaviour)
    };
}

/// The tables that a file may have once.
pub(in crate::pad::device) static BEHAVIOUR: [Table<Behaviour>; 7] = [
    Table { path: "thermal", words: &[], keys: &THERMAL },
    Table {
        path: "ageing",
        words: &[],
        keys: &[
            channels!(
                ageing.share,
                RATIO,
                (-0.5, 0.5),
                "the share of the strain that is lost after \"cycles\""
            ),
            number!(
                ageing.cycles,
                Unit::Cycle,
                (100.0, 1e7),
                "the cycles of load after which \"share\" is lost"
            ),
            number!(
                ageing.onset_cycles,
                Unit::Cycle,
                (1.0, 1e6),
                "the cycles of load after which the loss slows down"
            ),
        ],
    },
    Table { path: "noise", words: &[], keys: &NOISE },
    Table {
        path: "mains",
        words: &[],
        keys: &[
            channels!(mains.amplitude_uv, UV, (-1_000.0, 1_000.0), "the amplitude of the mains' sine"),
            number!(mains.frequency_hz, Unit::Hertz, (45.0, 65.0), "the mains' frequency, 50 or 60 Hz"),
        ],
    },
    Table {
        path: "sampling",
        words: &[],
        keys: &[
            number!(sampling.range_uv, UV, (3_000.0, 2e6), "the largest magnitude that is converted"),
            number!(sampling.step_uv, UV, (0.0, 10_000.0), "one count of the converter, 0 for none"),
            channels!(sampling.skew_us, Unit::Microsecond, (0.0, 50_000.0), "how late a channel is sampled"),
        ],
    },
    Table {
        path: "finger",
        words: &[PATCH[0].name],
        keys: &[
            number!(
                finger.wander_mm,
                MM,
                SCATTER_MM,
                "the standard deviation of a held contact's place along x and along y"
            ),
            number!(finger.wander_time_s, SECOND, CORRELATION_S, "how long the place stays about the same"),
            number!(
                finger.tremor_share,
                RATIO,
                SCATTER_SHARE,
                "the standard deviation of a held force's relative error"
            ),
            number!(finger.tremor_time_s, SECOND, CORRELATION_S, "how long the force stays about the same"),
        ],
    },
    Table { path: "rig", words: &[], keys: &RIG },
];

static THERMAL: [Key<Behaviour>; 6] = [
    number!(
        thermal.reference_c,
        Unit::Celsius,
        (-20.0, 60.0),
        "the temperature at which gains and offsets are those of the modules"
    ),
    channels!(
        thermal.zero_uv_per_c,
        Unit::MicrovoltPerKelvin,
        (-1_000.0, 1_000.0),
        "the slope of the zero by temperature"
    ),
    channels!(
        thermal.zero_uv_per_c2,
        Unit::MicrovoltPerKelvin2,
        (-10.0, 10.0),
        "the curvature of the zero by temperature"
    ),
    channels!(
        thermal.gain_per_c,
        Unit::PerKelvin,
        (-0.01, 0.01),
        "the relative change of the gain by temperature"
    ),
    number!(
        thermal.zero_scatter_uv_per_c,
        Unit::MicrovoltPerKelvin,
        (0.0, 300.0),
        "the standard deviation of \"zero_uv_per_c\" from pad to pad"
    ),
    number!(
        thermal.gain_scatter_per_c,
        Unit::PerKelvin,
        (0.0, 0.01),
        "the standard deviation of \"gain_per_c\" from pad to pad"
    ),
];

static NOISE: [Key<Behaviour>; 5] = [
    channels!(noise.additive_uv, UV, (0.0, 1_000.0), "the standard deviation of each sample's own error"),
    channels!(noise.share, RATIO, (0.0, 0.2), "the standard deviation of the signal's relative error"),
    number!(
        noise.share_time_s,
        SECOND,
        (0.0, 1_000.0),
        "how long the relative error stays about the same, 0 if each sample has its own"
    ),
    channels!(
        noise.drift_uv_per_h,
        Unit::MicrovoltPerHour,
        (-10_000.0, 10_000.0),
        "the even drift of the zero"
    ),
    channels!(
        noise.walk_uv,
        UV,
        (0.0, 10_000.0),
        "the standard deviation of the zero's random walk after an hour"
    ),
];

static RIG: [Key<Behaviour>; 12] = [
    number!(
        rig.reference_tilt_x_deg,
        DEG,
        TILT_DEG,
        "the turn of the reference sensor about x, right-handed"
    ),
    number!(
        rig.reference_tilt_y_deg,
        DEG,
        TILT_DEG,
        "the turn of the reference sensor about y, right-handed"
    ),
    number!(rig.reference_gain, RATIO, (0.5, 2.0), "the written force over the true one"),
    Key::<Behaviour>::new(
        "reference_zero_n",
        NEWTON,
        (-10.0, 10.0),
        list!(rig.reference_zero_n),
        "the written force minus the true one along x, y, z",
    )
    .listed(&AXES)
    .with(Effect::Behaviour),
    number!(rig.reference_noise_n, NEWTON, (0.0, 1.0), "the standard deviation of each written force"),
    number!(rig.stage_x_mm, MM, STAGE_MM, "the true place minus the written one along x"),
    number!(rig.stage_y_mm, MM, STAGE_MM, "the true place minus the written one along y"),
    number!(
        rig.stage_rotation_deg,
        DEG,
        (-180.0, 180.0),
        "the turn from the written place to the true one, counter-clockwise about the pad's axis"
    ),
    number!(rig.stage_scale, RATIO, (0.5, 2.0), "the true distance from the pad's axis over the written one"),
    number!(
        rig.stage_scatter_mm,
        MM,
        SCATTER_MM,
        "the standard deviation of the true place along x and along y, anew for each approach"
    ),
    number!(
        rig.force_scatter_share,
        RATIO,
        SCATTER_SHARE,
        "the standard deviation of the true force's relative error, anew for each approach"
    ),
    number!(rig.label_lag_ms, Unit::Millisecond, (-1_000.0, 1_000.0), "how late the labels are"),
];

/// The numbers of a `[[crosstalk]]` table.
pub(in crate::pad::device) static CROSSTALK: [Key<Crosstalk>; 1] = [entry!(
    Crosstalk,
    share,
    RATIO,
    LEAK,
    "the share of the signal of \"with\" that is added to \"channel\""
)];

/// The numbers of a `[[module_crosstalk]]` table.
pub(in crate::pad::device) static MODULE_CROSSTALK: [Key<ModuleCrosstalk>; 1] = [entry!(
    ModuleCrosstalk,
    share,
    RATIO,
    LEAK,
    "the share of the signals of \"with\" that is added to those of \"module\""
)];

/// The numbers of a `[[hysteresis]]` table.
pub(in crate::pad::device) static HYSTERESIS: [Key<OnChannels<PlayOperator>>; 2] = [
    law!(
        PlayOperator,
        threshold_uv,
        threshold,
        UV,
        (0.1, 20_000.0),
        "how far the play operator stays behind"
    ),
    law!(PlayOperator, share, share, RATIO, (0.0, 0.9), "the play operator's part of the strain"),
];

/// The numbers of a `[[creep]]` table.
pub(in crate::pad::device) static CREEP: [Key<OnChannels<Relaxation>>; 2] = [
    law!(Relaxation, time_s, time_s, SECOND, (0.01, 1e5), "the time constant"),
    law!(
        Relaxation,
        share,
        share,
        RATIO,
        (-0.5, 1.0),
        "the share of the strain that is added after a long time"
    ),
];
