//! The covariance of what no cause explains: noise, a smooth background, and errors that the model is known to have.

use super::basis::{Basis, Prior};
use super::model::{Linearised, Model};
use super::noise::NoiseLevel;
use super::observations::Observations;
use super::system::{ChannelSystem, Reduced};
use super::whitening::Whitening;
use crate::numeric::dense::{Matrix, gram};
use crate::numeric::linear::{LargeFactor, dot};
use crate::numeric::statistics::rms;

/// Largest background, as a share of a channel's root mean square.
pub(super) const BACKGROUND_MAX: f64 = 0.03;
/// Root mean square of what the simulator itself gets wrong, smooth as well and the same way: 0.44 % against an independent solution.
const MODEL_ERROR: f64 = 0.005;
/// Largest smooth remainder that is not a finding.
pub(super) const REMAINDER_MAX: f64 = BACKGROUND_MAX + MODEL_ERROR;
/// Where its search begins, and where it ends.
const BACKGROUND_FIRST: f64 = 0.01;
const BACKGROUND_MIN: f64 = 1e-4;
/// Degrees of freedom that the mean over all channels and loads counts for in each.
const POOLED_FREEDOM: f64 = 6.0;
/// Steps of the search for the background's sizes: at each length, and from sizes that are nearly right.
const STEPS: usize = 5;
const STEPS_AGAIN: usize = 6;
/// Steps of the search for its length, each by the golden section.
const SECTIONS: usize = 5;
const GOLDEN: f64 = 0.618_034;
/// A column's prior while noise is estimated, as a share of the channel's root mean square.
const SIGNATURE_PRIOR: f64 = 0.1;
/// How often noise and what surrounds it are found in turn.
const NOISE_ROUNDS: usize = 3;
/// Least part of the rows that count as degrees of freedom.
const FREEDOM_RATIO_MIN: f64 = 0.1;

/// Sizes of the smooth background.
#[derive(Clone, Debug)]
pub(super) struct Background {
    /// The process.
    pub(super) prior: Prior,
    /// For each channel and load: standard deviation as a share of the channel's root mean square.
    pub(super) shares: Vec<[f64; 3]>,
    /// For each channel: the degrees of freedom that its size is known by.
    pub(super) freedom: Vec<f64>,
}

/// The rows of a measurement as systems of its channels.
pub(super) struct Systems {
    pub(super) channels: Vec<ChannelSystem>,
    pub(super) noise: Vec<NoiseLevel>,
    basis: Basis,
    /// Σ (load φ)(load φ)ᵀ/n over the rows of the whole measurement.
    mean_squares: Matrix,
    /// For each channel, what makes that G: zᵀ G z is the mean square of B z over the channel's.
    extents: Vec<f64>,
    /// Number of all columns.
    pub(super) columns: usize,
}

/// What the background's functions say of a channel's residual.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Remainder {
    /// Over the rows, as a share of the channel's mean square.
    pub(super) mean_square: f64,
    /// Standard deviation of that.
    pub(super) deviation: f64,
    /// ẑᵀ T⁻¹ ẑ.
    pub(super) energy: f64,
    /// The degrees of freedom that the rows tell: about the energy, unless the background is larger than it may be.
    pub(super) freedom: f64,
}

/// All channels' systems with one background.
pub(super) struct Marginal {
    /// Aᵀ V⁻¹ A over all columns.
    pub(super) fisher: Matrix,
    /// Aᵀ V⁻¹ r.
    pub(super) score: Vec<f64>,
    /// rᵀ V⁻¹ r.
    pub(super) square: f64,
    log_determinant: f64,
    pub(super) channels: Vec<Reduced>,
}

/// A column of all: its signature, channel by channel.
pub(super) type Column<'c> = &'c [Option<Vec<f64>>];

