//! Rivals that nobody could ask for: a column is missing, and what it would have told may have gone with what was found.

use crate::diagnosis::report::{Finding, NotTestable};
use crate::effect::Effect;
use tactpad_inference::observations::{Observations, Sample};
use tactpad_numeric::statistics::correlation;

/// What goes with the order of the rows by this rank correlation or more cannot be told from what went on with them.
const IN_ORDER: f64 = 0.8;

/// A cause that looks like another one where what it goes with goes with what the other one does.
struct Pair {
    found: Effect,
    untestable: Effect,
    /// What the found cause goes with; temperatures that nobody wrote down may have gone with anything.
    with: Option<fn(&Sample) -> Option<f64>>,
}

const PAIRS: [Pair; 4] = [
    Pair { found: Effect::ZeroDrift, untestable: Effect::ThermalZero, with: None },
    Pair { found: Effect::ThermalZero, untestable: Effect::ZeroDrift, with: Some(|it| it.temp_c) },
    Pair { found: Effect::Ageing, untestable: Effect::ThermalGain, with: None },
    Pair { found: Effect::ThermalGain, untestable: Effect::Ageing, with: Some(|it| it.temp_c) },
];

/// The findings with the rivals among the causes that are not testable. Each says which column would tell.
pub(crate) fn with_untestable(
    mut findings: Vec<Finding>,
    not_testable: &[NotTestable],
    observations: &Observations,
) -> Vec<Finding> {
    for finding in &mut findings {
        for pair in PAIRS.iter().filter(|pair| pair.found == finding.effect) {
            let missing = not_testable.iter().find(|it| it.effect == pair.untestable);
            let Some(NotTestable { needs, .. }) = missing else { continue };
            if pair.with.is_none_or(|with| is_in_order(observations, with)) {
                finding.confounded_with.push((pair.untestable, finding.target));
                finding.separate_by = Some(match pair.untestable {
                    Effect::ThermalZero | Effect::ThermalGain => format!(
                        "write down the temperature of each row under {needs}, and let it go up and down while you measure"
                    ),
                    _ => format!(
                        "write {needs} for each row, and measure once more while the temperature goes back"
                    ),
                });
            }
        }
    }
    findings
}

/// Whether something goes with the order of the rows: by Spearman's correlation.
fn is_in_order(observations: &Observations, with: fn(&Sample) -> Option<f64>) -> bool {
    let mut rows: Vec<(f64, f64)> = observations
        .samples
        .iter()
        .zip(&observations.numbers)
        .filter_map(|(sample, number)| Some((with(sample)?, *number as f64)))
        .collect();
    rows.sort_by(|one, other| one.0.total_cmp(&other.0));
    // Equal values share their middle rank.
    let mut ranks = Vec::with_capacity(rows.len());
    for equal in rows.chunk_by(|one, other| one.0 == other.0) {
        let rank = ranks.len() as f64 + 0.5 * (equal.len() - 1) as f64;
        ranks.extend(equal.iter().map(|_| rank));
    }
    let numbers: Vec<f64> = rows.iter().map(|(_, number)| *number).collect();
    correlation(&ranks, &numbers).abs() >= IN_ORDER
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::data::target::Target;

    /// Rivals of a cause in rows of these temperatures, where the other one lacks a column.
    fn rivals(found: Effect, untestable: Effect, temp_c: impl Fn(usize) -> f64) -> Vec<Effect> {
        let sample = |row: usize| Sample { temp_c: Some(temp_c(row)), ..Sample::default() };
        let observations = Observations {
            samples: (0..90).map(sample).collect(),
            numbers: (0..90).collect(),
            ..Observations::default()
        };
        let missing = [NotTestable { effect: untestable, needs: "cycle" }];
        let found = with_untestable(vec![Finding::of(found, Target::Channel(4))], &missing, &observations);
        assert_eq!(found[0].separate_by.is_some(), !found[0].confounded_with.is_empty());
        found[0].confounded_with.iter().map(|rival| rival.0).collect()
    }

    #[test]
    fn what_has_no_column_stays_a_rival_where_it_may_have_gone_along() {
        let warming = |row: usize| 20.0 + 0.1 * row as f64;
        let steps = |row: usize| if row < 45 { 20.0 } else { 25.0 };
        let to_and_fro = |row: usize| 20.0 + 5.0 * (0.3 * row as f64).sin();
        let [gain, ageing] = [Effect::ThermalGain, Effect::Ageing];
        assert_eq!(rivals(gain, ageing, warming), [ageing]);
        assert_eq!(rivals(gain, ageing, steps), [ageing]);
        assert_eq!(rivals(gain, ageing, to_and_fro), []);
        // A temperature that nobody wrote down may have gone with anything.
        assert_eq!(rivals(ageing, gain, to_and_fro), [gain]);
        assert_eq!(rivals(Effect::ZeroDrift, Effect::ThermalZero, warming), [Effect::ThermalZero]);
        assert_eq!(rivals(Effect::Creep, Effect::ThermalZero, warming), []);
    }
}
