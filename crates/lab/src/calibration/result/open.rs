//! Ambiguity between pad and rig: errors of its own that the contacts do not tell from the pad's.

use super::known::PressPrecision;
use super::numbers::Number;
use crate::effect::Effect;

/// An error of the rig is worth a word if it is at least this part of the variance of what it blurs.
const SHARE_MIN: f64 = 0.25;

/// An error of the rig that blurs decoded contacts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OpenByRig {
    /// The cause in a diagnosis.
    pub effect: Effect,
    /// Number that it blurs.
    pub of: Blurred,
    /// Its standard deviation: mm of the place along an axis, a share of the force along it, or across it.
    pub deviation: f64,
    /// Its part of the variance that the field's error leaves of that, as a mean over the plate.
    pub share: f64,
}

/// Number that an error of the rig blurs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Blurred {
    /// x and y.
    Place,
    /// Fx, Fy, Fz.
    Force,
}

/// The errors of the rig that blur most, by the numbers of a fit and what it knows all over the plate.
///
/// A contact is decoded in the frame of the labels. So the stage's offset is an error of the place one by one, its turn one of r φ,
/// a tilt of the reference one of F τ across the force, its gain one of F γ along it.
pub(crate) fn by_rig(numbers: &[Number], map: &[PressPrecision]) -> Vec<OpenByRig> {
    let count = map.len().max(1) as f64;
    let mean = |of: &dyn Fn(&PressPrecision) -> f64| map.iter().map(of).sum::<f64>() / count;
    let (place_mm2, force2) = (mean(&|it| it.deviation_mm.powi(2)), mean(&|it| it.force_share.powi(2)));
    let square_mm2 = mean(&|it| it.place_mm.iter().map(|mm| mm * mm).sum());
    // Σ σ² of the numbers of a cause.
    let variance = |effect: Effect| -> f64 {
        let of_cause = numbers.iter().filter(|it| it.quantity.effect() == Some(effect));
        of_cause.map(|it| it.deviation.powi(2)).sum()
    };
    let radian = 1.0_f64.to_radians();
    // Per axis: two of the place, three of the force.
    let place = |effect, variance_mm2: f64| (effect, Blurred::Place, variance_mm2 / 2.0, place_mm2);
    let force = |effect, variance: f64| (effect, Blurred::Force, variance / 3.0, force2);
    let all = [
        place(Effect::StageOffset, variance(Effect::StageOffset)),
        place(Effect::StageRotation, variance(Effect::StageRotation) * radian.powi(2) * square_mm2),
        place(Effect::StageScale, variance(Effect::StageScale) * square_mm2),
        force(Effect::ReferenceTilt, variance(Effect::ReferenceTilt) * radian.powi(2)),
        force(Effect::ReferenceGain, variance(Effect::ReferenceGain)),
    ];
    let open = all.map(|(effect, of, variance, whole)| OpenByRig {
        effect,
        of,
        deviation: variance.sqrt(),
        share: (variance / whole).min(1.0),
    });
    open.into_iter().filter(|it| it.share >= SHARE_MIN).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::calibration::data::rig::RIG;
    use crate::calibration::result::numbers::Quantity;
    use crate::diagnosis::data::target::Target;

    fn number(name: &str, deviation: f64) -> Number {
        let quantity = Quantity::Rig(RIG.iter().find(|it| it.name == name).unwrap());
        let target = Target::Rig;
        Number { quantity, target, value: 0.0, expected: 0.0, deviation, prior_deviation: 1.0 }
    }

    #[test]
    fn what_blurs_most_is_said_with_its_part() {
        let known = |x_mm| PressPrecision { place_mm: [x_mm, 0.0], deviation_mm: 0.1, force_share: 0.01 };
        let map = [known(10.0), known(-10.0)];
        let numbers = [
            number("stage_offset.x_mm", 0.08),
            number("stage_offset.y_mm", 0.08),
            // 10 mm · 0.1° is 0.017 mm: 3 % of the place's variance over both axes, and half of that for one.
            number("stage_rotation.deg", 0.1),
            number("reference_gain.gain", 0.015),
        ];
        let open = by_rig(&numbers, &map);
        let [stage, gain] = open.as_slice() else { panic!("{open:?}") };
        assert_eq!((stage.effect, stage.of), (Effect::StageOffset, Blurred::Place));
        assert!((stage.deviation - 0.08).abs() < 1e-12 && (stage.share - 0.64).abs() < 1e-9, "{stage:?}");
        assert_eq!((gain.effect, gain.of), (Effect::ReferenceGain, Blurred::Force));
        assert!((gain.share - 0.75).abs() < 1e-9, "{gain:?}");
        assert!(by_rig(&numbers, &[]).iter().all(|it| it.share == 1.0));
    }
}
