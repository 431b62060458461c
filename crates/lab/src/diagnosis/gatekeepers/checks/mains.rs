//! The mains in a channel's time series: a line near 50 or 60 Hz, or where the sampling folds it to.
//!
//! What a stretch's line takes off the squares, S, is held against the mean σ² per degree of freedom that frequencies nearby take
//! off, so that noise with a memory passes. With d such degrees of freedom S/2σ² is F distributed with 2 and d, and
//! d ln(1 + S/(d σ²)) is χ² with two; that adds up over the stretches. A line that the loads have as well is the press's own.
//!
//! Source: R. A. Fisher, Statistical Methods for Research Workers (1925), 21.1 (combined tests).

use super::line::{RowRun, Waves};
use crate::diagnosis::data::target::Target;
use crate::diagnosis::gatekeepers::gate::{Gate, LEVEL};
use crate::diagnosis::report::{Estimate, NotDetected, NotTestable};
use crate::effect::Effect;
use tactpad_core::counted::counted;
use tactpad_inference::policy::{POWER, WITHIN_95};
use tactpad_numeric::chi_square;
use tactpad_numeric::statistics::mean;

/// The grids' frequencies, and how far from them the mains are looked for.
const GRIDS_HZ: [f64; 2] = [50.0, 60.0];
const NEAR_HZ: f64 = 0.5;
/// Where noise is taken from.
const BESIDE_HZ: [f64; 2] = [1.0, 3.0];
/// Fewest and most samples of a stretch, and how long it takes at most.
const SAMPLES: [usize; 2] = [24, 256];
const SPAN_MAX_S: f64 = 10.0;
/// Stretches that a search looks at; of more, so many are picked evenly.
const STRETCHES_MAX: usize = 48;
/// Frequencies to look at within a stretch's resolution 1/T.
const PER_RESOLUTION: f64 = 4.0;
/// Another grid that explains this part as well cannot be told apart.
const ALIKE: f64 = 0.9;

/// A grid's frequencies, and each one's waves in the stretches that tell it.
struct Comb {
    grid_hz: f64,
    /// Frequencies to search, then those beside them.
    frequencies_hz: Vec<f64>,
    searched: usize,
    /// For each stretch and frequency.
    waves: Vec<Vec<Option<Waves>>>,
}

/// The noise of a stretch.
struct Noise {
    /// Which stretch.
    at: usize,
    /// For each degree of freedom.
    variance: f64,
    /// By how many it is known.
    freedom: f64,
}

/// A line as far as it was looked for in a channel.
struct Peak {
    grid_hz: f64,
    frequency_hz: f64,
    /// Of it, 95 % lie within.
    spread_hz: f64,
    square: f64,
    p_value: f64,
    amplitude: f64,
    spread: f64,
    /// Amplitude that is found in nine of ten.
    least: f64,
}

pub(crate) fn check(gate: &mut Gate) {
    let stretches = stretches(gate);
    let combs: Vec<Comb> = GRIDS_HZ.iter().filter_map(|grid| Comb::of(*grid, &picked(&stretches))).collect();
    if combs.is_empty() {
        gate.not_testable.push(NotTestable { effect: Effect::MainsPickup, needs: "trial" });
        return;
    }
    let asked = (gate.channels() * combs.iter().map(|comb| comb.searched).sum::<usize>()).max(1);
    let critical = LEVEL / asked as f64;
    let loads = loaded(gate, &stretches, &combs, critical);
    for channel in 0..gate.channels() {
        let residual = residual(gate, channel);
        let is_told = |it: &RowRun| it.rows.iter().all(|row| gate.observations.is_told[channel][*row]);
        let told: Vec<bool> = picked(&stretches).iter().map(|it| is_told(it)).collect();
        let own = picked(&stretches);
        let mut peaks: Vec<Peak> =
            combs.iter().filter_map(|comb| comb.peak(&own, &told, &residual, critical)).collect();
        peaks.sort_by(|one, other| other.square.total_cmp(&one.square));
        let Some(peak) = peaks.first() else { continue };
        if peak.p_value < critical && !loads.contains(&peak.grid_hz) {
            take_out(gate, channel, &stretches, &residual, &peaks);
        } else {
            let least = peaks.iter().map(|peak| peak.least).fold(0.0, f64::max);
            gate.not_detected.push(NotDetected {
                effect: Effect::MainsPickup,
                target: Target::Channel(channel),
                minimum_detectable: vec![("amplitude_uv", least)],
                rival_share: 0.0,
            });
        }
    }
}

/// The grids whose line is in the loads, too.
fn loaded(gate: &Gate, stretches: &[RowRun], combs: &[Comb], critical: f64) -> Vec<f64> {
    let own = picked(stretches);
    let told = vec![true; own.len()];
    let has_line = |comb: &&Comb| {
        (0..3).any(|axis| {
            let load: Vec<f64> = gate.observations.samples.iter().map(|sample| sample.load[axis]).collect();
            comb.peak(&own, &told, &load, critical).is_some_and(|peak| peak.p_value < critical)
        })
    };
    combs.iter().filter(has_line).map(|comb| comb.grid_hz).collect()
}

