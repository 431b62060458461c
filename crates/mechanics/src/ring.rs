//! A plate on modules at equal angles, as many as wanted: pads that no device file describes.

use std::sync::Arc;

use tactpad_core::pad::device::{Device, GAUGES};
use tactpad_core::pad::field::ForceMaps;
use tactpad_core::pad::influence::Gains;
use tactpad_core::quantity::MODULES;
use tactpad_numeric::zernike::jets;

use super::assembly::{Assembly, contact_map};
use super::foot::Foot;
use super::readings::Readings;
use super::superelement::{MODES, Superelement};
use super::system::SolveError;

/// Half-bridges of a module: x, y, z.
pub const BRIDGES: usize = 3;

/// A plate on so many modules, whose readings of a contact are known.
pub struct Ring<'d> {
    device: &'d Device,
    degree: usize,
    modules: Vec<Arc<Superelement>>,
    assembly: Assembly,
}

impl<'d> Ring<'d> {
    /// Puts the device's plate on `count` modules, at least one, where [`Device::ring`] says. `modules` are those of the
    /// device; the ring has them in turn. `degree` is the highest degree of the plate's polynomials.
    ///
    /// # Errors
    /// A plate without stiffness.
    pub fn of(
        device: &'d Device,
        count: usize,
        degree: usize,
        modules: &[Arc<Superelement>; MODULES],
    ) -> Result<Self, SolveError> {
        let in_turn = |index: usize| index % MODULES;
        let modules: Vec<_> = (0..count).map(|index| Arc::clone(&modules[in_turn(index)])).collect();
        let poses = device.ring(count);
        let at = |(index, pose)| Foot::at(pose, &device.modules[in_turn(index)], &device.stack);
        let feet: Vec<_> = poses.iter().enumerate().map(at).collect();
        let assembly = Assembly::of(device, degree, &feet, &modules)?;
        Ok(Self { device, degree, modules, assembly })
    }

    /// What the half-bridges read, µV/N: x, y and z of each module, as [`super::pad::Pad::signals`] has them.
    pub fn bridges(&self) -> Vec<ForceMaps> {
        let readings = Readings::of(self.device);
        self.maps(BRIDGES, |module, axis| readings.signal(module, axis))
    }

    /// What each gauge reads alone, in a bridge with a constant resistor of its own size, µV/N: R1 … R7 of each module.
    pub fn gauges(&self) -> Vec<ForceMaps> {
        let readings = Readings::of(self.device);
        self.maps(GAUGES, |module, gauge| readings.gauge(module, gauge))
    }

    /// Readings at a place of the plate, from [`Self::bridges`] or [`Self::gauges`].
    pub fn gains(&self, maps: &[ForceMaps], place_mm: [f64; 2]) -> Gains<Vec<[f64; 3]>> {
        let radius_mm = self.device.plate.radius_mm();
        let jets = jets(self.degree, place_mm.map(|mm| mm / radius_mm));
        let rows = maps.iter().map(|maps| maps.each_ref().map(|map| map.jet(&jets)));
        let mut gains = Gains { value: vec![], dx: vec![], dy: vec![] };
        for row in rows {
            gains.value.push(row.map(|jet| jet.value));
            gains.dx.push(row.map(|jet| jet.dx / radius_mm));
            gains.dy.push(row.map(|jet| jet.dy / radius_mm));
        }
        gains
    }

