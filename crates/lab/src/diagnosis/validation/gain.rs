//! Gain of the findings on rows that had no part in finding them.

use super::mean_square::{Draw, Population, Squares};
use crate::diagnosis::label::{Label, Search};
use crate::diagnosis::report::{Decoded, Gain, WithoutFinding};
use tactpad_core::tables::measured::zero::UNLOADED_N;
use tactpad_inference::model::{ChannelBaselines, Model};
use tactpad_inference::noise::Noise;
use tactpad_inference::observations::{Observations, Sample, Zeros};
use tactpad_inference::search::{Applied, AttributionFit};
use tactpad_numeric::statistics::mean;

/// A model at rows, and what the rows read.
#[derive(Clone, Copy)]
pub(crate) struct Rows<'r> {
    pub(crate) model: &'r dyn Model<Label>,
    pub(crate) observations: &'r Observations,
    /// The same rows before anything in them was repaired; none where nothing was.
    pub(crate) unrepaired: Option<&'r Self>,
}

impl Rows<'_> {
    /// As they were measured.
    pub(crate) const fn measured(&self) -> &Self {
        match self.unrepaired {
            Some(unrepaired) => unrepaired,
            None => self,
        }
    }

    /// Each channel's residuals with these hypotheses; NaN where a reading tells nothing.
    pub(crate) fn residuals(&self, applied: &Applied) -> Vec<Vec<f64>> {
        let readings = self.model.readings(applied);
        let Observations { readings: measured, is_told, .. } = self.observations;
        let left = |((y, f), is_told): ((&f64, f64), &bool)| if *is_told { y - f } else { f64::NAN };
        let channels = measured.iter().zip(readings).zip(is_told);
        channels
            .map(|((measured, modelled), is_told)| {
                measured.iter().zip(modelled).zip(is_told).map(left).collect()
            })
            .collect()
    }

    /// The means of the residuals.
    pub(crate) fn zeros(&self, applied: &Applied) -> Zeros {
        Zeros::of(&self.residuals(applied), &self.observations.samples)
    }

    /// The residuals beside these zeros.
    pub(crate) fn beside(&self, applied: &Applied, zeros: &Zeros) -> Vec<Vec<f64>> {
        let mut residuals = self.residuals(applied);
        for (channel, of) in residuals.iter_mut().enumerate() {
            let rows = of.iter_mut().zip(&self.observations.samples);
            rows.for_each(|(residual, sample)| *residual -= zeros.at(channel, sample));
        }
        residuals
    }

    /// The residuals beside each channel's zero.
    pub(crate) fn centred(&self, applied: &Applied) -> Vec<Vec<f64>> {
        self.beside(applied, &self.zeros(applied))
    }

    /// For each row, how far the decoded contact is from the one that was written; one without a contact counts nothing. None where
    /// the model knows no contacts.
    fn errors(&self, applied: &Applied, told: &ChannelBaselines<'_>) -> Option<Vec<Errors>> {
        let contacts = self.model.contacts(applied, told)?;
        let off =
            |found: &[f64], written: &[f64]| mean(found.iter().zip(written).map(|(a, b)| (a - b).abs()));
        let error = |(sample, contact): (&Sample, Option<[f64; 5]>)| match contact {
            Some([x, y, fx, fy, fz]) if is_loaded(sample) => Errors {
                contacts: 1.0,
                errors: [off(&[x, y], &sample.place_mm), off(&[fx, fy, fz], &sample.load)],
            },
            _ => Errors::default(),
        };
        Some(self.observations.samples.iter().zip(contacts).map(error).collect())
    }

    /// For each row, the sum of squares beside these zeros.
    fn squares(&self, applied: &Applied, zeros: &Zeros) -> Vec<f64> {
        self.added(&self.beside(applied, zeros), |left| left * left)
    }

    /// For each row, the sum over all readings that are numbers.
    fn added(&self, channels: &[Vec<f64>], of: impl Fn(f64) -> f64) -> Vec<f64> {
        let mut sums = vec![0.0; self.observations.rows()];
        for channel in channels {
            for (sum, value) in sums.iter_mut().zip(channel).filter(|(_, it)| !it.is_nan()) {
                *sum += of(*value);
            }
        }
        sums
    }

    /// For each row, the variance of its readings' noise, where these are expected without it.
    fn noise_squares(&self, expected: &[Vec<f64>], noise: &[Noise]) -> Vec<f64> {
        let variance = |channel: usize, row: usize| {
            let in_series = self.observations.samples[row].is_in_series();
            let is_told = self.observations.is_told[channel][row];
            if is_told { noise[channel].variance(expected[channel][row], in_series) } else { f64::NAN }
        };
        let rows = self.observations.rows();
        let squares = (0..noise.len()).map(|channel| (0..rows).map(|row| variance(channel, row)).collect());
        self.added(&squares.collect::<Vec<Vec<f64>>>(), |square| square)
    }

    /// For each row, the squares that are to be expected beside these zeros, where the channels have this noise and `expected`
    /// are the readings without it.
    fn expected_squares(
        &self,
        applied: &Applied,
        zeros: &Zeros,
        expected: &[Vec<f64>],
        noise: &[Noise],
    ) -> Vec<f64> {
        let modelled = self.model.readings(applied);
        let square = |channel: usize, row: usize| {
            let is_told = self.observations.is_told[channel][row];
            let sample = &self.observations.samples[row];
            let left = expected[channel][row] - modelled[channel][row] - zeros.at(channel, sample);
            let variance = noise[channel].variance(modelled[channel][row], sample.is_in_series());
            if is_told { left * left + variance } else { f64::NAN }
        };
        let rows = self.observations.rows();
        let squares = (0..modelled.len()).map(|channel| (0..rows).map(|row| square(channel, row)).collect());
        self.added(&squares.collect::<Vec<Vec<f64>>>(), |square| square)
    }
}

