//! The assembled pad: the plate on its three modules, and what it answers to a force anywhere on the plate.
//!
//! **Assembly.** The plate's stiffness plus that of the modules' feet, K = Kp + Σ QᵢᵀKᵢQᵢ, where Qᵢ takes the plate's
//! unknowns to the modes of foot i. The plate alone can move freely, so it is held by six springs that are taken
//! away again with the feet: K = K₀ + VᵀCV with V = (Q₀; Q₁; Q₂; held) and C = diag(K₀, K₁, K₂, −springs). K₀ is made
//! of small blocks; by Woodbury's identity, with Φ = K₀⁻¹Vᵀ and A = VΦ, K⁻¹Vᵀ = Φ (1 + CA)⁻¹. So a change of a
//! module's stiffness costs a system of 60 unknowns, a change of its place one more column of Φ for each mode.
//!
//! **Reciprocity.** A channel is a weighted sum of foot movements, s = bᵀV x, and x = K⁻¹f for a load f. So the
//! displacement v = K⁻¹Vᵀb of the plate under the *loads* b is the channel's influence field: s = vᵀf for every f.
//! Source: J. C. Maxwell, Phil. Mag. 27 (1864) 294; E. Betti, Il Nuovo Cimento 7 (1872) 69; M. A. Woodbury (1950).

use std::borrow::Borrow;
use std::sync::Arc;

use faer::linalg::solvers::{PartialPivLu, Solve};
use faer::{Mat, MatRef};

use crate::numeric::zernike::Polynomial;
use crate::pad::device::Device;
use crate::pad::field::ForceMaps;
use crate::quantity::{CHANNELS, MODULES};

use super::foot::Foot;
use super::plate::{FIELDS, Plate, Rigidity, held};
use super::readings::Readings;
use super::superelement::{MODES, Superelement};
use super::system::SolveError;

/// Rows of V: the feet's modes and the six held motions.
const ROWS: usize = MODULES * MODES + 6;

/// A pad whose answer to every load is known.
pub struct Pad {
    /// The pad's description.
    pub device: Device,
    degree: usize,
    /// The modules' superelements.
    pub modules: [Arc<Superelement>; MODULES],
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

impl Pad {
    /// Puts the plate on its modules. `degree` is the highest degree of the plate's polynomials.
    ///
    /// # Errors
    /// A plate without stiffness.
    pub fn of(
        device: &Device,
        degree: usize,
        modules: [Arc<Superelement>; MODULES],
    ) -> Result<Self, SolveError> {
        // As stiff as a foot, so that holding the plate and letting it go again loses no digits.
        let hold = modules[0].stiffness[2][2];
        let plate = Plate::of(degree, rigidity(device), hold)?;
        let couplings = couplings(device, degree);
        let springs = springs(&modules, hold);
        let responses = plate.solve(&couplings.transpose().to_owned());
        let compliance = &couplings * &responses;
        let inner = (Mat::<f64>::identity(ROWS, ROWS) + &springs * &compliance).partial_piv_lu();
        Ok(Self {
            device: device.clone(),
            degree,
            modules,
            plate,
            couplings,
            springs,
            responses,
            compliance,
            inner,
        })
    }

    /// What each channel reads, in µV/N.
    pub fn signals(&self) -> [ForceMaps; CHANNELS] {
        self.contact_maps(&self.signal_weights(&self.modules))
    }

    /// The sums of each channel's bridge, in the signals' unit, µV/N.
    pub fn bridge_sums(&self) -> [ForceMaps; CHANNELS] {
        let weights =
            self.module_rows(|module, axis| Readings::of(&self.device).sum(&self.modules[module], axis));
        self.contact_maps(&weights)
    }

    /// The force of the plate on each module along its axes x, y, z (z is negative for a pressed one), in N/N;
    /// in the order of the channels.
    pub fn reactions(&self) -> [ForceMaps; CHANNELS] {
        let weights = self.module_rows(|module, axis| self.modules[module].stiffness[axis]);
        self.contact_maps(&weights)
    }

    /// The plate's displacement under 1 N at a place (axis 0: along +x, 1: along +y, 2: pressing): polynomials of
    /// u, v, w, R α, R β in millimetres.
    pub fn deflection(&self, place_mm: [f64; 2], axis: usize) -> [Polynomial; FIELDS] {
        let (radius, lever) = (self.radius_mm(), self.lever());
        let jets = crate::numeric::zernike::jets(self.degree, place_mm.map(|mm| mm / radius));
        let patch = self.device.contact.patch_radius_mm / radius;
        let mut load = Mat::zeros(self.plate.unknowns(), 1);
        let size = jets.len();
        for k in 0..size {
            let mut coefficients = vec![0.0; size];
            coefficients[k] = 1.0;
            let mean = Polynomial { coefficients }.disc_mean(patch).value(&jets);
            let (field, sign) = if axis == 2 { (2, -1.0) } else { (axis, 1.0) };
            load[(field * size + k, 0)] = sign * mean;
            if axis < 2 {
                load[((3 + axis) * size + k, 0)] = lever * mean;
            }
        }
        let field = self.solve(&load);
        std::array::from_fn(|block| part(field.as_ref(), 0, block, size))
    }

    /// Movements of a module's foot (its modes, mm) in a displacement of the plate from [`Self::deflection`].
    pub fn foot_modes(&self, module: usize, deflection: &[Polynomial; FIELDS]) -> [f64; MODES] {
        let all: Vec<f64> = deflection.iter().flat_map(|field| field.coefficients.iter().copied()).collect();
        std::array::from_fn(|mode| {
            let row = self.couplings.row(module * MODES + mode);
            row.iter().zip(&all).map(|(q, x)| q * x).sum()
        })
    }

