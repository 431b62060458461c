//! The circumstances of the rows, as axes: load, its direction, time, temperature, cycles.

use super::subject::Subject;
use tactpad::lab::inference::observations::Sample;
use tactpad::numeric::statistics::rms;

/// A shear of less than this share of the loads has no direction worth drawing.
const LEAST_SHEAR: f64 = 0.05;
/// Fewer rows than this show no trend.
const ROWS_MIN: usize = 20;

/// One axis: a number for each row, NaN where there is none.
pub(super) struct Circumstance {
    /// The title.
    pub(super) title: String,
    /// Its values, row by row.
    pub(super) values: Vec<f64>,
    /// Names of the values where they are no numbers: of 0, 1, ….
    pub(super) names: Vec<&'static str>,
}

/// All that differ from row to row.
pub(super) fn all(subject: &Subject<'_>) -> Vec<Circumstance> {
    let samples = &subject.diagnosis.residuals.samples;
    let mut all = vec![load(samples, subject), direction(samples), time(samples)];
    all.push(of(samples, "temperature in °C", |it| it.temp_c));
    all.push(of(samples, "cycles of load", |it| it.cycle));
    all.push(Circumstance {
        names: vec!["loading", "unloading"],
        ..of(samples, "approach", |it| Some(f64::from(u8::from(it.is_unloading))))
    });
    all.retain(differs);
    all
}

fn of(samples: &[Sample], title: &str, value: impl Fn(&Sample) -> Option<f64>) -> Circumstance {
    let values = samples.iter().map(|sample| value(sample).unwrap_or(f64::NAN)).collect();
    Circumstance { title: title.to_owned(), values, names: Vec::new() }
}

fn load(samples: &[Sample], subject: &Subject<'_>) -> Circumstance {
    let title = subject.load_unit.map_or_else(|| "load".to_owned(), |unit| format!("load in {unit}"));
    of(samples, &title, |it| Some(it.load.iter().map(|n| n * n).sum::<f64>().sqrt()))
}

/// Where the shear points, counter-clockwise from x.
fn direction(samples: &[Sample]) -> Circumstance {
    let least = LEAST_SHEAR * rms(samples.iter().flat_map(|it| it.load));
    of(samples, "direction of the shear in °", |it| {
        let [fx, fy, _] = it.load;
        (fx.hypot(fy) > least).then(|| fy.atan2(fx).to_degrees())
    })
}

/// Time from the first row, in a unit that people count in.
fn time(samples: &[Sample]) -> Circumstance {
    let times = || samples.iter().filter_map(|it| it.t_s).filter(|it| it.is_finite());
    let [first, last] = [times().fold(f64::INFINITY, f64::min), times().fold(f64::NEG_INFINITY, f64::max)];
    let (unit_s, unit) = match last - first {
        span if span > 7200.0 => (3600.0, "h"),
        span if span > 120.0 => (60.0, "min"),
        _ => (1.0, "s"),
    };
    of(samples, &format!("time in {unit}"), |it| it.t_s.map(|t_s| (t_s - first) / unit_s))
}

/// Whether enough rows have different values.
fn differs(circumstance: &Circumstance) -> bool {
    let finite = || circumstance.values.iter().filter(|it| it.is_finite());
    let [low, high] = [
        finite().copied().fold(f64::INFINITY, f64::min),
        finite().copied().fold(f64::NEG_INFINITY, f64::max),
    ];
    finite().count() >= ROWS_MIN && high - low > 1e-9 * low.abs().max(high.abs())
}

/// Rows whose values lie together.
pub(super) struct Bin {
    /// Their median.
    pub(super) value: f64,
    pub(super) rows: Vec<usize>,
}

/// The middle nine tenths of the values lie in so many bins.
const BINS: f64 = 10.0;
/// A bin of fewer rows has no quantiles.
const ROWS_OF_BIN_MIN: usize = 4;

impl Circumstance {
    /// The rows in bins of equal width, each from a value on: so that rows of one written value, which scatter, stay together.
    pub(super) fn bins(&self) -> Vec<Bin> {
        let mut rows: Vec<usize> =
            (0..self.values.len()).filter(|row| self.values[*row].is_finite()).collect();
        rows.sort_by(|one, other| self.values[*one].total_cmp(&self.values[*other]));
        let width = self.width(&rows);
        let mut bins: Vec<Vec<usize>> = Vec::new();
        for row in rows {
            match bins.last_mut() {
                Some(last) if self.values[row] - self.values[last[0]] < width => last.push(row),
                _ => bins.push(vec![row]),
            }
        }
        let bins = bins.into_iter().filter(|rows| rows.len() >= ROWS_OF_BIN_MIN);
        bins.map(|rows| Bin { value: self.values[rows[rows.len() / 2]], rows }).collect()
    }

    /// Width of a bin, without the values farthest out; `rows` are in the order of their values.
    fn width(&self, rows: &[usize]) -> f64 {
        let Some(last) = rows.len().checked_sub(1) else { return 0.0 };
        let span = |share: f64| {
            let aside = (share * last as f64) as usize;
            self.values[rows[last - aside]] - self.values[rows[aside]]
        };
        if span(0.05) > 0.0 { span(0.05) / BINS } else { span(0.0) / BINS }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn circumstance(values: Vec<f64>) -> Circumstance {
        Circumstance { title: String::new(), values, names: Vec::new() }
    }

    #[test]
    fn values_that_scatter_about_one_stay_together() {
        let steps = circumstance((0..400).map(|at| f64::from(at % 4) + 1e-4 * f64::from(at)).collect());
        let values: Vec<f64> = steps.bins().iter().map(|bin| bin.value.round()).collect();
        assert_eq!(values, [0.0, 1.0, 2.0, 3.0]);
        let even = circumstance((0..1000).map(f64::from).collect());
        assert!((10..=12).contains(&even.bins().len()), "{}", even.bins().len());
        assert!(even.bins().iter().all(|bin| bin.rows.len() > 50));
        assert!(circumstance(vec![f64::NAN; 50]).bins().is_empty());
    }

    #[test]
    fn what_does_not_differ_is_left_out() {
        assert!(!differs(&circumstance(vec![3.0; 100])));
        assert!(!differs(&circumstance(vec![f64::NAN; 100])));
        assert!(differs(&circumstance((0..100).map(f64::from).collect())));
    }
}
