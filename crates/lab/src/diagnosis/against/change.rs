//! Hypotheses of change in a sensor, or in the rig that measured it, since an earlier recording.
//!
//! ```text
//! place = d + R(φ) written(t + lag),   load = written(t + lag)
//! yₖ = gₖ/γ fₖ(place, load) + δₖ t + βₖ ΔT + zₖ
//! ```
//!
//! f is the earlier recording's regression beside its zeros, γ what is written, or meant where nothing is, over the true load: by a
//! sensor that is linear in its load it is not told from a gain of all channels, and by any other one not surely. The zeros z are
//! always fitted.

use super::columns::Columns;
use crate::diagnosis::data::target::Target;
use crate::diagnosis::label::Hypothesis;
use crate::diagnosis::report::NotTestable;
use crate::effect::Effect;
use tactpad_inference::hypothesis::Parameter;

/// Kind of change of a hypothesis.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum ChangeKind {
    /// The gain of a channel, or of all.
    Gain(Option<usize>),
    /// What is written of a load.
    Load,
    /// The drift of a zero.
    Drift(Option<usize>),
    /// How a zero goes with the temperature.
    Thermal(Option<usize>),
    /// The stage's zero, along these of x, y, z.
    Offset(Vec<usize>),
    /// The stage's turn.
    Rotation,
    /// The labels' clock.
    Lag,
}

/// Columns by which changes can be told.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Circumstances {
    pub(super) has_time: bool,
    pub(super) has_temperature: bool,
    pub(super) has_series: bool,
    /// Whether places or presses are repeated in both recordings. Else nobody knows what a sensor does by itself from one to the next.
    pub(super) is_repeated: bool,
}

/// Everything that may have changed, as numbers.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Changes {
    pub(super) gains: Vec<f64>,
    pub(super) drifts_per_h: Vec<f64>,
    pub(super) zeros_per_c: Vec<f64>,
    pub(super) load: f64,
    pub(super) offset_mm: [f64; 3],
    pub(super) rotation_deg: f64,
    pub(super) lag_ms: f64,
}

/// Names of what can be found, those of the checks aside.
pub(super) const EFFECTS: [Effect; 8] = [
    Effect::ChannelGain,
    Effect::ExcitationGain,
    Effect::ReferenceGain,
    Effect::ZeroDrift,
    Effect::ThermalZero,
    Effect::StageOffset,
    Effect::StageRotation,
    Effect::TimeLag,
];
/// What is missing where nothing is repeated.
const REPEATED: &str = "six places or presses in each recording";
const AXES: [&str; 3] = ["x_mm", "y_mm", "z_mm"];

impl Changes {
    pub(super) fn none(channels: usize) -> Self {
        Self {
            gains: vec![1.0; channels],
            drifts_per_h: vec![0.0; channels],
            zeros_per_c: vec![0.0; channels],
            load: 1.0,
            offset_mm: [0.0; 3],
            rotation_deg: 0.0,
            lag_ms: 0.0,
        }
    }

    pub(super) fn apply(&mut self, act: &ChangeKind, values: &[f64]) {
        let each = |of: Option<usize>, numbers: &mut Vec<f64>, change: &dyn Fn(&mut f64)| match of {
            Some(channel) => change(&mut numbers[channel]),
            None => numbers.iter_mut().for_each(change),
        };
        match act {
            ChangeKind::Gain(of) => each(*of, &mut self.gains, &|it| *it *= values[0]),
            ChangeKind::Drift(of) => each(*of, &mut self.drifts_per_h, &|it| *it += values[0]),
            ChangeKind::Thermal(of) => each(*of, &mut self.zeros_per_c, &|it| *it += values[0]),
            ChangeKind::Load => self.load *= values[0],
            ChangeKind::Offset(axes) => {
                axes.iter().zip(values).for_each(|(axis, mm)| self.offset_mm[*axis] += mm);
            }
            ChangeKind::Rotation => self.rotation_deg += values[0],
            ChangeKind::Lag => self.lag_ms += values[0],
        }
    }

    /// Whether labels are other than they are written.
    pub(super) fn moves_labels(&self) -> bool {
        self.offset_mm != [0.0; 3] || self.rotation_deg != 0.0 || self.lag_ms != 0.0
    }
}

