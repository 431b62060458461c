//! Noise that is larger than it should be.
//!
//! No device states what each of its channels should have, so each is held against the others. Sound channels have a part of noise
//! that is the same in all and one that goes with the signal: ln σ = ln b √(r² + S²) + e with S the signal's root mean square and
//! r = a/b. They differ by the standard deviation [`NATURAL`] of e, or by what the others differ by where that is no chance. Static
//! samples and series, where each has its own noise, are looked at apart; what counts is the kind that tells more.
//!
//! Where an earlier recording knows each channel's noise, it is held against that: there all channels may be loud together.

use crate::diagnosis::data::target::Target;
use crate::diagnosis::report::{Estimate, Finding, NotDetected, Notice};
use crate::effect::Effect;
use tactpad_inference::noise::Noise;
use tactpad_inference::observations::Observations;
use tactpad_inference::policy::{POWER_QUANTILE, WITHIN_95};
use tactpad_numeric::chi_square;
use tactpad_numeric::statistics::{mean, rms};

/// Standard deviation by which the logarithms of sound channels' noise differ at least.
const NATURAL: f64 = 0.3;
/// Below this probability the others differ by more than that.
const WIDER: f64 = 0.05;
/// How often any channel of a sound pad may be found.
const LEVEL: f64 = 0.01;
/// How many ratios are tried, and how far beyond the least and largest signal, as a logarithm.
const RATIOS: usize = 40;
const BEYOND: f64 = 2.3;
/// Fewest others to hold a channel against.
const OTHERS_MIN: usize = 4;

/// Excess noise of the channels.
#[derive(Clone, Debug, Default)]
pub(crate) struct Excess {
    pub(crate) notices: Vec<Notice>,
    pub(crate) findings: Vec<Finding>,
    pub(crate) not_detected: Vec<NotDetected>,
}

impl Excess {
    /// What it says of some channels: what has no name in the others looks like noise.
    pub(crate) fn of_channels(mut self, is_asked: impl Fn(usize) -> bool) -> Self {
        self.findings.retain(|it| matches!(it.target, Target::Channel(channel) if is_asked(channel)));
        self.notices.retain(|it| it.channel.is_some_and(&is_asked));
        self
    }
}

/// A channel's noise and signal, as logarithms.
#[derive(Clone, Copy)]
struct Level {
    channel: usize,
    signal: f64,
    noise: f64,
    /// Variance by which so many rows know it.
    variance: f64,
}

/// A channel's noise beside what the others let expect, as logarithms.
#[derive(Clone, Copy)]
struct NoiseExcess {
    noise: f64,
    excess: f64,
    variance: f64,
}

/// Holds the channels' noise against each other; `signals` are the readings that the fit expects.
pub(crate) fn excess(observations: &Observations, noise: &[Noise], signals: &[Vec<f64>]) -> Excess {
    let kinds = if noise.iter().any(Noise::is_by_kind) {
        vec![vec![false], vec![true]]
    } else {
        vec![vec![false, true]]
    };
    let by_kind: Vec<Vec<Level>> = kinds
        .iter()
        .map(|kinds| {
            let all = noise.iter().zip(signals).enumerate();
            all.filter_map(|it| level(observations, it, kinds)).collect::<Vec<Level>>()
        })
        .filter(|levels| levels.len() > OTHERS_MIN)
        .collect();
    let all = (0..noise.len()).filter_map(|channel| Some((channel, beside(&by_kind, channel)?))).collect();
    told(observations, all, "the other channels let expect")
}

/// What is said of channels whose noise is known beside what is expected by `whom`.
fn told(observations: &Observations, all: Vec<(usize, NoiseExcess)>, whom: &str) -> Excess {
    let mut found = Excess::default();
    let critical = chi_square::quantile(2.0 * LEVEL / all.len() as f64, 1).sqrt();
    for (channel, own) in all {
        let deviation = own.variance.sqrt();
        if own.excess > critical * deviation {
            found.findings.push(finding(channel, own.excess, deviation));
            found.notices.push(notice(observations, channel, &own, whom));
        } else {
            found.not_detected.push(NotDetected {
                effect: Effect::NoiseExcess,
                target: Target::Channel(channel),
                minimum_detectable: vec![(
                    "factor",
                    libm::exp((critical + POWER_QUANTILE) * deviation) - 1.0,
                )],
                rival_share: 0.0,
            });
        }
    }
    found
}

