//! The text of a diagnosis for people.

use std::fmt;

use super::numbers::{decoded, estimate, percent, range};
use crate::cli::printing::wrapped::hanging;
use tactpad::lab::diagnosis::data::target::Target;
use tactpad::lab::diagnosis::report::{
    CommonGain, Diagnosis, Finding, Gain, NotDetected, NotTestable, Proposal, Verdict, times_text,
};
use tactpad::lab::effect::Effect;

/// A diagnosis in lines of a terminal.
pub(super) struct DiagnosisText<'d>(pub(super) &'d Diagnosis);

impl fmt::Display for DiagnosisText<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self(diagnosis) = self;
        if let Some(gains) = common_gain(diagnosis) {
            writeln!(f, "{}", hanging("", &gains))?;
        }
        writeln!(f, "{}", hanging("", &verdict(diagnosis)))?;
        writeln!(f, "{}", hanging("", &sizes(diagnosis)))?;
        for (at, notice) in diagnosis.gatekeepers.iter().enumerate() {
            let first = if at == 0 { "\nOf the recording itself, and of the fit:\n" } else { "" };
            writeln!(f, "{first}{}", hanging("  - ", &format!("{}.", notice.detail)))?;
        }
        for (number, finding) in (1..).zip(&diagnosis.findings) {
            let text = found(finding, &diagnosis.channels) + &to_tell(finding, &diagnosis.findings);
            writeln!(f, "\n{}", hanging(&format!("{number:>3}  "), &(text + ".")))?;
        }
        if let Some(next) = proposed(&diagnosis.next) {
            writeln!(f, "\n{}", hanging("", &next))?;
        }
        if let Some(gain) = &diagnosis.gain {
            writeln!(f, "\n{}", hanging("", &gained(gain, diagnosis)))?;
        }
        untested(f, diagnosis)?;
        undetected(f, &diagnosis.not_detected)
    }
}

/// What gains have in common, and who may have it.
pub(super) fn common_gain(diagnosis: &Diagnosis) -> Option<String> {
    let CommonGain { factor, share, separate_by } = diagnosis.common_gain()?;
    let told_by = separate_by.map(|it| format!(" To tell: {it}.")).unwrap_or_default();
    Some(format!(
        "Gains are {:.0} % of what the model gets wrong here. The channels have a factor of {factor:.2} in common, and these rows do not \
         tell whether the supply, the force sensor or each channel has it.{told_by}",
        100.0 * share
    ))
}

/// What to measure next; none where nothing would tell more.
pub(super) fn proposed(next: &Proposal) -> Option<String> {
    let Proposal { measurements, others, plan, .. } = next;
    let minutes: f64 = measurements.iter().map(|it| it.minutes).sum();
    let each: Vec<String> =
        measurements.iter().map(|it| format!("{}, {}", it.what, times_text(it.repeats))).collect();
    let mut text = String::new();
    if !each.is_empty() {
        text += &format!(
            "Next: {} rows in {minutes:.0} minutes tell these apart: {}. --next PLAN.csv writes them as a plan, and a second --measured takes \
             what it gave.",
            plan.rows.len(),
            each.join("; then ")
        );
    }
    if !others.is_empty() {
        let first = if each.is_empty() { "Next, as no plan tells more" } else { " What no plan tells" };
        text += &format!("{first}: {}.", others.join("; and "));
    }
    (!text.is_empty()).then_some(text)
}

fn verdict(diagnosis: &Diagnosis) -> String {
    let unnamed = percent(diagnosis.unnamed_share);
    let has_gains = !diagnosis.not_testable.iter().any(|it| it.effect == Effect::ChannelGain);
    match diagnosis.verdict {
        Verdict::NoDiscrepancy if !has_gains => {
            "No discrepancy in what these rows can show, which is little: what could not be tested stands below.".into()
        }
        Verdict::NoDiscrepancy => "No discrepancy: the model accounts for these rows.".into(),
        Verdict::Explained => "Explained: what the model gets wrong here is what is listed below.".into(),
        Verdict::PartlyExplained => format!(
            "Partly explained: the causes below hold, but {unnamed} of what the model gets wrong here has no \
             known cause."
        ),
        Verdict::Unexplained if diagnosis.findings.is_empty() => {
            "Unexplained: the model is wrong here, and no known cause accounts for it.".into()
        }
        Verdict::Unexplained => {
            "Unexplained: the model is wrong here. What is listed below describes how, but so much is left \
            beside it that each may be a part of something that is not in the catalogue."
                .into()
        }
    }
}

fn sizes(diagnosis: &Diagnosis) -> String {
    let Diagnosis { noise_floor, rmse_nominal, rmse_extended, .. } = diagnosis;
    let mut text = format!(
        "The channels' noise is {noise_floor:.1} µV rms; the model misses them by {rmse_nominal:.1} µV"
    );
    if !diagnosis.findings.is_empty() {
        text += &format!(", and with the causes below by {rmse_extended:.1} µV");
    }
    if let Some(ceiling) = diagnosis.ceiling_share.filter(|share| share.is_finite()) {
        text += &format!(". The causes remove {:.0} % of what any smooth model could", 100.0 * ceiling);
    }
    text + "."
}

/// A cause and where it is.
pub(super) fn cause(effect: Effect, target: &Target, channels: &[String]) -> String {
    if effect == Effect::Unlisted {
        return effect.title().to_owned();
    }
    let joint = if effect == Effect::ChannelsSwapped { "with" } else { "from" };
    let with = target.with(channels).map(|with| format!(" {joint} {with}")).unwrap_or_default();
    let side = target.side().map(|it| format!(" on its {} side", it.name())).unwrap_or_default();
    format!("{effect} of {}{with}{side}", target.name(channels))
}

