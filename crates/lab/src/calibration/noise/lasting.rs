//! Relative noise that lasts: each channel's gain wanders by itself, as Ornstein and Uhlenbeck's process.
//!
//! A minute of play is thousands of samples, but noise that lasts for seconds is drawn anew only some ten times in it. So it is a
//! state of the model. Contact i reads, with the signals D = diag(f),
//!
//! ```text
//! yᵢ = f(θ) + Dᵢ νᵢ + nᵢ        νᵢ = ρ νᵢ₋₁ + √(1 − ρ²) σ wᵢ        ρ = exp(−Δt/τ)
//! ```
//!
//! The states are eliminated one after the other, in the order of time: an information filter whose vector is linear in the
//! step δ of the parameters. Of what the contacts so far say of ν it keeps −½ νᵀ Y ν + νᵀ (z − Z δ).
//!
//! Source: P. de Jong, The diffuse Kalman filter, Ann. Statist. 19 (1991) 1073 (a filter whose vector is linear in unknown
//! parameters); H. E. Rauch, F. Tung, C. T. Striebel, AIAA J. 3 (1965) 1445 (the smoother).

use super::normal_equations::NormalEquations;
use super::residual::{MarginalPrecision, Residual};
use tactpad_core::quantity::CHANNELS;
use tactpad_numeric::linear::Factor;
use tactpad_numeric::products::{combined, dot};

type Matrix = [[f64; CHANNELS]; CHANNELS];

/// How the gains wander.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Wander {
    /// Time constant τ.
    pub(crate) time_s: f64,
    /// Standard deviation σ of each channel's gain.
    pub(crate) deviation: [f64; CHANNELS],
}

/// The filter.
pub(crate) struct Filter<'w> {
    wander: &'w Wander,
    /// Y.
    information: Matrix,
    /// z.
    vector: [f64; CHANNELS],
    /// Z: for each channel its derivatives by the parameters; empty where none are asked for.
    slopes: Vec<Vec<f64>>,
    /// −2 ln of what was eliminated.
    cost: f64,
}

/// Smoothed gains at each contact, by all contacts together.
pub(crate) struct Smoothed {
    /// Means of ν.
    pub(crate) mean: Vec<[f64; CHANNELS]>,
    /// Their covariances.
    pub(crate) covariance: Vec<Matrix>,
    /// Of each channel, the σ² that makes these states most likely, as a mean over so many of them.
    pub(crate) variance: [f64; CHANNELS],
}

/// A filtered state, and what came before it.
struct Filtered {
    mean: [f64; CHANNELS],
    covariance: Matrix,
    /// ρ, from the state before.
    kept: f64,
    /// Covariance before the contact was seen.
    predicted: Matrix,
}

impl<'w> Filter<'w> {
    /// Before the first contact: ν ~ N(0, σ²). There are so many parameters.
    pub(crate) fn new(wander: &'w Wander, parameters: usize) -> Self {
        Self {
            wander,
            information: diagonal(|k| 1.0 / variance(wander, k)),
            vector: [0.0; CHANNELS],
            slopes: vec![vec![0.0; parameters]; CHANNELS],
            cost: (0..CHANNELS).map(|k| variance(wander, k).ln()).sum(),
        }
    }

    /// The time until the next contact passes.
    ///
    /// With S = (1 − ρ²) σ² and M = Y + ρ² S⁻¹ the last state is eliminated:
    ///
    /// ```text
    /// Y ← S⁻¹ − ρ² S⁻¹ M⁻¹ S⁻¹      z ← ρ S⁻¹ M⁻¹ z      −½ |L⁻¹(z − Z δ)|² with M = L Lᵀ goes to the parameters
    /// ```
    pub(crate) fn pass(&mut self, after_s: f64, equations: Option<&mut NormalEquations>) -> Option<()> {
        let kept = self.wander.kept(after_s);
        let fresh: [f64; CHANNELS] = std::array::from_fn(|k| (1.0 - kept * kept) * variance(self.wander, k));
        let mut joint = self.information;
        (0..CHANNELS).for_each(|k| joint[k][k] += kept * kept / fresh[k]);
        let factor = Factor::of(&joint)?;
        self.eliminate(&factor, equations);
        let inverse = factor.inverse();
        self.information = std::array::from_fn(|i| {
            std::array::from_fn(|j| {
                let own = if i == j { 1.0 / fresh[i] } else { 0.0 };
                own - kept * kept * inverse[i][j] / (fresh[i] * fresh[j])
            })
        });
        let carried: Matrix = std::array::from_fn(|i| inverse[i].map(|entry| kept * entry / fresh[i]));
        self.vector = carried.map(|row| dot(&row, &self.vector));
        self.slopes = combined(&carried, &self.slopes);
        self.cost += fresh.iter().map(|variance| variance.ln()).sum::<f64>();
        Some(())
    }

