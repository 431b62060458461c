//! The assembled pad: the plate on its three modules, and what each channel reads for a force anywhere on the plate.

use faer::linalg::solvers::{Llt, Solve};
use faer::{Mat, Side};

use crate::device::Device;
use crate::quantity::{CHANNELS, MODULES};

use super::grams::Grams;
use super::plate::{FIELDS, Foot, Rigidity, stiffness, surface_work};
use super::superelement::{MODES, STRAINS, Superelement};
use super::system::SolveError;

pub struct Pad<'d> {
    device: &'d Device,
    grams: &'d Grams,
    modules: [&'d Superelement; MODULES],
    feet: [Mat<f64>; MODULES],
    factor: Llt<f64>,
}

impl<'d> Pad<'d> {
    pub fn of(
        device: &'d Device,
        grams: &'d Grams,
        modules: [&'d Superelement; MODULES],
    ) -> Result<Self, SolveError> {
        let (radius, thickness) = (device.plate.diameter_mm / 2.0, device.plate.thickness_mm);
        let rigidity = Rigidity::of(device.material.plate, thickness, radius);
        let mut matrix = stiffness(grams, rigidity);
        let feet: [Mat<f64>; MODULES] =
            std::array::from_fn(|i| Foot::of(device, i).modes(grams.degree, radius, thickness));
        for (foot, module) in feet.iter().zip(modules) {
            let k = Mat::from_fn(MODES, MODES, |i, j| module.stiffness[i][j]);
            matrix += foot.transpose() * (&k * foot);
        }
        let factor = matrix.llt(Side::Lower).map_err(|_| SolveError::NotPositive)?;
        Ok(Self { device, grams, modules, feet, factor })
    }

    /// coefs [27][n] µV/N
    pub fn signals(&self) -> Vec<Vec<f64>> {
        let mut right = Mat::zeros(FIELDS * self.feet[0].ncols() / FIELDS, CHANNELS);
        for m in 0..MODULES {
            let w = weights(self.device);
            for axis in 0..3 {
                let b = Mat::from_fn(1, MODES, |_, k| {
                    (0..STRAINS).map(|g| w[axis][g] * self.modules[m].strains[g][k]).sum::<f64>()
                });
                let row = b * &self.feet[m];
                for i in 0..row.ncols() {
                    right[(i, 3 * m + axis)] = row[(0, i)];
                }
            }
        }
        self.factor.solve_in_place(&mut right);
        let (radius, thickness) = (self.device.plate.diameter_mm / 2.0, self.device.plate.thickness_mm);
        let mean = self.grams.disc_mean(self.device.contact.patch_radius_mm / radius);
        (0..CHANNELS)
            .flat_map(|c| {
                surface_work(right.as_ref().subcols(c, 1), radius, thickness).map(|p| {
                    let v = Mat::from_fn(p.len(), 1, |i, _| p[i]);
                    let v = &mean * v;
                    (0..p.len()).map(|i| v[(i, 0)]).collect()
                })
            })
            .collect()
    }
}

fn weights(device: &Device) -> [[f64; STRAINS]; 3] {
    let signs: [[f64; 7]; 3] =
        [[1., -1., 0., 0., 0., 0., 0.], [0., 0., 1., -1., 0., 0., 0.], [0., 0., 0., 0., 1., 1., -1.]];
    signs.map(|s| {
        std::array::from_fn(|i| {
            let g = &device.gauges[i / 2];
            let law = device.gauge_law;
            let part = if i % 2 == 0 { 1.0 } else { law.transverse_ratio };
            1e6 * device.circuit.excitation_v * s[i / 2] * g.resistance_ratio * law.gauge_factor * part
        })
    })
}
