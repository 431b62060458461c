//! Which findings lose their names: those that look like parts of something that the catalogue does not have.
//!
//! An effect that is not in the catalogue is explained by what is nearest to it, in part. Three things give that away: a cause that does
//! not hold in all parts of the measurement (`specification`); a remainder that no cause explains, beside which a name means little;
//! and many findings at once, above all of one effect, for which one reason is likelier than as many.

use super::attribution::{Attribution, Search};
use super::causes::CATALOGUE;
use super::report::{Finding, INSEPARABLE, UNLISTED};
use super::target::Target;

/// A cause is named where it explains so many times what is left unexplained in the channels that tell of it,
const OVER_NEAR: f64 = 10.0;
/// and so many times what is left unexplained in all of them.
const OVER_ALL: f64 = 4.0;
/// So many findings of one effect need no reason in common,
const ALIKE_MAX: usize = 1;
/// and so many of any effects.
const CAUSES_MAX: usize = 2;
/// The least part of what is known of a cause by which a channel tells of it.
const PART_MIN: f64 = 0.01;

/// What may be named.
pub(super) struct Named {
    /// Each with its place in the fit.
    pub(super) findings: Vec<(usize, Finding)>,
    /// For each channel, the weighted squares that are left without a name.
    pub(super) unnamed_by_channel: Vec<f64>,
}

/// The findings that may be named, of `whole` weighted squares. Without a name are the remainders, what causes explain that hold in
/// some parts of the measurement only, and what explains little beside these.
pub(super) fn named(
    search: &Search<'_>,
    found: &Attribution,
    (whole, remainders): (f64, Vec<f64>),
) -> Option<Named> {
    let fit = &found.fit;
    let mut named = Named { findings: search.findings(found, whole)?, unnamed_by_channel: remainders };
    let mut at = 0;
    while let Some((place, finding)) = named.findings.get(at) {
        if finding.confounded_with.is_empty() && !search.holds_throughout(fit, *place)? {
            named.withdraw(at, search, found, whole);
        } else {
            at += 1;
        }
    }
    // What lost its name is a remainder, too.
    while let Some(at) = named.findings.iter().rposition(|it| !named.is_told(it, search, found, whole)) {
        named.withdraw(at, search, found, whole);
    }
    Some(named)
}

impl Named {
    fn withdraw(&mut self, at: usize, search: &Search<'_>, found: &Attribution, whole: f64) {
        let (place, finding) = self.findings.remove(at);
        let parts = search.parts(&found.fit, found.fit.applied[place].0);
        let squares = parts.into_iter().map(|part| part * finding.share * whole);
        self.unnamed_by_channel.iter_mut().zip(squares).for_each(|(unnamed, own)| *unnamed += own);
    }

    /// Whether a finding explains far more than what is left.
    fn is_told(
        &self,
        (place, finding): &(usize, Finding),
        search: &Search<'_>,
        found: &Attribution,
        whole: f64,
    ) -> bool {
        let parts = search.parts(&found.fit, found.fit.applied[*place].0);
        let channels = self.unnamed_by_channel.iter().zip(&parts);
        let near: f64 = channels.filter(|(_, part)| **part > PART_MIN).map(|(square, _)| square).sum();
        let square = finding.share * whole;
        square > OVER_NEAR * near && is_over(square, &self.unnamed_by_channel)
    }
}

/// Whether the weighted squares that a cause explains are far more than those that are left in all channels.
pub(super) fn is_over(square: f64, unnamed_by_channel: &[f64]) -> bool {
    square > OVER_ALL * unnamed_by_channel.iter().sum::<f64>()
}

/// Sets beside findings that one reason may have in common that it may be none of the catalogue: beside those of one effect at several
/// targets, beside three or more of any effects, and then also beside what each target has of its own, as that may be a part of it.
/// What the checks of the recording found does not count: it is seen in the readings themselves.
pub(super) fn in_common(findings: &mut [Finding]) {
    let of_catalogue = |effect: &str| CATALOGUE.iter().find(|it| it.effect() == effect);
    let asks = |effect: &str| of_catalogue(effect).is_some_and(|it| !it.is_individual());
    let effects: Vec<&str> = findings.iter().map(|it| it.effect).filter(|effect| asks(effect)).collect();
    let alike = |effect: &str| effects.iter().filter(|it| **it == effect).count();
    let is_doubted = |effect: &str| alike(effect) > ALIKE_MAX || effects.len() > CAUSES_MAX;
    let is_any = effects.iter().any(|effect| is_doubted(effect));
    for finding in findings.iter_mut().filter(|it| of_catalogue(it.effect).is_some()) {
        if is_doubted(finding.effect) || is_any && !asks(finding.effect) {
            finding.confounded_with.push((UNLISTED, Target::Pad));
            finding.separate_by.get_or_insert_with(|| INSEPARABLE.to_owned());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn finding((effect, target): (&'static str, Target)) -> Finding {
        Finding {
            effect,
            target,
            parameters: Vec::new(),
            shapes: Vec::new(),
            p_value: 1e-9,
            share: 0.3,
            confounded_with: Vec::new(),
            separate_by: None,
        }
    }

    fn doubted(causes: &[(&'static str, Target)]) -> Vec<usize> {
        let mut findings: Vec<Finding> = causes.iter().copied().map(finding).collect();
        in_common(&mut findings);
        (0..findings.len()).filter(|at| findings[*at].confounded_with == [(UNLISTED, Target::Pad)]).collect()
    }

    #[test]
    fn several_of_one_kind_and_many_of_any_may_have_one_reason() {
        let [displaced, rotated] = ["module_displaced", "module_rotated"];
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
            doubted(&[(displaced, module(0)), (rotated, module(0)), ("stage_offset", Target::Rig)]),
            [0, 1, 2]
        );
        assert_eq!(doubted(&[(displaced, module(0)), (displaced, module(2))]), [0, 1]);
    }

    #[test]
    fn what_each_target_has_of_its_own_and_what_checks_found_needs_no_reason() {
        let of_channels =
            |effect: &'static str| (0..4).map(move |channel| (effect, Target::Channel(channel)));
        let gains: Vec<_> =
            of_channels("channel_gain").chain([("module_rotated", Target::Module(1))]).collect();
        assert_eq!(doubted(&gains), [0; 0]);
        assert_eq!(doubted(&of_channels("channel_dead").collect::<Vec<_>>()), [0; 0]);
        let leaks = [0, 1].map(|from| ("channel_crosstalk", Target::Channels { into: 4, from }));
        let beside =
            [("channel_gain", Target::Channel(4)), leaks[0], leaks[1], ("channel_dead", Target::Channel(8))];
        assert_eq!(doubted(&beside), [0, 1, 2]);
    }
}