    /// A contact is seen: Y ← Y + D V⁻¹ D, z ← z + D V⁻¹ r, Z ← Z + D V⁻¹ A. `precision` is V⁻¹, and `weighted` has the rows of V⁻¹ A.
    pub(crate) fn see(&mut self, precision: &Matrix, residual: &Residual, weighted: &[Vec<f64>]) {
        for (i, line) in precision.iter().enumerate() {
            let uv = residual.uv[i];
            for (j, entry) in line.iter().enumerate() {
                self.information[i][j] += uv * entry * residual.uv[j];
            }
            self.vector[i] += uv * dot(line, &residual.residual_uv);
            if let (Some(sums), Some(row)) = (self.slopes.get_mut(i), weighted.get(i)) {
                sums.iter_mut().zip(row).for_each(|(sum, slope)| *sum += uv * slope);
            }
        }
    }

    /// Behind the last contact. Gives −2 ln of all that was eliminated, with what is left of the states.
    pub(crate) fn end(mut self, equations: Option<&mut NormalEquations>) -> Option<f64> {
        let factor = Factor::of(&self.information)?;
        self.eliminate(&factor, equations);
        Some(self.cost)
    }

    /// The state is integrated over: H ← H − (L⁻¹Z)ᵀ(L⁻¹Z), g ← g − (L⁻¹Z)ᵀ(L⁻¹z).
    fn eliminate(&mut self, factor: &Factor<CHANNELS>, equations: Option<&mut NormalEquations>) {
        let half = factor.solve_lower(&self.vector);
        self.cost += factor.log_determinant() - dot(&half, &half);
        let Some(equations) = equations else { return };
        // L⁻¹, column by column.
        let unit = |at: usize| std::array::from_fn(|k| f64::from(u8::from(k == at)));
        let columns: Matrix = std::array::from_fn(|at| factor.solve_lower(&unit(at)));
        let lower: Matrix = std::array::from_fn(|i| std::array::from_fn(|j| columns[j][i]));
        combined(&lower, &self.slopes)
            .into_iter()
            .zip(half)
            .for_each(|(row, half)| equations.subtract(row, half));
    }

    /// The state's mean and covariance by what was seen so far.
    fn state(&self) -> Option<([f64; CHANNELS], Matrix)> {
        let factor = Factor::of(&self.information)?;
        Some((factor.solve(&self.vector), factor.inverse()))
    }
}

impl Wander {
    /// ρ.
    fn kept(&self, after_s: f64) -> f64 {
        // Samples of one moment would have no fresh part to divide by.
        libm::exp(-after_s.max(1e-3 * self.time_s) / self.time_s)
    }

    /// The states by all contacts, which must be in order of time. `None` where a covariance has no inverse.
    pub(crate) fn smoothed(&self, contacts: &[(MarginalPrecision, &Residual)]) -> Option<Smoothed> {
        let mut filter = Filter::new(self, 0);
        let mut filtered: Vec<Filtered> = Vec::with_capacity(contacts.len());
        let mut previous_s = None;
        for (precision, residual) in contacts {
            let after_s = previous_s.replace(residual.at_s).map(|previous_s| residual.at_s - previous_s);
            if let Some(after_s) = after_s {
                filter.pass(after_s, None)?;
            }
            let (_, predicted) = filter.state()?;
            filter.see(&precision.matrix(), residual, &[]);
            let (mean, covariance) = filter.state()?;
            filtered.push(Filtered {
                mean,
                covariance,
                kept: after_s.map_or(0.0, |after_s| self.kept(after_s)),
                predicted,
            });
        }
        smoothed(&filtered)
    }
}

