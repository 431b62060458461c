//! The drift of a channel's zero from one reading of the untouched pad to the next, and what the readings say of it.
//!
//! The zero u walks at random and is read with noise: a local level model,
//!
//! ```text
//! yᵢ = uᵢ + nᵢ,  n ~ N(0, σ²),        uᵢ₊₁ = uᵢ + eᵢ,  e ~ N(0, ρ σ² Δᵢ)
//! ```
//!
//! with Δ from one reading to the next. ρ is what the readings make most likely. Where they are precise beside the drift (ρ → ∞)
//! the zero is what was read.
//!
//! Source: J. Durbin, S. J. Koopman, Time Series Analysis by State Space Methods (2012), chapter 2.

/// Fewer readings say nothing of their noise.
const READINGS_MIN: usize = 6;
/// ρ Δ that are tried, by their logarithm to the base 2, with Δ the mean.
const LOG2_RATIOS: std::ops::RangeInclusive<i32> = -14..=4;
/// By so much the likelihood must be larger than that of readings without noise, in natural logarithms.
const LIKELIER_BY: f64 = 3.0;

/// Drift of a zero.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drift {
    /// ρ, by the unit in which the places of readings count; infinite: the zero is what is read.
    ratio: f64,
}

impl Drift {
    /// The zero is what is read.
    pub const AS_READ: Self = Self { ratio: f64::INFINITY };

    /// The drift that these readings at these places make most likely.
    pub fn of(places: &[f64], readings: &[f64]) -> Self {
        let steps = steps(places);
        let known: Vec<f64> = steps.iter().copied().filter(|step| step.is_finite()).collect();
        let is_constant = readings.iter().all(|reading| *reading == readings[0]);
        if known.len() + 1 < READINGS_MIN || is_constant || readings.iter().any(|it| !it.is_finite()) {
            return Self::AS_READ;
        }
        let mean = known.iter().sum::<f64>() / known.len() as f64;
        let tried = LOG2_RATIOS.map(|power| libm::exp2(f64::from(power)) / mean);
        let likelihood = |ratio: f64| (ratio, log_likelihood(ratio, &steps, readings));
        let best = tried.map(likelihood).max_by(|one, other| one.1.total_cmp(&other.1));
        let as_read = log_likelihood(1e9 / mean, &steps, readings);
        match best.filter(|(_, found)| *found > as_read + LIKELIER_BY) {
            Some((ratio, _)) => Self { ratio },
            None => Self::AS_READ,
        }
    }

    /// What the zeros are if these values are read at these places.
    pub fn smoothed<const N: usize>(&self, places: &[f64], values: &[[f64; N]]) -> Vec<[f64; N]> {
        if self.ratio.is_infinite() {
            return values.to_vec();
        }
        // The least Σ (y − u)² + Σ wᵢ (uᵢ₊₁ − uᵢ)² with w = 1/(ρ Δ): a tridiagonal system, by L. H. Thomas' algorithm.
        let pulls: Vec<f64> = steps(places).iter().map(|step| (self.ratio * step).recip()).collect();
        let pull = |at: Option<usize>| at.and_then(|at| pulls.get(at)).copied().unwrap_or(0.0);
        let mut smoothed = values.to_vec();
        let mut superdiagonal = Vec::with_capacity(values.len());
        let mut before = (0.0, [0.0; N]);
        for (at, value) in smoothed.iter_mut().enumerate() {
            let (left, right) = (pull(at.checked_sub(1)), pull(Some(at)));
            let (share, carried) = before;
            let pivot = 1.0 + left + right - left * share;
            value
                .iter_mut()
                .zip(carried)
                .for_each(|(value, carried)| *value = (*value + left * carried) / pivot);
            before = (right / pivot, *value);
            superdiagonal.push(right / pivot);
        }
        for at in (1..smoothed.len()).rev() {
            let behind = smoothed[at];
            let here = &mut smoothed[at - 1];
            here.iter_mut().zip(behind).for_each(|(here, behind)| *here += superdiagonal[at - 1] * behind);
        }
        smoothed
    }
}

/// From each place to the next; infinite where a clock starts anew.
fn steps(places: &[f64]) -> Vec<f64> {
    let step = |pair: &[f64]| if pair[1] > pair[0] { pair[1] - pair[0] } else { f64::INFINITY };
    places.windows(2).map(step).collect()
}