/// Holds the channels' noise against what it was: for each channel the mean square that is expected of these rows and its relative variance;
/// none where that is not known.
pub(crate) fn excess_over(
    observations: &Observations,
    noise: &[Noise],
    signals: &[Vec<f64>],
    expected: &[Option<[f64; 2]>],
) -> Excess {
    let of_channel = |channel: usize| {
        let [square, variance] = expected[channel]?;
        let own = level(observations, (channel, (&noise[channel], &signals[channel])), &[false, true])?;
        let variance = NATURAL * NATURAL + own.variance + 0.25 * variance;
        Some((channel, NoiseExcess { noise: own.noise, excess: own.noise - 0.5 * square.ln(), variance }))
    };
    told(observations, (0..noise.len()).filter_map(of_channel).collect(), "the earlier recording lets expect")
}

/// A channel's level in rows of these kinds.
fn level(
    observations: &Observations,
    (channel, (noise, signal)): (usize, (&Noise, &Vec<f64>)),
    kinds: &[bool],
) -> Option<Level> {
    let rows = signal.iter().zip(&observations.samples).zip(&observations.is_told[channel]);
    let told = rows.filter(|((_, sample), is_told)| **is_told && kinds.contains(&sample.is_in_series()));
    let (signal, in_series): (Vec<f64>, Vec<bool>) =
        told.map(|((signal, sample), _)| (*signal, sample.is_in_series())).unzip();
    let level = Level {
        channel,
        signal: rms(signal.iter().copied()).ln(),
        noise: 0.5 * noise.mean_square(&signal, &in_series).ln(),
        variance: 0.5 / signal.len() as f64,
    };
    (level.signal.is_finite() && level.noise.is_finite()).then_some(level)
}

/// A channel's noise beside what the others let expect, in the kind of row that tells it best.
fn beside(by_kind: &[Vec<Level>], channel: usize) -> Option<NoiseExcess> {
    let of_kind = |levels: &Vec<Level>| {
        let own = levels.iter().find(|it| it.channel == channel)?;
        let others: Vec<Level> = levels.iter().filter(|it| it.channel != channel).copied().collect();
        let [should, variance] = predicted(&others, own);
        Some(NoiseExcess { noise: own.noise, excess: own.noise - should, variance: variance + own.variance })
    };
    by_kind.iter().filter_map(of_kind).min_by(|one, other| one.variance.total_cmp(&other.variance))
}

/// What a channel's noise should be by others', and the variance by which sound ones differ from that: the mean over the
/// ratios a/b, each as likely as the others make it.
fn predicted(others: &[Level], own: &Level) -> [f64; 2] {
    let by = |ratio: f64| {
        // ln √(r² + S²), of which the constant part is the same in all.
        let shape = |it: &Level| 0.5 * libm::log(ratio * ratio + libm::exp(2.0 * it.signal));
        let level = mean(others.iter().map(|it| it.noise - shape(it)));
        let square: f64 = others.iter().map(|it| (it.noise - shape(it) - level).powi(2)).sum();
        [level + shape(own), square]
    };
    let signals = || others.iter().chain([own]).map(|it| it.signal);
    let (low, high) = (signals().fold(f64::MAX, f64::min), signals().fold(f64::MIN, f64::max));
    // From a noise that is all in proportion to the signal to one that is the same everywhere.
    let steps = (0..=RATIOS).map(|step| step as f64 / RATIOS as f64);
    let tried: Vec<[f64; 2]> =
        steps.map(|part| by(libm::exp(low - BEYOND + part * (high - low + 2.0 * BEYOND)))).collect();
    let least = tried.iter().map(|[_, square]| *square).fold(f64::MAX, f64::min);
    let freedom = others.len() - 1;
    let natural = NATURAL * NATURAL;
    let is_wider = chi_square::exceeded(least / natural, freedom) < WIDER;
    let variance = if is_wider { least / freedom as f64 } else { natural };
    let weights: Vec<f64> =
        tried.iter().map(|[_, square]| libm::exp(0.5 * (least - square) / variance)).collect();
    let whole: f64 = weights.iter().sum();
    let over = |of: &dyn Fn(f64) -> f64| {
        tried.iter().zip(&weights).map(|([should, _], weight)| weight * of(*should)).sum::<f64>() / whole
    };
    let should = over(&|it| it);
    let by_ratio = over(&|it| (it - should).powi(2));
    [should, variance * (1.0 + 1.0 / others.len() as f64) + by_ratio]
}

