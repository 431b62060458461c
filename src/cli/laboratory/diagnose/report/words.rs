//! Causes in plain English.

use super::super::numbers::{carried, decimals, parts, rounded, with_unit};
use tactpad::lab::diagnosis::data::target::Target;
use tactpad::lab::diagnosis::report::{Estimate, Finding};
use tactpad::lab::effect::Effect;

/// A cause and where it is: `turned module (module 1)`.
pub(super) fn cause(effect: Effect, target: &Target, channels: &[String]) -> String {
    let with = target.with(channels).map(|with| format!(" from {}", place(&with))).unwrap_or_default();
    let side = target.side().map(|it| format!(", {} side", it.name())).unwrap_or_default();
    match target {
        Target::Pad | Target::Rig | Target::All => effect.title().to_owned(),
        _ => format!("{} ({}{with}{side})", effect.title(), place(&target.name(channels))),
    }
}

/// The sentence of a finding, without its full stop.
pub(super) fn sentence(finding: &Finding, channels: &[String]) -> String {
    let mut told = String::new();
    for part in finding.effect.sentence().split('{') {
        match part.split_once('}') {
            Some((wanted, rest)) => told += &(filled(wanted, finding, channels) + rest),
            None => told += part,
        }
    }
    told
}

/// The same with a capital letter.
pub(super) fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

/// How likely as much is by chance.
pub(super) fn chance(p_value: f64) -> String {
    const STEPS: [(f64, &str); 4] = [(1e9, "billion"), (1e6, "million"), (1e3, "thousand"), (1.0, "")];
    let once_in = 1.0 / p_value;
    if once_in.is_nan() {
        return "unknown".to_owned();
    }
    if once_in > 1e12 {
        return "practically never (p below 10⁻¹²)".to_owned();
    }
    let (step, word) = STEPS.iter().find(|(step, _)| once_in >= *step).copied().unwrap_or((1.0, ""));
    let count = once_in / step;
    let power = 10_f64.powf(count.log10().floor());
    let count = (count / power).round() * power;
    format!("once in {} measurements", format!("{count:.0} {word}").trim())
}

/// The text for a placeholder.
fn filled(wanted: &str, finding: &Finding, channels: &[String]) -> String {
    let Finding { target, parameters, .. } = finding;
    match wanted {
        "target" if matches!(target, Target::Pad | Target::Rig | Target::All) => "every channel".to_owned(),
        "target" if matches!(target, Target::Labels(_)) => "the labels".to_owned(),
        "target" => subject(target, channels),
        "with" => target.with(channels).map(|with| place(&with)).unwrap_or_default(),
        "map" => finding.labels.as_ref().and_then(|it| it.map.clone()).unwrap_or_default(),
        "side" => target.side().map(|it| it.name().replace('-', "−")).unwrap_or_default(),
        _ => sizes(wanted, parameters),
    }
}

/// The numbers of a placeholder: those that are not none within their intervals, or all where all are.
fn sizes(wanted: &str, parameters: &[Estimate]) -> String {
    let numbers: Vec<(Vec<&str>, &Estimate)> = wanted
        .split('&')
        .filter_map(|number| {
            let mut words = number.split('|');
            let name = words.next()?;
            Some((words.collect(), parameters.iter().find(|it| it.name == name)?))
        })
        .collect();
    let told = |is_told: fn(&Estimate) -> bool| -> Vec<String> {
        numbers.iter().filter(|(_, it)| is_told(it)).map(|(words, it)| size(it, words)).collect()
    };
    let some = told(is_some);
    listed(&if some.is_empty() { told(|_| true) } else { some })
}

fn is_some(estimate: &Estimate) -> bool {
    let [low, high] = estimate.interval95;
    none(estimate.name).is_none_or(|none| !(low..=high).contains(&none))
}

fn subject(target: &Target, channels: &[String]) -> String {
    let name = target.name(channels);
    let is_channel = matches!(target, Target::Channel(_) | Target::Channels { .. });
    if is_channel && !name.starts_with("channel ") { format!("channel {name}") } else { place(&name) }
}

/// `a, b and c`.
pub(super) fn listed(words: &[String]) -> String {
    match words {
        [first @ .., last] if !first.is_empty() => format!("{} and {last}", first.join(", ")),
        _ => words.concat(),
    }
}

/// `module1` as people write it.
pub(super) fn place(name: &str) -> String {
    let number = name
        .strip_prefix("module")
        .filter(|it| !it.is_empty() && it.chars().all(|digit| digit.is_ascii_digit()));
    number.map_or_else(|| name.to_owned(), |number| format!("module {number}"))
}

