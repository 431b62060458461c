//! In which ways a pad may have changed, each as columns of the equations.

use crate::diagnosis::data::target::Target;
use crate::diagnosis::model::mechanics::side_share;
use crate::diagnosis::model::setting::Change;
use crate::effect::Effect;
use tactpad_core::pad::device::{Device, Side};
use tactpad_core::quantity::{CHANNELS, MODULES};
use tactpad_inference::policy::WITHIN_95;
use tactpad_numeric::linear::Reduced;

/// Shares of a bond's area that are tried: the diagnosis asks for no more than the last.
const SHARES: std::ops::RangeInclusive<u32> = 1..=40;
const SHARE_STEP: f64 = 0.02;
/// Of a unit's information, less than this part is rounding.
const INFORMATION_MIN: f64 = 1e-9;

/// How a column's multiple c becomes the number that is told.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum MultipleScale {
    /// A gain 1 + c.
    Gain,
    /// A factor 1/(1 − c): compliances add up.
    Factor,
    /// c times this.
    Times(f64),
}

impl MultipleScale {
    pub(super) fn value(self, multiple: f64) -> f64 {
        match self {
            Self::Gain => 1.0 + multiple,
            // At c = 1 it is rigid, and beyond nothing.
            Self::Factor if multiple >= 1.0 => f64::INFINITY,
            Self::Factor => 1.0 / (1.0 - multiple),
            Self::Times(unit) => unit * multiple,
        }
    }
}

/// A number of a candidate.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct CandidateNumber {
    pub(super) name: &'static str,
    told: MultipleScale,
    /// Values that a pad can have: those of the diagnosis.
    bounds: [f64; 2],
    /// Its column, by the changes of the equations.
    pub(super) column: Vec<f64>,
}

/// A way in which a pad may have changed.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Candidate {
    pub(super) effect: Effect,
    pub(super) target: Target,
    pub(super) numbers: Vec<CandidateNumber>,
    /// Of a bond: places and shares of the known changes.
    bond: Vec<(usize, f64)>,
}

/// A candidate fitted.
#[derive(Clone, Debug)]
pub(super) struct FittedCandidate {
    /// With its columns as they are there.
    pub(super) candidate: Candidate,
    /// χ².
    pub(super) square: f64,
}

impl CandidateNumber {
    fn of(name: &'static str, told: MultipleScale, bounds: [f64; 2], column: Vec<f64>) -> Self {
        Self { name, told, bounds, column }
    }

    /// Value and ends of its interval, by the multiple and its deviation.
    pub(super) fn estimate(&self, multiple: f64, deviation: f64) -> (f64, [f64; 2]) {
        let ends = [-WITHIN_95, WITHIN_95].map(|factor| self.told.value(multiple + factor * deviation));
        (self.told.value(multiple), ends)
    }

    fn is_possible(&self, multiple: f64) -> bool {
        let [least, most] = self.bounds;
        (least..=most).contains(&self.told.value(multiple))
    }
}

impl Candidate {
    fn of(effect: Effect, target: Target, numbers: Vec<CandidateNumber>) -> Self {
        Self { effect, target, numbers, bond: Vec::new() }
    }

    pub(super) fn columns(&self) -> Vec<Vec<f64>> {
        self.numbers.iter().map(|number| number.column.clone()).collect()
    }

    /// What it explains; `None` where it has no size that a pad can have, or nothing tells it.
    pub(super) fn explained(&self, equations: &Reduced) -> Option<FittedCandidate> {
        if !self.bond.is_empty() {
            return self.came_off(equations);
        }
        let own = equations.combined(&self.columns());
        let is_told = (0..own.score.len()).all(|at| own.information[at][at] > INFORMATION_MIN);
        let (solution, _) = is_told.then(|| own.solved()).flatten()?;
        let is_possible = self.numbers.iter().zip(&solution).all(|(number, c)| number.is_possible(*c));
        let square = solution.iter().zip(&own.score).map(|(c, score)| c * score).sum();
        is_possible.then(|| FittedCandidate { candidate: self.clone(), square })
    }

    /// The share s of the bond with the largest χ²(s) = 2 sᵀc − cᵀSc, where its change c(s) has one size. As a column it is c(s)/s.
    fn came_off(&self, equations: &Reduced) -> Option<FittedCandidate> {
        let size = equations.score.len();
        let tried = SHARES.map(|step| {
            let share = SHARE_STEP * f64::from(step);
            let column = lost(&self.bond, share, size);
            let own = equations.combined(std::slice::from_ref(&column));
            (share, column, 2.0 * own.score[0] - own.information[0][0])
        });
        let (share, column, square) = tried.max_by(|one, other| one.2.total_cmp(&other.2))?;
        let mut candidate = self.clone();
        let [number] = candidate.numbers.as_mut_slice() else { return None };
        number.column = column.iter().map(|entry| entry / share).collect();
        (square > 0.0).then_some(FittedCandidate { candidate, square })
    }
}

