//! The causes that were found, as findings.

use crate::diagnosis::label::Search;
use crate::diagnosis::report::Finding;
use tactpad_inference::error::InferenceError;
use tactpad_inference::search::{Attribution, is_random_effect};

/// The findings with their places in the fit, the largest first. `whole` is the weighted squared residual above noise and
/// background.
pub(crate) fn findings(
    search: &Search<'_>,
    found: &Attribution,
    whole: f64,
) -> Result<Vec<(usize, Finding)>, InferenceError> {
    let mut findings = Vec::new();
    let gains = search.predictive_gains(&found.fit);
    for (at, square) in search.squares(found)?.into_iter().enumerate() {
        let (hypothesis, _) = found.fit.applied[at];
        let (projected, score) = search.without(&found.fit, at)?;
        let test = projected.test(&search.columns.of_hypothesis[hypothesis], &score);
        let is_random_effect = is_random_effect(&found.random_effects, hypothesis);
        if is_random_effect && (test.p_value() >= found.critical || gains[at] <= 0.0) {
            continue;
        }
        let (rivals, doubt) = if is_random_effect {
            search.rivals_of_random_effect(found, at, &projected, &score)?
        } else {
            (search.rivals_in_place(found, at, &projected, &score)?, Vec::new())
        };
        let label = |at: usize| search.model.hypotheses()[at].label;
        let (effect, target) = label(hypothesis);
        let finding = Finding {
            effect,
            target,
            parameters: search.estimates(found, at, &doubt)?,
            shapes: search.shapes(found, at),
            p_value: test.p_value(),
            share: (square / whole).clamp(0.0, 1.0),
            confounded_with: rivals.into_iter().map(label).collect(),
            separate_by: None,
            labels: None,
        };
        findings.push((at, finding));
    }
    findings.sort_by(|(_, one), (_, other)| other.share.total_cmp(&one.share));
    Ok(findings)
}
