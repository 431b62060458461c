//! A pad under a press of 1 N: how the plate and each module move.

use std::sync::Arc;

use tactpad_core::pad::device::{Device, Material};
use tactpad_core::quantity::MODULES;
use tactpad_numeric::zernike::{Polynomial, jets};

use super::deformed::{Deformed, ModeShapes};
use super::foot::Foot;
use super::pad::Pad;
use super::plate::FIELDS;
use super::simulator::{PLATE_DEGREE, Simulator};
use super::system::SolveError;

/// Strain in a plane: εxx, εyy and the engineering shear γxy.
pub type PlaneStrain = [f64; 3];

/// Von Mises's equivalent stress of a material that is strained in a plane and free across it, MPa.
pub fn plane_von_mises_mpa([xx, yy, xy]: PlaneStrain, material: Material) -> f64 {
    // σxx = E/(1 − ν²) (εxx + ν εyy), τ = E/(2(1 + ν)) γ.
    let Material { e_mpa, nu, .. } = material;
    let plane_mpa = e_mpa / (1.0 - nu * nu);
    let [sx, sy] = [xx + nu * yy, yy + nu * xx].map(|strain| plane_mpa * strain);
    let tau = e_mpa / (2.0 * (1.0 + nu)) * xy;
    (sx * sx - sx * sy + sy * sy + 3.0 * tau * tau).sqrt()
}

/// A pad that is pressed with 1 N.
pub struct PressedPad {
    /// The pad.
    pub pad: Pad,
    /// Centre of the contact.
    pub place_mm: [f64; 2],
    modules: [Arc<ModeShapes>; MODULES],
    deflection: [Polynomial; FIELDS],
}

/// How the plate moves at a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlateMovement {
    /// Displacement of the top surface in the pad frame.
    pub top_mm: [f64; 3],
    /// How much farther points move along x and y per millimetre above the middle plane.
    pub rotation: [f64; 2],
}

impl Simulator {
    /// The device's pad, pressed with 1 N at a place of the plate, with its modules inside.
    ///
    /// # Errors
    /// As for [`Simulator::pad`].
    pub fn pressed(&mut self, device: &Device, place_mm: [f64; 2]) -> Result<PressedPad, SolveError> {
        let mut modules = Vec::with_capacity(MODULES);
        for module in 0..MODULES {
            modules.push(self.shapes(device, module)?);
        }
        let modules = [0, 1, 2].map(|module| Arc::clone(&modules[module]));
        Ok(PressedPad::of(self.pad(device)?, modules, place_mm))
    }
}

impl PressedPad {
    /// Presses a pad whose modules have these shapes; `place_mm` lies on the plate.
    pub fn of(pad: Pad, modules: [Arc<ModeShapes>; MODULES], place_mm: [f64; 2]) -> Self {
        let deflection = pad.deflection(place_mm, 2);
        Self { pad, place_mm, modules, deflection }
    }

    /// How the plate moves at a place of it.
    pub fn plate(&self, place_mm: [f64; 2]) -> PlateMovement {
        let plate = &self.pad.device.plate;
        let radius_mm = plate.radius_mm();
        let jets = jets(PLATE_DEGREE, place_mm.map(|mm| mm / radius_mm));
        let [u, v, w, a, b] = self.deflection.each_ref().map(|field| field.value(&jets));
        let rotation = [a / radius_mm, b / radius_mm];
        let height_mm = plate.thickness_mm / 2.0;
        PlateMovement { top_mm: [u + height_mm * rotation[0], v + height_mm * rotation[1], w], rotation }
    }

    /// Strain of the plate in its plane, εxx, εyy and the engineering shear γxy, at a place and a height above the
    /// middle plane.
    pub fn plate_strain(&self, place_mm: [f64; 2], height_mm: f64) -> PlaneStrain {
        let radius_mm = self.pad.device.plate.radius_mm();
        let jets = jets(PLATE_DEGREE, place_mm.map(|mm| mm / radius_mm));
        let [u, v, _, a, b] = self.deflection.each_ref().map(|field| field.jet(&jets));
        // u,x + ζ α,x and so on; the fields are u, v, R α, R β over the place divided by R.
        let lever = height_mm / radius_mm;
        let [xx, yy] = [u.dx + lever * a.dx, v.dy + lever * b.dy];
        let xy = u.dy + v.dx + lever * (a.dy + b.dx);
        [xx, yy, xy].map(|slope| slope / radius_mm)
    }

