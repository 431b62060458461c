//! Which changes explain what differs between two plays, one after the other, and which of them stand alone.
//!
//! χ² counts in units of what the plays contradict themselves by. The level of false alarms is one for all candidates together.

use super::candidates::{Candidate, CandidateNumber, FittedCandidate};
use crate::calibration::change::plays::PlayEstimate;
use crate::diagnosis::data::target::Target;
use crate::diagnosis::report::{Estimate, Finding};
use crate::effect::Effect;
use tactpad_inference::policy::{LEVEL, POWER};
use tactpad_numeric::chi_square::{exceeded, noncentrality, quantile};
use tactpad_numeric::linear::Reduced;

/// Without labels no signature is known better than to a tenth of itself, where those of a diagnosis are to three hundredths: what
/// explains less than its square beside another change may be an error of that one.
const SIGNATURE_PART: f64 = 0.1 * 0.1;
/// More changes at once are described by nobody.
const FINDINGS_MAX: usize = 4;

/// The candidates and the equations that they have a part in.
pub(super) struct Selection<'c> {
    pub(super) candidates: &'c [Candidate],
    pub(super) equations: &'c Reduced,
    /// By how much variances are larger than stated.
    pub(super) inflation: f64,
}

impl<'c> Selection<'c> {
    pub(super) fn of(candidates: &'c [Candidate], compared: &'c PlayEstimate) -> Self {
        Self { candidates, equations: &compared.changes, inflation: compared.inflation }
    }

    /// The changes that were found, in the order of the equations.
    pub(super) fn solution(&self) -> Vec<f64> {
        let columns = columns(&self.selected());
        let mut changes = vec![0.0; self.equations.score.len()];
        let Some((multiples, _)) = self.equations.combined(&columns).solved() else { return changes };
        for (multiple, column) in multiples.into_iter().zip(&columns) {
            changes.iter_mut().zip(column).for_each(|(change, entry)| *change += multiple * entry);
        }
        changes
    }

    /// The p-value from which on a change is found.
    fn critical(&self) -> f64 {
        LEVEL / self.candidates.len().max(1) as f64
    }

    fn p_value(&self, square: f64, numbers: usize) -> f64 {
        exceeded(square / self.inflation, numbers)
    }

    fn p_of(&self, explained: &FittedCandidate) -> f64 {
        self.p_value(explained.square, explained.candidate.numbers.len())
    }

    /// Findings, the clearest first.
    pub(super) fn findings(&self) -> Vec<Finding> {
        let selected = self.selected();
        let Some((solution, variances)) = self.equations.combined(&columns(&selected)).solved() else {
            return Vec::new();
        };
        let whole: f64 = self.equations.combined(&columns(&selected)).square().unwrap_or_default();
        let mut numbers = solution.into_iter().zip(variances);
        let finding = |(at, it): (usize, &FittedCandidate)| {
            let estimate = |number: &CandidateNumber| {
                let (multiple, variance) = numbers.next().unwrap_or((f64::NAN, f64::NAN));
                let (value, interval95) = number.estimate(multiple, (variance * self.inflation).sqrt());
                let [one, other] = interval95;
                Estimate { name: number.name, value, interval95: [one.min(other), one.max(other)] }
            };
            let others: Vec<FittedCandidate> =
                selected.iter().enumerate().filter(|(of, _)| *of != at).map(|(_, it)| it.clone()).collect();
            let alone = self.beside(&others, &it.candidate).unwrap_or_else(|| it.clone());
            Finding {
                effect: it.candidate.effect,
                target: it.candidate.target,
                parameters: it.candidate.numbers.iter().map(estimate).collect(),
                shapes: Vec::new(),
                p_value: self.p_of(&alone),
                share: if whole > 0.0 { (alone.square / whole).clamp(0.0, 1.0) } else { 0.0 },
                confounded_with: self.rivals(&others, &alone),
                separate_by: None,
                labels: None,
            }
        };
        selected.iter().enumerate().map(finding).collect()
    }

    /// What a candidate explains beside changes that are free.
    fn beside(&self, free: &[FittedCandidate], candidate: &Candidate) -> Option<FittedCandidate> {
        if free.is_empty() {
            return candidate.explained(self.equations);
        }
        candidate.explained(&self.equations.beside(&columns(free))?)
    }

    fn selected(&self) -> Vec<FittedCandidate> {
        let mut selected: Vec<FittedCandidate> = Vec::new();
        while selected.len() < FINDINGS_MAX {
            let is_new = |it: &&Candidate| {
                selected.iter().all(|of| (of.candidate.effect, of.candidate.target) != (it.effect, it.target))
            };
            let found = self.candidates.iter().filter(is_new).filter_map(|it| self.beside(&selected, it));
            let Some(best) = found.min_by(|one, other| self.order(one, other)) else { break };
            let largest = selected.iter().map(|it| it.square).fold(0.0, f64::max);
            if self.p_of(&best) > self.critical() || best.square < SIGNATURE_PART * largest {
                break;
            }
            selected.push(best);
        }
        selected
    }

