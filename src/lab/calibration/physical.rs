//! The device's numbers in which a pad may differ, as parameters of the fit.
//!
//! A pose p is additive: the field is G + p ∂G/∂p. What is positive is a factor, whose logarithm q the fit has: a modulus E e^q,
//! a thickness t e^q. Compliances add up in series, so the field is linear in 1/E, and in 1/t³ of a plate that bends:
//!
//! ```text
//! G + E (1 − e^−q) ∂G/∂E        G + ⅓ t (1 − e^−3q) ∂G/∂t
//! ```

use super::prior_deviations::Kind;
use crate::pad::device::Device;
use crate::pad::device::parameter::Parameter;
use crate::pad::device::unit::Unit;
use crate::pad::field::{PadField, Sensitivity};

/// A number of the device.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Physical {
    /// Which.
    pub parameter: Parameter,
    kind: Kind,
    /// Its value in the pad that the field is of.
    own: f64,
}

/// Those that a field knows, with its derivatives by them.
pub(super) fn free<'f>(field: &'f PadField, device: &Device) -> (Vec<Physical>, Vec<&'f Sensitivity>) {
    field.sensitivities.iter().filter_map(|it| Some((Physical::of(it.parameter, device)?, it))).unzip()
}

impl Physical {
    /// `None` for a number in which pads of a kind do not differ, or one that the prior's other parameters stand for.
    pub(super) fn of(parameter: Parameter, device: &Device) -> Option<Self> {
        let kind = match (parameter.module(), parameter.unit()) {
            (Some(_), Unit::Millimetre) => Kind::Shift,
            (Some(_), Unit::Degree) => Kind::Turn,
            (Some(_), _) => Kind::Stiffness,
            // Sheet metal has one modulus and many thicknesses.
            (None, Unit::Millimetre) if parameter.name() == "plate.thickness_mm" => Kind::PlateThickness,
            (None, Unit::Megapascal) if parameter.name() != "material.plate.e_mpa" => Kind::CommonModulus,
            (None, _) => return None,
        };
        Some(Self { parameter, kind, own: parameter.get(device) })
    }

    /// The kind, which has a prior.
    pub(super) const fn kind(&self) -> Kind {
        self.kind
    }

    /// Whether the fit has the logarithm of a factor.
    pub(super) const fn is_factor(&self) -> bool {
        matches!(self.kind, Kind::Stiffness | Kind::PlateThickness | Kind::CommonModulus)
    }

    /// n of 1/qⁿ in which the field is linear; of a pose there is none.
    const fn power(&self) -> f64 {
        if matches!(self.kind, Kind::PlateThickness) { 3.0 } else { 1.0 }
    }

    /// The weight w of ∂G/∂p in the field, and ∂w/∂q.
    pub(super) fn weight(&self, q: f64) -> [f64; 2] {
        if !self.is_factor() {
            return [q, 1.0];
        }
        // w = p/n (1 − e^−nq), ∂w/∂q = p e^−nq.
        let left = libm::exp(-self.power() * q);
        [self.own / self.power() * (1.0 - left), self.own * left]
    }

    /// The number itself; of a pose its change.
    pub(super) fn value(&self, q: f64) -> f64 {
        if self.is_factor() { self.own * libm::exp(q) } else { q }
    }

    /// What a deviation of the parameter is in the number's unit, about the field's own pad.
    pub(super) const fn unit(&self) -> f64 {
        if self.is_factor() { self.own } else { 1.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn physical(name: &str) -> Option<Physical> {
        Physical::of(name.parse().unwrap(), &Device::nominal())
    }

    #[test]
    fn pads_of_a_kind_differ_in_poses_stiffnesses_moduli_and_the_plates_thickness() {
        let is_factor = |name| physical(name).map(|it| it.is_factor());
        assert_eq!(is_factor("module.1.radial_mm"), Some(false));
        assert_eq!(is_factor("module.1.frame_e_factor"), Some(true));
        assert_eq!(is_factor("plate.thickness_mm"), Some(true));
        assert_eq!(is_factor("material.epoxy.e_mpa"), Some(true));
        assert_eq!((is_factor("plate.diameter_mm"), is_factor("material.plate.e_mpa")), (None, None));
    }

    #[test]
    fn weights_are_tangents_and_bounded_by_what_is_rigid() {
        for name in
            ["module.0.rotation_deg", "module.2.bond_e_factor", "plate.thickness_mm", "material.adh.e_mpa"]
        {
            let it = physical(name).unwrap();
            for q in [-0.3, 0.0, 0.4] {
                let [behind, ahead] = [-1e-5, 1e-5].map(|step| it.weight(q + step)[0]);
                let slope = (ahead - behind) / 2e-5;
                assert!((slope / it.weight(q)[1] - 1.0).abs() < 1e-6, "{name}: {slope}");
            }
            // About the nominal pad a weight is the number's own change.
            let small = 1e-6;
            let change = it.value(small) - it.value(0.0);
            assert!((it.weight(small)[0] / change - 1.0).abs() < 1e-4, "{name}");
        }
        // However stiff the plate is, no more is lost than all that it gives way.
        assert!((physical("plate.thickness_mm").unwrap().weight(50.0)[0] - 1.0 / 3.0).abs() < 1e-12);
    }
}