/// Backwards: with C = ρ Pᵢ (P⁻ᵢ₊₁)⁻¹ the mean is mᵢ + C (mᵢ₊₁ˢ − ρ mᵢ), the covariance Pᵢ + C (Pᵢ₊₁ˢ − P⁻ᵢ₊₁) Cᵀ.
fn smoothed(filtered: &[Filtered]) -> Option<Smoothed> {
    let last = filtered.last()?;
    let (mut mean, mut covariance) = (vec![last.mean], vec![last.covariance]);
    let mut squares = [0.0; CHANNELS];
    for (here, next) in filtered.iter().zip(&filtered[1..]).rev() {
        let (later_mean, later) = (mean[mean.len() - 1], covariance[covariance.len() - 1]);
        let factor = Factor::of(&next.predicted)?;
        // Row i of C.
        let gain: Matrix = here.covariance.map(|row| factor.solve(&row.map(|entry| next.kept * entry)));
        let change: Matrix =
            std::array::from_fn(|i| std::array::from_fn(|j| later[i][j] - next.predicted[i][j]));
        let off: [f64; CHANNELS] = std::array::from_fn(|k| later_mean[k] - next.kept * here.mean[k]);
        let own_mean: [f64; CHANNELS] = std::array::from_fn(|k| here.mean[k] + dot(&gain[k], &off));
        let half: Matrix = std::array::from_fn(|i| std::array::from_fn(|j| dot(&change[i], &gain[j])));
        let own: Matrix = std::array::from_fn(|i| {
            std::array::from_fn(|j| {
                here.covariance[i][j] + (0..CHANNELS).map(|k| gain[i][k] * half[k][j]).sum::<f64>()
            })
        });
        for k in 0..CHANNELS {
            // E (νᵢ₊₁ − ρ νᵢ)²/(1 − ρ²), with Cov(νᵢ₊₁, νᵢ) = Pᵢ₊₁ˢ Cᵀ.
            let step = later_mean[k] - next.kept * own_mean[k];
            let together = dot(&later[k], &gain[k]);
            let square =
                step * step + later[k][k] + next.kept * next.kept * own[k][k] - 2.0 * next.kept * together;
            squares[k] += square / (1.0 - next.kept * next.kept);
        }
        mean.push(own_mean);
        covariance.push(own);
    }
    let (first_mean, first) = (mean[mean.len() - 1], covariance[covariance.len() - 1]);
    let count = filtered.len() as f64;
    let variance =
        std::array::from_fn(|k| (squares[k] + first_mean[k] * first_mean[k] + first[k][k]) / count);
    mean.reverse();
    covariance.reverse();
    Some(Smoothed { mean, covariance, variance })
}

/// σ², which is never zero.
fn variance(wander: &Wander, channel: usize) -> f64 {
    wander.deviation[channel].max(1e-4).powi(2)
}

