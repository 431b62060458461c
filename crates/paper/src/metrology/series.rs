//! Trials: time series with their zero taken off, and the parts of them in which the load stays.

use super::output::sum_uv;
use super::rows::{Zeros, is_same_place, is_unloaded, less};
use tactpad_core::quantity::CHANNELS;
use tactpad_core::tables::measured::{Label, Row, Table};
use tactpad_numeric::statistics::{mean, mean_vector};

/// A load is constant as long as each part of it stays so close to its mean, and as a share of its press:
/// references are noisy, and fingers tremble in proportion.
const CONSTANT_N: f64 = 0.1;
const CONSTANT_SHARE: f64 = 0.05;

/// The trials of a table with their zeros.
pub(super) struct Trials<'t> {
    /// Rows with times and channels, and what these read without load.
    trials: Vec<(Vec<&'t Row>, [f64; CHANNELS])>,
}

/// One sample of a trial. A trial may have a million: they stay in the table.
#[derive(Clone, Copy)]
pub(super) struct Sample<'t> {
    row: &'t Row,
    zero_uv: &'t [f64; CHANNELS],
}

impl<'t> Trials<'t> {
    /// The trials with times, channels and a zero: their own unloaded start, else the unloaded static rows around
    /// them.
    pub(super) fn of(table: &'t Table) -> Self {
        let zeros = Zeros::of(table);
        let mut trials: Vec<Vec<(u32, &Row)>> = vec![Vec::new(); table.trials.len()];
        for (index, row) in table.rows.iter().enumerate() {
            if let Some(trial) = row.trial.and_then(|trial| trials.get_mut(trial)) {
                trial.push((index as u32, row));
            }
        }
        Self { trials: trials.into_iter().filter_map(|rows| with_zero(rows, &zeros)).collect() }
    }

    /// The samples of each.
    pub(super) fn each(&self) -> impl Iterator<Item = Vec<Sample<'_>>> {
        self.trials.iter().map(|(rows, zero_uv)| rows.iter().map(|row| Sample { row, zero_uv }).collect())
    }
}

impl Sample<'_> {
    pub(super) fn t_s(&self) -> f64 {
        self.row.t_s.unwrap_or_default()
    }

    pub(super) const fn label(&self) -> &Label {
        &self.row.label
    }

    /// Beyond the zero.
    pub(super) fn uv(&self) -> [f64; CHANNELS] {
        less(&self.row.uv.unwrap_or_default(), self.zero_uv)
    }
}

/// `None` without zero or samples.
fn with_zero<'t>(rows: Vec<(u32, &'t Row)>, zeros: &Zeros) -> Option<(Vec<&'t Row>, [f64; CHANNELS])> {
    let start = rows.iter().take_while(|(_, row)| is_unloaded(&row.label));
    let start: Vec<&[f64; CHANNELS]> = start.filter_map(|(_, row)| row.uv.as_ref()).collect();
    let (first, _) = rows.first()?;
    let zero_uv =
        if start.is_empty() { zeros.at(*first as usize)? } else { mean_vector(start.iter().copied()) };
    let is_sample = |row: &&Row| row.t_s.is_some() && row.uv.is_some();
    Some((rows.into_iter().map(|(_, row)| row).filter(is_sample).collect(), zero_uv))
}

/// The parts of a trial in which place and load stay, in order; they cover it.
pub(super) fn plateaus<'s, 't>(samples: &'s [Sample<'t>]) -> Vec<&'s [Sample<'t>]> {
    let mut parts = Vec::new();
    let mut rest = samples;
    while !rest.is_empty() {
        let (part, later) = rest.split_at(constant(rest));
        parts.push(part);
        rest = later;
    }
    parts
}

/// The parts in which a load is held for this time: plateaus whose halves do not differ, unlike those of a slow
/// ramp.
pub(super) fn held<'s, 't>(
    samples: &'s [Sample<'t>],
    seconds: f64,
) -> impl Iterator<Item = &'s [Sample<'t>]> {
    let long = plateaus(samples).into_iter().filter(move |part| duration_s(part) >= seconds);
    long.filter(|part| {
        let (first, second) = part.split_at(part.len() / 2);
        let level_n = mean_fz_n(part).abs();
        (mean_fz_n(first) - mean_fz_n(second)).abs() <= 0.5 * (CONSTANT_N + CONSTANT_SHARE * level_n)
    })
}

