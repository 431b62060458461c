//! Which findings lose their names: those that look like parts of something that the catalogue does not have.
//!
//! An effect that is not in the catalogue is explained by what is nearest to it, in part. Three things give that away: a cause that does
//! not hold in all parts of the measurement (`specification`), which is no finding; a remainder that no cause explains, beside which a
//! name means little; and several findings of one effect, or about one module, for which one reason is likelier than as many. The latter two
//! stay in the report as a set with `unlisted_cause`.

use super::findings::findings;
use crate::diagnosis::causes::catalogue::CATALOGUE;
use crate::diagnosis::causes::cause::Cause;
use crate::diagnosis::data::target::Target;
use crate::diagnosis::label::Search;
use crate::diagnosis::report::{Finding, INSEPARABLE};
use crate::effect::Effect;
use tactpad_inference::error::InferenceError;
use tactpad_inference::search::{Attribution, is_random_effect};

/// A cause is named where it explains so many times what is left unexplained in the channels that tell of it,
pub(crate) const OVER_NEAR: f64 = 10.0;
/// and so many times what is left unexplained in all of them.
const OVER_ALL: f64 = 4.0;
/// So many findings of one effect need no reason in common,
const ALIKE_MAX: usize = 1;
/// and so many about one module.
const ABOUT_MODULE_MAX: usize = 2;
/// The least part of what is known of a cause by which a channel tells of it.
const PART_MIN: f64 = 0.01;

/// A finding of the search.
pub(crate) struct Candidate {
    /// Its place in the fit.
    pub(crate) place: usize,
    pub(crate) finding: Finding,
    /// Too much is left beside it: it may be a part of that.
    pub(crate) is_doubted: bool,
}

/// Named and unnamed candidates.
pub(crate) struct NamingResult {
    pub(crate) candidates: Vec<Candidate>,
    /// For each channel, the weighted squares that are left without an explanation.
    pub(crate) unnamed_by_channel: Vec<f64>,
    /// The same with those of the doubted findings.
    pub(crate) doubted_by_channel: Vec<f64>,
}

/// The findings of `whole` weighted squares, and which of them may be named. Without an explanation are the remainders, and what causes
/// explain that hold in some parts of the measurement only. What explains little beside these is doubted, and then so is what explains
/// little beside that; nothing is where `is_complete` says that all is told.
pub(crate) fn named(
    search: &Search<'_>,
    found: &Attribution,
    whole: f64,
    remainders: Vec<f64>,
    is_complete: bool,
) -> Result<NamingResult, InferenceError> {
    let fit = &found.fit;
    let squares = |place: usize, finding: &Finding| -> Vec<f64> {
        let parts = search.parts(fit, fit.applied[place].0);
        parts.into_iter().map(|part| part * finding.share * whole).collect()
    };
    let (mut candidates, mut unnamed_by_channel) = (Vec::new(), remainders);
    for (place, finding) in findings(search, found, whole)? {
        if finding.confounded_with.is_empty() && !search.holds_throughout(fit, place)? {
            add(&mut unnamed_by_channel, &squares(place, &finding));
        } else {
            let is_doubted = search.is_within_model_error(found, place)?;
            candidates.push(Candidate { place, finding, is_doubted });
        }
    }
    let mut doubted_by_channel =
        if is_complete { vec![0.0; unnamed_by_channel.len()] } else { unnamed_by_channel.clone() };
    let is_little =
        |it: &Candidate, left: &[f64]| !it.is_doubted && !is_told(&squares(it.place, &it.finding), left);
    while let Some(at) = candidates.iter().rposition(|it| is_little(it, &doubted_by_channel)) {
        candidates[at].is_doubted = true;
        // What a pad has of its own is expected in all sizes: a small part of it says nothing of the larger ones.
        if !is_random_effect(&found.random_effects, fit.applied[candidates[at].place].0) {
            add(&mut doubted_by_channel, &squares(candidates[at].place, &candidates[at].finding));
        }
    }
    Ok(NamingResult { candidates, unnamed_by_channel, doubted_by_channel })
}

fn add(to: &mut [f64], squares: &[f64]) {
    to.iter_mut().zip(squares).for_each(|(sum, own)| *sum += own);
}

/// Whether a finding explains far more, by its `squares` in each channel, than what is `left` in them.
fn is_told(squares: &[f64], left: &[f64]) -> bool {
    let square: f64 = squares.iter().sum();
    let channels = squares.iter().zip(left);
    let near: f64 = channels.filter(|(own, _)| **own > PART_MIN * square).map(|(_, left)| left).sum();
    square > OVER_NEAR * near && is_over(square, left)
}

fn of_catalogue(effect: Effect) -> Option<&'static Cause> {
    CATALOGUE.iter().find(|it| it.effect == effect)
}

/// Whether the weighted squares that a cause explains are far more than those that are left in all channels.
pub(crate) fn is_over(square: f64, unnamed_by_channel: &[f64]) -> bool {
    square > OVER_ALL * unnamed_by_channel.iter().sum::<f64>()
}

