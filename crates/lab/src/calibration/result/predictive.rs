//! Posterior predictive checks: whether contacts that are held out miss the fit by as much as it says that they will.
//!
//! A contact's residual r has the covariance V − G about the fit that it had a part in, with V of the noise model and the posterior
//! covariance G of what the fit says. About the fit of all other contacts it is r₋ = V (V − G)⁻¹ r, with the covariance
//! C = V (V − G)⁻¹ V. Decoded by R = (JᵀWJ)⁻¹ JᵀW it misses its label by d = R r₋, with the covariance D = R C Rᵀ. So q = dᵀ D⁻¹ d over
//! the place is 2 in the mean, over the force 3: of all contacts together, and of each third of the plate, of the forces and of the time.
//! Where they miss by more the model lacks something there, and regions that are stated there are too narrow.
//!
//! Labels have gross errors, so q has another distribution than χ²: that of n contacts is χ² of ν = 2 n m²/s² degrees, with the mean
//! m and the variance s² of all.
//!
//! Sources: A. Gelman, X.-L. Meng, H. Stern, Statistica Sinica 6 (1996) 733; R. D. Cook, S. Weisberg, Residuals and Influence in
//! Regression, Chapman and Hall 1982, section 2.2 (leaving one out by the fit of all); F. E. Satterthwaite, Biometrics Bulletin 2 (1946)
//! 110 (ν).

use crate::calibration::data::contacts::Knowledge;
use crate::calibration::problem::ExplainedContact;
use tactpad_core::pipeline::contact::uncertainty::UNKNOWNS;
use tactpad_core::quantity::CHANNELS;
use tactpad_numeric::chi_square::exceeded;
use tactpad_numeric::linear::Factor;
use tactpad_numeric::products::dot;
use tactpad_numeric::statistics::{mean, population_deviation};

/// Parts of each kind.
const PARTS: usize = 3;
/// Checks: the place and the force, of all contacts and of the thirds by radius, force and time.
const CHECKS: usize = 2 * (1 + 3 * PARTS);
/// Level of false alarms, for all checks together.
const LEVEL: f64 = 0.01;
/// What misses by less, as a mean square, is too little to be told.
const RATIO_MIN: f64 = 1.25;
/// Fewer contacts than these in a part are no part.
const CONTACTS_MIN: usize = 8;

/// Numbers of a contact that a fit predicts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Predicted {
    /// x and y.
    Place,
    /// Fx, Fy and Fz.
    Force,
}

impl Predicted {
    const ALL: [Self; 2] = [Self::Place, Self::Force];
    const PLACE: usize = 2;
    const FORCE: usize = UNKNOWNS - Self::PLACE;

    /// How many.
    const fn numbers(self) -> usize {
        match self {
            Self::Place => Self::PLACE,
            Self::Force => Self::FORCE,
        }
    }
}

/// Partition of the contacts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Partition {
    /// All of them.
    Whole,
    /// Their distance from the middle.
    Radius,
    /// The magnitude of their force.
    Force,
    /// When they were measured.
    Time,
}

impl Partition {
    const THIRDS: [Self; 3] = [Self::Radius, Self::Force, Self::Time];

    fn of(self, contact: &ExplainedContact) -> f64 {
        match self {
            Self::Whole => 0.0,
            Self::Radius => libm::hypot(contact.place_mm[0], contact.place_mm[1]),
            Self::Force => contact.residual.force_n,
            Self::Time => contact.residual.at_s,
        }
    }
}

/// One part of the contacts, each held out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PredictiveCheck {
    /// What is predicted of them.
    pub of: Predicted,
    /// Partition of the contacts.
    pub by: Partition,
    /// Which third, by that, from the smallest on; 0 of all.
    pub third: usize,
    /// Contacts in it.
    pub contacts: usize,
    /// Their mean square over the stated one.
    pub ratio: f64,
    /// Probability of a ratio so large by chance.
    pub p_value: f64,
}

impl PredictiveCheck {
    /// Whether they miss by more than is stated.
    pub fn is_missed(&self) -> bool {
        self.ratio >= RATIO_MIN && self.p_value < LEVEL / CHECKS as f64
    }
}

