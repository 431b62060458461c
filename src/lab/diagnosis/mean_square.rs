//! The mean square of residuals over places like those of the plan, by locked rows.
//!
//! Let e² be the squared residuals at the locked rows, and ê² those that the fit to the open rows lets expect, at all rows: with the
//! fitted causes, the smooth background and the noise. Then
//!
//! ```text
//! ⟨e²⟩ = mean of ê² over all rows + mean of (e² − ê²) over the locked ones
//! ```
//!
//! The locked rows correct whatever the expectation has wrong. The better that is, the less it counts which places were locked.
//!
//! Source: A. N. Angelopoulos, S. Bates, C. Fannjiang, M. I. Jordan, T. Zrnic, Science 382 (2023) 669 (prediction-powered inference).

use crate::numeric::random::SplitMix64;

/// Draws of the bootstrap over clusters.
const DRAWS: usize = 1000;
/// The same draws for the same data.
const SEED: u64 = 0x6a19;

/// Squares, added up in each cluster.
pub(super) struct Squares {
    /// At the locked rows.
    pub(super) found: Vec<f64>,
    /// Those that are to be expected at the locked and at the open rows; none where nothing is known of that.
    pub(super) expected: Option<[Vec<f64>; 2]>,
}

/// Clusters, some more than once.
pub(super) struct Draw {
    pub(super) locked: Vec<usize>,
    open: Vec<usize>,
}

/// How many readings each cluster has.
pub(super) struct Counts {
    pub(super) locked: Vec<f64>,
    pub(super) open: Vec<f64>,
}

impl Squares {
    /// ⟨e²⟩ of the drawn clusters.
    pub(super) fn mean(&self, counts: &Counts, draw: &Draw) -> f64 {
        let over = |of: &[f64], clusters: &[usize]| clusters.iter().map(|at| of[*at]).sum::<f64>();
        let locked = over(&counts.locked, &draw.locked);
        let found = over(&self.found, &draw.locked) / locked;
        let Some([at_locked, at_open]) = &self.expected else { return found };
        let expected = [over(at_locked, &draw.locked), over(at_open, &draw.open)];
        let all = locked + over(&counts.open, &draw.open);
        (found - expected[0] / locked + (expected[0] + expected[1]) / all).max(0.0)
    }
}

impl Draw {
    /// Each cluster once.
    pub(super) fn all(counts: &Counts) -> Self {
        Self { locked: (0..counts.locked.len()).collect(), open: (0..counts.open.len()).collect() }
    }

    fn random(counts: &Counts, random: &mut SplitMix64) -> Self {
        let mut drawn = |clusters: usize| -> Vec<usize> {
            (0..clusters).map(|_| (random.next_bits() % clusters as u64) as usize).collect()
        };
        Self { locked: drawn(counts.locked.len()), open: drawn(counts.open.len()) }
    }
}

/// Ends of the 95 % interval of what is computed of clusters, by drawing as many of them as there are.
pub(super) fn interval95(counts: &Counts, of: impl Fn(&Draw) -> f64) -> [f64; 2] {
    let mut random = SplitMix64::new(SEED);
    let mut drawn: Vec<f64> = (0..DRAWS).map(|_| of(&Draw::random(counts, &mut random))).collect();
    drawn.sort_by(f64::total_cmp);
    [0.025, 0.975].map(|share| drawn[(share * DRAWS as f64) as usize])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn squares(is_expected: bool) -> (Counts, Squares) {
        // Four open clusters in five are as large as expected; locked ones are so much larger.
        let counts = Counts { locked: vec![2.0; 10], open: vec![2.0; 40] };
        let at = |cluster: usize| 2.0 * (1.0 + (cluster % 10) as f64);
        let expected = [(0..10).map(at).collect(), (0..40).map(at).collect()];
        let found = (0..10).map(|cluster| 1.5 * at(cluster)).collect();
        (counts, Squares { found, expected: is_expected.then_some(expected) })
    }

    #[test]
    fn what_was_expected_wrongly_is_corrected_and_narrows_the_interval() {
        let widths = [false, true].map(|is_expected| {
            let (counts, squares) = squares(is_expected);
            let mean = squares.mean(&counts, &Draw::all(&counts));
            assert!((mean - 1.5 * 5.5).abs() < 1e-9, "{mean}");
            let [low, high] = interval95(&counts, |draw| squares.mean(&counts, draw));
            assert!(low < mean && mean < high);
            high - low
        });
        assert!(widths[1] < 0.6 * widths[0], "{widths:?}");
    }
}
