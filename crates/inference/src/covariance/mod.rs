//! The covariance of what no cause explains: noise, a smooth background, and errors that the model is known to have.

pub mod basis;
mod channel_rows;
pub mod equations;
pub mod system;
pub mod whitening;

use std::sync::Arc;

use rayon::prelude::*;

use self::basis::{Basis, LENGTHS_TRIED, Prior};
use self::channel_rows::{ChannelRows, wide_precisions};
use self::equations::{NormalEquations, Reduced};
use self::system::ChannelSystem;
use crate::error::{InferenceError, Stage, factorised};
use crate::model::{Column, Linearised, Model, Signature};
use crate::noise::Noise;
use crate::observations::Observations;
use crate::policy::REMAINDER_MAX;
use tactpad_numeric::dense::{Matrix, gram};
use tactpad_numeric::linear::LargeFactor;
use tactpad_numeric::products::dot;
use tactpad_numeric::statistics::rms;

/// Where the search for the background's sizes begins, and where it ends.
const BACKGROUND_FIRST: f64 = 0.01;
const BACKGROUND_MIN: f64 = 1e-4;
/// Degrees of freedom that the mean over all channels and loads counts for in each.
const POOLED_FREEDOM: f64 = 6.0;
/// Steps of the search for the background's sizes: at each length, and from sizes that are nearly right.
const STEPS: usize = 5;
const STEPS_AGAIN: usize = 6;
/// A step that raises the likelihood's logarithm by less ends it.
const LIKELIER: f64 = 0.05;
/// Lengths from which the search goes on, by their number.
const LENGTHS_FIRST: [usize; 3] = [2, 5, 8];

/// Sizes of the smooth background.
#[derive(Clone, Debug)]
pub struct Background {
    /// The process, and the number of its length.
    pub prior: Prior,
    length: usize,
    /// For each channel and load: standard deviation as a share of the channel's root mean square.
    pub shares: Vec<[f64; 3]>,
    /// For each channel: the degrees of freedom that its size is known by.
    pub freedom: Vec<f64>,
}

/// The rows of a measurement as systems of its channels.
pub struct Systems {
    /// Each channel's system.
    pub channels: Vec<ChannelSystem>,
    /// Each channel's noise, as its residual tells it.
    pub noise: Vec<Noise>,
    smooth: Arc<Smooth>,
    /// For each channel, what makes that G: zᵀ G z is the mean square of B z over the channel's.
    extents: Vec<f64>,
    /// Number of all columns.
    pub columns: usize,
}

/// The background's functions at the rows.
pub struct Smooth {
    basis: Basis,
    /// Σ (load φ)(load φ)ᵀ/n over the rows of the whole measurement.
    mean_squares: Matrix,
    /// The largest remainder that counts as background.
    most: f64,
}

impl Smooth {
    /// `observations` are rows of `all`.
    pub fn of(all: &Observations, observations: &Observations) -> Self {
        let basis = Basis::of(observations);
        Self { mean_squares: mean_squares(all, &basis), basis, most: REMAINDER_MAX }
    }

    /// Without a background.
    #[cfg(test)]
    pub fn without(self) -> Self {
        Self { most: 0.0, ..self }
    }
}

/// Smooth remainder of a channel's residual in the background's functions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Remainder {
    /// Over the rows, as a share of the channel's mean square.
    pub mean_square: f64,
    /// Standard deviation of that.
    pub deviation: f64,
    /// ẑᵀ T⁻¹ ẑ.
    pub energy: f64,
    /// The degrees of freedom that the rows tell: about the energy, unless the background is larger than it may be.
    pub freedom: f64,
}

/// All channels' systems with one background.
pub struct Marginal {
    /// Aᵀ V⁻¹ A over all columns.
    pub fisher: Matrix,
    /// Aᵀ V⁻¹ r.
    pub score: Vec<f64>,
    /// rᵀ V⁻¹ r.
    pub square: f64,
    log_determinant: f64,
    /// Each channel's part.
    pub channels: Vec<Reduced>,
}

