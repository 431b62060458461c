//! A known weight in a file: what it tells of the common gain of the pad, and the decoder that knows it.

use std::fmt;

use tactpad_core::network::Zero;
use tactpad_core::pad::weight::Weight;
use tactpad_core::pipeline::call::Call;
use tactpad_core::pipeline::contact::Decoder;
use tactpad_core::pipeline::mapping::profile::Profile;
use tactpad_core::pipeline::weighing::factor::Weighed;
use tactpad_core::pipeline::weighing::kept::kept;
use tactpad_core::pipeline::weighing::refusal::WeighError;
use tactpad_core::pipeline::weighing::resting::{MeanReading, SettlingDetector};
use tactpad_core::pipeline::{NoProbe, Pipeline};
use tactpad_core::quantity::Strain;
use tactpad_core::tables::measured::{Table, zero};
use tactpad_core::tables::recording::Recording;
use tactpad_core::time::{HostInstant, StreamInstant};

/// Thresholds of hysteresis follow the gain that is sought. It is found anew with those that it gives: after so many rounds it
/// changes by less than a thousandth of its deviation.
const ROUNDS: usize = 3;

/// A load that rested in a recording.
#[derive(Clone, Debug, PartialEq)]
pub struct RestedLoad {
    /// When, in seconds since the first sample.
    pub at_s: f64,
    /// Its readings.
    pub readings: Vec<MeanReading>,
}

/// Findings in a file.
#[derive(Clone, Debug)]
pub struct InFile {
    /// Gain factor by the weight.
    pub weighed: Weighed,
    /// How many readings it was told by.
    pub readings: usize,
    /// When it rested; none in a table.
    pub at_s: Option<f64>,
    /// The decoder of the pad as it is now.
    pub decoder: Decoder,
}

/// Why a file does not tell the gain.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum FileError {
    /// The decoder does not know what its channels should read.
    Decoder,
    /// No row says what the untouched pad reads, and neither does the decoder.
    NoZero,
    /// Nothing rests there, or not the weight.
    Weigh(WeighError),
}

impl fmt::Display for FileError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Decoder => f.write_str("only inverse decoders keep a gain: make one with `tactpad calibrate` or `tactpad adapt --method inverse`"),
            Self::NoZero => f.write_str("no row without force says what the untouched pad reads: measure one before the weight is put down"),
            Self::Weigh(WeighError::NothingCame | WeighError::NotSteady) => {
                f.write_str("no load rests in it for two seconds: record the weight alone on the plate, and the untouched pad before it")
            }
            Self::Weigh(error) => error.fmt(f),
        }
    }
}

impl std::error::Error for FileError {}

/// Weighs by a table all of whose loads are the weight, wherever it stood.
///
/// # Errors
/// See [`FileError`].
pub fn in_table(
    decoder: &Decoder,
    table: &Table,
    weight: Weight,
    full_scale_n: f64,
) -> Result<InFile, FileError> {
    found(decoder, weight, |decoder| {
        let rests = RestedLoad {
            at_s: 0.0,
            readings: of_table(decoder, table, full_scale_n).ok_or(FileError::NoZero)?,
        };
        Ok(vec![rests])
    })
    .map(|found| InFile { at_s: None, ..found })
}

/// Weighs by the load that rests most evenly of those that can be the weight. `rests` gives the loads that rest, as this decoder
/// takes them.
///
/// # Errors
/// See [`FileError`], or what `rests` returns.
pub fn found<E: From<FileError>>(
    decoder: &Decoder,
    weight: Weight,
    mut rests: impl FnMut(&Decoder) -> Result<Vec<RestedLoad>, E>,
) -> Result<InFile, E> {
    let mut now = kept(decoder, 1.0, 0.0).ok_or(FileError::Decoder)?;
    let mut factor = 1.0;
    let mut round = || -> Result<InFile, E> {
        let rests = rests(&now)?;
        let (rest, weighed) = steadiest(&rests, weight, &now).map_err(FileError::Weigh)?;
        // What this decoder misses is what the one before has missed.
        factor *= weighed.factor;
        let weighed = Weighed { factor, ..weighed };
        now = kept(decoder, factor, weighed.deviation).ok_or(FileError::Decoder)?;
        Ok(InFile { weighed, readings: rest.readings.len(), at_s: Some(rest.at_s), decoder: now.clone() })
    };
    for _ in 1..ROUNDS {
        round()?;
    }
    round()
}