fn finding(channel: usize, excess: f64, deviation: f64) -> Finding {
    let within = WITHIN_95 * deviation;
    Finding {
        effect: Effect::NoiseExcess,
        target: Target::Channel(channel),
        parameters: vec![Estimate {
            name: "factor",
            value: libm::exp(excess),
            interval95: [-within, within].map(|by| libm::exp(excess + by)),
        }],
        shapes: Vec::new(),
        p_value: 0.5 * chi_square::exceeded((excess / deviation).powi(2), 1),
        share: 0.0,
        confounded_with: Vec::new(),
        separate_by: None,
        labels: None,
    }
}

fn notice(observations: &Observations, channel: usize, own: &NoiseExcess, whom: &str) -> Notice {
    let detail = format!(
        "{} has {:.1} times the noise that {whom}: {:.1} instead of {:.1}; its rows keep as little weight \
         as that; look at its wires, and at its spectrum in a series at rest",
        observations.channels.get(channel).map_or("?", String::as_str),
        libm::exp(own.excess),
        libm::exp(own.noise),
        libm::exp(own.noise - own.excess)
    );
    Notice { check: "noise", channel: Some(channel), detail }
}

#[cfg(test)]
mod tests {
    use super::*;
    use tactpad_inference::observations::Sample;
    use tactpad_numeric::random::SplitMix64;

    /// Nine channels of signals between 100 and 4,000, the fifth with so many times its noise of 0.2 to 0.8 % each; half of the rows
    /// are of series, whose noise is `of_series` times as large, and in which the first channel has ten times its signal.
    fn found(seed: u64, factor: f64, of_series: f64) -> Excess {
        let mut random = SplitMix64::new(seed);
        let mut between = |low: f64, high: f64| low + (high - low) * f64::from(random.fraction());
        let (mut noise, mut signals) = (Vec::new(), Vec::new());
        let in_series = |row: usize| row >= 200;
        for channel in 0..9 {
            let size = between(100.0, 4000.0);
            let times =
                |row: usize| if channel == 0 && of_series > 1.0 && in_series(row) { 10.0 } else { 1.0 };
            let signal: Vec<f64> = (0..400).map(|row| size * times(row) * libm::sin(row as f64)).collect();
            let own = if channel == 4 { factor } else { 1.0 };
            let level =
                [between(0.002, 0.008) * size * 0.5_f64.sqrt(), between(0.002, 0.008)].map(|it| own * it);
            noise.push(Noise::known([level, level.map(|it| of_series * it)]));
            signals.push(signal);
        }
        let sample = |row: usize| Sample { trial: in_series(row).then_some(0), ..Sample::default() };
        let observations = Observations {
            is_told: vec![vec![true; 400]; 9],
            samples: (0..400).map(sample).collect(),
            ..Observations::default()
        };
        excess(&observations, &noise, &signals)
    }

    #[test]
    fn sound_channels_differ_and_a_loud_one_is_told() {
        for of_series in [1.0, 5.0] {
            let alarms = (0..400).filter(|seed| !found(*seed, 1.0, of_series).findings.is_empty()).count();
            assert!(alarms <= 8, "{alarms} of 400");
        }
        let right = |it: &Excess| it.findings.len() == 1 && it.findings[0].target == Target::Channel(4);
        let told = |factor: f64| (0..400).filter(|seed| right(&found(*seed, factor, 1.0))).count();
        assert!(told(3.0) > 200 && told(5.0) > 360, "{} and {} of 400", told(3.0), told(5.0));
        let holds = |it: &Excess| it.findings[0].parameters[0].interval95;
        let loud: Vec<Excess> = (0..400).map(|seed| found(seed, 5.0, 1.0)).filter(right).collect();
        let covered = loud.iter().filter(|it| holds(it)[0] <= 5.0 && holds(it)[1] >= 5.0).count();
        assert!(covered as f64 > 0.9 * loud.len() as f64, "{covered} of {}", loud.len());
    }
}