impl Systems {
    /// `columns` are the signatures about the present point, `linearised` that point. The `model` says what it knows of its channels.
    /// With `before`, the systems about another point, the noise is not sought from the beginning.
    pub fn of<L>(
        observations: &Observations,
        smooth: &Arc<Smooth>,
        model: &dyn Model<L>,
        linearised: &Linearised,
        columns: &[Column<'_>],
        before: Option<&Self>,
    ) -> Result<Self, InferenceError> {
        let basis = &smooth.basis;
        let load_rms = observations.load_rms();
        let (in_series, follows) = (observations.in_series(), observations.follows());
        let wide = basis.prior(0)?;
        let sizes = model.sizes();
        let errors: Vec<&[Vec<f64>]> = (0..sizes.len()).map(|channel| model.stated_errors(channel)).collect();
        let of_channel = |channel: usize| {
            let modelled = &linearised.readings[channel];
            let size = rms(modelled.iter().copied()) / load_rms;
            let rows = ChannelRows {
                observations,
                channel,
                modelled,
                doubts: &linearised.doubts[channel],
                errors: errors[channel],
                background: products(&linearised.loads, &basis.values, size),
                columns,
                in_series: &in_series,
                follows: &follows,
            };
            let before = before.map(|it| (it.noise[channel], it.channels[channel].whitening.memory()));
            let (system, level) = rows.system(wide, before).map_err(|error| error.in_channel(channel))?;
            Ok((system, level, (size / sizes[channel]).powi(2)))
        };
        // Of several errors that of the first channel, whichever is found first.
        let channels: Vec<_> = (0..sizes.len()).into_par_iter().map(of_channel).collect();
        let mut systems = Self {
            channels: Vec::new(),
            noise: Vec::new(),
            smooth: Arc::clone(smooth),
            extents: Vec::new(),
            columns: columns.len(),
        };
        for channel in channels {
            let (system, level, extent) = channel?;
            systems.channels.push(system);
            systems.noise.push(level);
            systems.extents.push(extent);
        }
        Ok(systems)
    }

    /// The background's functions of a channel at other rows, where `whole` is its root mean square over the measurement.
    pub fn background_at(&self, channel: usize, whole: f64, rows: &Observations) -> Vec<Vec<f64>> {
        let values: Vec<Vec<f64>> =
            rows.samples.iter().map(|sample| self.smooth.basis.at(sample.place_mm)).collect();
        let loads: Vec<[f64; 3]> = rows.samples.iter().map(|sample| sample.load).collect();
        products(&loads, &values, self.extents[channel].sqrt() * whole)
    }

    /// ẑ of a channel, with these coordinates of the columns.
    pub fn background_of(&self, channel: usize, fit: &Marginal, coordinates: &[f64]) -> Vec<f64> {
        smooth(&self.channels[channel].equations, &fit.channels[channel], coordinates)
    }

    /// G z of a channel.
    fn extent(&self, channel: usize, z: &[f64]) -> Vec<f64> {
        self.smooth.mean_squares.times(z).into_iter().map(|value| value * self.extents[channel]).collect()
    }

    /// The coordinates of the background's functions, load by load.
    fn by_load<'z>(&self, z: &'z [f64]) -> std::slice::Chunks<'z, f64> {
        z.chunks(self.smooth.basis.len().max(1))
    }

    /// With this background.
    ///
    /// # Errors
    /// A system is not positive definite.
    pub fn marginal(&self, background: &Background) -> Result<Marginal, InferenceError> {
        let all: Vec<&NormalEquations> = self.channels.iter().map(|it| &it.equations).collect();
        self.marginal_of(&all, self.columns, background)
    }

    /// The same with some of the columns only; the others count as nothing.
    pub fn marginal_with(
        &self,
        columns: &[usize],
        background: &Background,
    ) -> Result<Marginal, InferenceError> {
        let picked = self.picked(columns);
        self.marginal_of(&picked.iter().collect::<Vec<_>>(), self.columns, background)
    }

    /// The same with some of the columns and `further` ones, which are numbered after all others.
    pub fn marginal_beside(
        &self,
        columns: &[usize],
        further: &[Signature],
        background: &Background,
    ) -> Result<Marginal, InferenceError> {
        let of_channel = |(channel, system): (usize, &ChannelSystem)| {
            let own = further.iter().enumerate().filter_map(|(at, it)| {
                let values = it[channel].as_deref()?;
                Some((self.columns + at, values))
            });
            system.beside(columns, &own.collect::<Vec<_>>())
        };
        let all: Vec<NormalEquations> = self.channels.par_iter().enumerate().map(of_channel).collect();
        self.marginal_of(&all.iter().collect::<Vec<_>>(), self.columns + further.len(), background)
    }

    /// The same of some of the rows.
    pub fn marginal_at(
        &self,
        rows: &[usize],
        columns: &[usize],
        background: &Background,
    ) -> Result<Marginal, InferenceError> {
        let of_channel = |(channel, system): (usize, &ChannelSystem)| {
            system.at(rows, columns).map_err(|error| error.in_channel(channel))
        };
        let all: Vec<_> = self.channels.par_iter().enumerate().map(of_channel).collect();
        let all = all.into_iter().collect::<Result<Vec<NormalEquations>, InferenceError>>()?;
        self.marginal_of(&all.iter().collect::<Vec<_>>(), self.columns, background)
    }

    fn picked(&self, columns: &[usize]) -> Vec<NormalEquations> {
        self.channels.iter().map(|it| it.equations.picked(columns)).collect()
    }

    /// `count` is the number of all columns.
    fn marginal_of(
        &self,
        equations: &[&NormalEquations],
        count: usize,
        background: &Background,
    ) -> Result<Marginal, InferenceError> {
        let of_channel = |(channel, (it, shares)): (usize, (&&NormalEquations, &[f64; 3]))| {
            it.reduced(&background.prior, shares).map_err(|error| error.in_channel(channel))
        };
        let channels: Vec<_> =
            equations.par_iter().zip(&background.shares).enumerate().map(of_channel).collect();
        let channels = channels.into_iter().collect::<Result<Vec<Reduced>, InferenceError>>()?;
        Ok(Marginal::of(equations.iter().map(|it| it.columns.as_slice()).zip(channels), count))
    }

    /// The same covariance about another point: each channel's `residual`, and `columns` with their numbers.
    pub fn about(
        &self,
        marginal: &Marginal,
        columns: &[(usize, Column<'_>)],
        residual: &[Vec<f64>],
    ) -> Marginal {
        let of_channel = |(channel, (system, held)): (usize, (&ChannelSystem, &Reduced))| {
            let own = columns.iter().filter_map(|(number, it)| Some((*number, it[channel].as_deref()?)));
            let equations = system.about(&own.collect::<Vec<_>>(), &residual[channel]);
            let reduced = equations.reduced_by(held.factor.clone(), held.log_determinant);
            (equations.columns, reduced)
        };
        let channels: Vec<(Vec<usize>, Reduced)> =
            self.channels.par_iter().zip(&marginal.channels).enumerate().map(of_channel).collect();
        Marginal::of(channels, self.columns)
    }

    /// Coordinates of all columns, fitted at once with wide priors: beside them nothing is left that any cause explains.
    pub fn explained(
        &self,
        marginal: &Marginal,
        linearised: &Linearised,
    ) -> Result<Vec<f64>, InferenceError> {
        let mut precisions = vec![0.0; self.columns];
        for (system, modelled) in self.channels.iter().zip(&linearised.readings) {
            for (number, precision) in system.equations.columns.iter().zip(wide_precisions(system, modelled))
            {
                precisions[*number] = f64::max(precisions[*number], precision);
            }
        }
        let known = (0..self.columns).filter(|column| precisions[*column] > 0.0).collect();
        Ok(Fitted { columns: known, precisions: &precisions }.solved(marginal)?.coordinates)
    }

    /// The background with the greatest likelihood when the columns `fitted` are free. From a `start` its length is sought nearby.
    pub fn background(
        &self,
        fitted: &Fitted<'_>,
        start: Option<&Background>,
    ) -> Result<Background, InferenceError> {
        let first = match start {
            Some(start) => self.sized(fitted, start, STEPS)?,
            None => self.first(fitted)?,
        };
        let (mut likelihood, mut best) = first;
        for step in [1, usize::MAX] {
            // One length after the other while that helps: up, or down.
            let mut is_better = true;
            while is_better {
                let length = best.length.wrapping_add(step);
                if length >= LENGTHS_TRIED {
                    break;
                }
                let Ok(next) = self.with_length(length, &best) else { break };
                let (found, sized) = self.sized(fitted, &next, STEPS)?;
                is_better = found > likelihood;
                if is_better {
                    (likelihood, best) = (found, sized);
                }
            }
        }
        Ok(best)
    }

    /// The same with the length of the `start`.
    pub fn resized(&self, fitted: &Fitted<'_>, start: &Background) -> Result<Background, InferenceError> {
        Ok(self.sized(fitted, start, STEPS_AGAIN)?.1)
    }

    /// The best of a few lengths, and its likelihood.
    fn first(&self, fitted: &Fitted<'_>) -> Result<(f64, Background), InferenceError> {
        let mut start = Background {
            prior: self.smooth.basis.prior(0)?.clone(),
            length: 0,
            shares: vec![[BACKGROUND_FIRST; 3]; self.channels.len()],
            freedom: vec![0.0; self.channels.len()],
        };
        let [first, rest @ ..] = LENGTHS_FIRST;
        let mut best = self.sized(fitted, &self.with_length(first, &start)?, STEPS)?;
        start.shares.clone_from(&best.1.shares);
        for length in rest {
            let found = self.sized(fitted, &self.with_length(length, &start)?, STEPS)?;
            start.shares.clone_from(&found.1.shares);
            if found.0 > best.0 {
                best = found;
            }
        }
        Ok(best)
    }

    /// With another of the lengths that are tried.
    fn with_length(&self, length: usize, like: &Background) -> Result<Background, InferenceError> {
        Ok(Background { prior: self.smooth.basis.prior(length)?.clone(), length, ..like.clone() })
    }

    /// The sizes with the greatest likelihood for a length, and that likelihood.
    fn sized(
        &self,
        fitted: &Fitted<'_>,
        start: &Background,
        steps: usize,
    ) -> Result<(f64, Background), InferenceError> {
        let mut background = start.clone();
        let mut likelihood = f64::NEG_INFINITY;
        let equations = self.picked(&fitted.columns);
        let equations: Vec<&NormalEquations> = equations.iter().collect();
        for _ in 0..steps {
            let marginal = self.marginal_of(&equations, self.columns, &background)?;
            let solution = fitted.solved(&marginal)?;
            let before = std::mem::replace(
                &mut likelihood,
                -0.5 * (marginal.square - solution.removed + marginal.log_determinant),
            );
            if likelihood - before < LIKELIER {
                break;
            }
            background = self.updated(&background, &equations, &marginal, &solution.coordinates);
        }
        Ok((likelihood, background))
    }

    /// Each channel's smooth remainder, with these coordinates of the columns.
    pub fn remainders(&self, background: &Background, fit: &Marginal, coordinates: &[f64]) -> Vec<Remainder> {
        let remainder = |(at, (system, reduced)): (usize, (&ChannelSystem, &Reduced))| {
            let z = smooth(&system.equations, reduced, coordinates);
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
    fn updated(
        &self,
        background: &Background,
        equations: &[&NormalEquations],
        marginal: &Marginal,
        coordinates: &[f64],
    ) -> Background {
        let prior = &background.prior;
        let sums = |(channel, (own, reduced)): (usize, (&&NormalEquations, &Reduced))| -> [[f64; 2]; 3] {
            let z = smooth(own, reduced, coordinates);
            let mean_square = dot(&z, &self.extent(channel, &z));
            let allowed = (self.smooth.most * self.smooth.most / mean_square).min(1.0);
            let energies: Vec<f64> = self.by_load(&z).map(|z| allowed * prior.energy(z)).collect();
            let freedom = reduced.freedom(prior, &background.shares[channel]);
            std::array::from_fn(|load| [energies[load], freedom[load]])
        };
        let sums: Vec<[[f64; 2]; 3]> =
            equations.par_iter().zip(&marginal.channels).enumerate().map(sums).collect();
        let all = sums.iter().flatten().fold([0.0; 2], |all, it| [all[0] + it[0], all[1] + it[1]]);
        let pooled = all[0] / all[1].max(1e-3);
        let size = |[energy, freedom]: [f64; 2]| {
            let share = ((POOLED_FREEDOM * pooled + energy) / (POOLED_FREEDOM + freedom)).sqrt();
            share.max(BACKGROUND_MIN)
        };
        Background {
            prior: prior.clone(),
            length: background.length,
            shares: sums.iter().map(|loads| loads.map(size)).collect(),
            freedom: sums.iter().map(|loads| loads.iter().map(|it| it[1]).sum()).collect(),
        }
    }
}

/// Columns that are free, and their prior precisions (0: none).
pub struct Fitted<'p> {
    /// Numbers of the free columns.
    pub columns: Vec<usize>,
    /// Precision of each column's prior.
    pub precisions: &'p [f64],
}

/// The least-squares solution for some columns.
pub struct Solved {
    /// For all columns, zero where they are not free.
    pub coordinates: Vec<f64>,
    /// Reduction of the square by the solution.
    pub removed: f64,
}

impl Marginal {
    /// The sum of the channels, each with the numbers of its columns among so many.
    fn of(channels: impl IntoIterator<Item = (impl AsRef<[usize]>, Reduced)>, count: usize) -> Self {
        let mut all = Self {
            fisher: Matrix::zeros(count, count),
            score: vec![0.0; count],
            square: 0.0,
            log_determinant: 0.0,
            channels: Vec::new(),
        };
        for (columns, reduced) in channels {
            let columns = columns.as_ref();
            for (row, number) in columns.iter().enumerate() {
                all.score[*number] += reduced.score[row];
                let line = all.fisher.row_mut(*number);
                for (column, other) in columns.iter().enumerate() {
                    line[*other] += reduced.fisher.at(row, column);
                }
            }
            all.square += reduced.square;
            all.log_determinant += reduced.log_determinant;
            all.channels.push(reduced);
        }
        all
    }

    /// ln det V.
    pub const fn log_determinant(&self) -> f64 {
        self.log_determinant
    }
}

impl Fitted<'_> {
    /// The factor of what the rows and the priors tell of the columns.
    pub fn factorised(&self, marginal: &Marginal) -> Result<LargeFactor, InferenceError> {
        let mut inner = marginal.fisher.picked(&self.columns, &self.columns);
        for (at, column) in self.columns.iter().enumerate() {
            inner.row_mut(at)[at] += self.precisions[*column];
        }
        factorised(&inner, Stage::Causes)
    }

    /// The generalised least-squares solution.
    pub fn solved(&self, marginal: &Marginal) -> Result<Solved, InferenceError> {
        let score: Vec<f64> = self.columns.iter().map(|column| marginal.score[*column]).collect();
        let found = self.factorised(marginal)?.solve(&score);
        let removed = found.iter().zip(&score).map(|(psi, score)| psi * score).sum();
        let mut coordinates = vec![0.0; marginal.score.len()];
        self.columns.iter().zip(found).for_each(|(column, psi)| coordinates[*column] = psi);
        Ok(Solved { coordinates, removed })
    }
}

/// ẑ = H⁻¹ Bᵀ D⁻¹ (r − A ψ̂).
fn smooth(equations: &NormalEquations, reduced: &Reduced, coordinates: &[f64]) -> Vec<f64> {
    let own: Vec<f64> = equations.columns.iter().map(|number| coordinates[*number]).collect();
    reduced.factor.solve(&equations.background_score(&own))
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