/// The change of a bond that has lost a share: Lagrange's polynomials through the known shares and none.
fn lost(bond: &[(usize, f64)], share: f64, size: usize) -> Vec<f64> {
    let mut column = vec![0.0; size];
    for (at, own) in bond {
        // s/sᵢ Π (s − sⱼ)/(sᵢ − sⱼ).
        let others = bond.iter().filter(|(other, _)| other != at);
        let product: f64 = others.map(|(_, other)| (share - other) / (own - other)).product();
        column[*at] = share / own * product;
    }
    column
}

/// All candidates, where the changes of the equations are the channels' gains and then these of the field.
pub(super) fn candidates(device: &Device, changes: &[Change]) -> Vec<Candidate> {
    let size = CHANNELS + changes.len();
    let unit = |entries: &[(usize, f64)]| {
        let mut column = vec![0.0; size];
        entries.iter().for_each(|(at, value)| column[*at] = *value);
        column
    };
    let gain = |channels: std::ops::Range<usize>| {
        let entries: Vec<(usize, f64)> = channels.map(|channel| (channel, 1.0)).collect();
        vec![CandidateNumber::of("gain", MultipleScale::Gain, [0.05, 20.0], unit(&entries))]
    };
    let mut all: Vec<Candidate> = (0..CHANNELS)
        .map(|channel| {
            Candidate::of(Effect::ChannelGain, Target::Channel(channel), gain(channel..channel + 1))
        })
        .collect();
    all.extend((0..MODULES).map(|module| {
        Candidate::of(Effect::ModuleGain, Target::Module(module), gain(3 * module..3 * module + 3))
    }));
    let mechanics = Mechanics { device, changes, size };
    all.extend((0..MODULES).flat_map(|module| mechanics.of_module(module)));
    all.extend(mechanics.factor(Effect::PlateStiffness, Target::Pad, "material.plate.e_mpa", [0.05, 20.0]));
    all
}

struct Mechanics<'c> {
    device: &'c Device,
    changes: &'c [Change],
    size: usize,
}

