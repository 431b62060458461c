//! Report of a diagnosis.

use crate::diagnosis::data::target::Target;
use crate::effect::{Effect, EffectFamily};
use tactpad_core::tables::measured::Table;
use tactpad_inference::observations::Sample;
pub use tactpad_inference::search::estimates::Estimate;
use tactpad_numeric::statistics::mean;

/// Sentence where nothing tells confounded causes apart.
pub(super) const INSEPARABLE: &str = "no measurement in the catalogue separates these";

/// The whole answer.
#[derive(Clone, Debug, PartialEq)]
pub struct Diagnosis {
    /// Names of the channels.
    pub channels: Vec<String>,
    /// Each channel's full scale: its largest reading by the model.
    pub full_scale: Vec<f64>,
    /// In one word.
    pub verdict: Verdict,
    /// Root mean square of the channels' noise, in their unit.
    pub noise_floor: f64,
    /// Root mean square of the residual of the model as it is, zeros taken off.
    pub rmse_nominal: f64,
    /// The same with the named and confounded causes.
    pub rmse_extended: f64,
    /// Correlation length of the smooth background, and its mean size as a share of a channel's root mean square.
    pub background_mm: f64,
    /// See [`Self::background_mm`].
    pub background_share: f64,
    /// Findings, the largest first.
    pub findings: Vec<Finding>,
    /// Effects that were tested and not found.
    pub not_detected: Vec<NotDetected>,
    /// Effects that could not be tested.
    pub not_testable: Vec<NotTestable>,
    /// Part of the weighted squared residual above noise and background that no cause explains; 0 where that is chance.
    pub unnamed_share: f64,
    /// For each channel, the weighted squares of what no cause explains.
    pub unnamed_by_channel: Vec<f64>,
    /// Share that the findings remove of what a flexible model could; `None`: no such model was fitted.
    pub ceiling_share: Option<f64>,
    /// On the locked rows; `None` where nothing was found.
    pub gain: Option<Gain>,
    /// Notices of the checks of the recording, and of the fit.
    pub gatekeepers: Vec<Notice>,
    /// Residuals, row by row.
    pub residuals: Residuals,
    /// What to measure next; nothing where nothing is open.
    pub next: Proposal,
}

/// Gains of several channels that may have one reason in common.
#[derive(Clone, Debug, PartialEq)]
pub struct CommonGain {
    /// Their geometric mean.
    pub factor: f64,
    /// The part of the residual that gains explain.
    pub share: f64,
    /// What would tell whose it is: the shortest that is said of any of them.
    pub separate_by: Option<String>,
}

impl Diagnosis {
    /// What the channels' gains have in common, where the supply or the force sensor may be the reason; none where each channel has its own,
    /// or one has.
    pub fn common_gain(&self) -> Option<CommonGain> {
        let is_common =
            |rival: &(Effect, Target)| matches!(rival.0, Effect::ExcitationGain | Effect::ReferenceGain);
        let gains = self.findings.iter().filter(|it| it.effect == Effect::ChannelGain);
        let common = gains.clone().filter(|it| it.confounded_with.iter().any(is_common));
        let logs: Vec<f64> =
            common.clone().filter_map(|it| Some(libm::log(it.parameters.first()?.value))).collect();
        (logs.len() > 1).then(|| CommonGain {
            factor: libm::exp(mean(logs)),
            share: gains.map(|it| it.share).sum(),
            separate_by: common.filter_map(|it| it.separate_by.clone()).min_by_key(String::len),
        })
    }
}

#[cfg(test)]
impl Diagnosis {
    /// One that found this and says no more.
    pub(super) fn of(channels: Vec<String>, full_scale: Vec<f64>, findings: Vec<Finding>) -> Self {
        Self {
            channels,
            full_scale,
            verdict: Verdict::Explained,
            noise_floor: 10.0,
            rmse_nominal: 80.0,
            rmse_extended: 11.0,
            background_mm: 10.0,
            background_share: 0.01,
            findings,
            not_detected: Vec::new(),
            not_testable: Vec::new(),
            unnamed_share: 0.0,
            unnamed_by_channel: Vec::new(),
            ceiling_share: None,
            gain: None,
            gatekeepers: Vec::new(),
            residuals: Residuals::default(),
            next: Proposal::default(),
        }
    }
}

#[cfg(test)]
impl Finding {
    /// A named one that removes a third.
    pub(super) fn of(effect: Effect, target: Target) -> Self {
        Self {
            effect,
            target,
            parameters: Vec::new(),
            shapes: Vec::new(),
            p_value: 1e-9,
            share: 0.3,
            confounded_with: Vec::new(),
            separate_by: None,
            labels: None,
        }
    }
}

/// Residuals at the rows by which causes were found, each channel's zero taken off.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Residuals {
    /// Labels of each row.
    pub samples: Vec<Sample>,
    /// Root mean square of each channel's noise, in its unit.
    pub noise: Vec<f64>,
    /// Each channel's residuals of the model as it is, row by row; NaN where a reading tells nothing.
    pub nominal: Vec<Vec<f64>>,
    /// The same with the named and confounded causes.
    pub extended: Vec<Vec<f64>>,
}

