//! The pad's own dynamics in series with the mean filter: what a step of force becomes before it is sampled.

use std::f64::consts::{FRAC_1_SQRT_2, PI};

use serde::Serialize;

use super::filter;
use super::procedures::RATE_HZ;
use super::response::crossing;
use crate::damping::{DAMPING_RANGE, DAMPING_RATIO};
use tactpad_core::quantity::CHANNELS;
use tactpad_mechanics::vibration::NaturalMotion;
use tactpad_numeric::oscillator::Oscillator;
use tactpad_numeric::statistics::{mean, population_deviation};

/// Instants between two samples at which the step is tried.
const PHASES: usize = 200;

/// Samples after the step: the filter has seen the whole of it, and any ringing is over.
const SAMPLES: usize = 3 * filter::WINDOW;

/// A natural motion, and its part in the output.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Ringing {
    /// Its frequency.
    pub frequency_hz: f64,
    /// What the plate does.
    pub kind: &'static str,
    /// Its share in what the three z channels together read at rest of a press in the middle. Shares of all motions add
    /// up to 1; some are negative.
    pub output_share: f64,
}

/// What a step becomes: means over all instants between two samples at which it may come, and their standard deviations.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct InSeries {
    /// From the step to half of the output's.
    pub delay_ms: f64,
    /// Its standard deviation: over the instants of the step.
    pub delay_deviation_ms: f64,
    /// From 10 to 90 % of the output's step.
    pub rise_ms: f64,
    /// Its standard deviation.
    pub rise_deviation_ms: f64,
    /// Where the gain falls to 1/√2.
    pub bandwidth_hz: f64,
}

/// A pad's own dynamics, and what they do to the stream's.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PadDynamics {
    /// The slowest natural motions, from the slowest on.
    pub motions: Vec<Ringing>,
    /// The one that has the largest part in the output of a press in the middle; the step rings with it.
    pub dominating: Ringing,
    /// ζ of that motion.
    pub damping_ratio: f64,
    /// Between what ζ lies.
    pub damping_range: [f64; 2],
    /// By how much the plate itself overshoots, as a share of the step.
    pub overshoot: f64,
    /// When the plate itself stays within 2 % of the step.
    pub settling_ms: f64,
    /// Up to where the plate itself follows within ±3 dB.
    pub plate_bandwidth_hz: f64,
    /// Samples per second of the paper's stream.
    pub rate_hz: f64,
    /// A pad that follows at once, behind the filter.
    pub filter_alone: InSeries,
    /// This pad behind the filter.
    pub with_pad: InSeries,
    /// The same with the least and the greatest damping.
    pub with_pad_by_damping: [InSeries; 2],
}

impl PadDynamics {
    /// Of a pad with these motions; nothing if there is none.
    pub fn of_motions(motions: Vec<Ringing>) -> Option<Self> {
        let dominating = *motions.iter().max_by(|a, b| a.output_share.total_cmp(&b.output_share))?;
        let with = |damping_ratio| Oscillator { frequency_hz: dominating.frequency_hz, damping_ratio };
        let plate = with(DAMPING_RATIO);
        Some(Self {
            motions,
            dominating,
            damping_ratio: DAMPING_RATIO,
            damping_range: DAMPING_RANGE,
            overshoot: plate.overshoot(),
            settling_ms: 1e3 * plate.settling_s(),
            plate_bandwidth_hz: plate.bandwidth_hz(),
            rate_hz: RATE_HZ,
            filter_alone: in_series(None),
            with_pad: in_series(Some(plate)),
            with_pad_by_damping: DAMPING_RANGE.map(|ratio| in_series(Some(with(ratio)))),
        })
    }

    /// Of a pad with these natural motions, whose z channels together read `still_uv_per_n` of a press in the middle.
    pub fn of(motions: &[NaturalMotion], still_uv_per_n: f64) -> Option<Self> {
        let of_output = |motion: &NaturalMotion| {
            let [_, _, z0, _, _, z1, _, _, z2] = motion.still_uv_per_n([0.0; 2]);
            (z0 + z1 + z2) / still_uv_per_n
        };
        let ringing = |motion: &NaturalMotion| Ringing {
            frequency_hz: motion.frequency_hz,
            kind: motion.kind().name(),
            output_share: of_output(motion),
        };
        Self::of_motions(motions.iter().map(ringing).collect())
    }
}

