//! The device's numbers in which a pad may differ, as parameters of the fit.
//!
//! A pose p is additive: the field is G + p ∂G/∂p. What is positive is a factor, whose logarithm q the fit has: a modulus E e^q,
//! a thickness t e^q. Compliances add up in series, so the field is linear in 1/E, and in 1/t³ of a plate that bends:
//!
//! ```text
//! G + E (1 − e^−q) ∂G/∂E        G + ⅓ t (1 − e^−3q) ∂G/∂t
//! ```
//!
//! Where G is the field of a pad that has q₀ already, E and t are that pad's, and q − q₀ stands for p and q.

use super::prior_deviations::ParameterKind;
use crate::tangent::{STIFFNESS_REACH, TURN_REACH_DEG, shift_reach_mm};
use tactpad_core::pad::device::Device;
use tactpad_core::pad::device::parameter::Parameter;
use tactpad_core::pad::device::unit::Unit;
use tactpad_core::pad::field::{PadField, Sensitivity};

/// A number of the device.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Physical {
    /// Which.
    pub parameter: Parameter,
    kind: ParameterKind,
    /// Its value in a pad that does not differ.
    expected: f64,
    /// q₀: by how much the pad that the field is of differs.
    about: f64,
}

/// Those that the field of a pad knows, with its derivatives by them. They are 0 in `expected`.
pub(crate) fn free<'f>(
    field: &'f PadField,
    own: &Device,
    expected: &Device,
) -> (Vec<Physical>, Vec<&'f Sensitivity>) {
    let of = |it: &'f Sensitivity| Some((Physical::of(it.parameter, own, expected)?, it));
    field.sensitivities.iter().filter_map(of).unzip()
}

impl Physical {
    /// `None` for a number in which pads of a kind do not differ, or one that the prior's other parameters stand for.
    fn of(parameter: Parameter, own: &Device, expected: &Device) -> Option<Self> {
        let kind = match (parameter.module(), parameter.unit()) {
            (Some(_), Unit::Millimetre) => ParameterKind::Shift,
            (Some(_), Unit::Degree) => ParameterKind::Turn,
            (Some(_), _) => ParameterKind::Stiffness,
            // Sheet metal has one modulus and many thicknesses.
            (None, Unit::Millimetre) if parameter.name() == "plate.thickness_mm" => {
                ParameterKind::PlateThickness
            }
            (None, Unit::Megapascal) if parameter.name() != "material.plate.e_mpa" => {
                ParameterKind::CommonModulus
            }
            (None, _) => return None,
        };
        let mut it = Self { parameter, kind, expected: parameter.get(expected), about: 0.0 };
        let own = parameter.get(own);
        it.about = if it.is_factor() { libm::log(own / it.expected) } else { own - it.expected };
        Some(it)
    }

    /// The kind, which has a prior.
    pub(crate) const fn kind(&self) -> ParameterKind {
        self.kind
    }

    /// Whether the fit has the logarithm of a factor.
    pub(crate) const fn is_factor(&self) -> bool {
        matches!(
            self.kind,
            ParameterKind::Stiffness | ParameterKind::PlateThickness | ParameterKind::CommonModulus
        )
    }

    /// n of 1/qⁿ in which the field is linear; of a pose there is none.
    const fn power(&self) -> f64 {
        if matches!(self.kind, ParameterKind::PlateThickness) { 3.0 } else { 1.0 }
    }

    /// The weight w of ∂G/∂p in the field, and ∂w/∂q.
    pub(crate) fn weight(&self, q: f64) -> [f64; 2] {
        let beyond = self.beyond(q);
        if !self.is_factor() {
            return [beyond, 1.0];
        }
        // With p = p₀ e^q₀: w = p/n (1 − e^−n(q − q₀)), ∂w/∂q = p e^−n(q − q₀).
        let (own, left) = (self.value(self.about), libm::exp(-self.power() * beyond));
        [own / self.power() * (1.0 - left), own * left]
    }

    /// The number itself; of a pose its change.
    pub(crate) fn value(&self, q: f64) -> f64 {
        if self.is_factor() { self.expected * libm::exp(q) } else { q }
    }

    /// Gives a device the number.
    pub(crate) fn put(&self, device: &mut Device, q: f64) {
        let value = if self.is_factor() { self.value(q) } else { self.expected + q };
        self.parameter.set(device, value);
    }

    /// q − q₀: how far it is from the pad that the field is of.
    pub(crate) fn beyond(&self, q: f64) -> f64 {
        q - self.about
    }

    /// How far that may be until the field's tangent is off by as much as it says.
    pub(crate) fn reach(&self, device: &Device) -> f64 {
        match self.kind {
            ParameterKind::Shift => shift_reach_mm(device),
            ParameterKind::Turn => TURN_REACH_DEG,
            // A plate's stiffness goes with the cube of its thickness.
            _ => STIFFNESS_REACH / self.power(),
        }
    }

    /// Scale from a deviation of the parameter to the number's unit, about a pad that does not differ.
    pub(crate) const fn unit(&self) -> f64 {
        if self.is_factor() { self.expected } else { 1.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn physical(name: &str) -> Option<Physical> {
        Physical::of(name.parse().unwrap(), &Device::nominal(), &Device::nominal())
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
    fn about_another_pad_the_field_is_the_same() {
        // G = −1/pⁿ is linear in 1/pⁿ, and ∂G/∂p = n/pⁿ⁺¹.
        let (mut own, expected) = (Device::nominal(), Device::nominal());
        for name in ["module.0.radial_mm", "plate.thickness_mm", "material.adh.e_mpa"] {
            let parameter: Parameter = name.parse().unwrap();
            physical(name).unwrap().put(&mut own, 0.3);
            let it = Physical::of(parameter, &own, &expected).unwrap();
            assert!(it.beyond(0.3).abs() < 1e-12 && it.weight(0.3)[0].abs() < 1e-12, "{name}");
            let field = |p: f64| if it.is_factor() { -p.powf(-it.power()) } else { p };
            let slope = |p: f64| if it.is_factor() { it.power() * p.powf(-it.power() - 1.0) } else { 1.0 };
            for q in [-0.2, 0.3, 0.5] {
                let linearised = field(it.value(0.3)) + it.weight(q)[0] * slope(it.value(0.3));
                assert!((linearised / field(it.value(q)) - 1.0).abs() < 1e-12, "{name} {q}");
            }
        }
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
