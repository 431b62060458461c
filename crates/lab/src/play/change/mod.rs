//! Changes of a pad before a play without labels: since an earlier play, or since it was calibrated.
//!
//! Nine channels against five unknowns of a contact leave four equations for each press. The pad as it was (its gains, poses,
//! crosstalk, memory) is what the earlier play, or the decoder, says; what only the later play has is a change
//! ([`Comparison`]). The gain that all channels share is a force, and a shift or turn that
//! all modules share is a place: no press tells them.

mod candidates;
mod selection;

use std::fmt;

use self::candidates::{Candidate, candidates};
use self::selection::Selection;
use crate::calibration::change::Comparison;
use crate::calibration::change::plays::{PlayEstimate, Plays};
use crate::calibration::data::contacts::Fitted;
use crate::calibration::data::earlier::EarlierCalibration;
use crate::calibration::fit::FitError;
use crate::calibration::fit::search::Report;
use crate::diagnosis::model::mechanics::{at_place, changes};
use crate::diagnosis::report::Finding;
use crate::effect::Effect;
use crate::play::windows::{PlayWindows, WINDOW_S, Window};
use tactpad_core::pad::changes::FieldChange;
use tactpad_core::pad::device::Device;
use tactpad_core::pad::field::PadField;
use tactpad_core::pipeline::contact::Decoder;

/// Fewer presses of a play tell too little, and more hardly more, as noise lasts.
const PRESSES_MIN: usize = 200;
const PRESSES_MAX: usize = 600;
/// So often the equations are made anew about the changes that were found: a contact's place depends on them.
const ROUNDS: usize = 2;
/// Between the plays so long passes that no noise lasts.
const APART_S: f64 = 86_400.0;

/// The pad as it was.
#[derive(Clone, Copy, Debug)]
pub enum Before<'b> {
    /// As it was played on.
    Play(&'b [Window]),
    /// As it was calibrated.
    Decoder(&'b Decoder),
}

/// Changes that a play shows.
#[derive(Clone, Debug)]
pub struct DetectedChanges {
    /// Changes, the clearest first.
    pub findings: Vec<Finding>,
    /// Presses, as windows of a tenth of a second: of the earlier play, if there is one, and of the later.
    pub presses: (Option<usize>, usize),
    /// By how much the plays contradict themselves: variances are taken to be so much larger.
    pub inflation: f64,
    /// The smallest change of any module's gain, as a share of it, that would have been found in nine of ten such plays.
    pub least_module_gain: f64,
}

/// Which of the two.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Which {
    /// The pad as it was.
    Earlier,
    /// The play.
    Later,
}

/// Why nothing can be said.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum ChangeError {
    /// The pad is never untouched for a moment.
    NoRest(Which),
    /// There are too few presses.
    TooFew(Which, usize),
    /// A decoder of this name that does not say how far it may be off.
    Untold(&'static str),
    /// The fit has no answer.
    Fit(FitError),
}

impl ChangeError {
    /// Whose fault it is, if one play's.
    pub const fn which(&self) -> Option<Which> {
        match self {
            Self::NoRest(which) | Self::TooFew(which, _) => Some(*which),
            Self::Untold(_) => Some(Which::Earlier),
            Self::Fit(_) => None,
        }
    }
}

impl fmt::Display for ChangeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoRest(_) => {
                f.write_str("the pad is never untouched for a moment; lift the finger between presses")
            }
            Self::TooFew(_, presses) => write!(
                f,
                "the finger presses with 0.3 N or more for {:.1} s in all, and {:.0} s are the least: play for longer",
                *presses as f64 * WINDOW_S,
                PRESSES_MIN as f64 * WINDOW_S
            ),
            Self::Untold(name) => write!(
                f,
                "it is a decoder ({name}) that does not say, place by place, how far it may be off; name one that tactpad calibrate, \
                 adapt --play or adapt --method inverse made of this pad, or an earlier capture"
            ),
            Self::Fit(error) => error.fmt(f),
        }
    }
}

impl std::error::Error for ChangeError {}

