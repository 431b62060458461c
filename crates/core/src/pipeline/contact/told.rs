//! Contacts that a pad decoded on its own.

use firmware_proto::contact::{ContactSample, UNKNOWN};

use super::balance::on_plate;
use super::uncertainty::{Covariance, Estimate};
use crate::quantity::Contact;

/// Deviations of what a pad cannot tell: as unsure as a place on the plate, and a force of a finger, can be.
const UNKNOWN_MM: f64 = 15.0;
const UNKNOWN_N: f64 = 5.0;

/// The contact of a sample with how sure it is; `None` if nothing touches the pad. A place beyond the plate is moved to its rim.
pub fn estimate(sample: &ContactSample) -> Option<Estimate> {
    let ContactSample { place_um, force_mn, has_shear, .. } = sample;
    let [x_mm, y_mm] = on_plate(place_um.map(|um| f64::from(um) * 1e-3)).map(|mm| mm as f32);
    let [fx_n, fy_n, fz_n] = force_mn.map(|mn| (f64::from(mn) * 1e-3) as f32);
    let [fx_n, fy_n] = if *has_shear { [fx_n, fy_n] } else { [0.0; 2] };
    let deviation = |told: u16, unknown: f64| if told == UNKNOWN { unknown } else { f64::from(told) * 1e-3 };
    let place = deviation(sample.place_deviation_um, UNKNOWN_MM);
    let shear = if *has_shear { deviation(sample.shear_deviation_mn, UNKNOWN_N) } else { 0.0 };
    let normal = deviation(sample.normal_deviation_mn, UNKNOWN_N);
    let deviations = [place, place, shear, shear, normal];
    let covariance: Covariance = std::array::from_fn(|i| {
        std::array::from_fn(|j| if i == j { deviations[i] * deviations[i] } else { 0.0 })
    });
    let contact = Contact { x_mm, y_mm, fx_n, fy_n, fz_n };
    sample.is_touched.then_some(Estimate { contact, covariance, misfit: 0.0 })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_touch_is_what_the_pad_says_and_nothing_is_no_contact() {
        assert_eq!(estimate(&ContactSample::untouched(1, 2)), None);
        let touched = ContactSample {
            place_um: [12_500, -3_000],
            force_mn: [900, -400, 1_250],
            place_deviation_um: 400,
            is_touched: true,
            has_shear: true,
            ..ContactSample::untouched(1, 2)
        };
        let found = estimate(&touched).unwrap();
        assert_eq!(found.contact, Contact { x_mm: 12.5, y_mm: -3.0, fx_n: 0.9, fy_n: -0.4, fz_n: 1.25 });
        assert!((found.covariance[1][1].sqrt() - 0.4).abs() < 1e-9);
        let plain = estimate(&ContactSample { has_shear: false, ..touched }).unwrap().contact;
        assert_eq!((plain.fx_n, plain.fy_n), (0.0, 0.0), "it cannot measure them");
    }

    #[test]
    fn any_numbers_are_a_place_on_the_plate() {
        for um in [i32::MIN, i32::MAX] {
            let touched =
                ContactSample { place_um: [um; 2], is_touched: true, ..ContactSample::untouched(1, 2) };
            let Contact { x_mm, y_mm, .. } = estimate(&touched).unwrap().contact;
            assert!((f64::from(x_mm).hypot(f64::from(y_mm)) - 30.0).abs() < 1e-3, "{x_mm} {y_mm}");
        }
    }
}