/// Number of samples from the first one on that hold its load; at least one.
fn constant(samples: &[Sample]) -> usize {
    let mut sums = [0.0; 3];
    for (count, sample) in samples.iter().enumerate() {
        let force_n = [sample.label().fx_n, sample.label().fy_n, sample.label().fz_n];
        let held_n = sums.map(|sum| sum / count as f64);
        let off_n = CONSTANT_N + CONSTANT_SHARE * held_n[2].abs();
        let stays = (0..3).all(|axis| (force_n[axis] - held_n[axis]).abs() <= off_n);
        if count > 0 && !(stays && is_same_place(samples[0].label(), sample.label())) {
            return count;
        }
        sums = std::array::from_fn(|axis| sums[axis] + force_n[axis]);
    }
    samples.len()
}

/// From the first sample to the last one; zero without samples.
pub(super) fn duration_s(samples: &[Sample]) -> f64 {
    samples.first().zip(samples.last()).map_or(0.0, |(first, last)| last.t_s() - first.t_s())
}

/// Mean label; not a number without samples.
pub(super) fn mean_label(samples: &[Sample]) -> Label {
    let over = |of: fn(&Label) -> f64| mean(samples.iter().map(|sample| of(sample.label())));
    Label {
        x_mm: over(|label| label.x_mm),
        y_mm: over(|label| label.y_mm),
        fx_n: over(|label| label.fx_n),
        fy_n: over(|label| label.fy_n),
        fz_n: over(|label| label.fz_n),
    }
}

/// Mean labelled press; not a number without samples.
pub(super) fn mean_fz_n(samples: &[Sample]) -> f64 {
    mean_label(samples).fz_n
}

/// Mean sum of the z channels; not a number without samples.
pub(super) fn mean_sum_uv(samples: &[Sample]) -> f64 {
    mean(samples.iter().map(|sample| sum_uv(&sample.uv())))
}

#[cfg(test)]
mod tests {
    use super::super::fixture::{press, series, table, unloaded};
    use super::*;

    fn first<'t>(trials: &'t Trials<'t>) -> Vec<Sample<'t>> {
        trials.each().next().unwrap()
    }

    #[test]
    fn a_trial_is_tared_by_its_start_or_by_static_zeros() {
        let step = |t_s: f64| if t_s < 1.0 { (press(0.0), 5.0) } else { (press(2.0), 105.0) };
        let loaded = |_: f64| (press(2.0), 105.0);
        let [own, by_static, none] = [
            table(series(0, 10.0, 2.0, step)),
            table([unloaded(1.0)].into_iter().chain(series(0, 10.0, 2.0, loaded))),
            table(series(0, 10.0, 2.0, loaded)),
        ]
        .map(|table| {
            Trials::of(&table).each().next().and_then(|trial| trial.last().map(|last| last.uv()[3]))
        });
        assert_eq!((own, by_static, none), (Some(100.0), Some(104.0), None));
    }

    #[test]
    fn steps_part_a_trial() {
        let stairs = table(series(0, 45.0, 6.0, |t_s| (press((t_s / 2.0).floor()), 0.0)));
        let levels: Vec<f64> = plateaus(&first(&Trials::of(&stairs))).into_iter().map(mean_fz_n).collect();
        assert_eq!(levels, [0.0, 1.0, 2.0]);
        let ramp = table(series(0, 45.0, 10.0, |t_s| (press(0.5 * t_s), 0.0)));
        assert_eq!(plateaus(&first(&Trials::of(&ramp))).iter().map(|part| part.len()).sum::<usize>(), 450);
    }

    #[test]
    fn a_slow_ramp_holds_nothing() {
        for seconds in [10.0, 40.0, 400.0] {
            let ramp = table(series(0, 45.0, seconds, |t_s| (press(5.0 * t_s / seconds), 0.0)));
            // The last part may be cut short where the ramp ends.
            assert!(held(&first(&Trials::of(&ramp)), 0.05 * seconds).count() <= 1, "{seconds}");
        }
        // A tremor of 2 % is no ramp.
        let trembling = |t_s: f64| press(5.0 + 0.1 * (7.0 * t_s).sin() + 0.05 * (31.0 * t_s).sin());
        let rows = series(0, 45.0, 10.0, |t_s| (trembling(t_s), 0.0));
        let held_s: Vec<f64> = Trials::of(&table([unloaded(0.0)].into_iter().chain(rows)))
            .each()
            .flat_map(|trial| held(&trial, 5.0).map(duration_s).collect::<Vec<_>>())
            .collect();
        assert!(held_s.len() == 1 && held_s[0] > 9.9, "{held_s:?}");
    }
}