/// Changes before a play. `field` is that of `device`, the nominal pad, and `flaws` what its modules may lack.
///
/// # Errors
/// Too few presses, no rest, a decoder that does not say how far it may be off, or readings beyond anything that a pad can read.
pub fn changed(
    before: Before<'_>,
    later: &[Window],
    device: &Device,
    field: &PadField,
    flaws: &[FieldChange],
    report: Report<'_>,
) -> Result<DetectedChanges, ChangeError> {
    let plate_mm = device.plate.radius_mm();
    let maps = |place_mm: [f64; 2]| at_place(field, flaws, place_mm.map(|mm| mm / plate_mm)).to_vec();
    let candidates = candidates(device, &changes(device, device, field, flaws));
    match before {
        Before::Play(earlier) => {
            let (play, later) = one_after_the_other([earlier, later], device)?;
            let plays = Plays { recording: &play.recording, fitted: &play.fitted, later };
            let comparison = Comparison::with_play(plays, device, field, &maps, report);
            DetectedChanges::by(&comparison.map_err(ChangeError::Fit)?, &candidates)
        }
        Before::Decoder(decoder) => {
            let as_it_was = calibrated(decoder)?;
            let play = play(later, Which::Later, device)?;
            let plays = Plays { recording: &play.recording, fitted: &play.fitted, later: 0 };
            let comparison = Comparison::with_decoder(plays, device, field, &as_it_was, &maps);
            DetectedChanges::by(&comparison.map_err(ChangeError::Fit)?, &candidates)
        }
    }
}

/// What a decoder tells of its pad, if it says how far that may be off.
fn calibrated(decoder: &Decoder) -> Result<EarlierCalibration<'_>, ChangeError> {
    EarlierCalibration::of(decoder)
        .filter(|it| !it.inverse.field_error().modes().is_empty())
        .ok_or(ChangeError::Untold(decoder.name()))
}

/// Both plays as one, and the first row of the later.
fn one_after_the_other(
    [earlier, later]: [&[Window]; 2],
    device: &Device,
) -> Result<(PlayWindows, usize), ChangeError> {
    let first = play(earlier, Which::Earlier, device)?;
    let begin_s = earlier.last().map_or(0.0, |it| it.end_s) + APART_S;
    let moved = |it: &Window| Window { begin_s: it.begin_s + begin_s, end_s: it.end_s + begin_s, ..*it };
    let later: Vec<Window> = later.iter().map(moved).collect();
    let second = play(&later, Which::Later, device)?;
    let rows = earlier.len();
    let mut fitted = first.fitted;
    fitted.extend(second.fitted.iter().map(|it| Fitted { row: rows + it.row, ..*it }));
    Ok((PlayWindows { recording: first.recording.then(second.recording), fitted }, rows))
}

impl DetectedChanges {
    fn by(comparison: &Comparison<'_>, candidates: &[Candidate]) -> Result<Self, ChangeError> {
        let mut compared = comparison.about(&[]).map_err(ChangeError::Fit)?;
        for _ in 0..ROUNDS {
            let found = Selection::of(candidates, &compared).solution();
            if found.iter().all(|change| *change == 0.0) {
                break;
            }
            compared = comparison.about(&found).map_err(ChangeError::Fit)?;
        }
        Ok(Self::of(candidates, &compared))
    }

    fn of(candidates: &[Candidate], compared: &PlayEstimate) -> Self {
        let selection = Selection::of(candidates, compared);
        let modules = candidates.iter().filter(|it| it.effect == Effect::ModuleGain);
        let [earlier, later] = compared.contacts;
        Self {
            findings: selection.findings(),
            presses: ((earlier > 0).then_some(earlier), later),
            inflation: compared.inflation,
            least_module_gain: modules.map(|it| selection.least(it)).fold(0.0, f64::max),
        }
    }
}

/// A play's contacts, evenly over its time.
fn play(windows: &[Window], which: Which, device: &Device) -> Result<PlayWindows, ChangeError> {
    let mut play =
        PlayWindows::of(windows, &[], device.contact.full_scale_n).ok_or(ChangeError::NoRest(which))?;
    let presses = play.fitted.len();
    if presses < PRESSES_MIN {
        return Err(ChangeError::TooFew(which, presses));
    }
    let stride = presses.div_ceil(PRESSES_MAX);
    play.fitted = play.fitted.into_iter().step_by(stride).collect();
    Ok(play)
}