impl Systems {
    /// `columns` are the signatures about the present point, `linearised` that point; `observations` are rows of `all`. The `model`
    /// says what it knows of its channels.
    pub(super) fn of(
        [all, observations]: [&Observations; 2],
        model: &dyn Model,
        linearised: &Linearised,
        columns: &[Column<'_>],
    ) -> Option<Self> {
        let basis = Basis::of(observations);
        let load_rms = observations.load_rms();
        let follows = observations.follows();
        let wide = basis.prior(basis.lengths_mm()[0])?;
        let mut noise = Vec::new();
        let mut extents = Vec::new();
        let mut channels = Vec::new();
        for ((channel, readings), whole) in observations.readings.iter().enumerate().zip(model.sizes()) {
            let modelled = &linearised.readings[channel];
            let residual: Vec<f64> = readings.iter().zip(modelled).map(|(y, f)| y - f).collect();
            let size = rms(modelled.iter().copied()) / load_rms;
            let background = products(&linearised.loads, &basis.values, size);
            let doubts = &linearised.doubts[channel];
            extents.push((size / whole).powi(2));
            let errors = model.stated_errors(channel);
            let own: Vec<(usize, &[f64])> = columns
                .iter()
                .enumerate()
                .filter_map(|(number, column)| Some((number, column[channel].as_deref()?)))
                .collect();
            let (mut level, mut memory) = (NoiseLevel::first(modelled), 0.0);
            let system = |level: &NoiseLevel, memory: f64| {
                let is_told = &observations.is_told[channel];
                let variance = |(row, is_told): (usize, &bool)| {
                    let doubt = doubts.get(row).copied().unwrap_or_default();
                    if *is_told { level.variance(modelled[row]) + doubt * doubt } else { f64::INFINITY }
                };
                let variances: Vec<f64> = is_told.iter().enumerate().map(variance).collect();
                let whitening = Whitening::of(&variances, &follows, memory);
                ChannelSystem::of(&own, &background, errors, &residual, whitening)
            };
            for _ in 0..if observations.is_alive(channel) { NOISE_ROUNDS } else { 0 } {
                (level, memory) = estimated_noise(&system(&level, memory)?, &level, modelled, &wide)?;
            }
            channels.push(system(&level, memory)?);
            noise.push(level);
        }
        Some(Self {
            channels,
            noise,
            mean_squares: mean_squares(all, &basis),
            extents,
            basis,
            columns: columns.len(),
        })
    }

    /// The background's functions of a channel at other rows, where `whole` is its root mean square over the measurement.
    pub(super) fn background_at(&self, channel: usize, whole: f64, rows: &Observations) -> Vec<Vec<f64>> {
        let values: Vec<Vec<f64>> =
            rows.samples.iter().map(|sample| self.basis.at(sample.place_mm)).collect();
        let loads: Vec<[f64; 3]> = rows.samples.iter().map(|sample| sample.load).collect();
        products(&loads, &values, self.extents[channel].sqrt() * whole)
    }

    /// G z of a channel.
    fn extent(&self, channel: usize, z: &[f64]) -> Vec<f64> {
        self.mean_squares.times(z).into_iter().map(|value| value * self.extents[channel]).collect()
    }

    /// The coordinates of the background's functions, load by load.
    fn by_load<'z>(&self, z: &'z [f64]) -> std::slice::Chunks<'z, f64> {
        z.chunks(self.basis.len().max(1))
    }

    /// With this background; `None` where a system is not positive definite.
    pub(super) fn marginal(&self, background: &Background) -> Option<Marginal> {
        let mut fisher = Matrix::zeros(self.columns, self.columns);
        let mut score = vec![0.0; self.columns];
        let (mut square, mut log_determinant) = (0.0, 0.0);
        let mut channels = Vec::new();
        for (at, system) in self.channels.iter().enumerate() {
            let reduced = system.reduced(&background.prior, &background.shares[at])?;
            for (row, number) in system.columns.iter().enumerate() {
                score[*number] += reduced.score[row];
                let line = fisher.row_mut(*number);
                for (column, other) in system.columns.iter().enumerate() {
                    line[*other] += reduced.fisher.at(row, column);
                }
            }
            square += reduced.square;
            log_determinant += reduced.log_determinant;
            channels.push(reduced);
        }
        Some(Marginal { fisher, score, square, log_determinant, channels })
    }

    /// Coordinates of all columns, fitted at once with wide priors: beside them nothing is left that any cause explains.
    pub(super) fn explained(&self, marginal: &Marginal, linearised: &Linearised) -> Option<Vec<f64>> {
        let mut precisions = vec![0.0; self.columns];
        for (system, modelled) in self.channels.iter().zip(&linearised.readings) {
            for (number, precision) in system.columns.iter().zip(wide_precisions(system, modelled)) {
                precisions[*number] = f64::max(precisions[*number], precision);
            }
        }
        let known = (0..self.columns).filter(|column| precisions[*column] > 0.0).collect();
        Some(Fitted { columns: known, precisions: &precisions }.solved(marginal)?.coordinates)
    }

    /// The background with the greatest likelihood when the columns `fitted` are free, `start` being a guess.
    pub(super) fn background(&self, fitted: &Fitted<'_>, start: Option<&Background>) -> Option<Background> {
        if let Some(start) = start {
            return Some(self.sized(fitted, start, STEPS_AGAIN)?.1);
        }
        let [least, most] = self.basis.lengths_mm().map(f64::ln);
        let mut best = Background {
            prior: self.basis.prior(least.exp())?,
            shares: vec![[BACKGROUND_FIRST; 3]; self.channels.len()],
            freedom: vec![0.0; self.channels.len()],
        };
        // Golden section over ln l.
        let at = |log_length: f64, best: &mut Background| -> Option<f64> {
            best.prior = self.basis.prior(log_length.exp())?;
            let (likelihood, sized) = self.sized(fitted, best, STEPS)?;
            *best = sized;
            Some(likelihood)
        };
        let (mut low, mut high) = (least, most);
        let mut inner = [high - GOLDEN * (high - low), low + GOLDEN * (high - low)];
        let mut likelihood = [at(inner[0], &mut best)?, at(inner[1], &mut best)?];
        for _ in 0..SECTIONS {
            if likelihood[0] > likelihood[1] {
                high = inner[1];
                inner = [high - GOLDEN * (high - low), inner[0]];
                likelihood = [at(inner[0], &mut best)?, likelihood[0]];
            } else {
                low = inner[0];
                inner = [inner[1], low + GOLDEN * (high - low)];
                likelihood = [likelihood[1], at(inner[1], &mut best)?];
            }
        }
        at(f64::midpoint(low, high), &mut best)?;
        Some(best)
    }

    /// The sizes with the greatest likelihood for a length, and that likelihood.
    fn sized(&self, fitted: &Fitted<'_>, start: &Background, steps: usize) -> Option<(f64, Background)> {
        let mut background = start.clone();
        let mut likelihood = f64::NEG_INFINITY;
        for _ in 0..steps {
            let marginal = self.marginal(&background)?;
            let solution = fitted.solved(&marginal)?;
            likelihood = -0.5 * (marginal.square - solution.removed + marginal.log_determinant);
            background = self.updated(&background, &marginal, &solution.coordinates);
        }
        Some((likelihood, background))
    }

    /// Each channel's smooth remainder, with these coordinates of the columns.
    pub(super) fn remainders(
        &self,
        background: &Background,
        fit: &Marginal,
        coordinates: &[f64],
    ) -> Vec<Remainder> {
        let remainder = |(at, (system, reduced)): (usize, (&ChannelSystem, &Reduced))| {
            let z = smooth(system, reduced, coordinates);
            let shares = background.shares[at];
            let slope = self.extent(at, &z);
            Remainder {
                mean_square: dot(&z, &slope),
                // Var zᵀ G z = 4 zᵀ G Var(z) G z.
                deviation: 2.0 * dot(&slope, &reduced.factor.solve(&slope)).max(0.0).sqrt(),
                energy: self
                    .by_load(&z)
                    .zip(shares)
                    .map(|(z, share)| background.prior.energy(z) / (share * share))
                    .sum(),
                freedom: reduced.freedom(&background.prior, &shares).iter().sum(),
            }
        };
        self.channels.iter().zip(&fit.channels).enumerate().map(remainder).collect()
    }

    /// One step of MacKay's fixed point for each size τ: τ² = Σ zᵀ T⁻¹ z/Σ γ, with T the process' covariance at τ = 1 and
    /// γ = K − tr(T⁻¹ Var z)/τ² what the rows tell of its K functions; the pooled size counts as further observations. Of a
    /// remainder that is larger than a background may be, the background has as much as it may.
    fn updated(&self, background: &Background, marginal: &Marginal, coordinates: &[f64]) -> Background {
        let prior = &background.prior;
        let sums = |(channel, (system, reduced)): (usize, (&ChannelSystem, &Reduced))| -> [[f64; 2]; 3] {
            let z = smooth(system, reduced, coordinates);
            let mean_square = dot(&z, &self.extent(channel, &z));
            let allowed = (REMAINDER_MAX * REMAINDER_MAX / mean_square).min(1.0);
            let energies: Vec<f64> = self.by_load(&z).map(|z| allowed * prior.energy(z)).collect();
            let freedom = reduced.freedom(prior, &background.shares[channel]);
            std::array::from_fn(|load| [energies[load], freedom[load]])
        };
        let sums: Vec<[[f64; 2]; 3]> =
            self.channels.iter().zip(&marginal.channels).enumerate().map(sums).collect();
        let all = sums.iter().flatten().fold([0.0; 2], |all, it| [all[0] + it[0], all[1] + it[1]]);
        let pooled = all[0] / all[1].max(1e-3);
        let size = |[energy, freedom]: [f64; 2]| {
            let share = ((POOLED_FREEDOM * pooled + energy) / (POOLED_FREEDOM + freedom)).sqrt();
            share.max(BACKGROUND_MIN)
        };
        Background {
            prior: prior.clone(),
            shares: sums.iter().map(|loads| loads.map(size)).collect(),
            freedom: sums.iter().map(|loads| loads.iter().map(|it| it[1]).sum()).collect(),
        }
    }
}

