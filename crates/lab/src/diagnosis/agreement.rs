//! Findings that several recordings of one pad share.

use super::report::{Diagnosis, Finding};

/// The causes that every one of these diagnoses names, each as it stands in each of them.
///
/// A cause of the pad is there in each recording of it, so a name counts if no recording lacks it, and if each number's
/// intervals have a value in common. What one recording alone shows may be of its rig, or chance.
pub fn agreed<'d>(diagnoses: &[&'d Diagnosis]) -> Vec<Vec<&'d Finding>> {
    let Some((first, others)) = diagnoses.split_first() else { return Vec::new() };
    let everywhere = |finding: &'d Finding| {
        let same = others.iter().map(|it| named(it).find(|other| are_one(finding, other)));
        let all: Vec<&Finding> = std::iter::once(Some(finding)).chain(same).collect::<Option<_>>()?;
        overlap(&all).then_some(all)
    };
    named(first).filter_map(everywhere).collect()
}

/// Named findings of a diagnosis; sets of causes are no names.
fn named(diagnosis: &Diagnosis) -> impl Iterator<Item = &Finding> {
    diagnosis.findings.iter().filter(|it| it.confounded_with.is_empty())
}

fn are_one(one: &Finding, other: &Finding) -> bool {
    (one.effect, one.target) == (other.effect, other.target)
}

/// Whether some value lies in all intervals, number by number.
fn overlap(all: &[&Finding]) -> bool {
    let numbers = all.first().map_or(0, |it| it.parameters.len());
    (0..numbers).all(|number| {
        let intervals = all.iter().filter_map(|it| it.parameters.get(number)).map(|it| it.interval95);
        let whole = [f64::NEG_INFINITY, f64::INFINITY];
        let [low, high] = intervals.fold(whole, |[low, high], [a, b]| [low.max(a), high.min(b)]);
        low <= high
    })
}

#[cfg(test)]
mod tests {
    use super::super::report::Estimate;
    use super::*;
    use crate::diagnosis::data::target::Target;
    use crate::effect::Effect;

    fn finding(channel: usize, gain: f64) -> Finding {
        Finding {
            effect: Effect::ChannelGain,
            target: Target::Channel(channel),
            parameters: vec![Estimate { name: "gain", value: gain, interval95: [gain - 0.01, gain + 0.01] }],
            shapes: Vec::new(),
            p_value: 1e-9,
            share: 0.5,
            confounded_with: Vec::new(),
            separate_by: None,
            labels: None,
        }
    }

    fn diagnosis(findings: Vec<Finding>) -> Diagnosis {
        Diagnosis::of(Vec::new(), Vec::new(), findings)
    }

    #[test]
    fn a_name_is_given_by_all_recordings_and_alike() {
        let confounded =
            Finding { confounded_with: vec![(Effect::ExcitationGain, Target::Pad)], ..finding(4, 1.1) };
        let one = diagnosis(vec![finding(2, 1.1), finding(3, 1.2), finding(4, 1.1), finding(5, 0.9)]);
        let other = diagnosis(vec![finding(3, 1.21), confounded, finding(5, 0.95)]);
        // The second channel stands in one only, the fourth is no name in the other, the fifth is another size.
        let found = agreed(&[&one, &other]);
        let [third] = found.as_slice() else { panic!("{found:?}") };
        assert!(third.iter().all(|it| it.target == Target::Channel(3)) && third.len() == 2);
        assert_eq!(agreed(&[&one]).len(), 4);
        assert_eq!(agreed(&[&other]).len(), 2);
        assert!(agreed(&[]).is_empty());
    }
}