/// ln p(y | ρ) at the most likely σ, but for a constant: Kalman's filter from a first zero of which nothing is known.
fn log_likelihood(ratio: f64, steps: &[f64], readings: &[f64]) -> f64 {
    let Some((first, rest)) = readings.split_first() else { return f64::NEG_INFINITY };
    // Mean and variance of the zero, in σ².
    let (mut mean, mut variance) = (*first, 1.0);
    let (mut squares, mut log_determinant, mut count) = (0.0, 0.0, 0.0);
    for (step, reading) in steps.iter().zip(rest) {
        if step.is_infinite() {
            (mean, variance) = (*reading, 1.0);
            continue;
        }
        let predicted = variance + ratio * step;
        let whole = predicted + 1.0;
        let innovation = reading - mean;
        squares += innovation * innovation / whole;
        log_determinant += libm::log(whole);
        count += 1.0;
        (mean, variance) = (mean + predicted / whole * innovation, predicted / whole);
    }
    -0.5 * (count * libm::log(squares / count) + log_determinant)
}

#[cfg(test)]
mod tests {
    use super::*;
    use tactpad_numeric::random::SplitMix64;

    /// Zeros that drift by `drift` from one reading to the next, and readings of them with a noise of 5.
    fn walk(drift: f64, seed: u64) -> (Vec<f64>, Vec<[f64; 1]>, Vec<f64>) {
        let mut random = SplitMix64::new(seed);
        let mut normal = || f64::from(random.normal());
        let (mut zero, mut all) = (40.0, (Vec::new(), Vec::new(), Vec::new()));
        for at in 0..28 {
            all.0.push(f64::from(25 * at));
            all.1.push([zero + 5.0 * normal()]);
            all.2.push(zero);
            zero += drift * normal();
        }
        all
    }

    fn rms_off(found: &[[f64; 1]], zeros: &[f64]) -> f64 {
        let squares = found.iter().zip(zeros).map(|([one], other)| (one - other).powi(2));
        libm::sqrt(squares.sum::<f64>() / zeros.len() as f64)
    }

    #[test]
    fn a_zero_that_stands_is_the_mean_of_its_readings_and_one_that_drifts_is_what_is_read() {
        let mean = |drift: f64| {
            let off = |seed| {
                let (places, readings, zeros) = walk(drift, seed);
                let read: Vec<f64> = readings.iter().map(|[one]| *one).collect();
                rms_off(&Drift::of(&places, &read).smoothed(&places, &readings), &zeros)
            };
            (1..=40).map(off).sum::<f64>() / 40.0
        };
        // The noise of a reading is 5; of a mean of 28, 0.9.
        let [standing, slow, fast] = [0.0, 1.0, 50.0].map(mean);
        assert!(standing < 2.0 && slow < 3.0 && fast < 5.2, "{standing} {slow} {fast}");
    }

    #[test]
    fn smoothing_is_the_solution_of_its_equations() {
        let places = [0.0, 1.0, 3.0, 2.0, 4.0];
        let values = [[1.0, -2.0], [2.0, 0.5], [4.0, 1.0], [-3.0, 7.0], [0.0, 1.0]];
        let smoothed = Drift { ratio: 0.7 }.smoothed(&places, &values);
        let pulls = [1.0 / 0.7, 0.5 / 0.7, 0.0, 0.5 / 0.7];
        for k in 0..2 {
            for at in 0..5 {
                let towards = |other: usize, pull: f64| pull * (smoothed[at][k] - smoothed[other][k]);
                let left = if at > 0 { towards(at - 1, pulls[at - 1]) } else { 0.0 };
                let right = if at < 4 { towards(at + 1, pulls[at]) } else { 0.0 };
                let read = smoothed[at][k] + left + right;
                assert!((read - values[at][k]).abs() < 1e-12, "{at} {k}: {read}");
            }
        }
    }

    #[test]
    fn few_readings_and_equal_ones_are_what_is_read() {
        assert_eq!(Drift::of(&[0.0, 1.0, 2.0], &[1.0, 5.0, -4.0]), Drift::AS_READ);
        assert_eq!(Drift::of(&[0.0; 0], &[]), Drift::AS_READ);
        let places: Vec<f64> = (0..9).map(f64::from).collect();
        assert_eq!(Drift::of(&places, &[3.0; 9]), Drift::AS_READ);
        assert_eq!(Drift::of(&[1.0; 9], &[1.0, 2.0, 3.0, 1.0, 2.0, 3.0, 1.0, 2.0, 3.0]), Drift::AS_READ);
    }
}
