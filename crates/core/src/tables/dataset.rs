//! Contacts to train and to judge decoders on, drawn from a seed.
//!
//! [`paper`] draws those of the paper's section 2.3. `docs/simulation.md` says how its sentence is read: places even over
//! the disc; Fz even over 0 to 5 N; Fx and Fy of even magnitude and either sign.
//!
//! Places and forces do not depend on each other, nor one contact on another. No transcendental function is called, so
//! that every machine draws the same numbers.

use crate::pad::device::Patch;
use crate::quantity::Contact;
use tactpad_numeric::random::SplitMix64;

/// Contacts of the paper's dataset with a force along each axis; as many more are normal only.
pub const PAPER_HALF: usize = 7_200;

/// The paper's 14,400 contacts: [`PAPER_HALF`] three-axis ones, then as many normal ones.
///
/// Places reach `max_centre_radius_mm` of `patch`, each force `full_scale_n`. The same seed draws the same contacts.
///
/// Source: Wu et al., *Sensors* 2026, 26(4), 1378, section 2.3, read as `docs/simulation.md` says.
pub fn paper(patch: &Patch, seed: u64) -> Vec<Contact> {
    let mut random = SplitMix64::new(seed);
    let full_scale_n = patch.full_scale_n as f32;
    let mut contacts = Vec::with_capacity(2 * PAPER_HALF);
    for index in 0..2 * PAPER_HALF {
        let [x_mm, y_mm] = place(&mut random).map(|share| share * patch.max_centre_radius_mm as f32);
        let fz_n = full_scale_n * random.fraction();
        let mut contact = Contact { x_mm, y_mm, fz_n, ..Contact::default() };
        if index < PAPER_HALF {
            contact.fx_n = full_scale_n * random.uniform();
            contact.fy_n = full_scale_n * random.uniform();
        }
        contacts.push(contact);
    }
    contacts
}

/// A place on the unit disc, evenly over its area: the first of a square's places that lies on it.
fn place(random: &mut SplitMix64) -> [f32; 2] {
    loop {
        let [x, y] = [random.uniform(), random.uniform()];
        if x * x + y * y <= 1.0 {
            return [x, y];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PATCH: Patch = Patch { patch_radius_mm: 1.0, max_centre_radius_mm: 29.0, full_scale_n: 5.0 };

    /// Kolmogorov's statistic √n·D of a sample against the even distribution over 0..1.
    fn unevenness(sample: impl Iterator<Item = f64>) -> f64 {
        let mut sample: Vec<f64> = sample.collect();
        sample.sort_by(f64::total_cmp);
        let count = sample.len() as f64;
        let off = |(index, value): (usize, &f64)| {
            let below = index as f64 / count;
            (value - below).abs().max((below + 1.0 / count - value).abs())
        };
        count.sqrt() * sample.iter().enumerate().map(off).fold(0.0, f64::max)
    }

    /// An even sample exceeds this once in a million: 2 exp(−2 · 2.7²). The tests ask some 40 times.
    const UNEVEN: f64 = 2.7;

    fn halves(seed: u64) -> [Vec<Contact>; 2] {
        let mut three_axis = paper(&PATCH, seed);
        let normal = three_axis.split_off(PAPER_HALF);
        [three_axis, normal]
    }

    #[test]
    fn places_are_even_over_the_disc() {
        for seed in 0..4 {
            for half in halves(seed) {
                let polar = |contact: &Contact| {
                    let (x, y) = (f64::from(contact.x_mm) / 29.0, f64::from(contact.y_mm) / 29.0);
                    (x.hypot(y).powi(2), y.atan2(x) / std::f64::consts::TAU + 0.5)
                };
                assert!(half.iter().all(|contact| polar(contact).0 <= 1.0 + 1e-6));
                let area = unevenness(half.iter().map(|contact| polar(contact).0));
                let angle = unevenness(half.iter().map(|contact| polar(contact).1));
                assert!(area < UNEVEN && angle < UNEVEN, "seed {seed}: {area} {angle}");
            }
        }
    }

    #[test]
    fn forces_are_even_over_their_ranges() {
        for seed in 0..4 {
            let [three_axis, normal] = halves(seed);
            let fifth = |newtons: f32| f64::from(newtons) / 5.0;
            for half in [&three_axis, &normal] {
                let pressed = unevenness(half.iter().map(|contact| fifth(contact.fz_n)));
                assert!(pressed < UNEVEN, "seed {seed}: {pressed}");
            }
            let axes: [fn(&Contact) -> f32; 2] = [|contact| contact.fx_n, |contact| contact.fy_n];
            for of in axes {
                let magnitude = unevenness(three_axis.iter().map(|contact| fifth(of(contact).abs())));
                let forward = three_axis.iter().filter(|contact| of(contact) > 0.0).count() as f64;
                assert!(magnitude < UNEVEN, "seed {seed}: {magnitude}");
                // Five standard deviations of a fair coin.
                assert!((forward - 3_600.0).abs() < 5.0 * 7_200_f64.sqrt() / 2.0, "seed {seed}: {forward}");
            }
            assert!(normal.iter().all(|contact| (contact.fx_n, contact.fy_n) == (0.0, 0.0)));
        }
    }

    #[test]
    fn nothing_depends_on_anything_else() {
        let [three_axis, _] = halves(11);
        let values = |Contact { x_mm, y_mm, fx_n, fy_n, fz_n }: Contact| [x_mm, y_mm, fx_n, fy_n, fz_n - 2.5];
        let rows: Vec<[f64; 5]> =
            three_axis.into_iter().map(|contact| values(contact).map(f64::from)).collect();
        let products = |one: usize, other: usize, later: usize| -> f64 {
            rows.iter().zip(rows.iter().skip(later)).map(|(row, next)| row[one] * next[other]).sum()
        };
        for one in 0..5 {
            for other in 0..5 {
                for later in [0, 1] {
                    let norm = (products(one, one, 0) * products(other, other, 0)).sqrt();
                    let correlation = products(one, other, later) / norm;
                    let is_same = one == other && later == 0;
                    // Five standard deviations, 1/√7200 each.
                    assert!(is_same || correlation.abs() < 0.059, "{one} {other} {later}: {correlation}");
                }
            }
        }
    }

    #[test]
    fn the_patch_sets_the_ranges() {
        let small = Patch { patch_radius_mm: 1.0, max_centre_radius_mm: 2.9, full_scale_n: 10.0 };
        for (one, other) in paper(&PATCH, 3).iter().zip(paper(&small, 3)) {
            assert!((0.1 * one.x_mm - other.x_mm).abs() < 1e-5 && (2.0 * one.fx_n - other.fx_n).abs() < 1e-5);
            assert!((0.1 * one.y_mm - other.y_mm).abs() < 1e-5 && (2.0 * one.fz_n - other.fz_n).abs() < 1e-5);
        }
    }
}
