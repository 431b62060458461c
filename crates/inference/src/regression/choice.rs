//! The kernel with the greatest evidence over all channels together.

use super::kernel::{Group, Kernel, Labels, pivots};
use super::system::System;
use tactpad_numeric::dense::Matrix;
use tactpad_numeric::products::dot;
use tactpad_numeric::statistics::population_deviation;

/// Rows by which the kernel is chosen, and its pivots then.
const ROWS_CHOICE: usize = 480;
const PIVOTS_CHOICE: usize = 140;
/// Ratios of noise to signal, as variances, at which the evidence is looked at while the kernel is chosen.
pub(crate) const RATIOS: [f64; 6] = [1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 1e-1];
/// The first length, how far it goes, and by what factor it is changed.
const LENGTH_FIRST: f64 = 1.2;
const LENGTHS: [f64; 2] = [0.15, 12.0];
const LENGTH_STEP: f64 = 1.45;
/// Values of β where there are loads.
const BLENDS: [f64; 4] = [1e-6, 1e-4, 1e-2, 1.0];
/// Passes over all numbers of the kernel.
const PASSES: usize = 3;

/// Rows by which the kernel is chosen.
pub(crate) struct KernelSelection {
    rows: Vec<Vec<f64>>,
    others: Vec<Vec<f64>>,
    readings: Vec<Vec<f64>>,
}

impl KernelSelection {
    pub(crate) fn of(labels: &Labels, rows: &[Vec<f64>], readings: &[Vec<f64>]) -> Self {
        let count = rows.len().min(ROWS_CHOICE);
        let picked: Vec<usize> = (0..count).map(|at| at * rows.len() / count).collect();
        let centred = |channel: &Vec<f64>| -> Vec<f64> {
            let size = population_deviation(channel).max(f64::MIN_POSITIVE.sqrt());
            picked.iter().map(|row| channel[*row] / size).collect()
        };
        Self {
            rows: picked.iter().map(|row| rows[*row].clone()).collect(),
            others: picked.iter().map(|row| labels.others.get(*row).cloned().unwrap_or_default()).collect(),
            readings: readings.iter().map(centred).collect(),
        }
    }

    /// The kernel with the greatest evidence: each number in turn, by steps that go on while they help.
    pub(crate) fn chosen(&self, labels: &Labels) -> Option<Kernel> {
        let groups = &labels.groups;
        let has_loads = groups.iter().any(|group| group.is_load);
        let first = |blend: f64| Kernel {
            blend,
            linear: vec![LENGTH_FIRST; groups.len()],
            smooth: vec![LENGTH_FIRST; groups.len()],
        };
        let mut best = first(if has_loads { BLENDS[1] } else { 1.0 });
        let mut evidence = self.evidence(groups, &best)?;
        let mut better = |kernel: Kernel, best: &mut Kernel| {
            let found = self.evidence(groups, &kernel).unwrap_or(f64::NEG_INFINITY);
            let is_better = found > evidence;
            if is_better {
                (evidence, *best) = (found, kernel);
            }
            is_better
        };
        for _ in 0..PASSES {
            let before = best.clone();
            for (at, is_linear) in numbers(groups, has_loads) {
                for factor in [LENGTH_STEP, 1.0 / LENGTH_STEP] {
                    while let Some(next) = stepped(&best, at, is_linear, factor) {
                        if !better(next, &mut best) {
                            break;
                        }
                    }
                }
            }
            for blend in BLENDS.into_iter().filter(|_| has_loads) {
                better(Kernel { blend, ..best.clone() }, &mut best);
            }
            if best == before {
                break;
            }
        }
        Some(best)
    }

    /// Over all channels, each with the ratio that suits it best.
    fn evidence(&self, groups: &[Group], kernel: &Kernel) -> Option<f64> {
        let (taken, factor) = pivots(groups, kernel, &self.rows, PIVOTS_CHOICE)?;
        let functions = self.rows.iter().zip(&self.others).map(|(row, others)| {
            let with: Vec<f64> = taken.iter().map(|at| kernel.of(groups, &self.rows[*at], row)).collect();
            let mut functions = vec![1.0];
            functions.extend(others);
            functions.extend(factor.solve_lower(&with));
            functions
        });
        let functions = Matrix::from_rows(&functions.collect::<Vec<_>>());
        let columns: Vec<Vec<f64>> = (0..functions.columns()).map(|at| functions.column(at)).collect();
        let free = 1 + self.others.first().map_or(0, Vec::len);
        let system = System::of(&columns, &[], free, self.rows.len());
        let rights: Vec<(Vec<f64>, f64)> = self
            .readings
            .iter()
            .map(|readings| (functions.transposed_times(readings), dot(readings, readings)))
            .collect();
        let mut most = vec![f64::NEG_INFINITY; rights.len()];
        for ratio in RATIOS {
            let factor = system.factorised(ratio)?;
            for (most, (right, square)) in most.iter_mut().zip(&rights) {
                *most = most.max(system.with(&factor, ratio, right, *square).2);
            }
        }
        Some(most.iter().sum())
    }
}

/// The kernel's lengths that mean something: a group's number, and whether it is one of the linear part.
fn numbers(groups: &[Group], has_loads: bool) -> Vec<(usize, bool)> {
    let of_group = |(at, group): (usize, &Group)| {
        let linear = (has_loads && !group.is_load).then_some((at, true));
        linear.into_iter().chain([(at, false)])
    };
    groups.iter().enumerate().flat_map(of_group).collect()
}

/// The kernel with one length changed; `None` at the end of the range.
fn stepped(kernel: &Kernel, at: usize, is_linear: bool, factor: f64) -> Option<Kernel> {
    let mut next = kernel.clone();
    let length = if is_linear { &mut next.linear[at] } else { &mut next.smooth[at] };
    *length *= factor;
    (*length >= LENGTHS[0] && *length <= LENGTHS[1]).then_some(next)
}