/// Sets beside findings that one reason may have in common that it may be none of the catalogue: beside those of one effect at several
/// targets, and beside three or more about one module; then also beside what explains no more than these together, as that may be a part
/// of it. What the checks of the recording found does not count: it is seen in the readings themselves. Nor do `individual` effects, of which
/// each target has its own.
pub(crate) fn in_common(findings: Vec<Finding>, individual: &[Effect], has_modules: bool) -> Vec<Finding> {
    let asks = |it: &Finding| {
        of_catalogue(it.effect).is_some_and(|cause| !cause.is_individual && !individual.contains(&it.effect))
    };
    let count =
        |is_like: &dyn Fn(&Finding) -> bool| findings.iter().filter(|it| asks(it) && is_like(it)).count();
    let has_reason = |it: &Finding| {
        let alike = count(&|other| other.effect == it.effect);
        let module = it.target.module().filter(|_| has_modules);
        let about = module.map_or(0, |own| count(&|other| other.target.module() == Some(own)));
        asks(it) && (alike > ALIKE_MAX || about > ABOUT_MODULE_MAX)
    };
    let mut is_part: Vec<bool> = findings.iter().map(has_reason).collect();
    let is_small = |at: &usize, is_part: &[bool]| {
        let of_parts: f64 =
            findings.iter().zip(is_part).filter(|(_, is_part)| **is_part).map(|(it, _)| it.share).sum();
        !is_part[*at] && of_catalogue(findings[*at].effect).is_some() && findings[*at].share <= of_parts
    };
    while is_part.contains(&true)
        && let Some(small) = (0..findings.len()).find(|at| is_small(at, &is_part))
    {
        is_part[small] = true;
    }
    let set = |(it, is_part): (Finding, bool)| if is_part { doubted(it) } else { it };
    findings.into_iter().zip(is_part).map(set).collect()
}

/// The finding as one that may be a part of what is not in the catalogue.
pub(crate) fn doubted(mut finding: Finding) -> Finding {
    if !finding.is_doubted() {
        finding.confounded_with.push((Effect::Unlisted, Target::Pad));
        finding.separate_by.get_or_insert_with(|| INSEPARABLE.to_owned());
    }
    finding
}

#[cfg(test)]
mod tests {
    use super::*;

    fn doubted(causes: &[(Effect, Target)]) -> Vec<usize> {
        let findings = in_common(
            causes.iter().map(|(effect, target)| Finding::of(*effect, *target)).collect(),
            &[],
            true,
        );
        (0..findings.len())
            .filter(|at| findings[*at].confounded_with == [(Effect::Unlisted, Target::Pad)])
            .collect()
    }

    #[test]
    fn a_finding_is_told_by_far_more_than_what_is_left() {
        // Ten times what is left in its own channels, four times what is left in all.
        assert!(is_told(&[100.0, 0.0], &[9.9, 0.0]) && !is_told(&[100.0, 0.0], &[10.1, 0.0]));
        assert!(is_told(&[100.0, 0.0], &[0.0, 24.9]) && !is_told(&[100.0, 0.0], &[0.0, 25.1]));
        // Channels that have next to nothing of it are not its own.
        assert!(is_told(&[100.0, 0.9], &[0.0, 20.0]) && !is_told(&[100.0, 1.1], &[0.0, 20.0]));
        assert_eq!(
            super::doubted(super::doubted(Finding::of(Effect::Creep, Target::Pad))).confounded_with.len(),
            1
        );
    }

    #[test]
    fn several_of_one_kind_and_many_of_any_may_have_one_reason() {
        let [displaced, rotated] = [Effect::ModuleDisplaced, Effect::ModuleRotated];
        let module = Target::Module;
        assert_eq!(doubted(&[(displaced, module(0)), (rotated, module(1))]), [0; 0]);
        assert_eq!(
            doubted(&[(displaced, module(0)), (displaced, module(1)), (rotated, module(1))]),
            [0, 1, 2]
        );
        assert_eq!(
            doubted(&[(displaced, module(0)), (rotated, module(1)), (displaced, module(2))]),
            [0, 1, 2]
        );
        assert_eq!(
            doubted(&[(displaced, module(0)), (rotated, module(0)), (Effect::StageOffset, Target::Rig)]),
            [0; 0]
        );
        let tilted = (Effect::ModuleTilted, module(0));
        assert_eq!(doubted(&[(displaced, module(0)), (rotated, module(0)), tilted]), [0, 1, 2]);
        assert_eq!(doubted(&[(displaced, module(0)), (displaced, module(2))]), [0, 1]);
    }

    #[test]
    fn what_each_target_has_of_its_own_and_what_checks_found_needs_no_reason() {
        let of_channels = |effect: Effect| (0..4).map(move |channel| (effect, Target::Channel(channel)));
        let gains: Vec<_> =
            of_channels(Effect::ChannelGain).chain([(Effect::ModuleRotated, Target::Module(1))]).collect();
        assert_eq!(doubted(&gains), [0; 0]);
        assert_eq!(doubted(&of_channels(Effect::ChannelDead).collect::<Vec<_>>()), [0; 0]);
        let leaks = [0, 1].map(|from| (Effect::ChannelCrosstalk, Target::Channels { into: 4, from }));
        let beside = [
            (Effect::ChannelGain, Target::Channel(4)),
            leaks[0],
            leaks[1],
            (Effect::ChannelDead, Target::Channel(8)),
        ];
        assert_eq!(doubted(&beside), [0, 1, 2]);
    }
}
