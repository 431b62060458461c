//! The process' covariance, and the rows that stand for all.

use tactpad_numeric::dense::Matrix;
use tactpad_numeric::linear::LargeFactor;
use tactpad_numeric::statistics::rms;

const LEFT_MIN: f64 = 1e-6;

/// Inputs of one kind: those that turn into each other when the axes turn have one length.
#[derive(Clone, Debug, PartialEq)]
pub struct Group {
    /// Which inputs.
    pub inputs: Vec<usize>,
    /// Whether they are loads: zero is nothing.
    pub is_load: bool,
}

/// Labels of rows.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Labels {
    /// The inputs' groups.
    pub groups: Vec<Group>,
    /// For each row, its inputs.
    pub rows: Vec<Vec<f64>>,
    /// For each row, what acts linearly and on its own: time, temperature.
    pub others: Vec<Vec<f64>>,
}

/// The kernel, in units of the inputs' extent.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Kernel {
    /// β.
    pub blend: f64,
    /// For each group: λₚ.
    pub linear: Vec<f64>,
    /// For each group: λₓ.
    pub smooth: Vec<f64>,
}

impl Kernel {
    pub(crate) fn of(&self, groups: &[Group], one: &[f64], other: &[f64]) -> f64 {
        let (mut product, mut places, mut all) = (0.0, 0.0, 0.0);
        let mut begin = 0;
        for (at, group) in groups.iter().enumerate() {
            let end = begin + group.inputs.len();
            let pairs = || one[begin..end].iter().zip(&other[begin..end]);
            let square: f64 = pairs().map(|(a, b)| (a - b) * (a - b)).sum();
            all += square / (self.smooth[at] * self.smooth[at]);
            if group.is_load {
                product += pairs().map(|(a, b)| a * b).sum::<f64>();
            } else {
                places += square / (self.linear[at] * self.linear[at]);
            }
            begin = end;
        }
        let linear =
            if self.blend < 1.0 && product != 0.0 { product * libm::exp(-0.5 * places) } else { 0.0 };
        (1.0 - self.blend) * linear + self.blend * libm::exp(-0.5 * all)
    }
}

/// A group's middles and extent: half of the widest range, or the root mean square of loads.
pub(crate) fn scale(group: &Group, rows: &[Vec<f64>]) -> (Vec<f64>, f64) {
    let along = |input: &usize| {
        let of = || rows.iter().map(|row| row[*input]);
        [of().fold(f64::INFINITY, f64::min), of().fold(f64::NEG_INFINITY, f64::max)]
    };
    let ranges: Vec<[f64; 2]> = group.inputs.iter().map(along).collect();
    if group.is_load {
        let size =
            group.inputs.iter().map(|input| rms(rows.iter().map(|row| row[*input]))).fold(0.0, f64::max);
        return (vec![0.0; ranges.len()], size.max(f64::MIN_POSITIVE.sqrt()));
    }
    let extent = ranges.iter().map(|[low, high]| 0.5 * (high - low)).fold(f64::MIN_POSITIVE.sqrt(), f64::max);
    (ranges.iter().map(|[low, high]| f64::midpoint(*low, *high)).collect(), extent)
}

/// A row's inputs group by group, in units of their extent.
pub(crate) fn scaled(groups: &[Group], scales: &[(Vec<f64>, f64)], row: &[f64]) -> Vec<f64> {
    let of_group = |(group, (middles, extent)): (&Group, &(Vec<f64>, f64))| {
        let inputs = group.inputs.iter().zip(middles);
        inputs.map(|(input, middle)| (row[*input] - middle) / extent).collect::<Vec<_>>()
    };
    groups.iter().zip(scales).flat_map(of_group).collect()
}

/// The rows that a pivoted factorisation takes first, and the factor of their covariance.
pub(crate) fn pivots(
    groups: &[Group],
    kernel: &Kernel,
    rows: &[Vec<f64>],
    most: usize,
) -> Option<(Vec<usize>, LargeFactor)> {
    let mut left: Vec<f64> = rows.iter().map(|row| kernel.of(groups, row, row)).collect();
    let whole = left.iter().fold(0.0, |most: f64, it| most.max(*it));
    let mut taken: Vec<usize> = Vec::new();
    let mut lines: Vec<Vec<f64>> = Vec::new();
    while taken.len() < most.min(rows.len()) {
        let (next, largest) = left
            .iter()
            .enumerate()
            .fold((0, 0.0), |best, (at, left)| if *left > best.1 { (at, *left) } else { best });
        if largest <= LEFT_MIN * whole {
            break;
        }
        let root = largest.sqrt();
        let mut line: Vec<f64> = rows.iter().map(|row| kernel.of(groups, &rows[next], row)).collect();
        for before in &lines {
            let factor = before[next];
            line.iter_mut().zip(before).for_each(|(value, before)| *value -= factor * before);
        }
        line.iter_mut().for_each(|value| *value /= root);
        left.iter_mut().zip(&line).for_each(|(left, value)| *left = (*left - value * value).max(0.0));
        left[next] = 0.0;
        taken.push(next);
        lines.push(line);
    }
    let mut covariance = Matrix::zeros(taken.len(), taken.len());
    for (at, one) in taken.iter().enumerate() {
        for (with, other) in taken.iter().enumerate() {
            covariance.row_mut(at)[with] = kernel.of(groups, &rows[*one], &rows[*other]);
        }
        covariance.row_mut(at)[at] += 0.1 * LEFT_MIN * whole;
    }
    Some((taken, covariance.factorised()?))
}
