//! How sharply a cause can be known at best (Cramér and Rao): with the background's covariance, the noise and a zero of each
//! channel that is not known.

use crate::case::Case;
use crate::fields::{NOMINAL, signals};
use crate::measured::{Measured, Quality, Seeds, measured, typical};
use crate::plan::Row;
use crate::truth::Truth;

/// From the lower to the upper end of an interval at 95 %, in deviations.
const WIDTH: f64 = 2.0 * 1.959_964;

/// The least width of an interval at 95 % for each parameter of the only hidden cause; not finite where the data say
/// nothing. Noise is taken as independent from row to row.
pub(crate) fn least_widths(case: &Case) -> Vec<f64> {
    let truth = &case.truths[0];
    let rows = case.rows();
    let slopes: Vec<Vec<[f64; 9]>> =
        (0..truth.parameters.len()).map(|index| slope(truth, index, &rows)).collect();
    let mut information = vec![vec![0.0; slopes.len()]; slopes.len()];
    for channel in 0..9 {
        let whitened = Whitening::new(&rows, &case.quality, channel);
        let zero = whitened.of(vec![1.0; rows.len()]);
        let unknown = |values: Vec<f64>| match truth.effect.as_str() {
            // The zero itself is asked for.
            "channel_offset" => values,
            _ => without(values, &zero),
        };
        let own: Vec<Vec<f64>> = slopes
            .iter()
            .map(|slope| unknown(whitened.of(slope.iter().map(|row| row[channel]).collect())))
            .collect();
        for (row, a) in information.iter_mut().zip(&own) {
            row.iter_mut().zip(&own).for_each(|(sum, b)| *sum += product(a, b));
        }
    }
    inverse_diagonal(information).into_iter().map(|variance| WIDTH * variance.sqrt()).collect()
}

/// How the channels, less what the nominal pad has for the labels, change with a parameter.
fn slope(truth: &Truth, index: usize, rows: &[Row]) -> Vec<[f64; 9]> {
    let step = (1e-3 * truth.parameters[index].1.abs()).max(1e-6);
    let [ahead, behind] = [step, -step].map(|step| {
        let mut truth = truth.clone();
        truth.parameters[index].1 += step;
        residual(truth, rows)
    });
    let difference = |(a, b): (&[f64; 9], &[f64; 9])| std::array::from_fn(|k| (a[k] - b[k]) / (2.0 * step));
    ahead.iter().zip(&behind).map(difference).collect()
}

fn residual(truth: Truth, rows: &[Row]) -> Vec<[f64; 9]> {
    let silent = Quality { background: [0.0, 14.0], noise: [[0.0; 2]; 9], ..Quality::STATED };
    let seeds = Seeds { pad: 1, recording: 1 };
    let Measured { labels, channels, .. } = measured(rows.to_vec(), &[truth], &silent, &|_, _| {}, seeds);
    let less = |(label, channels): (&crate::plan::Contact, &[f64; 9])| {
        let nominal = signals(&NOMINAL.at(label.place), label.force);
        std::array::from_fn(|k| channels[k] - nominal[k])
    };
    labels.iter().zip(&channels).map(less).collect()
}

/// Divides by the square root of a channel's covariance: Cholesky's factor, row by row.
struct Whitening(Vec<Vec<f64>>);

impl Whitening {
    fn new(rows: &[Row], quality: &Quality, channel: usize) -> Self {
        let rms = typical(rows)[channel];
        let [share, length] = quality.background;
        let [additive, multiplicative] = quality.noise[channel];
        let force = |row: &Row| row.contact.force;
        let along = |a: &Row, b: &Row| force(a).iter().zip(force(b)).map(|(a, b)| a * b).sum::<f64>();
        let loaded = rows.iter().filter(|row| row.loaded());
        let mean = loaded.clone().map(|row| along(row, row)).sum::<f64>() / loaded.count() as f64;
        let variance = (share * rms).powi(2) / mean;
        let mut factor: Vec<Vec<f64>> = Vec::with_capacity(rows.len());
        for (i, row) in rows.iter().enumerate() {
            let signal = signals(&NOMINAL.at(row.contact.place), force(row))[channel];
            let noise = (additive * rms).powi(2) + (multiplicative * signal).powi(2);
            let mut own = Vec::with_capacity(i + 1);
            for (j, other) in rows[..=i].iter().enumerate() {
                let [dx, dy] = [0, 1].map(|axis| row.contact.place[axis] - other.contact.place[axis]);
                let smooth =
                    variance * along(row, other) * (-(dx * dx + dy * dy) / (2.0 * length * length)).exp();
                if j == i {
                    own.push((smooth + noise - product(&own, &own)).sqrt());
                } else {
                    own.push((smooth - product(&own, &factor[j][..j])) / factor[j][j]);
                }
            }
            factor.push(own);
        }
        Self(factor)
    }

    fn of(&self, mut values: Vec<f64>) -> Vec<f64> {
        for (i, row) in self.0.iter().enumerate() {
            values[i] = (values[i] - product(&row[..i], &values[..i])) / row[i];
        }
        values
    }
}

fn product(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// What of `values` is not along `other`.
fn without(mut values: Vec<f64>, other: &[f64]) -> Vec<f64> {
    let share = product(&values, other) / product(other, other);
    values.iter_mut().zip(other).for_each(|(value, other)| *value -= share * other);
    values
}

/// The diagonal of the inverse of a matrix of at most three rows, by elimination.
fn inverse_diagonal(matrix: Vec<Vec<f64>>) -> Vec<f64> {
    let size = matrix.len();
    let column = |index: usize| {
        let mut matrix = matrix.clone();
        let mut right: Vec<f64> = (0..size).map(|row| f64::from(u8::from(row == index))).collect();
        for pivot in 0..size {
            for other in (0..size).filter(|other| *other != pivot) {
                let share = matrix[other][pivot] / matrix[pivot][pivot];
                let above = matrix[pivot].clone();
                matrix[other].iter_mut().zip(above).for_each(|(cell, above)| *cell -= share * above);
                right[other] -= share * right[pivot];
            }
        }
        right[index] / matrix[index][index]
    };
    (0..size).map(column).collect()
}

/// Without a background, a zero is known as the mean of its readings.
#[test]
fn the_least_width_of_a_gain_is_that_of_its_noise() {
    use crate::plan::Plan;
    let mut case =
        Case::new("width", 1, Plan::Paper, vec![Truth::new("channel_gain", "m0z", &[("gain", 1.0)])]);
    case.quality = Quality { background: [0.0, 14.0], noise: [[0.01, 0.0]; 9], ..Quality::STATED };
    let rows = case.rows();
    let rms = typical(&rows)[2];
    let signal: Vec<f64> =
        rows.iter().map(|row| signals(&NOMINAL.at(row.contact.place), row.contact.force)[2]).collect();
    let mean = signal.iter().sum::<f64>() / signal.len() as f64;
    let spread: f64 = signal.iter().map(|signal| (signal - mean).powi(2)).sum();
    let expected = WIDTH * 0.01 * rms / spread.sqrt();
    let found = least_widths(&case)[0];
    assert!((found / expected - 1.0).abs() < 1e-3, "{found} {expected}");
}