/// A cause with its numbers and their intervals.
pub(crate) fn sized(finding: &Finding, channels: &[String]) -> String {
    let mut numbers: Vec<String> = finding.parameters.iter().map(estimate).collect();
    if let Some(note) = &finding.labels {
        let map = note.map.iter().map(|map| format!("\"{map}\""));
        numbers.extend(
            map.chain(note.part.clone()).chain(note.argument.iter().map(|it| format!("say so with {it}"))),
        );
    }
    let first = cause(finding.effect, &finding.target, channels);
    let colon = if numbers.is_empty() { "" } else { ": " };
    format!("{first}{colon}{}", numbers.join(", "))
}

fn found(finding: &Finding, channels: &[String]) -> String {
    let share = 100.0 * finding.share;
    let first = sized(finding, channels);
    let mut text = format!("{first}; p {:.0e}, {share:.0} % of the residual", finding.p_value);
    if !finding.confounded_with.is_empty() {
        let others = finding.confounded_with.iter().map(|(effect, target)| cause(*effect, target, channels));
        let others: Vec<String> = others.collect();
        // Labels are one thing with all of these mistakes in the wiring together.
        let between = if finding.labels.is_some() { " together with " } else { ", or from " };
        text += &format!(". These rows do not tell it from {}", others.join(between));
    }
    text
}

/// The measurement that tells, once for all findings of which it does.
fn to_tell(finding: &Finding, all: &[Finding]) -> String {
    let is_alone = finding.confounded_with.iter().all(|(effect, _)| *effect == Effect::Unlisted);
    let Some(measurement) = finding.separate_by.as_ref().filter(|_| !is_alone) else { return String::new() };
    let first = all.iter().position(|other| other.separate_by.as_ref() == Some(measurement));
    match first {
        Some(first) if !std::ptr::eq(&raw const all[first], finding) => {
            format!(". To tell: as for {}", first + 1)
        }
        _ => format!(". To tell: {}", measurement.trim_end_matches('.')),
    }
}

fn gained(gain: &Gain, diagnosis: &Diagnosis) -> String {
    let Gain { rows_locked, rmse_ratio, rmse_ratio_interval95: [low, high], .. } = gain;
    let mut text = format!(
        "On {rows_locked} rows that had no part in this, the causes bring the model's error down to {rmse_ratio:.2} \
         of what it was ({low:.2} to {high:.2})"
    );
    let without = gain.per_cause.iter().map(|it| {
        format!("{:.2} without {}", it.rmse_ratio, cause(it.effect, &it.target, &diagnosis.channels))
    });
    let without: Vec<String> = without.collect();
    if !without.is_empty() {
        text += &format!("; {}", without.join(", "));
    }
    text += ".";
    for (of, decoded) in decoded(gain) {
        text += &format!(
            " The {of} decoded from them are off by {}, in place of {} (a change of {} to {}).",
            decoded.extended, decoded.nominal, decoded.change[0], decoded.change[1]
        );
    }
    text
}

/// Writes the causes that could not be tested, by the column that each needs.
fn untested(f: &mut fmt::Formatter<'_>, diagnosis: &Diagnosis) -> fmt::Result {
    let mut needs: Vec<&str> = diagnosis.not_testable.iter().map(|it| it.needs).collect();
    needs.sort_unstable();
    needs.dedup();
    for (index, column) in needs.iter().enumerate() {
        let effects = diagnosis.not_testable.iter().filter(|it| it.needs == *column);
        let effects: Vec<&str> = effects.map(|it| it.effect.name()).collect();
        let that_varies = if NotTestable::needs_column(column) { " that varies" } else { "" };
        let text = format!("Not testable without {column}{that_varies}: {}.", effects.join(", "));
        writeln!(f, "{}{}", if index == 0 { "\n" } else { "" }, hanging("", &text))?;
    }
    Ok(())
}

/// Writes the detection limits, a line for each effect.
fn undetected(f: &mut fmt::Formatter<'_>, all: &[NotDetected]) -> fmt::Result {
    let mut effects: Vec<Effect> = Vec::new();
    for it in all.iter().filter(|it| !it.minimum_detectable.is_empty()) {
        if !effects.contains(&it.effect) {
            effects.push(it.effect);
        }
    }
    if effects.is_empty() {
        return Ok(());
    }
    writeln!(f, "\nNot found; these sizes would be, in nine of ten such measurements:")?;
    for effect in effects {
        let sizes = least_sizes(all.iter().filter(|it| it.effect == effect));
        writeln!(f, "{}", hanging(&format!("  {effect:<20}"), &sizes))?;
    }
    Ok(())
}

/// For each number of one effect the sizes over its targets.
fn least_sizes<'d>(targets: impl Iterator<Item = &'d NotDetected>) -> String {
    let mut sizes: Vec<(&str, [f64; 2])> = Vec::new();
    for (name, size) in targets.flat_map(|it| &it.minimum_detectable) {
        let at = sizes.iter().position(|(known, _)| known == name).unwrap_or(sizes.len());
        if at == sizes.len() {
            sizes.push((name, [f64::INFINITY, f64::NEG_INFINITY]));
        }
        if size.is_finite() {
            let [least, greatest] = &mut sizes[at].1;
            (*least, *greatest) = (least.min(*size), greatest.max(*size));
        }
    }
    let told = sizes.iter().map(|(name, [least, greatest])| {
        if least.is_finite() { range(name, *least, *greatest) } else { format!("{name} at no size") }
    });
    told.collect::<Vec<_>>().join(", ")
}