/// Residual of a channel beside the model.
fn residual(gate: &Gate, channel: usize) -> Vec<f64> {
    let rows: Vec<usize> = (0..gate.observations.rows()).collect();
    let readings = gate.readings(channel, &rows);
    let Some(expected) = gate.expected(channel, &rows) else { return readings };
    readings.iter().zip(expected).map(|(y, f)| y - f).collect()
}

/// The series in stretches.
fn stretches(gate: &Gate) -> Vec<RowRun> {
    let mut stretches = Vec::new();
    for series in gate.series() {
        let mut rest = series.as_slice();
        while let Some(first) = rest.first() {
            let end_s = gate.t_s(*first) + SPAN_MAX_S;
            let within = rest.partition_point(|row| gate.t_s(*row) <= end_s).clamp(1, SAMPLES[1]);
            let (rows, after) = rest.split_at(within);
            if rows.len() >= SAMPLES[0] {
                stretches.push(RowRun::of(rows.to_vec(), rows.iter().map(|row| gate.t_s(*row)).collect()));
            }
            rest = after;
        }
    }
    stretches.retain(|stretch| stretch.span_s() > 0.0 && stretch.span_s() <= SPAN_MAX_S);
    stretches
}

fn picked(stretches: &[RowRun]) -> Vec<&RowRun> {
    stretches.iter().step_by(stretches.len().div_ceil(STRETCHES_MAX).max(1)).collect()
}

fn of_rows(values: &[f64], stretch: &RowRun) -> Vec<f64> {
    stretch.rows.iter().map(|row| values[*row]).collect()
}

impl Comb {
    /// `None` if no stretch sees the grid.
    fn of(grid_hz: f64, stretches: &[&RowRun]) -> Option<Self> {
        let span_s = stretches.iter().map(|it| it.span_s()).fold(f64::NAN, f64::max);
        let step = 1.0 / (PER_RESOLUTION * span_s.max(1.0));
        let steps = |from: f64, to: f64| {
            ((from / step).ceil() as i64..=(to / step).floor() as i64).map(move |k| k as f64 * step)
        };
        let mut frequencies_hz: Vec<f64> = steps(-NEAR_HZ, NEAR_HZ).map(|by| grid_hz + by).collect();
        let searched = frequencies_hz.len();
        let [near, far] = BESIDE_HZ;
        frequencies_hz.extend(steps(-far, -near).chain(steps(near, far)).map(|by| grid_hz + by));
        let waves: Vec<Vec<Option<Waves>>> =
            stretches.iter().map(|it| frequencies_hz.iter().map(|hz| it.waves(*hz)).collect()).collect();
        let is_seen = waves.iter().any(|of| of[..searched].iter().any(Option::is_some));
        is_seen.then_some(Self { grid_hz, frequencies_hz, searched, waves })
    }

    /// The largest line of the grid in `values`, by the stretches in which the channel is `told`; none where no stretch tells it.
    fn peak(&self, stretches: &[&RowRun], told: &[bool], values: &[f64], critical: f64) -> Option<Peak> {
        let cut: Vec<Vec<f64>> = stretches.iter().map(|it| of_rows(values, it)).collect();
        let told = (0..cut.len()).filter(|at| told[*at]);
        let usable: Vec<Noise> = told.filter_map(|at| self.noise(at, stretches[at], &cut[at])).collect();
        let squares: Vec<[f64; 2]> =
            (0..self.frequencies_hz.len()).map(|at| self.square(at, &usable, &cut)).collect();
        let beside = squares[self.searched..].iter().filter(|it| it[1] > 0.0);
        let scale = mean(beside.map(|[square, freedom]| square / freedom));
        let at = (0..self.searched).max_by(|one, other| squares[*one][0].total_cmp(&squares[*other][0]))?;
        let [square, freedom] = squares[at];
        if scale.is_nan() || scale <= 0.0 || freedom <= 0.0 {
            return None;
        }
        let total = |hz: f64| -> f64 {
            let of = |it: &Noise| Some(stretches[it.at].waves(hz)?.square(&cut[it.at]) / it.variance);
            usable.iter().filter_map(of).sum()
        };
        let step_hz = self.frequencies_hz[1] - self.frequencies_hz[0];
        let (frequency_hz, curvature) = top(self.frequencies_hz[at], step_hz, &total);
        let part = |it: &Noise| {
            let waves = stretches[it.at].waves(frequency_hz)?;
            Some([waves.amplitude(&cut[it.at]), waves.weight() / it.variance])
        };
        let parts: Vec<[f64; 2]> = usable.iter().filter_map(part).collect();
        let [amplitude, weight] = joint_amplitude(&parts);
        Some(Peak {
            grid_hz: self.grid_hz,
            frequency_hz,
            spread_hz: WITHIN_95 * (2.0 / curvature).sqrt(),
            square: square / scale,
            p_value: chi_square::exceeded(square / scale, freedom as usize),
            amplitude,
            spread: WITHIN_95 / weight.sqrt(),
            least: (noncentrality(critical, freedom as usize) / weight).sqrt(),
        })
    }

