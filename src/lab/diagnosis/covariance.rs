//! The covariance of what no cause explains: noise, a smooth background, and errors that the model is known to have.

use super::basis::Basis;
use super::model::Linearised;
use super::noise::NoiseLevel;
use super::observations::Observations;
use super::system::{ChannelSystem, Reduced};
use crate::numeric::dense::Matrix;
use crate::numeric::linear::LargeFactor;
use crate::numeric::statistics::rms;

/// Largest background, as a share of a channel's root mean square.
pub(super) const BACKGROUND_MAX: f64 = 0.03;
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
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Background {
    /// Its correlation length.
    pub(super) length_mm: f64,
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
    /// Number of all columns.
    pub(super) columns: usize,
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
    /// `columns` are the signatures about the present point, `linearised` that point.
    pub(super) fn of(
        observations: &Observations,
        linearised: &Linearised,
        columns: &[Column<'_>],
    ) -> Option<Self> {
        let basis = Basis::of(observations);
        let load_rms = observations.load_rms();
        let mut noise = Vec::new();
        let mut channels = Vec::new();
        for (channel, readings) in observations.readings.iter().enumerate() {
            let modelled = &linearised.readings[channel];
            let residual: Vec<f64> = readings.iter().zip(modelled).map(|(y, f)| y - f).collect();
            let size = rms(modelled.iter().copied()) / load_rms;
            let background = background_columns(observations, &basis, size);
            let own: Vec<(usize, &[f64])> = columns
                .iter()
                .enumerate()
                .filter_map(|(number, column)| Some((number, column[channel].as_deref()?)))
                .collect();
            let mut level = NoiseLevel::first(modelled);
            let system = |level: &NoiseLevel| {
                let is_told = &observations.is_told[channel];
                let variance =
                    |(f, is_told): (&f64, &bool)| if *is_told { level.variance(*f) } else { f64::INFINITY };
                let variances: Vec<f64> = modelled.iter().zip(is_told).map(variance).collect();
                ChannelSystem::of(&own, &background, &residual, &variances)
            };
            for _ in 0..if observations.is_alive(channel) { NOISE_ROUNDS } else { 0 } {
                level = estimated_noise(&system(&level), modelled, &basis)?;
            }
            channels.push(system(&level));
            noise.push(level);
        }
        Some(Self { channels, noise, basis, columns: columns.len() })
    }

    /// Variances of a channel's background functions, load by load.
    pub(super) fn variances(&self, background: &Background, channel: usize) -> Vec<f64> {
        let of_functions = self.basis.variances(background.length_mm);
        let shares = background.shares[channel];
        shares
            .iter()
            .flat_map(|share| of_functions.iter().map(move |variance| share * share * variance))
            .collect()
    }

    /// With this background; `None` where a system is not positive definite.
    pub(super) fn marginal(&self, background: &Background) -> Option<Marginal> {
        let mut fisher = Matrix::zeros(self.columns, self.columns);
        let mut score = vec![0.0; self.columns];
        let (mut square, mut log_determinant) = (0.0, 0.0);
        let mut channels = Vec::new();
        for (at, system) in self.channels.iter().enumerate() {
            let reduced = system.reduced(&self.variances(background, at))?;
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

    /// The background with the greatest likelihood when the columns `fitted` are free, `start` being a guess.
    pub(super) fn background(&self, fitted: &Fitted<'_>, start: Option<&Background>) -> Option<Background> {
        if let Some(start) = start {
            return Some(self.sized(fitted, start, STEPS_AGAIN)?.1);
        }
        let [least, most] = self.basis.lengths_mm().map(f64::ln);
        let first = Background {
            length_mm: 0.0,
            shares: vec![[BACKGROUND_FIRST; 3]; self.channels.len()],
            freedom: vec![0.0; self.channels.len()],
        };
        // Golden section over ln l.
        let mut best = first;
        let at = |log_length: f64, best: &mut Background| -> Option<f64> {
            best.length_mm = log_length.exp();
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

    /// For each channel, ẑᵀ T⁻¹ ẑ of the background and the degrees of freedom that its rows tell: about equal, unless the background
    /// is larger than it may be.
    pub(super) fn background_energy(
        &self,
        background: &Background,
        fit: &Marginal,
        coordinates: &[f64],
    ) -> Vec<[f64; 2]> {
        let channels = self.channels.iter().zip(&fit.channels).enumerate();
        channels
            .map(|(at, (system, reduced))| {
                let own: Vec<f64> = system.columns.iter().map(|number| coordinates[*number]).collect();
                let z = reduced.factor.solve(&system.background_score(&own));
                let prior = self.variances(background, at);
                let told = reduced.factor.inverse_diagonal();
                let square = z.iter().zip(&prior).map(|(z, prior)| z * z / prior).sum();
                [
                    square,
                    told.iter().zip(&prior).map(|(variance, prior)| (1.0 - variance / prior).max(0.0)).sum(),
                ]
            })
            .collect()
    }

    /// One step of MacKay's fixed point for each size τ: τ² = Σ z²/s / Σ γ, with s the function's variance at τ = 1 and
    /// γ = 1 − Var z/(τ² s) what the rows tell of it; the pooled size counts as further observations.
    fn updated(&self, background: &Background, marginal: &Marginal, coordinates: &[f64]) -> Background {
        let unit = self.basis.variances(background.length_mm);
        let mut sums = vec![[[0.0; 2]; 3]; self.channels.len()];
        for (channel, (system, reduced)) in self.channels.iter().zip(&marginal.channels).enumerate() {
            let own: Vec<f64> = system.columns.iter().map(|number| coordinates[*number]).collect();
            let z = reduced.factor.solve(&system.background_score(&own));
            let variances = reduced.factor.inverse_diagonal();
            for (at, (z, variance)) in z.iter().zip(variances).enumerate() {
                let (load, function) = (at / unit.len(), at % unit.len());
                let prior = background.shares[channel][load].powi(2) * unit[function];
                sums[channel][load][0] += z * z / unit[function];
                sums[channel][load][1] += (1.0 - variance / prior).max(0.0);
            }
        }
        let all = sums.iter().flatten().fold([0.0; 2], |all, it| [all[0] + it[0], all[1] + it[1]]);
        let pooled = all[0] / all[1].max(1e-3);
        let size = |[square, freedom]: [f64; 2]| {
            let share = ((POOLED_FREEDOM * pooled + square) / (POOLED_FREEDOM + freedom)).sqrt();
            share.clamp(BACKGROUND_MIN, BACKGROUND_MAX)
        };
        Background {
            length_mm: background.length_mm,
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

/// The background's functions times each load, in the channel's unit at a share of 1.
fn background_columns(observations: &Observations, basis: &Basis, size: f64) -> Vec<Vec<f64>> {
    let column = |load: usize, function: usize| {
        let rows = observations.samples.iter().zip(&basis.values);
        rows.map(|(sample, values)| size * sample.load[load] * values[function]).collect()
    };
    (0..3)
        .flat_map(|load| (0..basis.len()).map(move |function| (load, function)))
        .map(|(l, f)| column(l, f))
        .collect()
}

/// The noise when all causes and a large background are fitted with wide priors: what nothing smooth explains.
fn estimated_noise(system: &ChannelSystem, modelled: &[f64], basis: &Basis) -> Option<NoiseLevel> {
    let unit = basis.variances(basis.lengths_mm()[0]);
    let variances: Vec<f64> =
        (0..3).flat_map(|_| unit.iter().map(|s| 4.0 * BACKGROUND_MAX * BACKGROUND_MAX * s)).collect();
    let reduced = system.reduced(&variances)?;
    let size = rms(modelled.iter().copied());
    let mut inner = reduced.fisher.clone();
    let rows = system.told() as f64;
    let mut priors = Vec::new();
    for (at, column) in system.signatures.iter().enumerate() {
        let told = column.iter().zip(&system.weights).filter(|(_, weight)| **weight > 0.0);
        let own = rms(told.map(|(value, weight)| value / weight));
        let precision = (own / (SIGNATURE_PRIOR * size)).powi(2);
        priors.push(precision);
        inner.row_mut(at)[at] += precision;
    }
    let factor = inner.factorised()?;
    let coordinates = factor.solve(&reduced.score);
    let z = reduced.factor.solve(&system.background_score(&coordinates));
    let left = system.left_over(&coordinates, &z);
    let told = left.iter().zip(&system.weights).zip(modelled).filter(|((_, weight), _)| **weight > 0.0);
    let (residual, modelled): (Vec<f64>, Vec<f64>) =
        told.map(|((r, weight), modelled)| (r / weight, *modelled)).unzip();
    // Σ (1 − P Var): what the rows, not the priors, tell.
    let told = |inverse: Vec<f64>, precisions: &mut dyn Iterator<Item = f64>| -> f64 {
        inverse
            .iter()
            .zip(precisions)
            .map(|(variance, precision)| (1.0 - variance * precision).max(0.0))
            .sum()
    };
    let effective = told(factor.inverse_diagonal(), &mut priors.iter().copied())
        + told(reduced.factor.inverse_diagonal(), &mut variances.iter().map(|variance| 1.0 / variance));
    let freedom_ratio = (1.0 - effective / rows).max(FREEDOM_RATIO_MIN);
    Some(NoiseLevel::of(&residual, &modelled, freedom_ratio))
}