impl ChangeKind {
    /// Whether only what is read from the labels changes, not the labels.
    pub(super) const fn is_of_channels(&self) -> bool {
        matches!(self, Self::Gain(_) | Self::Load | Self::Drift(_) | Self::Thermal(_))
    }
}

/// All hypotheses with what they change; `extents` are the labels' least and greatest values.
pub(super) fn hypotheses(
    columns: &Columns,
    extents: &[[f64; 2]],
    there: Circumstances,
    asks_for: impl Fn(Effect) -> bool,
) -> Vec<(Hypothesis, ChangeKind)> {
    let channels = columns.channels.len();
    let gain = || vec![Parameter::factor("gain", [0.05, 20.0])];
    let drift = || vec![Parameter::additive("uv_per_h", [-1e7, 1e7], 1.0)];
    let thermal = || vec![Parameter::additive("uv_per_c", [-1e6, 1e6], 1.0)];
    let axes: Vec<usize> = (0..3).filter(|axis| columns.input(AXES[*axis]).is_some()).collect();
    let mm = |axis: &usize| {
        let [low, high] = columns.input(AXES[*axis]).map_or([0.0; 2], |at| extents[at]);
        let half = 0.5 * (high - low);
        Parameter::additive(AXES[*axis], [-half, half], 1e-3 * half)
    };
    let mut all: Vec<(Effect, Target, Vec<Parameter>, ChangeKind)> = Vec::new();
    all.push((Effect::ExcitationGain, Target::All, gain(), ChangeKind::Gain(None)));
    all.push((Effect::ReferenceGain, Target::All, gain(), ChangeKind::Load));
    all.extend(
        (0..channels).map(|k| (Effect::ChannelGain, Target::Channel(k), gain(), ChangeKind::Gain(Some(k)))),
    );
    if there.has_time {
        all.push((Effect::ZeroDrift, Target::All, drift(), ChangeKind::Drift(None)));
        all.extend(
            (0..channels)
                .map(|k| (Effect::ZeroDrift, Target::Channel(k), drift(), ChangeKind::Drift(Some(k)))),
        );
    }
    if there.has_temperature {
        all.push((Effect::ThermalZero, Target::All, thermal(), ChangeKind::Thermal(None)));
        all.extend(
            (0..channels)
                .map(|k| (Effect::ThermalZero, Target::Channel(k), thermal(), ChangeKind::Thermal(Some(k)))),
        );
    }
    if !axes.is_empty() {
        all.push((
            Effect::StageOffset,
            Target::All,
            axes.iter().map(mm).collect(),
            ChangeKind::Offset(axes.clone()),
        ));
    }
    if axes.starts_with(&[0, 1]) {
        let deg = vec![Parameter::additive("deg", [-180.0, 180.0], 1e-2)];
        all.push((Effect::StageRotation, Target::All, deg, ChangeKind::Rotation));
    }
    if there.has_series {
        all.push((
            Effect::TimeLag,
            Target::All,
            vec![Parameter::additive("ms", [-1e4, 1e4], 1.0)],
            ChangeKind::Lag,
        ));
    }
    let all = all.into_iter().filter(|(effect, ..)| there.is_repeated && asks_for(*effect));
    all.map(|(effect, target, parameters, act)| {
        (
            Hypothesis {
                label: (effect, target),
                parameters,
                signature_error: 0.0,
                prior_deviation: 0.0,
                zero_of: None,
            },
            act,
        )
    })
    .collect()
}

/// Hypotheses that cannot be tested, and the columns that are missing.
pub(super) fn missing(columns: &Columns, there: Circumstances) -> Vec<NotTestable> {
    if !there.is_repeated {
        return EFFECTS.map(|effect| NotTestable { effect, needs: REPEATED }).to_vec();
    }
    let has_place = AXES.iter().any(|name| columns.input(name).is_some());
    let turns = ["x_mm", "y_mm"].iter().all(|name| columns.input(name).is_some());
    [
        (Effect::ZeroDrift, "t_s", there.has_time),
        (Effect::ThermalZero, "temp_c", there.has_temperature),
        (Effect::TimeLag, "trial", there.has_series),
        (Effect::StageOffset, "x_mm", has_place),
        (Effect::StageRotation, "y_mm", turns),
    ]
    .into_iter()
    .filter(|(.., is_there)| !is_there)
    .map(|(effect, needs, _)| NotTestable { effect, needs })
    .collect()
}
