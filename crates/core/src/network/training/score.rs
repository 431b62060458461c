//! Errors of predictions: mean squared, mean absolute, R².

use crate::network::{Example, Network, OUTPUTS};
use tactpad_numeric::statistics;

/// Errors of one number over many examples, or of all five together.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Score {
    /// Mean of the squared errors.
    pub mse: f64,
    /// Mean of the errors' magnitudes.
    pub mae: f64,
    /// 1 − mean squared error / variance of the true values; one true value alone has none.
    pub r2: f64,
}

/// Errors in standardised units, in which the paper states them.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Scores {
    /// Means over the five numbers.
    pub all: Score,
    /// x, y, Fx, Fy, Fz.
    pub each: [Score; OUTPUTS],
}

impl Scores {
    /// Scores of a network on examples that it has not seen.
    pub fn of(network: &Network, examples: &[Example]) -> Self {
        let pairs: Vec<_> = examples
            .iter()
            .map(|example| {
                let found = network.decode(&example.uv);
                [&example.contact, &found].map(|contact| network.standardised(contact).map(f64::from))
            })
            .collect();
        let each =
            std::array::from_fn(|k| Score::of(pairs.iter().map(|[wanted, found]| [wanted[k], found[k]])));
        let mean = |of: fn(&Score) -> f64| statistics::mean(each.iter().map(of));
        let all = Score { mse: mean(|one| one.mse), mae: mean(|one| one.mae), r2: mean(|one| one.r2) };
        Self { all, each }
    }
}

impl Score {
    /// Of pairs of a true value and a found one; no pair has no score.
    fn of(pairs: impl Iterator<Item = [f64; 2]> + Clone) -> Self {
        let mean = |of: &dyn Fn([f64; 2]) -> f64| statistics::mean(pairs.clone().map(of));
        // R² = 1 − Σ (found − wanted)²/Σ (wanted − mean)².
        let mse = mean(&|[wanted, found]| (found - wanted).powi(2));
        let centre = mean(&|[wanted, _]| wanted);
        let variance = mean(&|[wanted, _]| (wanted - centre).powi(2));
        Self { mse, mae: mean(&|[wanted, found]| (found - wanted).abs()), r2: 1.0 - mse / variance }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scores_are_those_of_the_definitions() {
        let pairs = [[1.0, 1.5], [2.0, 2.0], [3.0, 2.0]];
        let score = Score::of(pairs.into_iter());
        let near = |found: f64, wanted: f64| assert!((found - wanted).abs() < 1e-12, "{found} {wanted}");
        near(score.mse, 1.25 / 3.0);
        near(score.mae, 0.5);
        near(score.r2, 1.0 - 1.25 / 2.0);
    }
}