impl Mechanics<'_> {
    fn of_module(&self, module: usize) -> Vec<Candidate> {
        let target = Target::Module(module);
        let key = |name: &str| format!("module.{module}.{name}");
        let mut all = Vec::new();
        all.extend(self.factor(Effect::ModuleStiffness, target, &key("frame_e_factor"), [0.02, 10.0]));
        let added = |effect, numbers: &[(&'static str, &str)], most: f64| {
            let number = |(name, of): &(&'static str, &str)| {
                let column = self.column(&key(of), 1.0)?;
                Some(CandidateNumber::of(name, MultipleScale::Times(1.0), [-most, most], column))
            };
            let numbers: Option<Vec<CandidateNumber>> = numbers.iter().map(number).collect();
            Some(Candidate::of(effect, target, numbers?))
        };
        let shifts = [("radial_mm", "radial_mm"), ("tangential_mm", "tangential_mm")];
        all.extend(added(Effect::ModuleDisplaced, &shifts, 5.0));
        all.extend(added(Effect::ModuleRotated, &[("deg", "rotation_deg")], 30.0));
        let tilts = [("tangential_deg", "tilt_tangential_deg"), ("radial_deg", "tilt_radial_deg")];
        all.extend(added(Effect::ModuleTilted, &tilts, 10.0));
        for side in Side::ALL {
            all.extend(self.open(module, side));
            all.extend(self.debonded(module, side));
        }
        all
    }

    fn column(&self, name: &str, value: f64) -> Option<Vec<f64>> {
        self.at(|change| matches!(change, Change::Number { name: own, .. } if *own == name), value)
    }

    fn at(&self, is_wanted: impl Fn(&Change) -> bool, value: f64) -> Option<Vec<f64>> {
        let at = self.changes.iter().position(is_wanted)?;
        let mut column = vec![0.0; self.size];
        column[CHANNELS + at] = value;
        Some(column)
    }

    /// A stiffness k: the field changes by k ∂G/∂k c with c = 1 − 1/factor.
    fn factor(&self, effect: Effect, target: Target, name: &str, bounds: [f64; 2]) -> Option<Candidate> {
        let own = self.changes.iter().find_map(|change| match change {
            Change::Number { name: of, own, .. } if *of == name => Some(*own),
            _ => None,
        })?;
        let number = CandidateNumber::of("factor", MultipleScale::Factor, bounds, self.column(name, own)?);
        Some(Candidate::of(effect, target, vec![number]))
    }

    fn open(&self, module: usize, side: Side) -> Option<Candidate> {
        let whole = side_share(self.device, side);
        let column = self.at(|change| *change == Change::FrameOpen(module, side), 1.0)?;
        let number = CandidateNumber::of("area_share", MultipleScale::Times(whole), [0.0, whole], column);
        Some(Candidate::of(Effect::ModuleFrameOpen, Target::ModuleSide(module, side), vec![number]))
    }

    fn debonded(&self, module: usize, side: Side) -> Option<Candidate> {
        let known = self.changes.iter().enumerate().filter_map(|(at, change)| match *change {
            Change::Debonded(of, from, share) if (of, from) == (module, side) => Some((CHANNELS + at, share)),
            _ => None,
        });
        let bond: Vec<(usize, f64)> = known.collect();
        let number =
            CandidateNumber::of("area_share", MultipleScale::Times(1.0), [0.0, 0.8], vec![0.0; self.size]);
        let of = Candidate::of(Effect::ModuleDebonded, Target::ModuleSide(module, side), vec![number]);
        (!bond.is_empty()).then_some(Candidate { bond, ..of })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::model::mechanics::changes;
    use tactpad_core::pad::changes::FieldChanges;
    use tactpad_core::pad::field::PadField;

    fn nominal() -> Vec<Candidate> {
        let device = Device::nominal();
        candidates(&device, &changes(&device, &device, &PadField::nominal(), &FieldChanges::nominal().0))
    }

    #[test]
    fn each_part_of_the_pad_has_its_candidates_and_nothing_names_all_of_it() {
        let all = nominal();
        let count = |effect: Effect| all.iter().filter(|it| it.effect == effect).count();
        let wanted = [
            (Effect::ChannelGain, 9),
            (Effect::ModuleGain, 3),
            (Effect::ModuleStiffness, 3),
            (Effect::ModuleDisplaced, 3),
            (Effect::ModuleRotated, 3),
            (Effect::ModuleTilted, 3),
            (Effect::ModuleDebonded, 12),
            (Effect::ModuleFrameOpen, 12),
            (Effect::PlateStiffness, 1),
        ];
        assert!(wanted.iter().all(|(effect, wanted)| count(*effect) == *wanted), "{}", all.len());
        assert_eq!(all.len(), wanted.iter().map(|(_, count)| count).sum::<usize>());
        // A gain of all channels would be a force.
        let is_common = |it: &Candidate| {
            it.numbers.iter().any(|number| number.column[..CHANNELS].iter().all(|c| *c != 0.0))
        };
        assert!(!all.iter().any(is_common));
    }

    #[test]
    fn a_bond_goes_through_the_known_changes() {
        let bond = [(0, 0.1), (1, 0.4), (2, 0.75)];
        for (at, share) in bond {
            let column = lost(&bond, share, 3);
            assert!(
                column
                    .iter()
                    .enumerate()
                    .all(|(of, entry)| (entry - f64::from(u8::from(of == at))).abs() < 1e-12)
            );
        }
        assert_eq!(lost(&bond, 0.0, 3), [0.0; 3]);
    }

    #[test]
    fn a_bond_has_the_share_that_the_equations_tell() {
        let candidate = nominal().into_iter().find(|it| it.effect == Effect::ModuleDebonded).unwrap();
        let size = candidate.numbers[0].column.len();
        let information: Vec<Vec<f64>> =
            (0..size).map(|i| (0..size).map(|j| if i == j { 50.0 } else { 0.0 }).collect()).collect();
        // s = S c(0.3): by that share all is explained, cᵀSc.
        let score: Vec<f64> = lost(&candidate.bond, 0.3, size).iter().map(|c| 50.0 * c).collect();
        let wanted: f64 = score.iter().map(|entry| entry * entry / 50.0).sum();
        let found = candidate.explained(&Reduced { information, score }).unwrap();
        assert!((found.square / wanted - 1.0).abs() < 1e-9);
        let (share, _) = found.candidate.numbers[0].estimate(0.3, 0.0);
        let column: Vec<f64> = found.candidate.numbers[0].column.iter().map(|c| 0.3 * c).collect();
        assert!((share - 0.3).abs() < 1e-12);
        assert!(
            column
                .iter()
                .zip(lost(&candidate.bond, 0.3, size))
                .all(|(one, other)| (one - other).abs() < 1e-12)
        );
    }

    #[test]
    fn numbers_are_told_as_the_diagnosis_tells_them() {
        assert!((MultipleScale::Gain.value(-0.08) - 0.92).abs() < 1e-12);
        assert!((MultipleScale::Factor.value(0.5) - 2.0).abs() < 1e-12);
        assert_eq!(MultipleScale::Factor.value(1.5), f64::INFINITY);
        assert!((MultipleScale::Times(0.25).value(0.5) - 0.125).abs() < 1e-12);
    }
}
