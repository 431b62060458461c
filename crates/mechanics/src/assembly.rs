//! A plate on any number of modules, and its answer to every load.
//!
//! The plate's stiffness plus that of the modules' feet, K = Kp + Σ QᵢᵀKᵢQᵢ, where Qᵢ takes the plate's unknowns to
//! the modes of foot i. The plate alone can move freely, so it is held by six springs that are taken away again with
//! the feet: K = K₀ + VᵀCV with V = (Q₀; Q₁; …; held) and C = diag(K₀, K₁, …, −springs). K₀ is made of small blocks;
//! by Woodbury's identity, with Φ = K₀⁻¹Vᵀ and A = VΦ, K⁻¹Vᵀ = Φ (1 + CA)⁻¹. So a change of a module's stiffness costs
//! a system of 18 unknowns for each module and six more, a change of its place one more column of Φ for each mode.
//!
//! Source: M. A. Woodbury, "Inverting Modified Matrices", Princeton (1950).

use std::borrow::Borrow;

use faer::linalg::solvers::{PartialPivLu, Solve};
use faer::{Mat, MatRef};

use tactpad_core::pad::device::Device;
use tactpad_core::pad::field::ForceMaps;
use tactpad_numeric::zernike::{Polynomial, count};

use super::foot::Foot;
use super::plate::{FIELDS, Plate, Rigidity, held};
use super::superelement::{MODES, Superelement};
use super::system::SolveError;

/// Motions of the plate that are held by springs.
const HELD: usize = 6;

/// The equations of a plate on its modules, solved. The rows of V are the feet's modes, module by module, and the
/// six held motions.
pub(super) struct Assembly {
    pub(super) plate: Plate,
    /// V: from the plate's unknowns to the feet's modes and the held motions.
    pub(super) couplings: Mat<f64>,
    /// C: the stiffness that stands at these.
    pub(super) springs: Mat<f64>,
    /// Φ: the held plate's displacement under a unit load at each.
    responses: Mat<f64>,
    /// A = V Φ.
    compliance: Mat<f64>,
    /// 1 + C A.
    inner: PartialPivLu<f64>,
}

impl Assembly {
    /// Puts the device's plate on modules that stand at these feet, at least one. `degree` is the highest degree of the
    /// plate's polynomials.
    ///
    /// # Errors
    /// A plate without stiffness.
    pub(super) fn of<M: Borrow<Superelement>>(
        device: &Device,
        degree: usize,
        feet: &[Foot],
        modules: &[M],
    ) -> Result<Self, SolveError> {
        // As stiff as a foot, so that holding the plate and letting it go again loses no digits.
        let hold = modules.first().map_or(1.0, |module| module.borrow().stiffness[2][2]);
        let plate = Plate::of(degree, rigidity(device), hold)?;
        let couplings = couplings(device, degree, feet);
        let springs = springs(modules, hold);
        let responses = plate.solve(&couplings.transpose().to_owned());
        let compliance = &couplings * &responses;
        let rows = couplings.nrows();
        let inner = (Mat::<f64>::identity(rows, rows) + &springs * &compliance).partial_piv_lu();
        Ok(Self { plate, couplings, springs, responses, compliance, inner })
    }

    /// Readings as weights of V's rows, one column for each: `of_module(i, r)` are the weights that reading r of
    /// module i gives the modes of its foot. The readings of a module stand together.
    pub(super) fn weights(
        &self,
        modules: usize,
        readings_each: usize,
        of_module: impl Fn(usize, usize) -> [f64; MODES],
    ) -> Mat<f64> {
        let mut weights = Mat::zeros(self.couplings.nrows(), modules * readings_each);
        for reading in 0..modules * readings_each {
            let (module, its) = (reading / readings_each, reading % readings_each);
            for (mode, value) in of_module(module, its).into_iter().enumerate() {
                weights[(module * MODES + mode, reading)] = value;
            }
        }
        weights
    }

    /// K⁻¹Vᵀ times the weights: Φ (1 + CA)⁻¹ b.
    pub(super) fn respond(&self, weights: &Mat<f64>) -> Mat<f64> {
        let taken = self.inner.solve(&self.springs * (&self.compliance * weights));
        &self.responses * (weights - taken)
    }

