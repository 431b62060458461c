//! The decoders, each fitted to its samples.

use std::fmt;
use std::sync::atomic::{AtomicUsize, Ordering};

use rayon::prelude::*;

use super::carried_out::ExecutedPlan;
use super::entries::{AblationEntry, Method, Samples};
use super::{Pad, Subject};
use crate::scdf::adaptation::{self, TooFew, adapt};
use crate::scdf::simulation;
use tactpad_core::network::{Example, Network, Zero};
use tactpad_core::pipeline::contact::Decoder;
use tactpad_core::pipeline::contact::regression::Target;
use tactpad_core::pipeline::shipped;
use tactpad_core::tables::measured::{Label, Row};
use tactpad_lab::calibration::fit::{FitError, fit};
use tactpad_lab::calibration::regression::{neighbours, regression};
use tactpad_numeric::random::SplitMix64;

/// Why a decoder cannot be fitted.
#[derive(Clone, Debug, PartialEq)]
pub struct DecoderFitError {
    /// Which.
    pub entry: AblationEntry,
    /// Why.
    pub why: Reason,
}

/// Why its samples did not make a decoder.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reason {
    /// They give no calibration.
    Calibration(FitError),
    /// They are too few for a network.
    Network(TooFew),
}

impl fmt::Display for DecoderFitError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: ", self.entry)?;
        match &self.why {
            Reason::Calibration(error) => error.fmt(f),
            Reason::Network(error) => error.fmt(f),
        }
    }
}

impl std::error::Error for DecoderFitError {}

/// Everything that a decoder can learn from.
struct TrainingData<'p> {
    subject: Subject<'p>,
    /// After stage I.
    network: &'p Network,
    simulated: Vec<Row>,
    /// The paper's plan.
    measured: ExecutedPlan,
}

/// Fits all decoders, as many at once as there are processors. `network` is that of stage I, for tared channels. `report`
/// hears how many are done.
///
/// # Errors
/// The first one that cannot be fitted.
pub fn decoders(
    subject: Subject<'_>,
    network: &Network,
    entries: &[AblationEntry],
    report: impl Fn(usize) + Sync,
) -> Result<Vec<Decoder>, DecoderFitError> {
    let known = TrainingData::of(subject, network);
    let done = AtomicUsize::new(0);
    let fitted = |entry: &AblationEntry| {
        let decoder = known.decoder(entry).map_err(|why| DecoderFitError { entry: *entry, why })?;
        report(done.fetch_add(1, Ordering::Relaxed) + 1);
        Ok(decoder)
    };
    entries.par_iter().map(fitted).collect()
}

impl<'p> TrainingData<'p> {
    fn of(subject: Subject<'p>, network: &'p Network) -> Self {
        let designed = subject.designed;
        let simulated = simulation::examples(designed.device, designed.field, subject.seed);
        let measured = ExecutedPlan::calibration(&subject);
        Self { subject, network, simulated: simulated.iter().map(row).collect(), measured }
    }

    /// Places of the measured contacts.
    fn places(&self, samples: Samples) -> Vec<usize> {
        let contacts = || self.measured.recording.contacts();
        match samples {
            Samples::Simulated | Samples::Untared => Vec::new(),
            Samples::First(count) => contacts().into_iter().take(count).collect(),
            Samples::Drawn(count) => drawn(contacts(), count, self.subject.seed),
            Samples::Raw => contacts(),
        }
    }

    fn rows(&self, samples: Samples) -> Vec<Row> {
        match samples {
            Samples::Simulated | Samples::Untared => self.simulated.clone(),
            Samples::Raw => self.measured.raw_at(&self.places(samples)),
            _ => self.places(samples).iter().map(|at| self.measured.recording.tared().rows[*at]).collect(),
        }
    }

    fn decoder(&self, entry: &AblationEntry) -> Result<Decoder, Reason> {
        let (rows, zero) = (|| self.rows(entry.samples), entry.samples.zero());
        let fitted = match entry.method {
            Method::Statics => Ok(shipped::statics()),
            Method::Network if entry.samples.measured() == 0 => Ok(self.stage_1(zero).into()),
            Method::Network => return self.adapted(&rows(), zero).map_err(Reason::Network),
            Method::Knn => neighbours(&rows(), zero).map(Decoder::from),
            Method::Linear => self.regression(&rows(), zero, Target::Contact),
            Method::Wrench => self.regression(&rows(), zero, Target::Wrench),
            Method::Inverse if entry.samples == Samples::Simulated => {
                Ok(shipped::uncalibrated(self.subject.designed.field.signals.clone()))
            }
            Method::Inverse => self.inverse(&self.places(entry.samples)),
        };
        fitted.map_err(Reason::Calibration)
    }

    fn inverse(&self, places: &[usize]) -> Result<Decoder, FitError> {
        let Pad { device, field } = self.subject.designed;
        let calibration = fit(&self.measured.recording, places, device, field, None)?;
        Ok(calibration.decoder())
    }

    /// The network of stage I, which takes these channels.
    fn stage_1(&self, zero: Zero) -> Network {
        let mut network = self.network.clone();
        network.zero = zero;
        network
    }

    fn adapted(&self, rows: &[Row], zero: Zero) -> Result<Decoder, TooFew> {
        let examples = adaptation::examples(rows);
        let adapted = adapt(&self.stage_1(zero), examples, self.subject.seed, |_, _| ())?;
        Ok(adapted.trained.network.into())
    }

    fn regression(&self, rows: &[Row], zero: Zero, target: Target) -> Result<Decoder, FitError> {
        let reach_mm = self.subject.designed.device.contact.max_centre_radius_mm;
        regression(rows, zero, target, reach_mm).map(Decoder::from)
    }
}

/// `count` of the places, drawn from the seed; all of them stay in their order.
fn drawn(mut places: Vec<usize>, count: usize, seed: u64) -> Vec<usize> {
    if count < places.len() {
        SplitMix64::named(seed, "rows").shuffle(&mut places);
        places.truncate(count);
    }
    places
}

fn row(example: &Example) -> Row {
    let [x_mm, y_mm, fx_n, fy_n, fz_n] = example.contact.map(f64::from);
    let label = Label { x_mm, y_mm, fx_n, fy_n, fz_n };
    Row { uv: Some(example.uv.map(f64::from)), ..Row::of(label) }
}