/// The factor by which stated deviations are too small where they are so most.
pub fn widening(checks: &[PredictiveCheck]) -> f64 {
    let missed = checks.iter().filter(|it| it.is_missed());
    missed.map(|it| it.ratio.sqrt()).fold(1.0, f64::max)
}

/// The checks of all written contacts; none of presses, whose noise lasts from one to the next.
pub(crate) fn checks(contacts: &[ExplainedContact]) -> Vec<PredictiveCheck> {
    let written = contacts.iter().filter(|it| it.residual.knowledge == Knowledge::Written);
    let held_out: Vec<HeldOut<'_>> = written.filter_map(HeldOut::of).collect();
    if held_out.len() < PARTS * CONTACTS_MIN {
        return Vec::new();
    }
    Predicted::ALL.into_iter().flat_map(|of| checks_of(of, &held_out)).collect()
}

/// A contact about the fit of all others.
struct HeldOut<'c> {
    contact: &'c ExplainedContact,
    /// q over what is predicted of it.
    squares: [f64; Predicted::ALL.len()],
}

impl<'c> HeldOut<'c> {
    /// `None` where the fit does not tell the contact.
    fn of(contact: &'c ExplainedContact) -> Option<Self> {
        let ExplainedContact { residual, precision, posterior_uv2, .. } = contact;
        let covariance = Factor::of(&precision.matrix())?.inverse();
        let own = from_fn(|k, l| covariance[k][l] - posterior_uv2[k][l]);
        // (V − G)⁻¹ V, whose transpose is V (V − G)⁻¹.
        let factor = Factor::of(&own)?;
        let spread: [[f64; CHANNELS]; CHANNELS] = covariance.map(|row| factor.solve(&row));
        // JᵀW and (JᵀWJ)⁻¹ JᵀW.
        let jacobian = &residual.label_jacobian;
        let weighted: [[f64; CHANNELS]; UNKNOWNS] =
            from_fn(|unknown, channel| jacobian[channel][unknown] * precision.weights[channel]);
        let normal: [[f64; UNKNOWNS]; UNKNOWNS] = from_fn(|one, other| {
            (0..CHANNELS).map(|channel| weighted[one][channel] * jacobian[channel][other]).sum()
        });
        let normal = Factor::of(&normal)?;
        let columns: [[f64; UNKNOWNS]; CHANNELS] = std::array::from_fn(|channel| {
            normal.solve(&std::array::from_fn(|unknown| weighted[unknown][channel]))
        });
        let decoding: [[f64; CHANNELS]; UNKNOWNS] = from_fn(|unknown, channel| columns[channel][unknown]);
        // R V (V − G)⁻¹, then d and D.
        let by_residual: [[f64; CHANNELS]; UNKNOWNS] =
            from_fn(|unknown, l| (0..CHANNELS).map(|k| decoding[unknown][k] * spread[k][l]).sum());
        let missed: [f64; UNKNOWNS] = by_residual.map(|row| dot(&row, &residual.residual_uv));
        let by_reading = by_residual.map(|row| covariance.map(|column| dot(&row, &column)));
        let stated: [[f64; UNKNOWNS]; UNKNOWNS] =
            from_fn(|one, other| dot(&by_reading[one], &decoding[other]));
        let place = square::<{ Predicted::PLACE }>(&missed, &stated, 0)?;
        let force = square::<{ Predicted::FORCE }>(&missed, &stated, Predicted::PLACE)?;
        Some(Self { contact, squares: [place, force] })
    }
}

fn from_fn<const ROWS: usize, const COLUMNS: usize>(
    entry: impl Fn(usize, usize) -> f64,
) -> [[f64; COLUMNS]; ROWS] {
    std::array::from_fn(|row| std::array::from_fn(|column| entry(row, column)))
}

/// dᵀ D⁻¹ d over N unknowns from the first on.
fn square<const N: usize>(
    missed: &[f64; UNKNOWNS],
    covariance: &[[f64; UNKNOWNS]; UNKNOWNS],
    first: usize,
) -> Option<f64> {
    let factor = Factor::<N>::of(&from_fn(|one, other| covariance[first + one][first + other]))?;
    let missed: [f64; N] = std::array::from_fn(|at| missed[first + at]);
    Some(dot(&missed, &factor.solve(&missed)))
}

