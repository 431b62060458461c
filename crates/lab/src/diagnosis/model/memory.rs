//! What rows owe to what was before them: friction, slow giving way, and clocks that are late.
//!
//! ```text
//! mₖ = eₖ + Σⱼ wⱼ (pⱼ − eₖ) + Σᵢ cᵢ (eₖ ∗ low pass of time constant τᵢ)
//! ```
//!
//! with play operators p (Prandtl and Ishlinskii) and a Prony series, in the order of the rows. A static load comes from rest, or
//! down from a higher one, and was held; a series begins at rest.

use tactpad_core::tables::measured::Label;
use tactpad_inference::observations::Sample;
use tactpad_numeric::memory::{PlayOperator, Relaxation};

/// Friction in one channel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ChannelFriction {
    pub(crate) channel: usize,
    /// Its threshold is a share of the channel's full scale.
    pub(crate) play: PlayOperator,
    /// A static load that comes from above came from so many times as far above as is thought.
    pub(crate) above: f64,
}

/// Memory of the channels.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct MemoryChain {
    pub(crate) plays: Vec<ChannelFriction>,
    /// Each with its channel.
    pub(crate) relaxations: Vec<(usize, Relaxation)>,
}

/// How a row came about.
#[derive(Clone, Copy, Debug, PartialEq)]
enum RowTransition {
    /// From rest, or down from so many times its load; held for so long, where that is written.
    Static { overload: Option<f64>, dwell_s: Option<f64> },
    /// The first of a series.
    First,
    /// It goes on with the series of the row before, after so long.
    Next { after_s: f64 },
}

/// The rows in their order.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct RowSequence {
    steps: Vec<RowTransition>,
}

/// A moment between two rows of a series: their numbers, and how far it is from the first to the second.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct RowInterval {
    pub(crate) rows: [usize; 2],
    pub(crate) part: f64,
}

impl RowSequence {
    /// `follows` says which rows go on with the row before; a series whose rows have no times is a run of static loads.
    /// `full_scale_n` is the largest load, from which others are approached downwards.
    pub(crate) fn of(samples: &[Sample], follows: &[bool], full_scale_n: f64) -> Self {
        let is_series = |at: usize| {
            let goes_on = |at: usize| follows.get(at).copied().unwrap_or(false);
            samples[at].t_s.is_some() && (goes_on(at) || goes_on(at + 1))
        };
        let after_s = |at: usize| Some((samples[at].t_s? - samples[at.checked_sub(1)?].t_s?).max(0.0));
        let step = |at: usize| match after_s(at).filter(|_| follows[at]) {
            Some(after_s) => RowTransition::Next { after_s },
            None if is_series(at) => RowTransition::First,
            None => from_rest(&samples[at], full_scale_n),
        };
        Self { steps: (0..samples.len()).map(step).collect() }
    }

    /// Whether any rows are a time series.
    pub(crate) fn has_series(&self) -> bool {
        self.steps.iter().any(|step| matches!(step, RowTransition::Next { .. }))
    }

    /// Whether static loads were reached from both sides.
    pub(crate) fn has_both_ways(&self) -> bool {
        let comes_down = |step: &RowTransition| match step {
            RowTransition::Static { overload, .. } => Some(overload.is_some()),
            _ => None,
        };
        let mut ways = self.steps.iter().filter_map(comes_down);
        ways.next().is_some_and(|first| ways.any(|way| way != first))
    }

    /// How long static loads were held: nobody knows, always the same, or not.
    pub(crate) fn dwells(&self) -> Dwells {
        let dwell = |step: &RowTransition| match step {
            RowTransition::Static { dwell_s, .. } => *dwell_s,
            _ => None,
        };
        let mut dwells = self.steps.iter().filter_map(dwell);
        match dwells.next() {
            None => Dwells::Unknown,
            Some(first) if dwells.all(|dwell| dwell == first) => Dwells::Alike,
            Some(_) => Dwells::Different,
        }
    }

