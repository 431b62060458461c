//! What each gauge of a module does under a force on that module: alone, and under the plate.
//!
//! A gauge's reading is δ r in microvolts, with the excitation δ and r = ΔR/R; the channels are sums of these
//! ([`HALF_BRIDGES`]). Forces are 1 N along the module's x, along its y, and pressing.

use faer::linalg::solvers::Solve;
use faer::{Mat, Side};

use tactpad_core::pad::device::{Device, GAUGES};
use tactpad_core::pad::wiring::HALF_BRIDGES;
use tactpad_numeric::zernike::Polynomial;

use super::pad::Pad;
use super::plate::FIELDS;
use super::readings::Readings;
use super::superelement::{MODES, Superelement};
use super::system::SolveError;

/// δ r of R1 to R7 in µV/N, for 1 N along x, along y, and pressing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GaugeReadings {
    /// `[force][gauge]`.
    pub uv_per_n: [[f64; GAUGES]; 3],
}

impl GaugeReadings {
    /// Of a module without a plate: the force lies evenly on its bond's top, which is free to move, turn and bend.
    ///
    /// # Errors
    /// A module without stiffness.
    pub fn alone(device: &Device, module: &Superelement) -> Result<Self, SolveError> {
        // K q = f, with f the work of the force on each mode: an even load works on the even modes alone.
        let stiffness = Mat::from_fn(MODES, MODES, |j, k| module.stiffness[j][k]);
        let factor = stiffness.llt(Side::Lower).map_err(|_| SolveError::NotPositive)?;
        let forces = Mat::from_fn(MODES, 3, |mode, force| match (mode == force, force) {
            (true, 2) => -1.0,
            (true, _) => 1.0,
            _ => 0.0,
        });
        let moved = factor.solve(&forces);
        let feet = [0, 1, 2].map(|force| std::array::from_fn(|mode| moved[(mode, force)]));
        Ok(Self::of_feet(device, module, &feet))
    }

    /// Of a module of the pad, with the force on the plate's top over the module's centre.
    pub fn in_pad(pad: &Pad, module: usize) -> Self {
        let pose = pad.device.poses()[module];
        let moved = [0, 1, 2].map(|axis| pad.deflection(pose.centre_mm, axis));
        let foot = |deflection: &[Polynomial; FIELDS]| pad.foot_modes(module, deflection);
        let [x, y, pressing] = moved.each_ref().map(foot);
        // A force along the module's axes is a sum of those along the pad's.
        let along = |[cos, sin]: [f64; 2]| -> [f64; MODES] {
            std::array::from_fn(|mode| cos * x[mode] + sin * y[mode])
        };
        let feet = [along(pose.along_x), along(pose.along_y), pressing];
        Self::of_feet(&pad.device, &pad.modules[module], &feet)
    }

    fn of_feet(device: &Device, module: &Superelement, feet_mm: &[[f64; MODES]; 3]) -> Self {
        let gauges = Readings::of(device).gauges(module);
        let reading =
            |gauge: &[f64; MODES], foot: &[f64; MODES]| gauge.iter().zip(foot).map(|(g, q)| g * q).sum();
        Self { uv_per_n: feet_mm.map(|foot| gauges.map(|gauge| reading(&gauge, &foot))) }
    }

    /// The module's channels x, y, z in µV/N: `[force][channel]`.
    pub fn channels_uv_per_n(&self) -> [[f64; 3]; 3] {
        self.uv_per_n.map(|gauges| {
            HALF_BRIDGES.map(|bridge| bridge.signs().iter().zip(gauges).map(|(sign, uv)| sign * uv).sum())
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::Fineness;
    use crate::simulator::PLATE_DEGREE;
    use crate::simulator::Simulator;
    use tactpad_numeric::zernike::jets;

    fn pad() -> Pad {
        Simulator::new(Fineness::STANDARD.scaled(3.0)).pad(&Device::nominal()).unwrap()
    }

    #[test]
    fn mirror_symmetry_leaves_each_force_to_its_own_channel() {
        let pad = pad();
        let alone = GaugeReadings::alone(&pad.device, &pad.modules[0]).unwrap();
        let channels = alone.channels_uv_per_n();
        for (force, row) in channels.iter().enumerate() {
            for (channel, uv) in row.iter().enumerate().filter(|(channel, _)| *channel != force) {
                assert!(uv.abs() < 1e-6 * row[force].abs(), "force {force} on channel {channel}: {row:?}");
            }
        }
        // As the device file says: Sx > 0 along +x, Sy < 0 along +y, Sz > 0 for a press.
        assert!(channels[0][0] > 0.0 && channels[1][1] < 0.0 && channels[2][2] > 0.0, "{channels:?}");
        let [r1, r2, ..] = alone.uv_per_n[2];
        assert!((r1 - r2).abs() < 1e-6 * r1.abs());
    }

    #[test]
    fn under_the_plate_the_channels_are_the_influence_field() {
        let pad = pad();
        let signals = pad.signals();
        for module in 0..3 {
            let pose = pad.device.poses()[module];
            let radius_mm = pad.device.plate.radius_mm();
            let jets = jets(PLATE_DEGREE, pose.centre_mm.map(|mm| mm / radius_mm));
            let found = GaugeReadings::in_pad(&pad, module).channels_uv_per_n();
            for axis in 0..3 {
                let [x, y, z] = signals[3 * module + axis].each_ref().map(|map| map.value(&jets));
                let along = |[cos, sin]: [f64; 2]| cos * x + sin * y;
                let wanted = [along(pose.along_x), along(pose.along_y), z];
                for (found, wanted) in found.iter().map(|row| row[axis]).zip(wanted) {
                    assert!(
                        (found - wanted).abs() < 1e-6 * wanted.abs().max(1.0),
                        "{module} {axis}: {found} {wanted}"
                    );
                }
            }
        }
    }
}
