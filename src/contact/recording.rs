//! A table of contacts as a decoder takes it: relative to the untouched pad, and free of what earlier contacts left behind.
//!
//! Rows are read in their order, as friction depends on it. Before each static sample the pad was released, and one that
//! is reached by unloading came from full scale. What friction does to the readings of the untouched pad is in the zeros,
//! so it is taken off them, too.

use super::friction::{Friction, History, PLAYS};
use crate::measured::zero::{self, Zeros};
use crate::measured::{Approach, Row, Table};
use crate::quantity::CHANNELS;

/// Rounds in which strains and what friction does to them are made to agree.
const ROUNDS: usize = 4;
/// A static load that is reached downwards comes from full scale, and from this much more than itself at least.
const OVERLOAD_MIN: f64 = 1.2;

/// For each play operator and channel: its state beside the strain, relative to the same of the untouched pad.
pub type Lags = [[f64; CHANNELS]; PLAYS];

/// A table that reads the untouched pad now and then.
#[derive(Clone, Debug)]
pub struct Recording {
    tared: Table,
    raw: Table,
    zeros: Zeros,
    full_scale_n: f64,
}

impl Recording {
    /// `None` if the table never reads the untouched pad. `full_scale_n` is the pad's largest force.
    pub fn of(raw: Table, full_scale_n: f64) -> Option<Self> {
        let (zeros, tared) = (Zeros::of(&raw)?, zero::tared(&raw)?);
        Some(Self { tared, raw, zeros, full_scale_n })
    }

    /// The table relative to the untouched pad.
    pub const fn tared(&self) -> &Table {
        &self.tared
    }

    /// Places of the rows that a decoder is fitted to.
    pub fn contacts(&self) -> Vec<usize> {
        zero::contacts(&self.raw)
    }

    /// The raw readings of the untouched pad, with their places.
    pub fn zeros(&self) -> impl Iterator<Item = (usize, [f64; CHANNELS])> {
        self.zeros.rows().iter().filter_map(|at| Some((*at, self.raw.rows.get(*at)?.uv?)))
    }

    /// The table relative to the untouched pad and without friction.
    pub fn freed(&self, friction: &Friction) -> Table {
        let mut freed = self.tared.clone();
        let lags = self.lags(&self.states(friction, |_| None));
        for (row, lags) in freed.rows.iter_mut().zip(lags) {
            row.uv = row.uv.map(|uv| without(uv, friction, &lags));
        }
        freed
    }

    /// Each row's states of the play operators less its strains. The strains are those of `known`, else the row's channels
    /// without friction: where a reading is to be explained, its own noise must not explain it.
    pub fn states(&self, friction: &Friction, known: impl Fn(usize) -> Option<[f64; CHANNELS]>) -> Vec<Lags> {
        let mut states = vec![[[0.0; CHANNELS]; PLAYS]; self.tared.rows.len()];
        for _ in 0..ROUNDS {
            states = self.walk(friction, &self.lags(&states), &known);
        }
        states
    }

    /// These states relative to those of the untouched pad. What friction added to a row's tared channels is the sum of
    /// shares times this.
    pub fn lags(&self, states: &[Lags]) -> Vec<Lags> {
        (0..states.len()).map(|at| self.relative(states, at)).collect()
    }

    /// The states if these lags are taken off the channels.
    fn walk(
        &self,
        friction: &Friction,
        lags: &[Lags],
        known: impl Fn(usize) -> Option<[f64; CHANNELS]>,
    ) -> Vec<Lags> {
        let mut history = History::default();
        let mut before: Option<usize> = None;
        let mut states = Vec::with_capacity(lags.len());
        for (at, (row, lags)) in self.tared.rows.iter().zip(lags).enumerate() {
            let is_zero = self.zeros.rows().binary_search(&at).is_ok();
            let read_uv = || row.uv.filter(|_| !is_zero).map(|uv| without(uv, friction, lags));
            let free_uv = known(at).or_else(read_uv).unwrap_or_default();
            if row.trial.is_none() || row.trial != before {
                history.follow(friction, &[0.0; CHANNELS]);
            }
            if row.trial.is_none() && row.approach == Some(Approach::Unloading) {
                let factor = self.overload(row);
                history.follow(friction, &free_uv.map(|uv| factor * uv));
            }
            history.follow(friction, &free_uv);
            before = row.trial;
            states.push(history.state_uv.map(|states| std::array::from_fn(|k| states[k] - free_uv[k])));
        }
        states
    }

    fn relative(&self, states: &[Lags], at: usize) -> Lags {
        std::array::from_fn(|play| {
            let zero_uv = self.zeros.at(at, |zero| states[zero][play]);
            std::array::from_fn(|channel| states[at][play][channel] - zero_uv[channel])
        })
    }

    /// The load from which a row's load was reached, beside it.
    fn overload(&self, row: &Row) -> f64 {
        let [_, _, fx_n, fy_n, fz_n] = row.label.numbers();
        let force_n = libm::hypot(libm::hypot(fx_n, fy_n), fz_n);
        if force_n > 0.0 { (self.full_scale_n / force_n).max(OVERLOAD_MIN) } else { 1.0 }
    }
}

fn without(uv: [f64; CHANNELS], friction: &Friction, lags: &Lags) -> [f64; CHANNELS] {
    std::array::from_fn(|k| {
        uv[k] - friction.iter().zip(lags).map(|(play, lags)| play.share[k] * lags[k]).sum::<f64>()
    })
}