/// Columns that are free, and their prior precisions (0: none).
pub(super) struct Fitted<'p> {
    pub(super) columns: Vec<usize>,
    pub(super) precisions: &'p [f64],
}

/// The least-squares solution for some columns.
pub(super) struct Solved {
    /// For all columns, zero where they are not free.
    pub(super) coordinates: Vec<f64>,
    /// What the solution takes off the square.
    pub(super) removed: f64,
}

impl Marginal {
    /// ln det V.
    pub(super) const fn log_determinant(&self) -> f64 {
        self.log_determinant
    }
}

impl Fitted<'_> {
    /// The factor of what the rows and the priors tell of the columns.
    pub(super) fn factorised(&self, marginal: &Marginal) -> Option<LargeFactor> {
        let mut inner = marginal.fisher.picked(&self.columns, &self.columns);
        for (at, column) in self.columns.iter().enumerate() {
            inner.row_mut(at)[at] += self.precisions[*column];
        }
        inner.factorised()
    }

    /// The generalised least-squares solution.
    pub(super) fn solved(&self, marginal: &Marginal) -> Option<Solved> {
        let score: Vec<f64> = self.columns.iter().map(|column| marginal.score[*column]).collect();
        let found = self.factorised(marginal)?.solve(&score);
        let removed = found.iter().zip(&score).map(|(psi, score)| psi * score).sum();
        let mut coordinates = vec![0.0; marginal.score.len()];
        self.columns.iter().zip(found).for_each(|(column, psi)| coordinates[*column] = psi);
        Some(Solved { coordinates, removed })
    }
}

