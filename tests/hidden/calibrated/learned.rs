//! What labels tell somebody of a pad who knows what pads are drawn from: gains, leaks, a smooth error of each map and, if asked,
//! numbers of the device, all of them normal, as a Gaussian process. By that the readings of a contact are known but for a covariance.
//!
//! With the parameters' covariance P, the labelled contacts' derivatives A and the covariance V of their noise, with that of their
//! labels, the covariance of what readings Bθ of another contact are is B P Bᵀ − B P Aᵀ (A P Aᵀ + V)⁻¹ A P Bᵀ.

use super::bound::Hidden;
use super::device::DeviceChanges;
use super::pad::{LABEL_MM, LABEL_N, LEAK, WIDE_GAIN};
use crate::plan::Contact;

/// A pad's labelled contacts.
pub(super) struct Learned<'h> {
    hidden: Hidden<'h>,
    device: DeviceChanges,
    known: Vec<Known>,
    /// L of A P Aᵀ + V = L Lᵀ, row by row up to the diagonal.
    lower: Vec<Vec<f64>>,
}

/// A contact, its strains, and the channels' signals after gains.
struct Known {
    contact: Contact,
    strain: [f64; 9],
    own: [f64; 9],
    /// Changes of the readings by one deviation of each number of the device that is not known.
    by_device: Vec<[f64; 9]>,
}

impl<'h> Learned<'h> {
    pub(super) fn of(hidden: Hidden<'h>, device: DeviceChanges, contacts: &[Contact]) -> Self {
        let loaded = contacts.iter().filter(|contact| contact.force != [0.0; 3]);
        let known: Vec<Known> = loaded.map(|contact| Known::of(&hidden, &device, contact)).collect();
        let mut learned = Self { hidden, device, known, lower: Vec::new() };
        for (at, one) in learned.known.iter().enumerate() {
            let (slopes, variances) = hidden.linearised(&one.contact);
            let labels = [LABEL_MM, LABEL_MM, LABEL_N, LABEL_N, LABEL_N];
            let noise = |i: usize, j: usize| {
                let own = if i == j { variances[i] } else { 0.0 };
                own + (0..5).map(|k| labels[k].powi(2) * slopes[k][i] * slopes[k][j]).sum::<f64>()
            };
            let blocks: Vec<[[f64; 9]; 9]> =
                learned.known[..=at].iter().map(|other| learned.covariance(one, other)).collect();
            for i in 0..9 {
                let mut row: Vec<f64> = blocks.iter().flat_map(|block| block[i]).collect();
                row.truncate(9 * at + i + 1);
                (0..=i).for_each(|j| row[9 * at + j] += noise(i, j));
                learned.lower.push(row);
            }
        }
        // Cholesky: Lᵢⱼ = (Aᵢⱼ − Σₖ Lᵢₖ Lⱼₖ)/Lⱼⱼ.
        for row in 0..learned.lower.len() {
            let (before, rest) = learned.lower.split_at_mut(row);
            let own = &mut rest[0];
            for (column, other) in before.iter().enumerate() {
                let sum: f64 = own[..column].iter().zip(other).map(|(own, other)| own * other).sum();
                own[column] = (own[column] - sum) / other[column];
            }
            let sum: f64 = own[..row].iter().map(|own| own * own).sum();
            own[row] = (own[row] - sum).sqrt();
        }
        learned
    }

    /// A P Bᵀ of two contacts.
    fn covariance(&self, one: &Known, other: &Known) -> [[f64; 9]; 9] {
        let Hidden { background, wiring, .. } = self.hidden;
        let [dx, dy] = [0, 1].map(|axis| one.contact.place[axis] - other.contact.place[axis]);
        let near = (-0.5 * (dx * dx + dy * dy) / background.length_mm.powi(2)).exp();
        let mut covariance = [[0.0; 9]; 9];
        for (one, other) in one.by_device.iter().zip(&other.by_device) {
            for (row, one) in covariance.iter_mut().zip(one) {
                row.iter_mut().zip(other).for_each(|(entry, other)| *entry += one * other);
            }
        }
        for channel in 0..9 {
            let gain = WIDE_GAIN.powi(2) / 3.0 * one.strain[channel] * other.strain[channel];
            let maps: f64 = (0..3)
                .map(|axis| {
                    let forces = one.contact.force[axis] * other.contact.force[axis];
                    (wiring.gains[channel] * background.deviation(channel, axis)).powi(2) * near * forces
                })
                .sum();
            // Of a channel's signal into each channel: itself, and those into which it leaks.
            let mut coupling = [0.0; 9];
            coupling[channel] = 1.0;
            wiring.leaks.iter().filter(|leak| leak.1 == channel).for_each(|leak| coupling[leak.0] += leak.2);
            for (i, row) in covariance.iter_mut().enumerate() {
                row.iter_mut()
                    .zip(coupling)
                    .for_each(|(entry, to)| *entry += (gain + maps) * coupling[i] * to);
                if i != channel {
                    row[i] += LEAK.powi(2) * one.own[channel] * other.own[channel];
                }
            }
        }
        covariance
    }

    /// Covariance of what a contact reads, with what is not known of the pad.
    pub(super) fn unknown(&self, contact: &Contact) -> [[f64; 9]; 9] {
        let one = Known::of(&self.hidden, &self.device, contact);
        let blocks: Vec<[[f64; 9]; 9]> =
            self.known.iter().map(|other| self.covariance(&one, other)).collect();
        // L⁻¹ A P Bᵀ, channel by channel.
        let halves: Vec<Vec<f64>> = (0..9)
            .map(|channel| {
                let mut half: Vec<f64> = blocks.iter().flat_map(|block| block[channel]).collect();
                for row in 0..half.len() {
                    let (before, rest) = half.split_at_mut(row);
                    let sum: f64 =
                        self.lower[row].iter().zip(before).map(|(lower, half)| lower * *half).sum();
                    rest[0] = (rest[0] - sum) / self.lower[row][row];
                }
                half
            })
            .collect();
        let mut unknown = self.covariance(&one, &one);
        for (i, row) in unknown.iter_mut().enumerate() {
            for (j, entry) in row.iter_mut().enumerate() {
                *entry -= halves[i].iter().zip(&halves[j]).map(|(one, other)| one * other).sum::<f64>();
            }
        }
        unknown
    }
}

impl Known {
    fn of(hidden: &Hidden<'_>, device: &DeviceChanges, contact: &Contact) -> Self {
        let strain = hidden.strain(contact);
        Self {
            contact: *contact,
            strain,
            own: std::array::from_fn(|k| hidden.wiring.gains[k] * strain[k]),
            by_device: device.columns(contact, hidden.wiring),
        }
    }
}

/// A matrix's inverse, by Gauss and Jordan's elimination.
pub(super) fn inverse<const N: usize>(mut matrix: [[f64; N]; N]) -> [[f64; N]; N] {
    let mut inverse: [[f64; N]; N] =
        std::array::from_fn(|i| std::array::from_fn(|j| f64::from(u8::from(i == j))));
    for pivot in 0..N {
        let own = matrix[pivot][pivot];
        matrix[pivot] = matrix[pivot].map(|value| value / own);
        inverse[pivot] = inverse[pivot].map(|value| value / own);
        for row in (0..N).filter(|row| *row != pivot) {
            let factor = matrix[row][pivot];
            for column in 0..N {
                matrix[row][column] -= factor * matrix[pivot][column];
                inverse[row][column] -= factor * inverse[pivot][column];
            }
        }
    }
    inverse
}
