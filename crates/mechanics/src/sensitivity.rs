//! Derivatives of the channels with respect to the device's numbers.
//!
//! With v = K⁻¹Vᵀb a channel's influence field, a number that changes the stiffness, the feet's place or the gauges'
//! answer changes it by dv = K⁻¹(dVᵀ b + Vᵀ db − dK v): one more solution, no new factorisation. With K = Kp + VᵀCV,
//!
//! ```text
//! dv = K⁻¹ ( dVᵀ (b − C V v) + Vᵀ (db − C dV v − dC V v) − dKp v )
//! ```
//!
//! dKp is known in closed form; dC and db follow from the modules' fields (see [`super::superelement`]); dV is the
//! central difference of polynomials.

use std::sync::Arc;

use faer::Mat;

use tactpad_core::pad::device::Device;
use tactpad_core::pad::device::parameter::Parameter;
use tactpad_core::pad::device::schema::Effect;
use tactpad_core::pad::device::unit::Unit;
use tactpad_core::pad::field::{ForceMaps, Sensitivity};
use tactpad_core::quantity::{CHANNELS, MODULES};

use super::assembly::{add, lever, patch_mean, rigidity, springs, work, work_per_height};
use super::mesh::Layer;
use super::pad::Pad;
use super::plate::Rigidity;
use super::superelement::{LayerDerivatives, Superelement};

/// The numbers whose derivatives the model knows: the keys of `[[module]]` tables that change the mechanics, but not
/// the debonding, which takes elements away; the modules' radius, the plate's thickness, the layers' thicknesses and the moduli. For any other number, solve again.
pub fn known() -> impl Iterator<Item = Parameter> {
    Parameter::all().filter(|parameter| {
        let name = parameter.name();
        let is_listed = (parameter.module().is_some() && !name.ends_with(".debonded_share"))
            || ["modules.centre_radius_mm", "plate.thickness_mm", "stack.post_height_mm"].contains(&name)
            || (name.starts_with("stack.") && name.ends_with("_thickness_mm"))
            || (name.starts_with("material.") && name.ends_with(".e_mpa"));
        is_listed && parameter.effect() == Effect::Field
    })
}

/// The device a little below and above its value of a number.
struct DeviceStep {
    devices: [Device; 2],
    /// The difference of the two values.
    width: f64,
}

impl DeviceStep {
    fn of(device: &Device, parameter: Parameter) -> Self {
        let value = parameter.get(device);
        // The moduli act linearly; a micrometre or a thousandth of a degree is small for a polynomial on the plate.
        let half = if parameter.unit() == Unit::Megapascal { 1e-3 * value } else { 1e-3 };
        let devices = [-half, half].map(|by| {
            let mut moved = device.clone();
            parameter.set(&mut moved, value + by);
            moved
        });
        Self { devices, width: 2.0 * half }
    }

    /// The slope of a figure of the device.
    fn slope(&self, figure: impl Fn(&Device) -> f64) -> f64 {
        let [below, above] = self.devices.each_ref().map(figure);
        (above - below) / self.width
    }
}

/// The sensitivities to all [`known`] numbers. `layers` are the derivatives of the pad's modules.
pub fn sensitivities(pad: &Pad, layers: &[Arc<Vec<LayerDerivatives>>; MODULES]) -> Vec<Sensitivity> {
    let base = Base::of(pad);
    known().map(|parameter| base.sensitivity(parameter, layers)).collect()
}

/// The channels' fields, about which everything is a small change.
struct Base<'p> {
    pad: &'p Pad,
    /// b: the channels' weights of V's rows.
    weights: Mat<f64>,
    /// v: one column for each channel.
    fields: Mat<f64>,
    /// V v.
    movements: Mat<f64>,
}

impl<'p> Base<'p> {
    fn of(pad: &'p Pad) -> Self {
        let weights = pad.signal_weights(&pad.modules);
        let fields = pad.assembly.respond(&weights);
        let movements = &pad.assembly.couplings * &fields;
        Self { pad, weights, fields, movements }
    }

    fn sensitivity(
        &self,
        parameter: Parameter,
        layers: &[Arc<Vec<LayerDerivatives>>; MODULES],
    ) -> Sensitivity {
        let Self { pad, weights, fields, movements } = self;
        let step = DeviceStep::of(&pad.device, parameter);
        let modules: [Superelement; MODULES] = std::array::from_fn(|m| module_slope(&step, m, &layers[m]));
        let (stiffness, gauges) = (springs(&modules, 0.0), pad.signal_weights(&modules));
        let couplings = self.coupling_slope(&step);
        let moved = &couplings * fields;
        let assembly = &pad.assembly;
        let at_feet = gauges - &assembly.springs * moved - stiffness * movements;
        let loads = couplings.transpose() * (weights - &assembly.springs * movements)
            + assembly.couplings.transpose() * at_feet
            - assembly.plate.forces(plate_slope(&pad.device, &step), fields);
        let changes = assembly.solve(&loads);
        let mut maps: [ForceMaps; CHANNELS] =
            std::array::from_fn(|channel| work(&changes, channel, lever(&pad.device)));
        // A thicker plate also lifts its top: the same field, a longer lever.
        let lifted = step.slope(|device| device.plate.thickness_mm / device.plate.diameter_mm);
        let lifts: [ForceMaps; CHANNELS] = std::array::from_fn(|channel| work_per_height(fields, channel));
        add(&mut maps, lifted, &lifts);
        Sensitivity { parameter, maps: maps.map(|maps| maps.map(|map| patch_mean(&pad.device, &map))) }
    }

    fn coupling_slope(&self, step: &DeviceStep) -> Mat<f64> {
        let [below, above] = step.devices.each_ref().map(|device| self.pad.couplings_of(device));
        let mut slope = above - below;
        slope *= faer::Scale(1.0 / step.width);
        slope
    }
}

fn plate_slope(device: &Device, step: &DeviceStep) -> Rigidity {
    let plate = rigidity(device);
    let (per_mpa, per_mm) =
        (plate.per_modulus(device.material.plate.e_mpa), plate.per_thickness(device.plate.thickness_mm));
    let modulus = step.slope(|device| device.material.plate.e_mpa);
    let thickness = step.slope(|device| device.plate.thickness_mm);
    let sum = |of: fn(&Rigidity) -> f64| modulus * of(&per_mpa) + thickness * of(&per_mm);
    Rigidity {
        stretching: sum(|r| r.stretching),
        bending: sum(|r| r.bending),
        shear: sum(|r| r.shear),
        nu: plate.nu,
    }
}

/// How a module's superelement changes with the step's number, through its layers' moduli and thicknesses.
fn module_slope(step: &DeviceStep, module: usize, layers: &[LayerDerivatives]) -> Superelement {
    let mut slope = Superelement::ZERO;
    for (layer, derivatives) in Layer::ALL.into_iter().zip(layers) {
        let modulus = step.slope(|device| layer.material(device, &device.modules[module]).e_mpa);
        let thickness = step.slope(|device| layer.thickness_mm(&device.stack));
        slope.add(modulus, &derivatives.per_mpa);
        slope.add(thickness, &derivatives.per_mm);
    }
    slope
}