    /// The moment that is so much later than a row: within its series, at whose ends time stands still.
    pub(crate) fn moment(&self, row: usize, later_s: f64) -> RowInterval {
        let (mut at, mut left_s) = (row, later_s);
        let gap_s = |row: usize| match self.steps.get(row) {
            Some(RowTransition::Next { after_s }) => Some(*after_s),
            _ => None,
        };
        while left_s > 0.0 {
            let Some(gap_s) = gap_s(at + 1) else { return RowInterval { rows: [at; 2], part: 0.0 } };
            if left_s < gap_s {
                return RowInterval { rows: [at, at + 1], part: left_s / gap_s };
            }
            (at, left_s) = (at + 1, left_s - gap_s);
        }
        while left_s < 0.0 {
            let Some(gap_s) = gap_s(at) else { return RowInterval { rows: [at; 2], part: 0.0 } };
            if -left_s < gap_s {
                return RowInterval { rows: [at, at - 1], part: -left_s / gap_s };
            }
            (at, left_s) = (at - 1, left_s + gap_s);
        }
        RowInterval { rows: [at; 2], part: 0.0 }
    }

    /// w (p − e), row by row, of a play operator.
    fn held_back(&self, play: &PlayOperator, above: f64, strain: &[f64]) -> Vec<f64> {
        let mut state = 0.0;
        let rows = self.steps.iter().zip(strain);
        rows.map(|(step, strain)| {
            match step {
                RowTransition::Static { overload: Some(times), .. } => {
                    state = play.pulled(0.0, strain * (1.0 + above * (times - 1.0)));
                }
                RowTransition::Static { .. } | RowTransition::First => state = 0.0,
                RowTransition::Next { .. } => {}
            }
            state = play.pulled(state, *strain);
            play.added(state, *strain)
        })
        .collect()
    }

    /// c u, row by row, of a relaxation. Between two rows it goes evenly; with an `early` of 1 it is at once where it goes, with −1 it goes there
    /// at the end.
    fn crept(&self, relaxation: &Relaxation, early: f64, strain: &[f64]) -> Vec<f64> {
        let (mut state, mut before) = (0.0, 0.0);
        let rows = self.steps.iter().zip(strain);
        rows.map(|(step, strain)| {
            state = match step {
                RowTransition::Static { dwell_s, .. } => {
                    // 1 − exp(−t/τ)
                    dwell_s.map_or(0.0, |dwell_s| -strain * libm::expm1(-dwell_s / relaxation.time_s))
                }
                RowTransition::First => 0.0,
                RowTransition::Next { after_s } => {
                    let first = before + early.max(0.0) * (strain - before);
                    let last = strain + early.min(0.0) * (strain - before);
                    relaxation.followed(state, [first, last], *after_s)
                }
            };
            before = *strain;
            relaxation.added(state)
        })
        .collect()
    }
}

/// What is known of how long loads were held.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Dwells {
    Unknown,
    Alike,
    Different,
}

impl RowInterval {
    /// A value there, on the line between the rows.
    pub(crate) fn of(&self, value: impl Fn(usize) -> f64) -> f64 {
        let [from, to] = self.rows.map(value);
        from + self.part * (to - from)
    }
}

impl MemoryChain {
    /// Whether a channel remembers the same by another.
    pub(crate) fn is_same(&self, other: &Self, channel: usize) -> bool {
        fn of<T: PartialEq>(one: &[T], other: &[T], is_own: impl Fn(&&T) -> bool + Copy) -> bool {
            one.iter().filter(is_own).eq(other.iter().filter(is_own))
        }
        of(&self.plays, &other.plays, |it| it.channel == channel)
            && of(&self.relaxations, &other.relaxations, |(own, _)| *own == channel)
    }

    /// What a channel's memory adds to its strain, row by row; none where it remembers nothing. `early` says when between two rows
    /// the load has changed.
    pub(crate) fn added(
        &self,
        course: &RowSequence,
        channel: usize,
        full_scale: f64,
        strain: &[f64],
        early: f64,
    ) -> Option<Vec<f64>> {
        let plays = self.plays.iter().filter(|it| it.channel == channel && it.play.share != 0.0);
        let plays = plays.map(|it| {
            let play = PlayOperator { threshold: it.play.threshold * full_scale, ..it.play };
            course.held_back(&play, it.above, strain)
        });
        let relaxations = self.relaxations.iter().filter(|(of, it)| *of == channel && it.share != 0.0);
        let relaxations = relaxations.map(|(_, it)| course.crept(it, early, strain));
        plays.chain(relaxations).reduce(|mut sum, rows| {
            sum.iter_mut().zip(rows).for_each(|(sum, value)| *sum += value);
            sum
        })
    }
}

