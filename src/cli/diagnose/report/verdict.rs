//! The whole answer in one sentence.

use super::Subject;
use super::words::{capital, cause, sentence};
use tactpad::lab::diagnosis::report::{Diagnosis, Finding, Verdict};

/// So many findings are told in the sentence itself.
const TOLD_MAX: usize = 3;
/// And of a set that cannot be told apart, so many.
const RIVALS_MAX: usize = 2;

/// `Channel m1z reads 12 % too much; nothing else is wrong beyond the noise.`
pub(super) fn headline(subject: &Subject<'_>) -> String {
    let diagnosis = subject.diagnosis;
    let told = capital(&told(diagnosis));
    let percent = 100.0 * diagnosis.unnamed_share;
    match diagnosis.verdict {
        Verdict::NoDiscrepancy => "The model accounts for these rows: nothing is wrong beyond the noise.".to_owned(),
        Verdict::Explained => format!("{told}; nothing else is wrong beyond the noise."),
        Verdict::PartlyExplained => {
            format!("{told}; {percent:.0} % of what the model gets wrong has no known cause.")
        }
        Verdict::Unexplained => "The model is wrong here, and no known cause accounts for it.".to_owned(),
    }
}

fn told(diagnosis: &Diagnosis) -> String {
    let findings = &diagnosis.findings;
    let mut clauses: Vec<String> =
        findings.iter().take(TOLD_MAX).map(|finding| clause(finding, &diagnosis.channels)).collect();
    match findings.len().saturating_sub(TOLD_MAX) {
        0 => {}
        1 => clauses.push("there is one more cause".to_owned()),
        more => clauses.push(format!("there are {more} more causes")),
    }
    clauses.join("; ")
}

/// A finding; of a set, that it is one.
fn clause(finding: &Finding, channels: &[String]) -> String {
    let others = &finding.confounded_with;
    let first = sentence(finding, channels);
    if others.is_empty() {
        return first;
    }
    let told = others.iter().take(RIVALS_MAX).map(|(effect, target)| cause(effect, target, channels));
    let told: Vec<String> = told.collect();
    let more = match others.len().saturating_sub(RIVALS_MAX) {
        0 => String::new(),
        more => format!(", or one of {more} other causes"),
    };
    format!("either {first}, or it is {}{more}", told.join(", or "))
}
