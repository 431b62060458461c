//! Posterior predictive checks: whether the contacts miss the fit alike everywhere, as the noise model says that they do.
//!
//! With V of the noise model a contact's residual r has q = rᵀ V⁻¹ r, which is 9 f as a mean where the model is right, with the share f of the
//! readings that are degrees of freedom. V is fitted to all contacts, so all of them together say nothing; but in a third of the
//! plate, of the forces or of the time n contacts should have the mean q̄ of all, and 9 n q̄ₜ/q̄ be χ² with 9 n degrees of freedom.
//! Where they miss by more the model lacks something there, and regions that are stated there are too narrow.
//!
//! Source: A. Gelman, X.-L. Meng, H. Stern, Statistica Sinica 6 (1996) 733.

use crate::calibration::data::contacts::Knowledge;
use crate::calibration::problem::ExplainedContact;
use tactpad_core::quantity::CHANNELS;
use tactpad_numeric::chi_square::exceeded;

/// Parts of each kind.
pub const PARTS: usize = 3;
/// Level of false alarms, for all parts together.
const LEVEL: f64 = 0.01;
/// What misses by less, as a mean square, is too little to be told.
const RATIO_MIN: f64 = 1.25;
/// Fewer contacts than these in a part are no part.
const CONTACTS_MIN: usize = 8;

/// Partition of the contacts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Partition {
    /// Their distance from the middle.
    Radius,
    /// The magnitude of their force.
    Force,
    /// When they were measured.
    Time,
}

impl Partition {
    const ALL: [Self; 3] = [Self::Radius, Self::Force, Self::Time];

    fn of(self, contact: &ExplainedContact) -> f64 {
        match self {
            Self::Radius => libm::hypot(contact.place_mm[0], contact.place_mm[1]),
            Self::Force => contact.residual.force_n,
            Self::Time => contact.residual.at_s,
        }
    }
}

/// One part of the contacts, held against all of them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PredictiveCheck {
    /// Partition of the contacts.
    pub by: Partition,
    /// Which third, by that, from the smallest on.
    pub third: usize,
    /// Contacts in it.
    pub contacts: usize,
    /// Their mean square over that of all.
    pub ratio: f64,
    /// Probability of a ratio so large by chance.
    pub p_value: f64,
}

impl PredictiveCheck {
    /// Whether they miss by more than the noise model says.
    pub fn is_missed(&self) -> bool {
        self.ratio >= RATIO_MIN && self.p_value < LEVEL / (Partition::ALL.len() * PARTS) as f64
    }
}

/// The checks of all written contacts; none of presses, whose noise lasts from one to the next.
pub(crate) fn checks(contacts: &[ExplainedContact]) -> Vec<PredictiveCheck> {
    let written: Vec<&ExplainedContact> =
        contacts.iter().filter(|it| it.residual.knowledge == Knowledge::Written).collect();
    let mean = written.iter().map(|it| square(it)).sum::<f64>() / written.len().max(1) as f64;
    if written.len() < PARTS * CONTACTS_MIN || mean <= 0.0 {
        return Vec::new();
    }
    Partition::ALL.into_iter().flat_map(|by| thirds(by, &written, mean)).collect()
}

fn thirds(by: Partition, contacts: &[&ExplainedContact], mean: f64) -> Vec<PredictiveCheck> {
    let mut sorted = contacts.to_vec();
    sorted.sort_by(|one, other| by.of(one).total_cmp(&by.of(other)));
    // Tables without times have one time.
    if sorted.first().map(|it| by.of(it)) == sorted.last().map(|it| by.of(it)) {
        return Vec::new();
    }
    let length = sorted.len().div_ceil(PARTS);
    let check = |(third, part): (usize, &[&ExplainedContact])| {
        let squares: f64 = part.iter().map(|it| square(it)).sum();
        let freedom = CHANNELS * part.len();
        let p_value = exceeded(CHANNELS as f64 * squares / mean, freedom);
        PredictiveCheck {
            by,
            third,
            contacts: part.len(),
            ratio: squares / mean / part.len() as f64,
            p_value,
        }
    };
    sorted.chunks(length).enumerate().map(check).collect()
}

/// q.
fn square(contact: &ExplainedContact) -> f64 {
    contact.precision.square(&contact.residual.residual_uv)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::calibration::noise::residual::{MarginalPrecision, Residual};
    use tactpad_core::pipeline::contact::uncertainty::UNKNOWNS;
    use tactpad_numeric::random::SplitMix64;

    /// Contacts with noise of 1, and of `rim` beyond 20 mm.
    fn contacts(rim: f64, knowledge: Knowledge, seed: u64) -> Vec<ExplainedContact> {
        let mut random = SplitMix64::new(seed);
        let precision = MarginalPrecision {
            weights: [1.0; CHANNELS],
            downdates: [[0.0; CHANNELS]; UNKNOWNS],
            log_determinant: 0.0,
        };
        let one = |index: usize| {
            let radius_mm = 27.0 * f64::from(random.fraction());
            let size = if radius_mm > 20.0 { rim } else { 1.0 };
            let residual = Residual {
                knowledge,
                at_s: index as f64,
                uv: [0.0; CHANNELS],
                force_n: f64::from(random.fraction()),
                residual_uv: [0; CHANNELS].map(|_| size * f64::from(random.normal())),
                label_jacobian: [[0.0; UNKNOWNS]; CHANNELS],
            };
            ExplainedContact { place_mm: [radius_mm, 0.0], residual, precision }
        };
        (0..300).map(one).collect()
    }

    #[test]
    fn alike_everywhere_nothing_is_missed() {
        let missed = (0..50).filter(|seed| {
            let found = checks(&contacts(1.0, Knowledge::Written, *seed));
            assert_eq!(found.len(), 9);
            found.iter().any(PredictiveCheck::is_missed)
        });
        assert_eq!(missed.count(), 0);
    }

    #[test]
    fn a_rim_that_is_not_described_is_told_by_radius() {
        let found = checks(&contacts(1.5, Knowledge::Written, 1));
        let missed: Vec<_> = found.iter().filter(|it| it.is_missed()).collect();
        let [rim] = missed.as_slice() else { panic!("{found:?}") };
        assert_eq!((rim.by, rim.third, rim.contacts), (Partition::Radius, 2, 100));
        // 78 of these 100 have 2.25 times the square, of all 300 a quarter: 1.97/1.32.
        assert!((rim.ratio - 1.5).abs() < 0.15, "{rim:?}");
    }

    #[test]
    fn presses_and_few_contacts_are_not_checked() {
        assert!(checks(&contacts(3.0, Knowledge::Unlabelled, 1)).is_empty());
        assert!(checks(&contacts(3.0, Knowledge::Written, 1)[..20]).is_empty());
    }
}