/// The stream behind a pad that rings so, or that follows at once.
fn in_series(pad: Option<Oscillator>) -> InSeries {
    let interval_ms = 1e3 / RATE_HZ;
    let phases = (0..PHASES).map(|k| (k as f64 + 0.5) / PHASES as f64);
    // [delay, rise]; a response that misses a level shows as not finite.
    let found: Vec<[f64; 2]> = phases
        .map(|phase| {
            let response = response(pad, phase);
            let at = |level: f64| crossing(&response, level).unwrap_or(f64::NAN);
            // Sample WINDOW is the first one behind the step, `phase` of an interval after it.
            [at(0.5) - filter::WINDOW as f64 + phase, at(0.9) - at(0.1)].map(|samples| samples * interval_ms)
        })
        .collect();
    let [delays, rises] =
        [0, 1].map(|which: usize| found.iter().map(|both| both[which]).collect::<Vec<f64>>());
    InSeries {
        delay_ms: mean(&delays),
        delay_deviation_ms: population_deviation(&delays),
        rise_ms: mean(&rises),
        rise_deviation_ms: population_deviation(&rises),
        bandwidth_hz: bandwidth_hz(pad),
    }
}

/// The filtered samples of a step from 0 to 1, from [`filter::WINDOW`] of them before the step on.
fn response(pad: Option<Oscillator>, phase: f64) -> Vec<f64> {
    let follows = |t_s: f64| match pad {
        Some(pad) => pad.step(t_s),
        None => f64::from(u8::from(t_s >= 0.0)),
    };
    let samples: Vec<f64> = (0..filter::WINDOW + SAMPLES)
        .map(|k| follows((k as f64 - filter::WINDOW as f64 + phase) / RATE_HZ))
        .collect();
    filter::means(&samples, |sample| [*sample; CHANNELS]).map(|[mean, ..]| mean).collect()
}

/// Where |sin(πWf/fs) / (W sin(πf/fs))| times the pad's gain falls to 1/√2.
fn bandwidth_hz(pad: Option<Oscillator>) -> f64 {
    let window = filter::WINDOW as f64;
    let gain = |hz: f64| {
        let half_turn = PI * hz / RATE_HZ;
        let filter = ((window * half_turn).sin() / (window * half_turn.sin())).abs();
        filter * pad.map_or(1.0, |pad| pad.gain(hz))
    };
    // Below the filter's first zero, at fs/W, a pad that is much faster leaves the gain falling all the way.
    let [mut low, mut high] = [0.0, RATE_HZ / window];
    for _ in 0..60 {
        let middle = f64::midpoint(low, high);
        if gain(middle) > FRAC_1_SQRT_2 { low = middle } else { high = middle }
    }
    low
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_filter_alone_is_as_the_twin_finds_it() {
        let found = in_series(None);
        let interval_ms = 1e3 / RATE_HZ;
        assert!((found.delay_ms - 2.5 * interval_ms).abs() < 1e-9, "{found:?}");
        assert!((found.rise_ms - 4.8 * interval_ms).abs() < 1e-9 && found.rise_deviation_ms < 1e-9);
        // A step between two samples is seen at the later one: an even spread over an interval.
        assert!((found.delay_deviation_ms / (interval_ms / 12.0_f64.sqrt()) - 1.0).abs() < 0.01, "{found:?}");
        assert!((found.bandwidth_hz / RATE_HZ - 0.07477).abs() < 1e-4, "{found:?}");
    }

    #[test]
    fn a_fast_pad_changes_little_and_a_slow_one_much() {
        let alone = in_series(None);
        let pad = |frequency_hz, damping_ratio| in_series(Some(Oscillator { frequency_hz, damping_ratio }));
        let fast = pad(1e5, 0.5);
        assert!((fast.delay_ms - alone.delay_ms).abs() < 0.02, "{fast:?}");
        // A mass on a spring follows late by 2ζ/ω for slow changes; here by 11 ms.
        let slow = pad(20.0, 0.7);
        assert!(slow.delay_ms - alone.delay_ms > 7.0 && slow.delay_ms - alone.delay_ms < 15.0, "{slow:?}");
        let slower = pad(3.0, 0.7);
        assert!(slower.rise_ms > alone.rise_ms && slower.bandwidth_hz < alone.bandwidth_hz, "{slower:?}");
        // Below its resonance the pad gives a little more: by (f/f₀)².
        let rings = pad(735.0, 0.02);
        assert!(rings.bandwidth_hz > alone.bandwidth_hz);
        assert!(rings.bandwidth_hz / alone.bandwidth_hz - 1.0 < 1e-4, "{rings:?}");
    }

    #[test]
    fn the_motion_with_the_largest_part_dominates() {
        let motion = |frequency_hz, output_share| Ringing { frequency_hz, kind: "tilts", output_share };
        let found =
            PadDynamics::of_motions(vec![motion(600.0, 0.0), motion(700.0, 0.9), motion(900.0, -0.2)]);
        assert_eq!(found.unwrap().dominating.frequency_hz, 700.0);
        assert_eq!(PadDynamics::of_motions(vec![]), None);
    }
}