/// ẑ = H⁻¹ Bᵀ D⁻¹ (r − A ψ̂).
fn smooth(system: &ChannelSystem, reduced: &Reduced, coordinates: &[f64]) -> Vec<f64> {
    let own: Vec<f64> = system.columns.iter().map(|number| coordinates[*number]).collect();
    reduced.factor.solve(&system.background_score(&own))
}

/// Σ (load φ)(load φ)ᵀ/n.
fn mean_squares(all: &Observations, basis: &Basis) -> Matrix {
    let values: Vec<Vec<f64>> = all.samples.iter().map(|sample| basis.at(sample.place_mm)).collect();
    let loads: Vec<[f64; 3]> = all.samples.iter().map(|sample| sample.load).collect();
    let columns = products(&loads, &values, 1.0 / (all.rows() as f64).sqrt());
    gram(&columns.iter().map(Vec::as_slice).collect::<Vec<_>>())
}

/// Each load times each function of the background, row by row: in the channel's unit at a share of 1 where `size` is the channel's
/// root mean square over the loads'.
fn products(loads: &[[f64; 3]], values: &[Vec<f64>], size: f64) -> Vec<Vec<f64>> {
    let functions = values.first().map_or(0, Vec::len);
    let column = |load: usize, function: usize| {
        loads.iter().zip(values).map(|(loads, values)| size * loads[load] * values[function]).collect()
    };
    (0..3)
        .flat_map(|load| (0..functions).map(move |function| (load, function)))
        .map(|(l, f)| column(l, f))
        .collect()
}

