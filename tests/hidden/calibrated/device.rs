//! What is not known of a device: how a contact's readings change with each of its numbers.

use super::pad::Wiring;
use crate::plan::Contact;

use tactpad::numeric::zernike::{Polynomial, jets};
use tactpad::pad::device::Device;
use tactpad::pad::device::unit::Unit;
use tactpad::pad::field::PadField;

/// How well numbers of a device are known, as `adapt` has it: where a module stands (mm, degrees), its moduli, those of all modules,
/// the plate's thickness.
const SHIFT_MM: f64 = 0.15;
const TURN_DEG: f64 = 2.0;
const MODULE_SHARE: f64 = 0.3;
const COMMON_SHARE: f64 = 0.2;
const THICKNESS_SHARE: f64 = 0.08;
/// Polynomials of the device's numbers have no higher degree.
const DEGREE: usize = 36;

/// Numbers of the device that are not known.
pub(super) struct DeviceChanges {
    /// Change of the channels' maps by one deviation of each.
    maps: Vec<[[Polynomial; 3]; 9]>,
    plate_mm: f64,
}

impl DeviceChanges {
    /// All are known.
    pub(super) fn none() -> Self {
        Self { maps: Vec::new(), plate_mm: Device::nominal().plate.radius_mm() }
    }

    /// Known as well as of any pad.
    pub(super) fn of_any() -> Self {
        Self { maps: changes(), ..Self::none() }
    }

    /// Change of what a contact reads by one deviation of each.
    pub(super) fn columns(&self, contact: &Contact, wiring: &Wiring) -> Vec<[f64; 9]> {
        let degree = if self.maps.is_empty() { 0 } else { DEGREE };
        let jets = jets(degree, contact.place.map(|mm| mm / self.plate_mm));
        let column = |maps: &[[Polynomial; 3]; 9]| {
            wiring.beyond_zero(&std::array::from_fn(|channel| {
                (0..3).map(|axis| maps[channel][axis].value(&jets) * contact.force[axis]).sum()
            }))
        };
        self.maps.iter().map(column).collect()
    }
}

/// Changes of the maps by one deviation of each number of the device.
fn changes() -> Vec<[[Polynomial; 3]; 9]> {
    let nominal = Device::nominal();
    let one = |it: &tactpad::pad::field::Sensitivity| {
        let value = it.parameter.get(&nominal);
        let deviation = match (it.parameter.module(), it.parameter.unit()) {
            (Some(_), Unit::Millimetre) => SHIFT_MM,
            (Some(_), Unit::Degree) => TURN_DEG,
            (Some(_), _) => MODULE_SHARE * value,
            (None, Unit::Millimetre) if it.parameter.name() == "plate.thickness_mm" => {
                THICKNESS_SHARE * value
            }
            (None, Unit::Megapascal) if it.parameter.name() != "material.plate.e_mpa" => COMMON_SHARE * value,
            (None, _) => return None,
        };
        let mut maps = it.maps.clone();
        maps.iter_mut().flatten().for_each(|map| map.coefficients.iter_mut().for_each(|it| *it *= deviation));
        Some(maps)
    };
    PadField::nominal().sensitivities.iter().filter_map(one).collect()
}
