//! Whether a device's behaviour can be: sums that no pad reaches, terms that are one, a converter without counts.

use super::finding::Finding;
use crate::pad::device::behaviour::Behaviour;
use crate::pad::device::unit::shown;
use crate::quantity::{CHANNEL_NAMES, CHANNELS, MODULES};

/// Sums of decimal fractions are off by less.
const ROUNDING: f64 = 1e-9;

pub(super) fn check(behaviour: &Behaviour, finding: &mut Finding<'_, '_>) {
    let leaks = behaviour.crosstalk.iter().map(|it| (it.channel, it.share));
    check_leaks(
        leaks,
        CHANNELS,
        "crosstalk",
        |channel| format!("channel {}", CHANNEL_NAMES[channel]),
        finding,
    );
    let leaks = behaviour.module_crosstalk.iter().map(|it| (it.module, it.share));
    check_leaks(leaks, MODULES, "module_crosstalk", |module| format!("module {module}"), finding);
    check_hysteresis(behaviour, finding);
    check_creep(behaviour, finding);
    check_converter(behaviour, finding);
}

/// What leaks into one of them must stay below its own signal, or they could not be told apart.
fn check_leaks(
    leaks: impl Iterator<Item = (usize, f64)>,
    count: usize,
    table: &str,
    name: impl Fn(usize) -> String,
    finding: &mut Finding<'_, '_>,
) {
    let mut sums = vec![0.0; count];
    for (index, (receiver, share)) in leaks.enumerate() {
        sums[receiver] += share.abs();
        if sums[receiver] >= 1.0 - ROUNDING {
            let message = format!("{} would hold as much of others as of itself", name(receiver));
            let help =
                format!("the sizes of its shares add up to {}; write less than 1", sum_shown(sums[receiver]));
            finding.refuse(&[&format!("{table}.{index}.share")], message, help);
        }
    }
}

/// A term of a sum, as the checks see it.
struct Term {
    channels: [bool; CHANNELS],
    /// What makes two terms one: the threshold or the time constant.
    place: f64,
    share: f64,
}

fn check_hysteresis(behaviour: &Behaviour, finding: &mut Finding<'_, '_>) {
    let terms = behaviour.hysteresis.iter();
    let terms: Vec<_> = terms
        .map(|it| Term { channels: it.channels, place: it.law.threshold, share: it.law.share })
        .collect();
    check_distinct(&terms, "hysteresis", "threshold_uv", finding);
    check_sums(
        &terms,
        "hysteresis",
        |sum| sum >= 1.0 - ROUNDING,
        finding,
        |channel, sum| {
            (
                format!("channel {channel} would not turn back when the load does"),
                format!("the shares of its play operators add up to {sum}; write less than 1"),
            )
        },
    );
}

fn check_creep(behaviour: &Behaviour, finding: &mut Finding<'_, '_>) {
    let terms = behaviour.creep.iter();
    let terms: Vec<_> =
        terms.map(|it| Term { channels: it.channels, place: it.law.time_s, share: it.law.share }).collect();
    check_distinct(&terms, "creep", "time_s", finding);
    check_sums(
        &terms,
        "creep",
        |sum| sum <= ROUNDING - 1.0,
        finding,
        |channel, sum| {
            (
                format!("channel {channel} would creep to nothing under load"),
                format!("the shares of its terms add up to {sum}; write more than -1"),
            )
        },
    );
}

/// Two terms at the same place are one, and were hardly meant to be two.
fn check_distinct(terms: &[Term], table: &str, key: &str, finding: &mut Finding<'_, '_>) {
    for (index, term) in terms.iter().enumerate() {
        for other in &terms[..index] {
            let common = (0..CHANNELS).find(|channel| term.channels[*channel] && other.channels[*channel]);
            if let Some(channel) = common.filter(|_| term.place == other.place) {
                let message = format!(
                    "channel {} has two [[{table}]] of \"{key}\" {}",
                    CHANNEL_NAMES[channel],
                    shown(term.place)
                );
                let help = "write one table with the sum of both shares";
                finding.refuse(&[&format!("{table}.{index}.{key}")], message, help);
            }
        }
    }
}

/// Refuses the term that brings a channel's sum of shares where it cannot be; `reason` says why for channel and sum.
fn check_sums(
    terms: &[Term],
    table: &str,
    is_impossible: impl Fn(f64) -> bool,
    finding: &mut Finding<'_, '_>,
    reason: impl Fn(&str, String) -> (String, String),
) {
    for (channel, name) in CHANNEL_NAMES.iter().enumerate() {
        let mut sum = 0.0;
        for (index, term) in terms.iter().enumerate().filter(|(_, term)| term.channels[channel]) {
            sum += term.share;
            if is_impossible(sum) {
                let (message, help) = reason(name, sum_shown(sum));
                finding.refuse(&[&format!("{table}.{index}.share")], message, help);
            }
        }
    }
}

fn check_converter(behaviour: &Behaviour, finding: &mut Finding<'_, '_>) {
    let sampling = &behaviour.sampling;
    if sampling.step_uv >= sampling.range_uv {
        let message = format!("\"step_uv\" ({}) leaves the converter no counts", shown(sampling.step_uv));
        let help = format!("write less than \"range_uv\", which is {}", shown(sampling.range_uv));
        finding.refuse(&["sampling.step_uv", "sampling.range_uv"], message, help);
    }
}

/// A sum of shares as a sentence shows it.
fn sum_shown(sum: f64) -> String {
    shown((sum * 1e9).round() / 1e9)
}