/// Notice of a check of the recording, or of the fit.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Notice {
    /// The check, in a word.
    pub check: &'static str,
    /// In which channel; none: in whole rows.
    pub channel: Option<usize>,
    /// What, in how many rows, what was done about it, and how to look at it.
    pub detail: String,
}

/// The answer in one word.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// The model says all.
    NoDiscrepancy,
    /// The findings say all that the model does not.
    Explained,
    /// They leave something.
    PartlyExplained,
    /// There is something, and no finding.
    Unexplained,
}

/// A cause, or a set of causes of which one holds.
#[derive(Clone, Debug, PartialEq)]
pub struct Finding {
    /// The cause.
    pub effect: Effect,
    /// Where.
    pub target: Target,
    /// Its numbers.
    pub parameters: Vec<Estimate>,
    /// The numbers of its course, which were fitted beside them.
    pub shapes: Vec<(&'static str, f64)>,
    /// The probability of as much by chance.
    pub p_value: f64,
    /// Part of the weighted squared residual above noise and background that it removes.
    pub share: f64,
    /// Other causes that explain it as well. Empty: the cause is named.
    pub confounded_with: Vec<(Effect, Target)>,
    /// The measurement that would tell them apart.
    pub separate_by: Option<String>,
    /// Of the labels: what no number says.
    pub labels: Option<LabelNote>,
}

/// What a finding of the labels says beside numbers.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LabelNote {
    /// Frame or sign, as an argument takes it.
    pub map: Option<String>,
    /// The rows, where it is not all of them.
    pub part: Option<String>,
    /// The argument that mends it; none where only the table can be mended.
    pub argument: Option<String>,
}

impl Finding {
    /// The family of the cause and of all that it is confounded with; none where they are of several, or one is not known.
    pub fn family(&self) -> Option<EffectFamily> {
        let own = self.effect.family();
        let is_own = |(effect, _): &(Effect, Target)| effect.family() == own;
        own.filter(|_| self.confounded_with.iter().all(is_own))
    }

    /// Whether it may be a part of something that is not in the catalogue.
    pub fn is_doubted(&self) -> bool {
        self.confounded_with.iter().any(|(effect, _)| *effect == Effect::Unlisted)
    }
}

/// A cause that was not found, and the size at which it would have been.
#[derive(Clone, Debug, PartialEq)]
pub struct NotDetected {
    /// The cause.
    pub effect: Effect,
    /// Where.
    pub target: Target,
    /// For each number: the deviation from none that is found in nine of ten measurements like this one.
    pub minimum_detectable: Vec<(&'static str, f64)>,
    /// The largest part of its signature that another cause reproduces.
    pub rival_share: f64,
}

/// A cause that the data cannot show.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NotTestable {
    /// The cause.
    pub effect: Effect,
    /// The column that is missing or stays the same, or what else is missing, in words.
    pub needs: &'static str,
}

impl NotTestable {
    /// Whether a column is missing.
    pub fn needs_column(needs: &str) -> bool {
        !needs.contains(' ')
    }
}

/// Gain of the findings on rows that had no part in finding them.
#[derive(Clone, Debug, PartialEq)]
pub struct Gain {
    /// How many rows.
    pub rows_locked: usize,
    /// Extended over nominal root mean square of the residual.
    pub rmse_ratio: f64,
    /// Ends of its 95 % interval.
    pub rmse_ratio_interval95: [f64; 2],
    /// How far decoded places are from the written ones, in mm; none where the model knows no contacts.
    pub position_mae: Option<Decoded>,
    /// The same of the loads, in N.
    pub force_mae: Option<Decoded>,
    /// Gain of each cause by itself.
    pub per_cause: Vec<WithoutFinding>,
}

/// Mean magnitudes of the errors along each axis, of contacts decoded by the model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Decoded {
    /// As it is.
    pub nominal: f64,
    /// With the findings.
    pub extended: f64,
    /// Ends of the 95 % interval of what the findings change.
    pub change_interval95: [f64; 2],
}

/// The residual with all findings but one.
#[derive(Clone, Debug, PartialEq)]
pub struct WithoutFinding {
    /// The one.
    pub effect: Effect,
    /// Where.
    pub target: Target,
    /// The residual without it over the nominal one.
    pub rmse_ratio: f64,
}

/// Further measurements that tell what is open, as cheaply as they were found.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Proposal {
    /// What to measure, in the order of the plan.
    pub measurements: Vec<ProposedMeasurement>,
    /// What else to do, where no rows of a plan tell: sentences.
    pub others: Vec<String>,
    /// The rows to measure, as a plan.
    pub plan: Table,
    /// How many pairs of causes nothing in the catalogue separates.
    pub inseparable: usize,
}

/// A further measurement.
#[derive(Clone, Debug, PartialEq)]
pub struct ProposedMeasurement {
    /// What to do.
    pub what: String,
    /// Why that tells causes apart.
    pub why: &'static str,
    /// How often.
    pub repeats: usize,
    /// What it takes in all, in minutes.
    pub minutes: f64,
}

/// `once`, `twice`, `3 times`.
pub fn times_text(count: usize) -> String {
    match count {
        1 => "once".to_owned(),
        2 => "twice".to_owned(),
        _ => format!("{count} times"),
    }
}
