//! A known weight that is put on the pad: what it presses with, and how well people know that.

use crate::quantity::WEIGHT_N_PER_G;

/// Standard deviation of a weight by a kitchen scale, and of what a table that is not level makes of it, as a share of it.
pub const WEIGHT_SHARE: f64 = 0.005;

/// Weights that a pad can feel and bears, in grams.
pub const GRAMS: [f64; 2] = [30.0, 1000.0];

/// A weight that a pad can feel and bears.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Weight {
    g: f64,
}

impl Weight {
    /// A weight of so many grams.
    ///
    /// # Errors
    /// A pad cannot feel it, or does not bear it; the text says which ones it can.
    pub fn of_g(g: f64) -> Result<Self, String> {
        check_weight(g).map(|()| Self { g })
    }

    /// Grams.
    pub const fn g(self) -> f64 {
        self.g
    }

    /// Force on a level plate, N.
    pub fn force_n(self) -> f64 {
        weight_n(self.g)
    }
}

/// Force of a mass in grams, N: m g.
pub fn weight_n(weight_g: f64) -> f64 {
    WEIGHT_N_PER_G * weight_g
}

/// Whether a pad can feel and bears a weight.
///
/// # Errors
/// It cannot; the text says which ones it can.
pub fn check_weight(weight_g: f64) -> Result<(), String> {
    let [least_g, largest_g] = GRAMS;
    if (least_g..=largest_g).contains(&weight_g) {
        return Ok(());
    }
    Err(format!("{weight_g} g is no weight for this pad: take one of {least_g} to {largest_g} g"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weights_that_no_pad_feels_or_bears_are_refused() {
        assert!((Weight::of_g(200.0).unwrap().force_n() - 1.961_33).abs() < 1e-9);
        for g in [29.9, 1000.1, -200.0, f64::NAN, f64::INFINITY] {
            assert!(Weight::of_g(g).unwrap_err().contains("30 to 1000 g"), "{g}");
        }
    }
}