/// Whether something presses: without that there is no place to decode.
pub(super) fn is_loaded(sample: &Sample) -> bool {
    sample.load.iter().map(|n| n * n).sum::<f64>() > UNLOADED_N * UNLOADED_N
}

/// How far a decoded contact is off.
#[derive(Clone, Copy, Default)]
struct Errors {
    /// 1, or 0 where there is none.
    contacts: f64,
    /// The mean magnitude of the error along the axes: of its place, of its load.
    errors: [f64; 2],
}

/// Root mean square of residuals beside zeros.
pub(crate) fn rmse(rows: &Rows<'_>, applied: &Applied, zeros: &Zeros) -> f64 {
    let count = rows.observations.is_told.iter().flatten().filter(|it| **it).count() as f64;
    (rows.squares(applied, zeros).iter().sum::<f64>() / count).sqrt()
}

/// Whether anything is left to say of the gain: something was found or repaired, and rows were locked.
fn is_asked([open, locked]: [&Rows<'_>; 2], applied: &Applied) -> bool {
    let is_changed = !applied.is_empty() || open.unrepaired.is_some();
    is_changed && locked.observations.rows() > 0
}

/// The gain of `applied` on the locked rows; none where nothing was found. Zeros are those of the open ones.
pub(crate) fn gain(
    search: &Search<'_>,
    fit: &AttributionFit,
    rows: [&Rows<'_>; 2],
    applied: &Applied,
) -> Option<Gain> {
    if !is_asked(rows, applied) {
        return None;
    }
    let [open, locked] = rows;
    let measured = [open.measured(), locked.measured()];
    let noise = &fit.systems.noise;
    let expected = rows.map(|rows| expected(search, fit, rows));
    let expected = ExpectedGain { readings: &expected, noise };
    let squares = |applied: &Applied| squares(rows, applied, Some(&expected));
    let (nothing, extended) = (Applied::new(), squares(applied));
    // Nobody expected what was repaired.
    let nominal = match open.unrepaired {
        Some(_) => self::squares(measured, &nothing, None),
        None => squares(&nothing),
    };
    let noise_squares = [(locked, &expected.readings[1]), (open, &expected.readings[0])]
        .map(|(rows, at)| rows.noise_squares(at, noise));
    let population = Population::of([measured[1].observations, measured[0].observations], noise_squares);
    let ratio = |extended: &Squares, draw: &Draw| {
        (population.mean(extended, draw) / population.mean(&nominal, draw)).sqrt()
    };
    let as_measured = population.as_measured();
    let without = |at: usize| {
        let others: Applied =
            applied.iter().enumerate().filter(|(k, _)| *k != at).map(|(_, it)| it.clone()).collect();
        let (effect, target) = search.model.hypotheses()[applied[at].0].label;
        WithoutFinding { effect, target, rmse_ratio: ratio(&squares(&others), &as_measured) }
    };
    let [position_mae, force_mae] = decoded(measured, rows, applied, noise, &population);
    Some(Gain {
        rows_locked: locked.observations.rows(),
        rmse_ratio: ratio(&extended, &as_measured),
        rmse_ratio_interval95: population.interval95(|draw| ratio(&extended, draw)),
        position_mae,
        force_mae,
        per_cause: (0..applied.len()).map(without).collect(),
    })
}

/// The readings that the fit lets expect at rows, without noise: ŷ = f(ψ̂) + ẑero + Σ ê E + B ẑ.
fn expected(search: &Search<'_>, fit: &AttributionFit, rows: &Rows<'_>) -> Vec<Vec<f64>> {
    let mut readings = rows.model.readings(&fit.applied);
    let channels = readings.len();
    for (channel, of) in readings.iter_mut().enumerate() {
        of.iter_mut().for_each(|value| *value += fit.coordinates[channel]);
        let z = fit.systems.background_of(channel, &fit.marginal, &fit.coordinates);
        let size = search.model.sizes()[channel];
        for (z, function) in z.iter().zip(fit.systems.background_at(channel, size, rows.observations)) {
            of.iter_mut().zip(function).for_each(|(value, function)| *value += z * function);
        }
    }
    for (error, by) in rows.model.common_errors(&fit.applied).iter().zip(&fit.coordinates[channels..]) {
        for (of, signature) in readings.iter_mut().zip(&error.signature) {
            of.iter_mut().zip(signature.iter().flatten()).for_each(|(value, slope)| *value += by * slope);
        }
    }
    readings
}

/// Gain that the fit lets expect.
struct ExpectedGain<'e> {
    /// At the open and at the locked rows, channel by channel.
    readings: &'e [Vec<Vec<f64>>; 2],
    noise: &'e [Noise],
}

/// Squares of the residuals with these hypotheses, and those that are to be expected, if that is known.
fn squares([open, locked]: [&Rows<'_>; 2], applied: &Applied, known: Option<&ExpectedGain<'_>>) -> Squares {
    let zeros = open.zeros(applied);
    let expected = known.map(|ExpectedGain { readings: [at_open, at_locked], noise }| {
        [(locked, at_locked), (open, at_open)]
            .map(|(rows, expected)| rows.expected_squares(applied, &zeros, expected, noise))
    });
    let mut found = locked.squares(applied, &zeros);
    if let Some(silent) = silent([open, locked]) {
        found.iter_mut().zip(silent).for_each(|(found, silent)| *found += silent);
    }
    Squares { found, expected }
}

/// For each of the locked rows, the squares of a dead channel's readings, which stay where they are. What a converter cuts off
/// is at its limit, and leaves nothing.
fn silent([open, locked]: [&Rows<'_>; 2]) -> Option<Vec<f64>> {
    let of = |rows: &Rows<'_>| -> Option<Vec<Vec<f64>>> {
        let Observations { readings, is_told, .. } = rows.unrepaired?.observations;
        let dead = |channel: &usize| !open.observations.is_alive(*channel);
        let own = |channel: usize| -> Vec<f64> {
            let readings = readings[channel].iter().zip(&is_told[channel]);
            readings.map(|(y, is_told)| if *is_told { *y } else { f64::NAN }).collect()
        };
        Some((0..readings.len()).filter(dead).map(own).collect())
    };
    let (at_open, mut at_locked) = (of(open)?, of(locked)?);
    for (channel, of) in at_open.iter().zip(&mut at_locked) {
        let middle = mean(channel.iter().copied().filter(|y| !y.is_nan()));
        of.iter_mut().for_each(|y| *y -= middle);
    }
    Some(locked.added(&at_locked, |left| left * left))
}

/// How the mean errors of decoded places and loads change.
fn decoded(
    measured: [&Rows<'_>; 2],
    rows: [&Rows<'_>; 2],
    applied: &Applied,
    noise: &[Noise],
    population: &Population,
) -> [Option<Decoded>; 2] {
    let errors = |[open, locked]: [&Rows<'_>; 2], applied: &Applied| {
        locked.errors(applied, &ChannelBaselines { zeros: &open.zeros(applied), noise })
    };
    let both = errors(measured, &Applied::new()).zip(errors(rows, applied));
    [0, 1].map(|at| both.as_ref().and_then(|(nominal, extended)| changed(nominal, extended, at, population)))
}

/// How the mean error of places (0) or loads (1) changes; none where there is no contact.
fn changed(nominal: &[Errors], extended: &[Errors], at: usize, population: &Population) -> Option<Decoded> {
    let of = |errors: &[Errors], draw: &Draw| {
        let sum = |it: &dyn Fn(&Errors) -> f64| -> f64 {
            draw.weights[0].iter().zip(errors).map(|(weight, error)| weight * it(error)).sum()
        };
        sum(&|error| error.errors[at]) / sum(&|error| error.contacts)
    };
    let change = |draw: &Draw| of(extended, draw) - of(nominal, draw);
    let as_measured = population.as_measured();
    let (nominal_mean, extended_mean) = (of(nominal, &as_measured), of(extended, &as_measured));
    (nominal_mean.is_finite() && extended_mean.is_finite()).then(|| Decoded {
        nominal: nominal_mean,
        extended: extended_mean,
        change_interval95: population.interval95(change),
    })
}