fn diagonal(of: impl Fn(usize) -> f64) -> Matrix {
    std::array::from_fn(|i| std::array::from_fn(|j| if i == j { of(i) } else { 0.0 }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::calibration::data::contacts::Knowledge;
    use crate::calibration::noise::NoisePrior;
    use crate::calibration::noise::model::NoiseModel;
    use tactpad_core::pipeline::contact::uncertainty::UNKNOWNS;
    use tactpad_numeric::linear::Symmetric;
    use tactpad_numeric::random::SplitMix64;

    const CONTACTS: usize = 6;
    const WANDER: Wander = Wander { time_s: 2.0, deviation: [0.03; CHANNELS] };

    /// Contacts of random times, signals, slopes and residuals, and of all kinds.
    fn contacts() -> Vec<Residual> {
        let mut random = SplitMix64::new(8);
        let mut at_s = 0.0;
        let mut normal = |size: f64| size * f64::from(random.normal());
        let mut contact = |index: usize| {
            at_s += 0.2 + normal(0.5).abs();
            Residual {
                knowledge: [Knowledge::Unlabelled, Knowledge::Written, Knowledge::Placed([0.3; UNKNOWNS])]
                    [index % 3],
                at_s,
                uv: [0; CHANNELS].map(|_| normal(1000.0)),
                force_n: 1.0,
                residual_uv: [0; CHANNELS].map(|_| normal(20.0)),
                label_jacobian: [[0; UNKNOWNS]; CHANNELS].map(|row| row.map(|_| normal(200.0))),
            }
        };
        (0..CONTACTS).map(&mut contact).collect()
    }

    fn seen() -> Vec<(MarginalPrecision, Residual)> {
        let model = NoiseModel::prior(NoisePrior::SIMULATED, WANDER.time_s);
        contacts()
            .into_iter()
            .map(|residual| (model.marginal_precision(&residual).unwrap(), residual))
            .collect()
    }

    /// The joint information of all states, state after state, and its vector: by the definition, without a filter.
    fn joint() -> (Symmetric, Vec<f64>, f64) {
        let (seen, size) = (seen(), CONTACTS * CHANNELS);
        let (mut information, mut vector, mut log_prior) = (Symmetric::zeros(size), vec![0.0; size], 0.0);
        for (index, (precision, residual)) in seen.iter().enumerate() {
            let kept = if index == 0 { 0.0 } else { WANDER.kept(residual.at_s - seen[index - 1].1.at_s) };
            for (channel, line) in precision.matrix().iter().enumerate() {
                let at = index * CHANNELS + channel;
                let fresh = (1.0 - kept * kept) * WANDER.deviation[channel].powi(2);
                log_prior += fresh.ln();
                // (ν − ρ ν′)²/S.
                let of = |factors: &[(usize, f64)]| {
                    let mut whole = vec![0.0; size];
                    factors.iter().for_each(|(at, factor)| whole[*at] += factor);
                    whole
                };
                let before = if index == 0 { (at, 0.0) } else { (at - CHANNELS, -kept) };
                information.add_product(1.0 / fresh, &of(&[(at, 1.0), before]));
                for (other, entry) in line.iter().enumerate() {
                    let (weight, beside) = (residual.uv[channel] * entry, index * CHANNELS + other);
                    vector[at] += weight * residual.residual_uv[other];
                    // a b = ½ ((a + b)² − a² − b²), each pair once from either side.
                    let half = 0.5 * weight * residual.uv[other];
                    information.add_product(half, &of(&[(at, 1.0), (beside, 1.0)]));
                    information.add_product(-half, &of(&[(at, 1.0)]));
                    information.add_product(-half, &of(&[(beside, 1.0)]));
                }
            }
        }
        (information, vector, log_prior)
    }

    #[test]
    fn the_filter_is_the_joint_gaussian_of_all_states() {
        let (information, vector, log_prior) = joint();
        let factor = information.factorised().unwrap();
        let half = factor.solve_lower(&vector);
        let wanted = log_prior + factor.log_determinant() - dot(&half, &half);
        let mut filter = Filter::new(&WANDER, 0);
        let mut previous_s = None;
        for (precision, residual) in &seen() {
            if let Some(previous_s) = previous_s.replace(residual.at_s) {
                filter.pass(residual.at_s - previous_s, None).unwrap();
            }
            filter.see(&precision.matrix(), residual, &[]);
        }
        let found = filter.end(None).unwrap();
        assert!((found / wanted - 1.0).abs() < 1e-8, "{found} {wanted}");
    }

    #[test]
    fn the_smoother_gives_means_and_covariances_of_the_joint_gaussian() {
        let (information, vector, _) = joint();
        let factor = information.factorised().unwrap();
        let mean = factor.solve(&vector);
        let blocks = factor.inverse_blocks(CHANNELS);
        let seen = seen();
        let pairs: Vec<_> = seen.iter().map(|(precision, residual)| (*precision, residual)).collect();
        let smoothed = WANDER.smoothed(&pairs).unwrap();
        for index in 0..CONTACTS {
            for channel in 0..CHANNELS {
                let off = smoothed.mean[index][channel] - mean[index * CHANNELS + channel];
                assert!(off.abs() < 1e-9, "{index} {channel}: {off}");
                let off = smoothed.covariance[index][channel][channel] - blocks[index][channel][channel];
                assert!(off.abs() < 1e-10, "{index} {channel}: {off}");
            }
        }
    }

    #[test]
    fn its_size_is_found_from_states_that_show() {
        // Residuals that are nothing but a gain's wandering, on signals far above the noise.
        let mut random = SplitMix64::new(3);
        let model = NoiseModel::prior(NoisePrior::SIMULATED, WANDER.time_s);
        let mut state = [0.0; CHANNELS];
        let contacts: Vec<Residual> = (0..600)
            .map(|index| {
                let kept = WANDER.kept(0.5);
                let fresh = (1.0 - kept * kept).sqrt() * 0.05;
                state = state.map(|it| kept * it + fresh * f64::from(random.normal()));
                let uv = [0; CHANNELS].map(|_| 3e4 + 1e4 * f64::from(random.uniform()));
                Residual {
                    knowledge: Knowledge::Written,
                    at_s: 0.5 * f64::from(index),
                    uv,
                    force_n: 0.0,
                    residual_uv: std::array::from_fn(|k| uv[k] * state[k]),
                    label_jacobian: [[0.0; UNKNOWNS]; CHANNELS],
                }
            })
            .collect();
        let seen: Vec<_> = contacts.iter().map(|it| (model.marginal_precision(it).unwrap(), it)).collect();
        let found = WANDER.smoothed(&seen).unwrap().variance.map(f64::sqrt);
        assert!(found.iter().all(|deviation| (deviation / 0.05 - 1.0).abs() < 0.12), "{found:?}");
    }
}