fn from_rest(sample: &Sample, full_scale_n: f64) -> RowTransition {
    let ([x_mm, y_mm], [fx_n, fy_n, fz_n]) = (sample.place_mm, sample.load);
    let label = Label { x_mm, y_mm, fx_n, fy_n, fz_n };
    RowTransition::Static {
        overload: sample.is_unloading.then(|| label.overload(full_scale_n)),
        dwell_s: sample.dwell_s,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn series(rows: usize, step_s: f64) -> RowSequence {
        let sample = |row: usize| Sample {
            trial: Some(0),
            t_s: Some(100.0 + step_s * row as f64),
            ..Sample::default()
        };
        let samples: Vec<Sample> = (0..rows).map(sample).collect();
        let follows: Vec<bool> = (0..rows).map(|row| row > 0).collect();
        RowSequence::of(&samples, &follows, 5.0)
    }

    fn held(is_unloading: bool, dwell_s: f64) -> Sample {
        Sample { load: [0.0, 0.0, 2.5], is_unloading, dwell_s: Some(dwell_s), ..Sample::default() }
    }

    #[test]
    fn a_loop_of_a_series_is_that_of_static_loads_from_both_sides() {
        let chain = MemoryChain {
            plays: vec![ChannelFriction {
                channel: 0,
                play: PlayOperator { threshold: 0.1, share: 0.2 },
                above: 1.0,
            }],
            relaxations: Vec::new(),
        };
        let up_and_down: Vec<f64> =
            (0..=20).map(|row: i32| 100.0 * f64::from(10 - (row - 10).abs())).collect();
        let added = chain.added(&series(21, 1.0), 0, 1000.0, &up_and_down, 0.0).unwrap();
        // 2 w r S
        assert!((added[15] - added[5] - 2.0 * 0.2 * 0.1 * 1000.0).abs() < 1e-9, "{added:?}");
        let course = RowSequence::of(&[held(false, 1.0), held(true, 1.0)], &[false; 2], 5.0);
        assert!(course.has_both_ways() && !course.has_series() && course.dwells() == Dwells::Alike);
        let ways = chain.added(&course, 0, 1000.0, &[500.0; 2], 0.0).unwrap();
        assert_eq!([ways[0], ways[1]], [added[5], added[15]]);
        assert_eq!(chain.added(&course, 1, 1000.0, &[500.0; 2], 0.0), None);
    }

    #[test]
    fn a_held_load_creeps_in_a_series_as_by_its_dwell() {
        let chain = MemoryChain {
            plays: Vec::new(),
            relaxations: vec![(0, Relaxation { time_s: 4.0, share: 0.05 })],
        };
        let mut strain = vec![500.0; 101];
        strain[0] = 0.0;
        // Within 0.1 s of the load.
        let added = chain.added(&series(101, 0.1), 0, 1000.0, &strain, 0.0).unwrap();
        let course = RowSequence::of(&[held(false, 9.95), held(false, 1.0)], &[false; 2], 5.0);
        assert_eq!(course.dwells(), Dwells::Different);
        let by_dwell = chain.added(&course, 0, 1000.0, &[500.0; 2], 0.0).unwrap();
        assert!((added[100] - by_dwell[0]).abs() < 1e-3, "{} {}", added[100], by_dwell[0]);
        let at = |early: f64| chain.added(&series(101, 0.1), 0, 1000.0, &strain, early).unwrap()[1];
        // 0.1 s of 4 s, half of them, none.
        assert!((at(1.0) - 25.0 * 0.024_690).abs() < 1e-4 && (2.0 * at(0.0) / at(1.0) - 1.0).abs() < 0.02);
        assert!(at(-1.0).abs() < 1e-9, "{}", at(-1.0));
    }

    #[test]
    fn moments_lie_on_the_line_and_stay_within_a_series() {
        let course = series(4, 0.5);
        let at = |row: usize, later_s: f64| course.moment(row, later_s).of(|row| 10.0 * row as f64);
        for (row, later_s, wanted) in
            [(1, 0.25, 15.0), (1, -0.25, 5.0), (1, 0.75, 25.0), (2, 9.0, 30.0), (2, -9.0, 0.0), (0, 0.0, 0.0)]
        {
            assert!((at(row, later_s) - wanted).abs() < 1e-9, "{row} {later_s}: {}", at(row, later_s));
        }
        let alone = RowSequence::of(&[held(false, 1.0)], &[false], 5.0);
        assert_eq!(alone.moment(0, 1.0).rows, [0, 0]);
    }
}