    /// The smaller p-value first; where both are none to speak of, the larger χ² for each number.
    fn order(&self, one: &FittedCandidate, other: &FittedCandidate) -> std::cmp::Ordering {
        let each = |it: &FittedCandidate| it.square / it.candidate.numbers.len() as f64;
        self.p_of(one).total_cmp(&self.p_of(other)).then(each(other).total_cmp(&each(one)))
    }

    /// The candidates beside which nothing significant of a finding is left.
    fn rivals(&self, others: &[FittedCandidate], finding: &FittedCandidate) -> Vec<(Effect, Target)> {
        let own = (finding.candidate.effect, finding.candidate.target);
        let is_rival = |candidate: &&Candidate| {
            if (candidate.effect, candidate.target) == own {
                return false;
            }
            let Some(rival) = self.beside(others, candidate) else { return false };
            let free: Vec<FittedCandidate> = others.iter().cloned().chain([rival]).collect();
            let left = self.beside(&free, &finding.candidate);
            left.is_none_or(|left| {
                self.p_of(&left) > self.critical() || left.square < SIGNATURE_PART * finding.square
            })
        };
        self.candidates.iter().filter(is_rival).map(|it| (it.effect, it.target)).collect()
    }

    /// The size of a candidate's first number, as a multiple of its column, that would have been found.
    pub(super) fn least(&self, candidate: &Candidate) -> f64 {
        let own = self.equations.combined(&candidate.columns());
        let wanted = noncentrality(quantile(self.critical(), 1), 1, POWER);
        // λ = c² S/φ.
        own.information.first().map_or(f64::INFINITY, |row| (wanted * self.inflation / row[0]).sqrt())
    }
}

fn columns(explained: &[FittedCandidate]) -> Vec<Vec<f64>> {
    explained.iter().flat_map(|it| it.candidate.columns()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::data::target::Target::Channel;
    use crate::play::change::candidates::candidates;
    use tactpad_core::pad::device::Device;
    use tactpad_core::quantity::CHANNELS;

    /// Gains only, each known by itself to 1 %, but for the common one, which nobody knows.
    fn equations(changes: &[f64; CHANNELS]) -> Reduced {
        let entry = |i: usize, j: usize| 1e4 * (f64::from(u8::from(i == j)) - 1.0 / CHANNELS as f64);
        let information: Vec<Vec<f64>> =
            (0..CHANNELS).map(|i| (0..CHANNELS).map(|j| entry(i, j)).collect()).collect();
        let score = information.iter().map(|row| row.iter().zip(changes).map(|(s, c)| s * c).sum()).collect();
        Reduced { information, score }
    }

    fn found(changes: &[f64; CHANNELS], inflation: f64) -> Vec<Finding> {
        let (candidates, equations) = (candidates(&Device::nominal(), &[]), equations(changes));
        Selection { candidates: &candidates, equations: &equations, inflation }.findings()
    }

    #[test]
    fn a_gain_that_all_share_is_not_seen() {
        assert!(found(&[0.3; CHANNELS], 1.0).is_empty());
    }

    #[test]
    fn a_modules_gain_is_named_and_no_channel_stands_for_it() {
        let module = std::array::from_fn(|k| if k / 3 == 1 { -0.1 } else { 0.0 });
        let findings = found(&module, 1.0);
        assert_eq!((findings.len(), findings[0].effect), (1, Effect::ModuleGain));
        assert!(findings[0].confounded_with.is_empty(), "{findings:?}");
        let estimate = findings[0].parameters[0];
        assert!((estimate.value - 0.9).abs() < 1e-9);
        // σ² = 1/S of the module: 10⁴ (3 − 9/9).
        assert!((estimate.interval95[1] - 0.9 - 1.959_964 * 0.01 / 2.0_f64.sqrt()).abs() < 1e-9);
        // χ² = 0.1² · 10⁴ · 2 is 200; of twelve candidates 9.1 is the critical one.
        assert!(found(&module, 30.0).is_empty(), "plays that contradict themselves by more tell nothing");
    }

    #[test]
    fn two_channels_are_two_findings() {
        let mut changes = [0.0; CHANNELS];
        (changes[0], changes[5]) = (0.2, -0.1);
        let findings = found(&changes, 1.0);
        let targets: Vec<_> = findings.iter().map(|it| (it.effect, it.target)).collect();
        assert_eq!(targets, [(Effect::ChannelGain, Channel(0)), (Effect::ChannelGain, Channel(5))]);
    }
}