    /// Highest degree of the plate's polynomials.
    pub(super) const fn degree(&self) -> usize {
        self.degree
    }

    /// What the channels read while the plate has these shapes, one column for each; µV.
    pub(super) fn signals_of(&self, shapes: &Mat<f64>) -> Mat<f64> {
        self.signal_weights(&self.modules).transpose() * (&self.couplings * shapes)
    }

    /// How far the foot of each module moves along its axes x, y, z under a force on the plate (z is negative for a pressed
    /// one), mm/N; in the order of the channels.
    pub fn foot_movements(&self) -> [ForceMaps; CHANNELS] {
        // Foot mode `axis` is the even movement along that axis.
        let weights =
            self.module_rows(|_, axis| std::array::from_fn(|mode| f64::from(u8::from(mode == axis))));
        self.contact_maps(&weights)
    }

    fn contact_maps(&self, weights: &Mat<f64>) -> [ForceMaps; CHANNELS] {
        self.maps(&self.respond(weights), self.lever()).map(|maps| maps.map(|map| self.patch_mean(&map)))
    }

    fn radius_mm(&self) -> f64 {
        self.device.plate.radius_mm()
    }

    /// Height of the plate's top above its middle plane, in plate radii.
    pub(super) fn lever(&self) -> f64 {
        self.device.plate.thickness_mm / (2.0 * self.radius_mm())
    }

    /// The channels as weights of V's rows, one column for each; of the pad's modules, or of changes of them.
    pub(super) fn signal_weights<M: Borrow<Superelement>>(&self, modules: &[M; MODULES]) -> Mat<f64> {
        let readings = Readings::of(&self.device);
        self.module_rows(|module, axis| readings.signal(modules[module].borrow(), axis))
    }

    /// V of a device that has another number than this one, but the same plate polynomials.
    pub(super) fn couplings_of(&self, device: &Device) -> Mat<f64> {
        couplings(device, self.degree)
    }

    fn module_rows(&self, row: impl Fn(usize, usize) -> [f64; MODES]) -> Mat<f64> {
        let mut weights = Mat::zeros(ROWS, CHANNELS);
        for channel in 0..CHANNELS {
            let (module, axis) = (channel / 3, channel % 3);
            for (mode, value) in row(module, axis).into_iter().enumerate() {
                weights[(module * MODES + mode, channel)] = value;
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

    /// Work of unit forces at a height (in plate radii) above the middle plane on nine displacements of the plate.
    pub(super) fn maps(&self, fields: &Mat<f64>, height: f64) -> [ForceMaps; CHANNELS] {
        let size = fields.nrows() / FIELDS;
        let mut maps = std::array::from_fn(|channel| {
            let [x, y, z] = [0, 1, 2].map(|field| part(fields.as_ref(), channel, field, size));
            // A pressing force acts along −z.
            [x, y, scaled(-1.0, z)]
        });
        add(&mut maps, height, &self.rotation_maps(fields));
        maps
    }

    /// What the work of unit forces gains per plate radius of height: the rotations.
    pub(super) fn rotation_maps(&self, fields: &Mat<f64>) -> [ForceMaps; CHANNELS] {
        let size = fields.nrows() / FIELDS;
        std::array::from_fn(|channel| {
            let [x, y] = [3, 4].map(|field| part(fields.as_ref(), channel, field, size));
            let none = Polynomial { coefficients: vec![0.0; size] };
            [x, y, none]
        })
    }

    /// A contact is an even traction over a disc: it reads the mean over the disc.
    pub(super) fn patch_mean(&self, map: &Polynomial) -> Polynomial {
        map.disc_mean(self.device.contact.patch_radius_mm / self.radius_mm())
    }
}

pub(super) fn rigidity(device: &Device) -> Rigidity {
    Rigidity::of(device.material.plate, device.plate.thickness_mm, device.plate.radius_mm())
}

fn couplings(device: &Device, degree: usize) -> Mat<f64> {
    let Device { plate, .. } = device;
    let feet: [Mat<f64>; MODULES] = std::array::from_fn(|module| {
        Foot::of(device, module).modes(degree, plate.radius_mm(), plate.thickness_mm)
    });
    let held = held(degree);
    Mat::from_fn(ROWS, feet[0].ncols(), |row, unknown| match feet.get(row / MODES) {
        Some(foot) => foot[(row % MODES, unknown)],
        None => {
            held[row - MODULES * MODES].iter().filter(|(k, _)| *k == unknown).map(|(_, factor)| factor).sum()
        }
    })
}

/// C of modules, and what takes the holding springs away again.
pub(super) fn springs<M: Borrow<Superelement>>(modules: &[M; MODULES], hold: f64) -> Mat<f64> {
    Mat::from_fn(ROWS, ROWS, |i, j| match (modules.get(i / MODES), i / MODES == j / MODES) {
        (Some(module), true) => module.borrow().stiffness[i % MODES][j % MODES],
        (None, _) if i == j => -hold,
        _ => 0.0,
    })
}

/// Adds a multiple of other maps.
pub(super) fn add(maps: &mut [ForceMaps; CHANNELS], factor: f64, other: &[ForceMaps; CHANNELS]) {
    for (map, other) in maps.iter_mut().flatten().zip(other.iter().flatten()) {
        map.coefficients.iter_mut().zip(&other.coefficients).for_each(|(c, o)| *c += factor * o);
    }
}

fn part(fields: MatRef<'_, f64>, column: usize, block: usize, size: usize) -> Polynomial {
    Polynomial { coefficients: (0..size).map(|k| fields[(block * size + k, column)]).collect() }
}

fn scaled(factor: f64, mut map: Polynomial) -> Polynomial {
    map.coefficients.iter_mut().for_each(|c| *c *= factor);
    map
}
