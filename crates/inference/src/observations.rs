//! Observations of any number of channels: readings, and the labels beside them.

use tactpad_numeric::random::SplitMix64;
use tactpad_numeric::statistics::{mean, rms};

/// Places nearer to each other than this are one location.
const LOCATION_MM: f64 = 0.25;
/// One location in so many is locked: it is looked at once, for the gain.
const LOCKED_ONE_IN: u64 = 5;

/// The written circumstances of a row.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sample {
    /// Where the contact was, as written.
    pub place_mm: [f64; 2],
    /// Fx, Fy, Fz by the reference, or whatever loads there are.
    pub load: [f64; 3],
    /// Index of its measurement, where several were made one after the other.
    pub measurement: usize,
    /// Index of its session.
    pub session: usize,
    /// Index of its time series; none for a static sample.
    pub trial: Option<usize>,
    /// On the clock of the channels.
    pub t_s: Option<f64>,
    /// On the clock of what was written down, if that has its own.
    pub label_t_s: Option<f64>,
    /// How long a static load was held before it was read.
    pub dwell_s: Option<f64>,
    /// Whether a static load came from a higher one.
    pub is_unloading: bool,
    /// Of the sensor.
    pub temp_c: Option<f64>,
    /// Cycles of load that the sensor has behind it.
    pub cycle: Option<f64>,
    /// By how much the sensor was turned.
    pub turned_deg: f64,
    /// Whether the load is a known weight's, which no reference has a part in.
    pub is_weight: bool,
    /// Its cluster, where that is not its location and session.
    pub block: Option<usize>,
}

impl Sample {
    /// Whether it is of a time series, and not static.
    pub const fn is_in_series(&self) -> bool {
        self.trial.is_some()
    }
}

/// Rows of a measurement.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Observations {
    /// Names of the channels.
    pub channels: Vec<String>,
    /// Each channel's readings, row by row.
    pub readings: Vec<Vec<f64>>,
    /// The same way, whether a reading tells anything: one that is missing or clipped does not.
    pub is_told: Vec<Vec<bool>>,
    /// Labels beside them.
    pub samples: Vec<Sample>,
    /// The rows' numbers in the whole measurement.
    pub numbers: Vec<usize>,
}

/// Each channel's zero, in each measurement.
#[derive(Clone, Debug, PartialEq)]
pub struct Zeros {
    of_channels: Vec<Vec<f64>>,
}

impl Zeros {
    /// The means of what a model leaves at these rows, channel by channel; what is not a number tells nothing. A measurement that none of the
    /// rows is of has the mean of all.
    pub fn of(residuals: &[Vec<f64>], samples: &[Sample]) -> Self {
        let measurements = samples.iter().map(|it| it.measurement + 1).max().unwrap_or(0);
        let of_channel = |residuals: &Vec<f64>| {
            let mean_of = |is_own: &dyn Fn(&Sample) -> bool| {
                let own = residuals.iter().zip(samples).filter(|(it, sample)| !it.is_nan() && is_own(sample));
                mean(own.map(|(residual, _)| *residual))
            };
            let whole = mean_of(&|_| true);
            let of = |measurement| mean_of(&|sample| sample.measurement == measurement);
            (0..measurements).map(of).map(|zero| if zero.is_nan() { whole } else { zero }).collect()
        };
        Self { of_channels: residuals.iter().map(of_channel).collect() }
    }

    /// The channel's at a row.
    pub fn at(&self, channel: usize, sample: &Sample) -> f64 {
        self.of_channels[channel].get(sample.measurement).copied().unwrap_or_default()
    }
}

impl Observations {
    /// How many rows there are.
    pub const fn rows(&self) -> usize {
        self.samples.len()
    }

    /// The rows at these places.
    pub fn picked(&self, rows: &[usize]) -> Self {
        fn of<T: Copy>(all: &[Vec<T>], rows: &[usize]) -> Vec<Vec<T>> {
            all.iter().map(|of| rows.iter().map(|row| of[*row]).collect()).collect()
        }
        Self {
            channels: self.channels.clone(),
            readings: of(&self.readings, rows),
            is_told: of(&self.is_told, rows),
            samples: rows.iter().map(|row| self.samples[*row]).collect(),
            numbers: rows.iter().map(|row| self.numbers[*row]).collect(),
        }
    }