/// A number in a sentence: its size with the word of its sign, or with the sign itself where there are no words.
fn size(estimate: &Estimate, words: &[&str]) -> String {
    let (value, interval, unit) = shown(estimate);
    let digits = sentence_digits(value, interval);
    let told = |value: f64| with_unit(&rounded(value, digits), &unit);
    match words {
        [more, less, ..] => format!("{} {}", told(value.abs()), if value < 0.0 { less } else { more }),
        [word] => format!("{} {word}", told(value)),
        [] => told(value),
    }
}

/// Two figures, or what the interval carries if that is less; one that is nothing by that keeps its figures.
fn sentence_digits(value: f64, interval95: [f64; 2]) -> usize {
    let carried = carried(value, interval95).saturating_sub(1);
    let is_left = value.abs() >= 0.5 * 10_f64.powi(-(carried as i32));
    if is_left { carried.min(two_figures(value)) } else { two_figures(value) }
}

/// As many digits behind the point as show two figures of the value, rounded.
fn two_figures(value: f64) -> usize {
    let places = decimals(value);
    let power = 10_f64.powi(places as i32);
    decimals((value * power).round() / power)
}

/// A number as people read it: factors and shares as per cent off none.
fn shown(estimate: &Estimate) -> (f64, [f64; 2], String) {
    let Estimate { name, value, interval95 } = *estimate;
    match parts(name).1 {
        "" | "/°C" => {
            let percent = |value: f64| 100.0 * (value - none(name).unwrap_or(0.0));
            (percent(value), interval95.map(percent), format!("%{}", parts(name).1))
        }
        unit => (value, interval95, unit.to_owned()),
    }
}

/// The value of a number where there is no such effect, if it has one.
pub(super) fn none(name: &str) -> Option<f64> {
    match name {
        "gain" | "scale" | "factor" => Some(1.0),
        "radius_mm" | "limit_uv" | "frequency_hz" => None,
        _ => Some(0.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn finding(effect: Effect, target: Target, parameters: &[(&'static str, f64, f64)]) -> Finding {
        let number = |(name, value, spread): &(&'static str, f64, f64)| Estimate {
            name,
            value: *value,
            interval95: [value - spread, value + spread],
        };
        Finding {
            effect,
            target,
            parameters: parameters.iter().map(number).collect(),
            shapes: Vec::new(),
            p_value: 1e-9,
            share: 0.5,
            confounded_with: Vec::new(),
            separate_by: None,
            labels: None,
        }
    }

    fn told(effect: Effect, target: Target, parameters: &[(&'static str, f64, f64)]) -> String {
        sentence(&finding(effect, target, parameters), &["m0x".to_owned(), "m0y".to_owned()])
    }

    #[test]
    fn findings_are_sentences() {
        let channel = Target::Channel(0);
        assert_eq!(
            told(Effect::ChannelGain, channel, &[("gain", 1.1203, 0.01)]),
            "channel m0x reads 12 % too much"
        );
        assert_eq!(
            told(Effect::ChannelGain, channel, &[("gain", 0.931, 0.002)]),
            "channel m0x reads 6.9 % too little"
        );
        let crosstalk = Target::Channels { into: 1, from: 0 };
        assert_eq!(
            told(Effect::ChannelCrosstalk, crosstalk, &[("share", 0.021, 0.002)]),
            "channel m0y takes up 2.1 % of m0x"
        );
        assert_eq!(
            told(Effect::ModuleRotated, Target::Module(2), &[("deg", -2.13, 0.3)]),
            "module 2 is turned 2.1° clockwise"
        );
        assert_eq!(
            told(Effect::ThermalZero, Target::Pad, &[("uv_per_c", -31.3, 2.0)]),
            "the zero of every channel moves by −31 µV/°C"
        );
        let displaced = [("radial_mm", -0.71, 0.02), ("tangential_mm", 0.01, 0.02)];
        assert_eq!(
            told(Effect::ModuleDisplaced, Target::Module(1), &displaced),
            "module 1 stands 0.71 mm too far in"
        );
        let askew = [("x_deg", 1.23, 0.2), ("y_deg", -0.8, 0.2)];
        assert_eq!(
            told(Effect::ReferenceTilt, Target::Rig, &askew),
            "the force reference stands askew by 1.2° about x and −0.8° about y"
        );
    }

    #[test]
    fn small_numbers_keep_a_digit() {
        assert_eq!(
            told(Effect::ChannelGain, Target::Channel(0), &[("gain", 1.004, 0.2)]),
            "channel m0x reads 0.40 % too much"
        );
    }

    #[test]
    fn chances_are_words() {
        assert_eq!(chance(3.1e-4), "once in 3 thousand measurements");
        assert_eq!(chance(0.02), "once in 50 measurements");
        assert_eq!(chance(0.0), "practically never (p below 10⁻¹²)");
        assert_eq!(chance(f64::NAN), "unknown");
    }
}