    /// A module as the plate moves its foot.
    pub fn module(&self, module: usize) -> Deformed<'_> {
        self.modules[module].moved(&self.pad.foot_modes(module, &self.deflection))
    }

    /// From a module's frame to the pad's.
    pub fn module_frame(&self, module: usize) -> ModuleFrame {
        let device = &self.pad.device;
        let foot = Foot::of(device, module);
        let [x, y] = foot.centre_mm;
        let lines = &self.modules[module].mesh.lines_mm[2];
        let top_mm = lines.last().copied().unwrap_or(0.0);
        ModuleFrame { foot_mm: [x, y, -device.plate.thickness_mm], axes: foot.axes, top_mm }
    }
}

/// Where a module's points and vectors are in the pad frame. A tilted module is turned about its foot's centre.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ModuleFrame {
    /// The foot's centre on the plate's underside.
    foot_mm: [f64; 3],
    axes: [[f64; 3]; 3],
    /// Height of the foot in the module's frame.
    top_mm: f64,
}

impl ModuleFrame {
    /// A point.
    pub fn place_mm(&self, [x, y, z]: [f64; 3]) -> [f64; 3] {
        let turned = self.vector([x, y, z - self.top_mm]);
        std::array::from_fn(|axis| self.foot_mm[axis] + turned[axis])
    }

    /// A vector.
    pub fn vector(&self, [x, y, z]: [f64; 3]) -> [f64; 3] {
        std::array::from_fn(|axis| x * self.axes[0][axis] + y * self.axes[1][axis] + z * self.axes[2][axis])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::Fineness;

    fn pressed(place_mm: [f64; 2]) -> PressedPad {
        let device = Device::nominal();
        Simulator::new(Fineness::STANDARD.scaled(3.0)).pressed(&device, place_mm).unwrap()
    }

    #[test]
    fn modules_move_with_the_plate() {
        let pad = pressed([12.0, 5.0]);
        for index in 0..MODULES {
            let (module, frame) = (pad.module(index), pad.module_frame(index));
            let tops = (0..module.mesh.lattice.len()).filter(|node| module.mesh.is_top(*node));
            let mut largest = 0.0_f64;
            let mut off = 0.0_f64;
            for node in tops {
                let [x, y, z] = frame.place_mm(module.mesh.place_mm(node));
                assert!((z + 1.0).abs() < 1e-12, "the foot is on the plate's underside");
                let found = frame.vector(module.displacements_mm[node]);
                let PlateMovement { top_mm, rotation } = pad.plate([x, y]);
                let wanted = [top_mm[0] - rotation[0], top_mm[1] - rotation[1], top_mm[2]];
                for (found, wanted) in found.into_iter().zip(wanted) {
                    (largest, off) = (largest.max(wanted.abs()), off.max((found - wanted).abs()));
                }
            }
            // A foot's parabolas do not follow the plate to the last digit.
            assert!(off < 0.02 * largest, "module {index}: {off} of {largest} mm");
        }
    }

    #[test]
    fn the_plates_strain_is_the_slope_of_its_movement() {
        let (pad, step_mm) = (pressed([12.0, 5.0]), 1e-3);
        for place in [[3.0, -4.0], [-14.0, 9.0], [21.0, 2.0]] {
            let across = |axis: usize| {
                let moved = |by_mm: f64| {
                    let mut place = place;
                    place[axis] += by_mm;
                    pad.plate(place).top_mm
                };
                let (ahead, behind) = (moved(step_mm), moved(-step_mm));
                [0, 1].map(|field| (ahead[field] - behind[field]) / (2.0 * step_mm))
            };
            let [[xx, yx], [xy, yy]] = [across(0), across(1)];
            let found = pad.plate_strain(place, 0.5);
            for (found, wanted) in found.into_iter().zip([xx, yy, xy + yx]) {
                assert!(
                    (found - wanted).abs() < 1e-5 * 1e-6_f64.max(wanted.abs()) + 1e-12,
                    "{found} {wanted}"
                );
            }
        }
    }

    #[test]
    fn an_equivalent_stress_in_the_plane_is_that_of_one_axis() {
        let steel = Device::nominal().material.plate;
        let pulled = [4.0 / steel.e_mpa, -steel.nu * 4.0 / steel.e_mpa, 0.0];
        assert!((plane_von_mises_mpa(pulled, steel) - 4.0).abs() < 1e-12);
        let sheared = [0.0, 0.0, 4.0 * 2.0 * (1.0 + steel.nu) / steel.e_mpa];
        assert!((plane_von_mises_mpa(sheared, steel) - 4.0 * 3.0_f64.sqrt()).abs() < 1e-12);
    }

    #[test]
    fn the_plate_sinks_most_on_the_side_that_is_pressed() {
        let pad = pressed([12.0, 5.0]);
        let sinks = |place| -pad.plate(place).top_mm[2];
        assert!(sinks([12.0, 5.0]) > 0.0 && sinks([12.0, 5.0]) > 2.0 * sinks([-12.0, -5.0]));
    }
}
