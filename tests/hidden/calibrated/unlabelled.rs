//! What presses without labels and a weight on marks tell somebody of a pad who knows what pads are drawn from: gains, leaks, a smooth
//! error of each map and, if asked, numbers of the device, all of them normal.
//!
//! Each contact's five numbers are unknown besides. With the parameters' precisions P, a contact's derivatives A by them and J by its own
//! numbers, the noise's precisions W and those Λ of its label, the information is H = P + Σ Aᵀ V⁻¹ A with
//! V⁻¹ = W − W J (Λ + Jᵀ W J)⁻¹ Jᵀ W, and what a contact with the derivatives B reads is known but for B H⁻¹ Bᵀ.

use super::bound::Hidden;
use super::device::DeviceChanges;
use super::learned::inverse;
use super::pad::{LEAK, REACH_MM, WIDE_GAIN};
use crate::plan::Contact;

use tactpad::numeric::linear::{LargeFactor, Symmetric};
use tactpad::numeric::products::{combined, dot};

/// So much of the background's variance may be left out of its expansion, at the rim.
const LEFT_MAX: f64 = 1e-3;

/// What is not known of a pad beside gains and leaks.
#[derive(Debug, Clone, Copy)]
pub(super) struct Unknown {
    /// A smooth error of each map, as large as this pad's.
    pub(super) background: bool,
    /// Numbers of the device.
    pub(super) device: bool,
}

/// A contact, and the precisions of its label.
pub(super) type Labelled = (Contact, [f64; 5]);

/// What contacts tell of a pad.
pub(super) struct Information<'h> {
    hidden: Hidden<'h>,
    device: DeviceChanges,
    /// Powers of x and y of the background's expansion.
    powers: Vec<[i32; 2]>,
    factor: Option<LargeFactor>,
}

impl<'h> Information<'h> {
    pub(super) fn of(hidden: Hidden<'h>, unknown: Unknown, contacts: &[Labelled]) -> Self {
        let powers = if unknown.background { powers(hidden.background.length_mm) } else { Vec::new() };
        let device = if unknown.device { DeviceChanges::of_any() } else { DeviceChanges::none() };
        let mut it = Self { hidden, device, powers, factor: None };
        // All columns are of one deviation.
        let size = it.slopes(&contacts[0].0)[0].len();
        let mut information = Symmetric::zeros(size);
        (0..size).for_each(|at| information.add_diagonal(at, 1.0));
        for some in contacts.chunks(8) {
            let pairs = some.iter().flat_map(|(contact, label)| {
                let rows = it.slopes(contact);
                let weighted = combined(&it.precision(contact, label), &rows);
                rows.into_iter().zip(weighted)
            });
            information.add_products(&pairs.collect::<Vec<_>>());
        }
        it.factor = information.factorised();
        it
    }

    /// V⁻¹.
    fn precision(&self, contact: &Contact, label: &[f64; 5]) -> [[f64; 9]; 9] {
        let (slopes, variances) = self.hidden.linearised(contact);
        let mut own = [[0.0; 5]; 5];
        for (i, row) in own.iter_mut().enumerate() {
            row[i] = label[i];
            for (j, entry) in row.iter_mut().enumerate() {
                *entry += (0..9).map(|k| slopes[i][k] * slopes[j][k] / variances[k]).sum::<f64>();
            }
        }
        let covariance = inverse(own);
        std::array::from_fn(|k| {
            std::array::from_fn(|l| {
                let by_contact: f64 = (0..25)
                    .map(|at| slopes[at / 5][k] * covariance[at / 5][at % 5] * slopes[at % 5][l])
                    .sum();
                (f64::from(u8::from(k == l)) - by_contact / variances[l]) / variances[k]
            })
        })
    }

    /// A: the channels' derivatives, by one deviation of each parameter.
    fn slopes(&self, contact: &Contact) -> Vec<Vec<f64>> {
        let Hidden { background, wiring, .. } = self.hidden;
        let Contact { place: [x, y], force } = *contact;
        let strain = self.hidden.strain(contact);
        let [east, north] = [x, y].map(|mm| mm / background.length_mm);
        let near = (-0.5 * (east * east + north * north)).exp();
        let terms: Vec<f64> = self
            .powers
            .iter()
            .map(|[i, j]| near * east.powi(*i) * north.powi(*j) / (factorial(*i) * factorial(*j)).sqrt())
            .collect();
        let mut columns: Vec<[f64; 9]> = Vec::new();
        let mut of_signal = [const { Vec::new() }; 9];
        for (channel, own) in of_signal.iter_mut().enumerate() {
            own.push(WIDE_GAIN / 3_f64.sqrt() * strain[channel]);
            for (axis, n) in force.iter().enumerate() {
                let size = wiring.gains[channel] * background.deviation(channel, axis) * n;
                own.extend(terms.iter().map(|term| size * term));
            }
        }
        // Into each channel: from itself, and what leaks.
        let coupled = |channel: usize, uv: f64| {
            let mut column = [0.0; 9];
            column[channel] = uv;
            wiring
                .leaks
                .iter()
                .filter(|leak| leak.1 == channel)
                .for_each(|leak| column[leak.0] += leak.2 * uv);
            column
        };
        for (channel, own) in of_signal.iter().enumerate() {
            columns.extend(own.iter().map(|uv| coupled(channel, *uv)));
        }
        for (into, from) in (0..81).map(|index| (index / 9, index % 9)).filter(|(into, from)| into != from) {
            let mut column = [0.0; 9];
            column[into] = LEAK * wiring.gains[from] * strain[from];
            columns.push(column);
        }
        columns.extend(self.device.columns(contact, wiring));
        (0..9).map(|channel| columns.iter().map(|column| column[channel]).collect()).collect()
    }

    /// Covariance of what a contact reads, with what is not known of the pad.
    pub(super) fn unknown(&self, contact: &Contact) -> [[f64; 9]; 9] {
        let factor = self.factor.as_ref().unwrap();
        let halves: Vec<Vec<f64>> = self.slopes(contact).iter().map(|row| factor.solve_lower(row)).collect();
        std::array::from_fn(|k| std::array::from_fn(|l| dot(&halves[k], &halves[l])))
    }
}

/// exp(−d²/2l²) of two places is Σ φ φ′ with φ = exp(−r²/2l²) (x/l)ⁱ (y/l)ʲ/√(i! j!): what i + j > n leave of 1 at a radius r is a Poisson
/// number's probability.
fn powers(length_mm: f64) -> Vec<[i32; 2]> {
    let rate = (REACH_MM / length_mm).powi(2);
    let mut left = 1.0;
    let mut powers = Vec::new();
    for degree in 0.. {
        powers.extend((0..=degree).map(|i| [i, degree - i]));
        left -= (-rate).exp() * rate.powi(degree) / factorial(degree);
        if left < LEFT_MAX {
            break;
        }
    }
    powers
}

fn factorial(of: i32) -> f64 {
    (1..=of).map(f64::from).product()
}
