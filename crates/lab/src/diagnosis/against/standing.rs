//! Whether what was found is seen without any covariance.
//!
//! A covariance by an earlier recording is only as good as that recording. So a cause must also make the plain squares of the residual
//! smaller, each channel's in units of its noise, and by more than these gains scatter from cluster to cluster. What does not is no
//! chance, as the tests have it, but no name either: it is unnamed.

use crate::diagnosis::label::Search;
use crate::diagnosis::report::{Diagnosis, Finding};
use crate::diagnosis::validation::gain::{Rows, gain, rmse};
use crate::diagnosis::verdict;
use crate::effect::Effect;
use tactpad_inference::search::{Applied, Attribution};

/// So many standard errors of its mean a gain must be.
const STANDS: f64 = 2.5;

/// Withdraws what does not stand by the plain squares of the open rows.
pub(super) fn standing(
    diagnosis: &mut Diagnosis,
    search: &Search<'_>,
    [open, locked]: &[Rows<'_>; 2],
    found: &Attribution,
) {
    let noise = diagnosis.residuals.noise.clone();
    let hypotheses = open.model.hypotheses();
    let place = |finding: &Finding| {
        let is_it = |(at, _): &(usize, Vec<f64>)| hypotheses[*at].label == (finding.effect, finding.target);
        found.fit.applied.iter().position(is_it)
    };
    let mut withdrawn: Vec<Finding> = Vec::new();
    // One after the other: what is withdrawn speaks for no other.
    loop {
        let told = |but: Option<usize>| -> Applied {
            let places = diagnosis.findings.iter().filter_map(place).filter(|at| Some(*at) != but);
            places.map(|at| found.fit.applied[at].clone()).collect()
        };
        let with = squares(open, &told(None), &noise);
        let stands = |finding: &Finding| {
            let Some(at) = place(finding) else { return finding.effect == Effect::ChannelOffset };
            let gains = squares(open, &told(Some(at)), &noise).into_iter().zip(&with);
            is_sure(&gains.map(|(without, with)| without - with).collect::<Vec<f64>>())
        };
        // The smallest first.
        let Some(least) = diagnosis.findings.iter().rposition(|finding| !stands(finding)) else { break };
        withdrawn.push(diagnosis.findings.remove(least));
    }
    if withdrawn.is_empty() {
        return;
    }
    let places = diagnosis.findings.iter().filter_map(place);
    let told: Applied = places.map(|at| found.fit.applied[at].clone()).collect();
    diagnosis.rmse_extended = rmse(open, &told, &open.zeros(&told));
    diagnosis.residuals.extended = open.centred(&told);
    diagnosis.gain = gain(search, &found.fit, [open, locked], &told);
    let unnamed: f64 = withdrawn.iter().map(|finding| finding.share).sum();
    diagnosis.unnamed_share = (diagnosis.unnamed_share + unnamed).min(1.0);
    diagnosis.verdict = verdict(&diagnosis.findings, diagnosis.unnamed_share);
}

/// For each cluster the sum of squares beside each channel's zero, in units of its noise.
fn squares(rows: &Rows<'_>, applied: &Applied, noise: &[f64]) -> Vec<f64> {
    let clusters = rows.observations.clusters();
    let mut squares = vec![0.0; clusters.iter().max().map_or(0, |last| last + 1)];
    for (channel, noise) in rows.centred(applied).iter().zip(noise) {
        for (left, cluster) in channel.iter().zip(&clusters).filter(|(left, _)| left.is_finite()) {
            squares[*cluster] += (left / noise.max(f64::MIN_POSITIVE.sqrt())).powi(2);
        }
    }
    squares
}

/// Whether a sum is above zero by more than its parts scatter.
fn is_sure(gains: &[f64]) -> bool {
    let sum: f64 = gains.iter().sum();
    let count = gains.len() as f64;
    let scatter: f64 = gains.iter().map(|gain| (gain - sum / count).powi(2)).sum();
    sum > STANDS * scatter.sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_cluster_alone_is_not_sure() {
        assert!(is_sure(&[1.0; 12]));
        assert!(!is_sure(&[0.1, -0.1, 0.0, 9.0, 0.1, -0.2, 0.0, 0.1]));
        assert!(!is_sure(&[-1.0; 12]));
    }
}