    fn maps(
        &self,
        readings_each: usize,
        of_module: impl Fn(&Superelement, usize) -> [f64; MODES],
    ) -> Vec<ForceMaps> {
        let modules = &self.modules;
        let weights = self
            .assembly
            .weights(modules.len(), readings_each, |module, reading| of_module(&modules[module], reading));
        let fields = self.assembly.respond(&weights);
        (0..fields.ncols()).map(|reading| contact_map(self.device, &fields, reading)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::Fineness;
    use crate::simulator::Simulator;

    /// Low, so that a test is quick; both paths have it.
    const DEGREE: usize = 20;

    fn modules(device: &Device) -> [Arc<Superelement>; MODULES] {
        Simulator::new(Fineness::STANDARD.scaled(3.0)).superelements(device).unwrap()
    }

    #[test]
    fn three_modules_are_the_pad() {
        let mut device = Device::nominal();
        // Unequal modules, so that a module in another's place is seen.
        device.modules[1].radial_mm = 0.4;
        device.modules[2].rotation_deg = 7.0;
        let modules = modules(&device);
        let pad = super::super::pad::Pad::of(&device, DEGREE, modules.clone()).unwrap();
        let ring = Ring::of(&device, MODULES, DEGREE, &modules).unwrap();
        assert_eq!(ring.bridges(), pad.signals(), "bit by bit");
    }

    #[test]
    fn bridges_are_the_differences_of_their_gauges() {
        let device = Device::nominal();
        let ring = Ring::of(&device, 4, DEGREE, &modules(&device)).unwrap();
        let (bridges, gauges) = (ring.bridges(), ring.gauges());
        assert_eq!((bridges.len(), gauges.len()), (4 * BRIDGES, 4 * GAUGES));
        let at = |maps: &[ForceMaps]| ring.gains(maps, [7.0, -11.0]).value;
        let (bridges, gauges) = (at(&bridges), at(&gauges));
        for (bridge, gauge) in bridges.chunks(BRIDGES).zip(gauges.chunks(GAUGES)) {
            for axis in 0..3 {
                let r = |number: usize| gauge[number - 1][axis];
                // R5 and R6 have half the resistance: alone they read twice what they give the bridge.
                let wanted = [r(1) - r(2), r(3) - r(4), 0.5 * r(5) + 0.5 * r(6) - r(7)];
                for (bridge, wanted) in bridge.iter().zip(wanted) {
                    assert!((bridge[axis] - wanted).abs() < 1e-9 * wanted.abs().max(1.0));
                }
            }
        }
    }

    #[test]
    fn a_turn_by_one_module_passes_the_readings_on() {
        let device = Device::nominal();
        for count in [2, 4, 6] {
            let ring = Ring::of(&device, count, DEGREE, &modules(&device)).unwrap();
            let maps = ring.gauges();
            let (sin, cos) = (360.0 / count as f64).to_radians().sin_cos();
            let turned = |[x, y]: [f64; 2]| [x * cos - y * sin, x * sin + y * cos];
            let pressed = |place_mm: [f64; 2]| -> Vec<f64> {
                ring.gains(&maps, place_mm).value.iter().map(|row| row[2]).collect()
            };
            let (before, after) = (pressed([9.0, 4.0]), pressed(turned([9.0, 4.0])));
            let largest = before.iter().fold(0.0_f64, |largest, uv| largest.max(uv.abs()));
            for (index, uv) in before.iter().enumerate() {
                let next = after[(index + GAUGES) % before.len()];
                assert!((next - uv).abs() < 1e-6 * largest, "{count}: {next} for {uv}");
            }
        }
    }

    #[test]
    fn half_bridges_cancel_most_of_what_gauges_read_of_a_press() {
        let device = Device::nominal();
        let ring = Ring::of(&device, MODULES, DEGREE, &modules(&device)).unwrap();
        let pressed = |maps: &[ForceMaps]| -> Vec<f64> {
            ring.gains(maps, [device.sites.centre_radius_mm, 0.0]).value.iter().map(|row| row[2]).collect()
        };
        let (bridges, gauges) = (pressed(&ring.bridges()), pressed(&ring.gauges()));
        let [_, y, z, ..] = bridges[..] else { panic!("{bridges:?}") };
        let [_, _, r3, r4, ..] = gauges[..] else { panic!("{gauges:?}") };
        // Across the narrow window the film bends most, and R3 and R4 stretch alike.
        assert!(r3 * r4 > 0.0 && r3.abs().min(r4.abs()) > 1.5 * z.abs(), "{gauges:?} {bridges:?}");
        assert!(y.abs() < 0.2 * r3.abs(), "{gauges:?} {bridges:?}");
    }

    #[test]
    fn slopes_are_those_of_the_readings() {
        let device = Device::nominal();
        let ring = Ring::of(&device, 2, DEGREE, &modules(&device)).unwrap();
        let maps = ring.bridges();
        let at = |x_mm: f64, y_mm: f64| ring.gains(&maps, [x_mm, y_mm]);
        let (here, step) = (at(5.0, 8.0), 1e-4);
        let (east, west, north, south) =
            (at(5.0 + step, 8.0), at(5.0 - step, 8.0), at(5.0, 8.0 + step), at(5.0, 8.0 - step));
        for reading in 0..maps.len() {
            for axis in 0..3 {
                let dx = (east.value[reading][axis] - west.value[reading][axis]) / (2.0 * step);
                let dy = (north.value[reading][axis] - south.value[reading][axis]) / (2.0 * step);
                assert!((here.dx[reading][axis] - dx).abs() < 1e-4, "{reading} {axis}");
                assert!((here.dy[reading][axis] - dy).abs() < 1e-4, "{reading} {axis}");
            }
        }
    }
}
