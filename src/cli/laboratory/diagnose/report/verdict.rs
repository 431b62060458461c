//! The whole answer in one sentence.

use super::super::numbers::percent;
use super::super::text::common_gain;
use super::subject::Subject;
use super::words::{capital, cause, listed, place, sentence};
use tactpad::lab::diagnosis::data::target::Target;
use tactpad::lab::diagnosis::report::{Diagnosis, Finding, Verdict};
use tactpad::lab::effect::Effect;

/// So many findings are told with their sizes; of more, what they are.
const TOLD_MAX: usize = 2;
/// And of a set that cannot be told apart, so many.
const RIVALS_MAX: usize = 2;

/// `Channel m1z reads 12 % too much; noise, background and a model’s usual errors account for the rest.`
pub(super) fn headline(subject: &Subject<'_>) -> String {
    let diagnosis = subject.diagnosis;
    let told = capital(&told(diagnosis));
    let unnamed = percent(diagnosis.unnamed_share);
    if let Some(gains) = common_gain(diagnosis) {
        return gains;
    }
    match diagnosis.verdict {
        Verdict::NoDiscrepancy => {
            "The model accounts for these rows: nothing is wrong beyond noise and background.".to_owned()
        }
        Verdict::Explained => {
            format!("{told}; noise, background and a model’s usual errors account for the rest.")
        }
        Verdict::PartlyExplained => {
            format!("{told}; {unnamed} of what the model gets wrong has no known cause.")
        }
        Verdict::Unexplained if diagnosis.findings.is_empty() => {
            "The model is wrong here, and no known cause accounts for it.".to_owned()
        }
        Verdict::Unexplained => {
            "The model is wrong here, in a way that no known causes account for. Those below describe it."
                .to_owned()
        }
    }
}

fn told(diagnosis: &Diagnosis) -> String {
    let Diagnosis { findings, channels, .. } = diagnosis;
    if findings.len() > TOLD_MAX {
        let sets = findings.iter().filter(|it| !it.confounded_with.is_empty()).count();
        let doubt = match sets {
            0 => "",
            1 => "; one of them could be something else",
            _ => "; some of them could be something else",
        };
        return format!("{} things are wrong: {}{doubt}", findings.len(), listed(&names(findings, channels)));
    }
    findings.iter().map(|finding| clause(finding, channels)).collect::<Vec<_>>().join("; ")
}

/// The names of the findings, those of one effect together.
fn names(findings: &[Finding], channels: &[String]) -> Vec<String> {
    let mut effects: Vec<Effect> = Vec::new();
    for finding in findings.iter().filter(|it| !matches!(it.target, Target::Pad | Target::Rig | Target::All))
    {
        if !effects.contains(&finding.effect) {
            effects.push(finding.effect);
        }
    }
    let of_effect = |effect: &Effect| {
        let places =
            findings.iter().filter(|it| it.effect == *effect).map(|it| place(&it.target.name(channels)));
        let mut places: Vec<String> = places.collect();
        places.sort();
        places.dedup();
        format!("{} ({})", effect.title(), places.join(", "))
    };
    let whole = findings
        .iter()
        .filter(|it| matches!(it.target, Target::Pad | Target::Rig | Target::All))
        .map(|it| it.effect.title().to_owned());
    whole.chain(effects.iter().map(of_effect)).collect()
}

/// A finding; of a set, that it is one.
fn clause(finding: &Finding, channels: &[String]) -> String {
    let others = &finding.confounded_with;
    let first = sentence(finding, channels);
    if others.is_empty() {
        return first;
    }
    let told = others.iter().take(RIVALS_MAX).map(|(effect, target)| cause(*effect, target, channels));
    let told: Vec<String> = told.collect();
    let more = match others.len().saturating_sub(RIVALS_MAX) {
        0 => String::new(),
        more => format!(", or one of {more} other causes"),
    };
    format!("either {first}, or it is {}{more}", told.join(", or "))
}