    /// A stretch's noise per degree of freedom, and how many it is known by.
    fn noise(&self, at: usize, stretch: &RowRun, values: &[f64]) -> Option<Noise> {
        let beside: Vec<f64> = self.waves[at][self.searched..]
            .iter()
            .flatten()
            .map(|waves| 0.5 * waves.square(values))
            .collect();
        let step_hz = self.frequencies_hz[1] - self.frequencies_hz[0];
        let freedom = 2.0 * (beside.len() as f64 * step_hz * stretch.span_s()).max(1.0);
        let variance = mean(beside);
        (variance > 0.0).then_some(Noise { at, variance, freedom })
    }

    /// The sum of the stretches' χ², and its degrees of freedom.
    fn square(&self, frequency: usize, usable: &[Noise], cut: &[Vec<f64>]) -> [f64; 2] {
        let of = |noise: &Noise| {
            let square = self.waves[noise.at][frequency].as_ref()?.square(&cut[noise.at]);
            Some(noise.freedom * (square / (noise.freedom * noise.variance)).ln_1p())
        };
        usable.iter().filter_map(of).fold([0.0; 2], |[sum, freedom], it| [sum + it, freedom + 2.0])
    }
}

/// The amplitude that stretches have together, and its weight. Rice's mean is A + σ²/(2A).
fn joint_amplitude(parts: &[[f64; 2]]) -> [f64; 2] {
    let weight: f64 = parts.iter().map(|[_, weight]| weight).sum();
    let unbiased =
        |[amplitude, weight]: &[f64; 2]| weight * amplitude - 0.5 / amplitude.max(f64::MIN_POSITIVE);
    [parts.iter().map(unbiased).sum::<f64>().max(0.0) / weight, weight]
}

/// λ at which χ² passes its critical value in nine of ten: exact for few degrees of freedom, by the normal law for many.
fn noncentrality(critical: f64, freedom: usize) -> f64 {
    if freedom <= 64 {
        return chi_square::noncentrality(chi_square::quantile(critical, freedom), freedom, POWER);
    }
    let deviations =
        chi_square::quantile(2.0 * critical, 1).sqrt() + chi_square::quantile(2.0 - 2.0 * POWER, 1).sqrt();
    deviations * (2.0 * freedom as f64).sqrt()
}

/// The maximum near a frequency by parabolas, and minus the second derivative there.
fn top(mut frequency_hz: f64, step_hz: f64, total: &dyn Fn(f64) -> f64) -> (f64, f64) {
    let mut curvature = 0.0;
    let mut step_hz = 0.5 * step_hz;
    for _ in 0..4 {
        let [below, here, above] = [-step_hz, 0.0, step_hz].map(|by| total(frequency_hz + by));
        curvature = (2.0 * here - below - above) / (step_hz * step_hz);
        if curvature <= 0.0 || curvature.is_nan() {
            return (frequency_hz, f64::MIN_POSITIVE);
        }
        frequency_hz += (0.5 * (above - below) / (step_hz * curvature)).clamp(-step_hz, step_hz);
        step_hz *= 0.5;
    }
    (frequency_hz, curvature)
}

/// Takes the largest line out of a channel, and says so.
fn take_out(gate: &mut Gate, channel: usize, stretches: &[RowRun], residual: &[f64], peaks: &[Peak]) {
    let Some(peak) = peaks.first() else { return };
    let mut rows = 0;
    let share = gate.mended(|gate| {
        for stretch in stretches {
            let Some(line) = stretch.line(peak.frequency_hz, &of_rows(residual, stretch)) else { continue };
            rows += stretch.rows.len();
            for (row, line) in stretch.rows.iter().zip(line) {
                gate.observations.readings[channel][*row] -= line;
            }
        }
    });
    let alike = peaks.iter().skip(1).find(|other| other.square > ALIKE * peak.square);
    let alike = alike
        .map(|other| format!("; at this rate {:.0} Hz would look the same", other.grid_hz))
        .unwrap_or_default();
    let detail = format!(
        "{} has a line of {:.1} at {:.2} Hz{alike}; it is taken out of {} of time series; twist and shield the pair, or sample \
         at another rate to see it move",
        gate.name(channel),
        peak.amplitude,
        peak.frequency_hz,
        counted(rows, "row")
    );
    let within = |value: f64, spread: f64| [(value - spread).max(0.0), value + spread];
    let estimates = vec![
        Estimate {
            name: "amplitude_uv",
            value: peak.amplitude,
            interval95: within(peak.amplitude, peak.spread),
        },
        Estimate {
            name: "frequency_hz",
            value: peak.frequency_hz,
            interval95: within(peak.frequency_hz, peak.spread_hz),
        },
    ];
    gate.notice("mains", Some(channel), detail);
    gate.find(Effect::MainsPickup, Target::Channel(channel), peak.p_value, share).parameters = estimates;
}
