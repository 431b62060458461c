//! Trials: time series with their zero taken off, and the parts of them in which the load stays.

use super::output::sum_uv;
use super::rows::{Zeros, is_same_place, is_unloaded, less};
use crate::numeric::statistics::{mean, mean_vector};
use crate::quantity::CHANNELS;
use crate::tables::measured::{Label, Row, Table};

/// A load is constant as long as each part of it stays so close to its mean, and as a share of its press:
/// references are noisy, and fingers tremble in proportion.
const CONSTANT_N: f64 = 0.1;
const CONSTANT_SHARE: f64 = 0.05;

/// One sample of a trial.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sample {
    pub(super) t_s: f64,
    pub(super) label: Label,
    /// Beyond the zero.
    pub(super) uv: [f64; CHANNELS],
}

/// The trials with times, channels and a zero: their own unloaded start, else the unloaded static rows around
/// them.
pub(super) fn all(table: &Table) -> Vec<Vec<Sample>> {
    let zeros = Zeros::of(table);
    let mut trials: Vec<Vec<(usize, &Row)>> = vec![Vec::new(); table.trials.len()];
    for (index, row) in table.rows.iter().enumerate() {
        if let Some(trial) = row.trial.and_then(|trial| trials.get_mut(trial)) {
            trial.push((index, row));
        }
    }
    trials.iter().filter_map(|rows| tared(rows, &zeros)).collect()
}

/// `None` without zero or samples. Rows without time or channels are left out.
fn tared(rows: &[(usize, &Row)], zeros: &Zeros) -> Option<Vec<Sample>> {
    let start: Vec<[f64; CHANNELS]> =
        rows.iter().take_while(|(_, row)| is_unloaded(&row.label)).filter_map(|(_, row)| row.uv).collect();
    let (first, _) = rows.first()?;
    let zero_uv = if start.is_empty() { zeros.at(*first)? } else { mean_vector(&start) };
    let sample = |row: &Row| Some(Sample { t_s: row.t_s?, label: row.label, uv: less(&row.uv?, &zero_uv) });
    Some(rows.iter().filter_map(|(_, row)| sample(row)).collect())
}

/// The parts of a trial in which place and load stay, in order; they cover it.
pub(super) fn plateaus(samples: &[Sample]) -> Vec<&[Sample]> {
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
pub(super) fn held(samples: &[Sample], seconds: f64) -> impl Iterator<Item = &[Sample]> {
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
        let force_n = [sample.label.fx_n, sample.label.fy_n, sample.label.fz_n];
        let held_n = sums.map(|sum| sum / count as f64);
        let off_n = CONSTANT_N + CONSTANT_SHARE * held_n[2].abs();
        let stays = (0..3).all(|axis| (force_n[axis] - held_n[axis]).abs() <= off_n);
        if count > 0 && !(stays && is_same_place(&samples[0].label, &sample.label)) {
            return count;
        }
        sums = std::array::from_fn(|axis| sums[axis] + force_n[axis]);
    }
    samples.len()
}

/// From the first sample to the last one; zero without samples.
pub(super) fn duration_s(samples: &[Sample]) -> f64 {
    samples.first().zip(samples.last()).map_or(0.0, |(first, last)| last.t_s - first.t_s)
}

/// Mean label; not a number without samples.
pub(super) fn mean_label(samples: &[Sample]) -> Label {
    let over = |of: fn(&Label) -> f64| mean(samples.iter().map(|sample| of(&sample.label)));
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
    mean(samples.iter().map(|sample| sum_uv(&sample.uv)))
}

#[cfg(test)]
mod tests {
    use super::super::fixture::{press, series, table, unloaded};
    use super::*;

    #[test]
    fn a_trial_is_tared_by_its_start_or_by_static_zeros() {
        let step = |t_s: f64| if t_s < 1.0 { (press(0.0), 5.0) } else { (press(2.0), 105.0) };
        let loaded = |_: f64| (press(2.0), 105.0);
        let [own, by_static, none] = [
            table(series(0, 10.0, 2.0, step)),
            table([unloaded(1.0)].into_iter().chain(series(0, 10.0, 2.0, loaded))),
            table(series(0, 10.0, 2.0, loaded)),
        ]
        .map(|table| all(&table).first().and_then(|trial| trial.last().map(|last| last.uv[3])));
        assert_eq!((own, by_static, none), (Some(100.0), Some(104.0), None));
    }

    #[test]
    fn steps_part_a_trial() {
        let stairs = table(series(0, 45.0, 6.0, |t_s| (press((t_s / 2.0).floor()), 0.0)));
        let trial = &all(&stairs)[0];
        let levels: Vec<f64> = plateaus(trial).into_iter().map(mean_fz_n).collect();
        assert_eq!(levels, [0.0, 1.0, 2.0]);
        let ramp = table(series(0, 45.0, 10.0, |t_s| (press(0.5 * t_s), 0.0)));
        let parts = all(&ramp);
        assert_eq!(plateaus(&parts[0]).iter().map(|part| part.len()).sum::<usize>(), 450);
    }

    #[test]
    fn a_slow_ramp_holds_nothing() {
        for seconds in [10.0, 40.0, 400.0] {
            let ramp = table(series(0, 45.0, seconds, |t_s| (press(5.0 * t_s / seconds), 0.0)));
            // The last part may be cut short where the ramp ends.
            assert!(held(&all(&ramp)[0], 0.05 * seconds).count() <= 1, "{seconds}");
        }
        // A tremor of 2 % is no ramp.
        let trembling = |t_s: f64| press(5.0 + 0.1 * (7.0 * t_s).sin() + 0.05 * (31.0 * t_s).sin());
        let rows = series(0, 45.0, 10.0, |t_s| (trembling(t_s), 0.0));
        let held_s: Vec<f64> = all(&table([unloaded(0.0)].into_iter().chain(rows)))
            .iter()
            .flat_map(|trial| held(trial, 5.0).map(duration_s).collect::<Vec<_>>())
            .collect();
        assert!(held_s.len() == 1 && held_s[0] > 9.9, "{held_s:?}");
    }
}