/// The load that rests most evenly, of those that can be the weight; else why the most even one cannot.
fn steadiest<'r>(
    rests: &'r [RestedLoad],
    weight: Weight,
    decoder: &Decoder,
) -> Result<(&'r RestedLoad, Weighed), WeighError> {
    let mut by_scatter: Vec<(f64, &RestedLoad)> =
        rests.iter().map(|rest| (scatter(&rest.readings), rest)).collect();
    by_scatter.sort_by(|one, other| one.0.total_cmp(&other.0));
    let mut why = WeighError::NothingCame;
    for (at, (_, rest)) in by_scatter.iter().enumerate() {
        match Weighed::of(&rest.readings, weight, decoder) {
            Ok(weighed) => return Ok((rest, weighed)),
            Err(error) if at == 0 => why = error,
            Err(_) => {}
        }
    }
    Err(why)
}

/// Variance of the normal force, as a share of its square.
fn scatter(readings: &[MeanReading]) -> f64 {
    let count = readings.len().max(1) as f64;
    let mean_n = readings.iter().map(|it| f64::from(it.contact.fz_n)).sum::<f64>() / count;
    let off_n2 = readings.iter().map(|it| (f64::from(it.contact.fz_n) - mean_n).powi(2)).sum::<f64>() / count;
    off_n2 / (mean_n * mean_n)
}

/// The readings of a table's loads. `None` if nothing says what the untouched pad reads.
fn of_table(decoder: &Decoder, table: &Table, full_scale_n: f64) -> Option<Vec<MeanReading>> {
    let contacts = zero::contacts(table);
    let recording = Recording::tared_or_raw(table.clone(), full_scale_n);
    let recording = match decoder.compensation.zero_uv {
        _ if recording.is_tared() => recording,
        Some(zero_uv) if decoder.zero() == Zero::Tared => recording.less(&zero_uv),
        _ => return None,
    };
    let taken = recording.into_taken(decoder);
    let read = |at: usize| taken.rows.get(at).and_then(|row| row.uv);
    let strains = contacts.into_iter().filter_map(read).map(|uv| Strain { uv: uv.map(|uv| uv as f32) });
    Some(strains.map(|strain| MeanReading::of(strain, decoder)).collect())
}

/// Makes a recording's calls again and finds the loads that rest in it.
#[derive(Debug)]
pub struct RestReader {
    pipeline: Pipeline,
    decoder: Decoder,
    begin: Option<StreamInstant>,
    samples: u64,
    resting: SettlingDetector,
    rests: Vec<RestedLoad>,
}

impl RestReader {
    /// One that has heard nothing. Of the profile only the filter matters.
    pub fn new(decoder: Decoder, profile: Profile) -> Self {
        let pipeline = Pipeline::new(decoder.clone(), profile);
        let (begin, samples, resting, rests) = (None, 0, SettlingDetector::default(), Vec::new());
        Self { pipeline, decoder, begin, samples, resting, rests }
    }

    /// Makes one call. Changes of the profile, pauses and weighings are left out: they change no reading.
    pub fn apply(&mut self, now: HostInstant, call: Call<'_>) {
        match call {
            Call::Profile(_) | Call::Pause | Call::Resume | Call::Weigh(_) => {}
            // One by one, so that no sample is passed over.
            Call::Bytes(bytes) => bytes.chunks(1).for_each(|byte| self.make(now, Call::Bytes(byte))),
            other => self.make(now, other),
        }
    }

    /// The loads that rested, in order of time.
    pub fn finish(self) -> Vec<RestedLoad> {
        self.rests
    }

    fn make(&mut self, now: HostInstant, call: Call<'_>) {
        let mut left = Some(call);
        while let Some(call) = left {
            left = self.pipeline.apply(now, call, &mut NoProbe);
        }
        let samples = self.pipeline.health().samples;
        if samples == self.samples {
            return;
        }
        self.samples = samples;
        let at = self.pipeline.at();
        let begin = *self.begin.get_or_insert(at);
        let Some(strain) = self.pipeline.contact().and(self.pipeline.strain()) else {
            self.resting.break_off();
            return;
        };
        let rested = self.resting.push(at, strain, &self.decoder);
        let at_s = 1e-6 * at.us_since(begin) as f64;
        self.rests.extend(rested.map(|rested| RestedLoad { at_s, readings: rested.into_iter().collect() }));
    }
}