    /// These rows as a whole measurement.
    pub fn as_whole(&self, rows: &[usize]) -> Self {
        Self { numbers: (0..rows.len()).collect(), ..self.picked(rows) }
    }

    /// For each row, whether it is of a time series, and not static.
    pub fn in_series(&self) -> Vec<bool> {
        self.samples.iter().map(Sample::is_in_series).collect()
    }

    /// For each row, whether it goes on with the time series of the row before it.
    pub fn follows(&self) -> Vec<bool> {
        let goes_on = |pair: &[Sample]| pair[0].trial.is_some() && pair[0].trial == pair[1].trial;
        std::iter::once(false).chain(self.samples.windows(2).map(goes_on)).take(self.rows()).collect()
    }

    /// These rows and all of the time series that they are of, in their order.
    pub fn with_series(&self, rows: &[usize]) -> Vec<usize> {
        let first_of_run = self.follows().into_iter().enumerate().scan(0, |first, (row, follows)| {
            *first = if follows { *first } else { row };
            Some(*first)
        });
        let first_of_run: Vec<usize> = first_of_run.collect();
        let mut is_asked = vec![false; self.rows()];
        rows.iter().for_each(|row| is_asked[first_of_run[*row]] = true);
        (0..self.rows()).filter(|row| is_asked[first_of_run[*row]]).collect()
    }

    /// Whether a channel tells anything at all.
    pub fn is_alive(&self, channel: usize) -> bool {
        self.is_told[channel].contains(&true)
    }

    /// For each row the number of its cluster: rows of one location and session share their errors.
    pub fn clusters(&self) -> Vec<usize> {
        let steps = |mm: f64| libm::round(mm / LOCATION_MM) as i64;
        let key = |sample: &Sample| match sample.block {
            Some(block) => (sample.measurement, block, [0; 2]),
            None => (sample.measurement, sample.session, sample.place_mm.map(steps)),
        };
        let mut keys: Vec<_> = self.samples.iter().map(key).collect();
        let rows = keys.clone();
        keys.sort_unstable();
        keys.dedup();
        rows.iter().map(|row| keys.partition_point(|key| key < row)).collect()
    }

    /// The rows to find causes by, and the locked ones: whole clusters, drawn once and for all by their number.
    pub fn split(&self) -> [Vec<usize>; 2] {
        let clusters = self.clusters();
        let is_locked =
            |row: &usize| SplitMix64::new(clusters[*row] as u64).next_bits().is_multiple_of(LOCKED_ONE_IN);
        let (locked, open) = (0..self.rows()).partition(is_locked);
        [open, locked]
    }

    /// Two halves of the clusters, the one between the other.
    pub fn halves(&self) -> [Vec<usize>; 2] {
        let clusters = self.clusters();
        let (one, other) = (0..self.rows()).partition(|row| clusters[*row].is_multiple_of(2));
        [one, other]
    }

    /// Root mean square of the loads' magnitudes.
    pub fn load_rms(&self) -> f64 {
        rms(self.samples.iter().map(|it| libm::sqrt(it.load.iter().map(|n| n * n).sum())))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_bring_their_series_along_and_nothing_else() {
        let trials = [None, Some(1), Some(1), Some(2), Some(1), Some(1), None];
        let samples = trials.map(|trial| Sample { trial, ..Sample::default() });
        let all = Observations {
            channels: Vec::new(),
            readings: Vec::new(),
            is_told: Vec::new(),
            samples: samples.to_vec(),
            numbers: (0..7).collect(),
        };
        assert_eq!(all.with_series(&[2, 6]), [1, 2, 6]);
        assert_eq!(all.with_series(&[5]), [4, 5]);
        assert!(all.with_series(&[]).is_empty());
    }

    #[test]
    fn each_measurement_has_a_zero_of_its_own() {
        let sample = |measurement| Sample { measurement, ..Sample::default() };
        let zeros = Zeros::of(&[vec![1.0, 3.0, f64::NAN, 8.0]], &[0, 0, 2, 2].map(sample));
        assert_eq!([0, 1, 2, 3].map(|at| zeros.at(0, &sample(at))), [2.0, 4.0, 8.0, 0.0]);
    }
}