/// Precisions of wide priors of a channel's columns: no column is more than a share of the channel's root mean square.
fn wide_precisions(system: &ChannelSystem, modelled: &[f64]) -> Vec<f64> {
    let size = rms(modelled.iter().copied());
    let precision = |column: &Vec<f64>| {
        let told = column.iter().zip(&system.whitening.weights).filter(|(_, weight)| **weight > 0.0);
        let own = rms(told.map(|(value, weight)| value / weight));
        (own / (SIGNATURE_PRIOR * size)).powi(2)
    };
    system.signatures.iter().map(precision).collect()
}

/// The noise and its memory, when all causes and a large background are fitted with wide priors: what nothing smooth explains.
fn estimated_noise(
    system: &ChannelSystem,
    level: &NoiseLevel,
    modelled: &[f64],
    wide: &Prior,
) -> Option<(NoiseLevel, f64)> {
    let shares = [2.0 * BACKGROUND_MAX; 3];
    let reduced = system.reduced(wide, &shares)?;
    let mut inner = reduced.fisher.clone();
    let weights = &system.whitening.weights;
    let rows = system.whitening.told() as f64;
    let priors = wide_precisions(system, modelled);
    priors.iter().enumerate().for_each(|(at, precision)| inner.row_mut(at)[at] += precision);
    let factor = inner.factorised()?;
    let coordinates = factor.solve(&reduced.score);
    let z = reduced.factor.solve(&system.background_score(&coordinates));
    let left = system.left_over(&coordinates, &z);
    let told = left.iter().zip(weights).zip(modelled).filter(|((_, weight), _)| **weight > 0.0);
    let (residual, modelled): (Vec<f64>, Vec<f64>) =
        told.map(|((r, _), modelled)| (r * level.variance(*modelled).sqrt(), *modelled)).unzip();
    // Σ (1 − P Var): what the rows, not the priors, tell.
    let told = |inverse: Vec<f64>, precisions: &mut dyn Iterator<Item = f64>| -> f64 {
        inverse
            .iter()
            .zip(precisions)
            .map(|(variance, precision)| (1.0 - variance * precision).max(0.0))
            .sum()
    };
    let effective = told(factor.inverse_diagonal(), &mut priors.iter().copied())
        + reduced.freedom(wide, &shares).iter().sum::<f64>()
        + system.stated.freedom();
    let freedom_ratio = (1.0 - effective / rows).max(FREEDOM_RATIO_MIN);
    Some((NoiseLevel::of(&residual, &modelled, freedom_ratio), system.whitening.memory_of(&left)))
}
