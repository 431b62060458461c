//! Noise that is larger than it should be.
//!
//! No device states what each of its channels should have, so each is held against the others. Noise goes with the signal or is
//! the same in all channels: ln σ = a + b ln S + e, where b is 1 or 0, whichever leaves the others nearer together. Sound channels
//! differ by the standard deviation [`NATURAL`] of e, or by what the others differ by where that is no chance.

use crate::lab::diagnosis::noise::NoiseLevel;
use crate::lab::diagnosis::observations::Observations;
use crate::lab::diagnosis::report::{Estimate, Finding, NotDetected, Notice};
use crate::lab::diagnosis::target::Target;
use crate::numeric::chi_square;
use crate::numeric::statistics::{mean, rms};

/// Standard deviation by which the logarithms of sound channels' noise differ at least.
const NATURAL: f64 = 0.3;
/// Below this probability the others differ by more than that.
const WIDER: f64 = 0.05;
/// How often any channel of a sound pad may be found.
const LEVEL: f64 = 0.01;
/// Fewest others to hold a channel against.
const OTHERS_MIN: usize = 4;
/// Normal quantiles: of 95 %, and of nine in ten.
const WITHIN_95: f64 = 1.959_964;
const POWER_90: f64 = 1.281_552;

/// Its name in reports.
pub(crate) const EFFECT: &str = "noise_excess";

/// What the noise of the channels says.
#[derive(Clone, Debug, Default)]
pub(crate) struct Excess {
    pub(crate) notices: Vec<Notice>,
    pub(crate) findings: Vec<Finding>,
    pub(crate) not_detected: Vec<NotDetected>,
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

/// Holds the channels' noise against each other; `signals` are the readings that the fit expects.
pub(crate) fn excess(observations: &Observations, noise: &[NoiseLevel], signals: &[Vec<f64>]) -> Excess {
    let levels: Vec<Level> =
        noise.iter().zip(signals).enumerate().filter_map(|it| level(observations, it)).collect();
    let mut found = Excess::default();
    if levels.len() <= OTHERS_MIN {
        return found;
    }
    let critical = chi_square::quantile(2.0 * LEVEL / levels.len() as f64, 1).sqrt();
    for own in &levels {
        let others: Vec<Level> = levels.iter().filter(|it| it.channel != own.channel).copied().collect();
        let [should, variance] = predicted(&others, own.signal);
        let deviation = (variance + own.variance).sqrt();
        let excess = own.noise - should;
        if excess > critical * deviation {
            found.findings.push(finding(own.channel, excess, deviation));
            found.notices.push(notice(observations, own, excess));
        } else {
            found.not_detected.push(NotDetected {
                effect: EFFECT,
                target: Target::Channel(own.channel),
                minimum_detectable: vec![("factor", libm::exp((critical + POWER_90) * deviation) - 1.0)],
                rival_share: 0.0,
            });
        }
    }
    found
}

fn level(
    observations: &Observations,
    (channel, (noise, signal)): (usize, (&NoiseLevel, &Vec<f64>)),
) -> Option<Level> {
    let told = signal.iter().zip(&observations.is_told[channel]).filter(|(_, is_told)| **is_told);
    let signal: Vec<f64> = told.map(|(signal, _)| *signal).collect();
    let level = Level {
        channel,
        signal: rms(signal.iter().copied()).ln(),
        noise: 0.5 * noise.mean_square(&signal).ln(),
        variance: 0.5 / signal.len() as f64,
    };
    (level.signal.is_finite() && level.noise.is_finite()).then_some(level)
}

/// What a channel's noise should be by others', and the variance by which sound ones differ from that.
fn predicted(others: &[Level], signal: f64) -> [f64; 2] {
    let by = |slope: f64| {
        let level = mean(others.iter().map(|it| it.noise - slope * it.signal));
        let square: f64 = others.iter().map(|it| (it.noise - slope * it.signal - level).powi(2)).sum();
        (level + slope * signal, square)
    };
    let [alike, relative] = [by(0.0), by(1.0)];
    let (should, square) = if alike.1 < relative.1 { alike } else { relative };
    let natural = NATURAL * NATURAL;
    let freedom = others.len() - 1;
    let is_wider = chi_square::exceeded(square / natural, freedom) < WIDER;
    let variance = if is_wider { square / freedom as f64 } else { natural };
    [should, variance * (1.0 + 1.0 / others.len() as f64)]
}

fn finding(channel: usize, excess: f64, deviation: f64) -> Finding {
    let within = WITHIN_95 * deviation;
    Finding {
        effect: EFFECT,
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
    }
}

fn notice(observations: &Observations, level: &Level, excess: f64) -> Notice {
    let detail = format!(
        "{} has {:.1} times the noise that the other channels let expect: {:.1} instead of {:.1}; its rows keep as little weight \
         as that; look at its wires, and at its spectrum in a series at rest",
        observations.channels.get(level.channel).map_or("?", String::as_str),
        libm::exp(excess),
        libm::exp(level.noise),
        libm::exp(level.noise - excess)
    );
    Notice { check: "noise", channel: Some(level.channel), detail }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numeric::random::SplitMix64;

    /// Nine channels of signals between 100 and 4,000, the fifth with so many times its noise of 0.2 to 0.8 % each.
    fn found(seed: u64, factor: f64) -> Excess {
        let mut random = SplitMix64::new(seed);
        let mut between = |low: f64, high: f64| low + (high - low) * f64::from(random.fraction());
        let (mut noise, mut signals) = (Vec::new(), Vec::new());
        for channel in 0..9 {
            let size = between(100.0, 4000.0);
            let signal: Vec<f64> = (0..400).map(|row| size * libm::sin(f64::from(row))).collect();
            let mut level = NoiseLevel::first(&signal);
            let times = if channel == 4 { factor } else { 1.0 };
            level.additive = times * between(0.002, 0.008) * size * 0.5_f64.sqrt();
            level.share = times * between(0.002, 0.008);
            noise.push(level);
            signals.push(signal);
        }
        let observations = Observations { is_told: vec![vec![true; 400]; 9], ..Observations::default() };
        excess(&observations, &noise, &signals)
    }

    #[test]
    fn sound_channels_differ_and_a_loud_one_is_told() {
        let alarms = (0..400).filter(|seed| !found(*seed, 1.0).findings.is_empty()).count();
        assert!(alarms <= 8, "{alarms} of 400");
        let right = |it: &Excess| it.findings.len() == 1 && it.findings[0].target == Target::Channel(4);
        let told = |factor: f64| (0..400).filter(|seed| right(&found(*seed, factor))).count();
        assert!(told(3.0) > 200 && told(5.0) > 380, "{} and {} of 400", told(3.0), told(5.0));
        let holds = |it: &Excess| it.findings[0].parameters[0].interval95;
        let loud: Vec<Excess> = (0..400).map(|seed| found(seed, 5.0)).filter(right).collect();
        let covered = loud.iter().filter(|it| holds(it)[0] <= 5.0 && holds(it)[1] >= 5.0).count();
        assert!(covered as f64 > 0.9 * loud.len() as f64, "{covered} of {}", loud.len());
    }
}