    /// K⁻¹ times any loads on the plate's unknowns.
    pub(super) fn solve(&self, loads: &Mat<f64>) -> Mat<f64> {
        let held = self.plate.solve(loads);
        let taken = self.inner.solve(&self.springs * (&self.couplings * &held));
        held - &self.responses * taken
    }
}

/// The plate's stiffness.
pub(super) fn rigidity(device: &Device) -> Rigidity {
    Rigidity::of(device.material.plate, device.plate.thickness_mm, device.plate.radius_mm())
}

/// Height of the plate's top above its middle plane, in plate radii.
pub(super) fn lever(device: &Device) -> f64 {
    device.plate.thickness_mm / (2.0 * device.plate.radius_mm())
}

/// What a contact gives a reading per newton, in the displacement of the plate that belongs to it. A contact is an
/// even traction over a disc on the plate's top.
pub(super) fn contact_map(device: &Device, fields: &Mat<f64>, reading: usize) -> ForceMaps {
    work(fields, reading, lever(device)).map(|map| patch_mean(device, &map))
}

/// The means over the contact's disc.
pub(super) fn patch_mean(device: &Device, map: &Polynomial) -> Polynomial {
    map.disc_mean(device.contact.patch_radius_mm / device.plate.radius_mm())
}

/// V of a plate on these feet.
pub(super) fn couplings(device: &Device, degree: usize, feet: &[Foot]) -> Mat<f64> {
    let plate = &device.plate;
    let modes = |foot: &Foot| foot.modes(degree, plate.radius_mm(), plate.thickness_mm);
    let feet: Vec<Mat<f64>> = feet.iter().map(modes).collect();
    let held = held(degree);
    let (rows, unknowns) = (feet.len() * MODES + HELD, FIELDS * count(degree));
    Mat::from_fn(rows, unknowns, |row, unknown| match feet.get(row / MODES) {
        Some(foot) => foot[(row % MODES, unknown)],
        None => held[row - feet.len() * MODES]
            .iter()
            .filter(|(k, _)| *k == unknown)
            .map(|(_, factor)| factor)
            .sum(),
    })
}

/// C of modules, and what takes the holding springs away again.
pub(super) fn springs<M: Borrow<Superelement>>(modules: &[M], hold: f64) -> Mat<f64> {
    let rows = modules.len() * MODES + HELD;
    Mat::from_fn(rows, rows, |i, j| match (modules.get(i / MODES), i / MODES == j / MODES) {
        (Some(module), true) => module.borrow().stiffness[i % MODES][j % MODES],
        (None, _) if i == j => -hold,
        _ => 0.0,
    })
}

/// Work of unit forces along +x, along +y and pressing, at a height (in plate radii) above the middle plane, on one
/// of several displacements of the plate.
pub(super) fn work(fields: &Mat<f64>, column: usize, height: f64) -> ForceMaps {
    let size = fields.nrows() / FIELDS;
    let [x, y, z] = [0, 1, 2].map(|field| part(fields.as_ref(), column, field, size));
    // A pressing force acts along −z.
    let mut maps = [x, y, scaled(-1.0, z)];
    add(std::slice::from_mut(&mut maps), height, &[work_per_height(fields, column)]);
    maps
}

/// What the work of unit forces gains per plate radius of height: the rotations.
pub(super) fn work_per_height(fields: &Mat<f64>, column: usize) -> ForceMaps {
    let size = fields.nrows() / FIELDS;
    let [x, y] = [3, 4].map(|field| part(fields.as_ref(), column, field, size));
    [x, y, Polynomial { coefficients: vec![0.0; size] }]
}

/// Adds a multiple of other maps.
pub(super) fn add(maps: &mut [ForceMaps], factor: f64, other: &[ForceMaps]) {
    for (map, other) in maps.iter_mut().flatten().zip(other.iter().flatten()) {
        map.coefficients.iter_mut().zip(&other.coefficients).for_each(|(c, o)| *c += factor * o);
    }
}

/// One of the plate's five fields u, v, w, R α, R β in one of several displacements.
pub(super) fn part(fields: MatRef<'_, f64>, column: usize, block: usize, size: usize) -> Polynomial {
    Polynomial { coefficients: (0..size).map(|k| fields[(block * size + k, column)]).collect() }
}

fn scaled(factor: f64, mut map: Polynomial) -> Polynomial {
    map.coefficients.iter_mut().for_each(|c| *c *= factor);
    map
}