fn checks_of(of: Predicted, held_out: &[HeldOut<'_>]) -> Vec<PredictiveCheck> {
    let square = |it: &HeldOut<'_>| it.squares[of as usize];
    let all: Vec<f64> = held_out.iter().map(square).collect();
    let [middle, deviation] = [mean(all.iter().copied()), population_deviation(&all)];
    let stated = of.numbers() as f64;
    // χ² has s² = 2 m, so that ν is m for each contact.
    let freedom = 2.0 * middle * middle / (deviation * deviation).max(2.0 * middle * middle / stated);
    let check = |by: Partition, third: usize, part: &[&HeldOut<'_>]| {
        let ratio = mean(part.iter().map(|it| square(it))) / stated;
        let freedom = freedom * part.len() as f64;
        let p_value = exceeded(ratio * freedom, freedom.round() as usize);
        PredictiveCheck { of, by, third, contacts: part.len(), ratio, p_value }
    };
    let mut sorted: Vec<&HeldOut<'_>> = held_out.iter().collect();
    let mut found = vec![check(Partition::Whole, 0, &sorted)];
    for by in Partition::THIRDS {
        let place = |it: &HeldOut<'_>| by.of(it.contact);
        sorted.sort_by(|one, other| place(one).total_cmp(&place(other)));
        // Tables without times have one time.
        if sorted.first().map(|it| place(it)) != sorted.last().map(|it| place(it)) {
            let thirds = sorted.chunks(sorted.len().div_ceil(PARTS)).enumerate();
            found.extend(thirds.map(|(third, part)| check(by, third, part)));
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::calibration::noise::residual::{MarginalPrecision, Residual};
    use tactpad_numeric::linear::Symmetric;
    use tactpad_numeric::random::SplitMix64;

    const PRECISION: MarginalPrecision = MarginalPrecision {
        weights: [1.0; CHANNELS],
        downdates: [[0.0; CHANNELS]; UNKNOWNS],
        log_determinant: 0.0,
    };

    /// Contacts with residuals of deviation 1 beside a fit that is certain, and of `rim` beyond 20 mm.
    fn contacts(rim: f64, knowledge: Knowledge, seed: u64) -> Vec<ExplainedContact> {
        let mut random = SplitMix64::new(seed);
        let one = |index: usize| {
            let radius_mm = 27.0 * f64::from(random.fraction());
            let size = if radius_mm > 20.0 { rim } else { 1.0 };
            let residual = Residual {
                knowledge,
                at_s: index as f64,
                uv: [0.0; CHANNELS],
                force_n: f64::from(random.fraction()),
                residual_uv: [0; CHANNELS].map(|_| size * f64::from(random.normal())),
                label_jacobian: [0; CHANNELS].map(|_| [0; UNKNOWNS].map(|_| f64::from(random.normal()))),
            };
            let posterior_uv2 = [[0.0; CHANNELS]; CHANNELS];
            ExplainedContact { place_mm: [radius_mm, 0.0], residual, precision: PRECISION, posterior_uv2 }
        };
        (0..300).map(one).collect()
    }

    #[test]
    fn alike_everywhere_nothing_is_missed() {
        let missed = (0..400).filter(|seed| {
            let found = checks(&contacts(1.0, Knowledge::Written, *seed));
            assert_eq!(found.len(), CHECKS);
            widening(&found) > 1.0
        });
        // Four are expected.
        assert!(missed.count() <= 8);
    }

    #[test]
    fn a_rim_that_is_not_described_is_told_by_radius() {
        let found = checks(&contacts(2.0, Knowledge::Written, 1));
        let rims: Vec<_> = found.iter().filter(|it| it.is_missed() && it.by == Partition::Radius).collect();
        let [place, force] = rims.as_slice() else { panic!("{found:?}") };
        assert_eq!(
            (place.of, place.third, force.of, force.third),
            (Predicted::Place, 2, Predicted::Force, 2)
        );
        // 78 of these 100 have four times the square.
        assert!((force.ratio - 3.3).abs() < 0.5, "{force:?}");
        assert!((widening(&found) - 3.3_f64.sqrt()).abs() < 0.2, "{found:?}");
    }

    /// Readings y = A θ + r of forty contacts under a prior of precision 1 for twenty parameters.
    #[test]
    fn leaving_one_out_by_the_fit_of_all_is_the_fit_of_all_others() {
        const PARAMETERS: usize = 20;
        let mut contacts = contacts(1.0, Knowledge::Written, 3);
        contacts.truncate(40);
        let mut random = SplitMix64::new(4);
        let mut normal = || f64::from(random.normal());
        let slopes: Vec<[Vec<f64>; CHANNELS]> = contacts
            .iter()
            .map(|_| [0; CHANNELS].map(|_| (0..PARAMETERS).map(|_| normal()).collect()))
            .collect();
        let readings: Vec<[f64; CHANNELS]> = contacts.iter().map(|it| it.residual.residual_uv).collect();
        // Residuals and posterior covariance of a contact about the fit of these.
        let about = |left_out: Option<usize>, at: usize| {
            let mut curvature = Symmetric::zeros(PARAMETERS);
            let mut right = vec![0.0; PARAMETERS];
            (0..PARAMETERS).for_each(|parameter| curvature.add_diagonal(parameter, 1.0));
            for of in (0..contacts.len()).filter(|of| Some(*of) != left_out) {
                for (row, reading) in slopes[of].iter().zip(readings[of]) {
                    curvature.add_product(1.0, row);
                    right.iter_mut().zip(row).for_each(|(right, slope)| *right += slope * reading);
                }
            }
            let factor = curvature.factorised().unwrap();
            let solution = factor.solve(&right);
            let halves = slopes[at].each_ref().map(|row| factor.solve_lower(row));
            let residual_uv: [f64; CHANNELS] =
                std::array::from_fn(|k| readings[at][k] - dot(&slopes[at][k], &solution));
            let posterior_uv2: [[f64; CHANNELS]; CHANNELS] = from_fn(|k, l| dot(&halves[k], &halves[l]));
            (residual_uv, posterior_uv2)
        };
        for at in [0, 17, 39] {
            let mut contact = contacts[at].clone();
            (contact.residual.residual_uv, contact.posterior_uv2) = about(None, at);
            let by_all = HeldOut::of(&contact).unwrap().squares;
            // About all others C = V + G, and V is 1.
            let (residual_uv, posterior_uv2) = about(Some(at), at);
            let others: [[f64; CHANNELS]; CHANNELS] =
                from_fn(|k, l| posterior_uv2[k][l] + f64::from(u8::from(k == l)));
            let jacobian = contact.residual.label_jacobian;
            let normal: [[f64; UNKNOWNS]; UNKNOWNS] =
                from_fn(|i, j| (0..CHANNELS).map(|k| jacobian[k][i] * jacobian[k][j]).sum());
            let normal = Factor::of(&normal).unwrap();
            let columns = jacobian.map(|row| normal.solve(&row));
            let decoding: [[f64; CHANNELS]; UNKNOWNS] = from_fn(|unknown, k| columns[k][unknown]);
            let missed = decoding.map(|row| dot(&row, &residual_uv));
            let stated: [[f64; UNKNOWNS]; UNKNOWNS] =
                from_fn(|i, j| (0..CHANNELS).map(|k| decoding[i][k] * dot(&others[k], &decoding[j])).sum());
            let by_others =
                [square::<2>(&missed, &stated, 0).unwrap(), square::<3>(&missed, &stated, 2).unwrap()];
            for (one, other) in by_all.iter().zip(by_others) {
                assert!((one - other).abs() < 1e-9 * other, "{by_all:?} {by_others:?}");
            }
        }
    }

    #[test]
    fn presses_and_few_contacts_are_not_checked() {
        assert!(checks(&contacts(3.0, Knowledge::Unlabelled, 1)).is_empty());
        assert!(checks(&contacts(3.0, Knowledge::Written, 1)[..20]).is_empty());
    }
}
