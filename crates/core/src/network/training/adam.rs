//! Adam: a step in which each parameter moves by about the rate, however large its gradient is.
//!
//! Source: D. P. Kingma and J. Ba, "Adam: a method for stochastic optimization", ICLR 2015, algorithm 1 with its
//! constants.

/// Decay of the first moment.
const BETA_1: f32 = 0.9;
/// Decay of the second moment.
const BETA_2: f32 = 0.999;
const EPSILON: f32 = 1e-8;

/// Running means of the gradients (first moment m) and of their squares (second moment v).
#[derive(Clone, Debug)]
pub(super) struct Adam {
    rate: f32,
    mean: Vec<f32>,
    square: Vec<f32>,
    /// β₁ᵗ and β₂ᵗ after t steps: what the means still hold of the zeros that they began with.
    beta_1_power: f64,
    beta_2_power: f64,
}

impl Adam {
    pub(super) fn new(rate: f32, parameters: usize) -> Self {
        Self {
            rate,
            mean: vec![0.0; parameters],
            square: vec![0.0; parameters],
            beta_1_power: 1.0,
            beta_2_power: 1.0,
        }
    }

    /// Moves the parameters θ against their gradient g.
    pub(super) fn step(&mut self, parameters: &mut [f32], gradient: &[f32]) {
        self.beta_1_power *= f64::from(BETA_1);
        self.beta_2_power *= f64::from(BETA_2);
        // Bias corrections m̂ = m/(1 − β₁ᵗ) and v̂ = v/(1 − β₂ᵗ), taken once for all parameters.
        let rate = (f64::from(self.rate) / (1.0 - self.beta_1_power)) as f32;
        let square_gain = (1.0 / (1.0 - self.beta_2_power)) as f32;
        let moments = self.mean.iter_mut().zip(&mut self.square);
        for ((parameter, slope), (mean, square)) in parameters.iter_mut().zip(gradient).zip(moments) {
            // m ← β₁ m + (1 − β₁) g, v ← β₂ v + (1 − β₂) g², θ ← θ − rate m̂/(√v̂ + ε).
            *mean = BETA_1 * *mean + (1.0 - BETA_1) * slope;
            *square = BETA_2 * *square + (1.0 - BETA_2) * slope * slope;
            *parameter -= rate * *mean / ((*square * square_gain).sqrt() + EPSILON);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_step_is_the_rate_and_the_way_leads_down() {
        let mut adam = Adam::new(0.01, 2);
        let mut parameters = [1.0, -3.0];
        adam.step(&mut parameters, &[5.0, -0.001]);
        assert!((parameters[0] - 0.99).abs() < 1e-6 && (parameters[1] + 2.99).abs() < 1e-6, "{parameters:?}");
        // (p − 0.5)² is least at 0.5.
        for _ in 0..2_000 {
            let gradient = parameters.map(|p| 2.0 * (p - 0.5));
            adam.step(&mut parameters, &gradient);
        }
        assert!(parameters.iter().all(|p| (p - 0.5).abs() < 1e-3), "{parameters:?}");
    }
}
