//! The assembled pad: the plate on its three modules, and what it answers to a force anywhere on the plate.
//!
//! **Reciprocity.** A channel is a weighted sum of foot movements, s = bᵀV x, and x = K⁻¹f for a load f (see
//! `assembly.rs`). So the displacement v = K⁻¹Vᵀb of the plate under the *loads* b is the channel's influence field:
//! s = vᵀf for every f.
//! Source: J. C. Maxwell, Phil. Mag. 27 (1864) 294; E. Betti, Il Nuovo Cimento 7 (1872) 69.

use std::borrow::Borrow;
use std::sync::Arc;

use faer::Mat;

use tactpad_core::pad::device::Device;
use tactpad_core::pad::field::ForceMaps;
use tactpad_core::quantity::{CHANNELS, MODULES};
use tactpad_numeric::zernike::Polynomial;

use super::assembly::{Assembly, contact_map, couplings, lever, part};
use super::foot::Foot;
use super::plate::FIELDS;
use super::readings::Readings;
use super::superelement::{MODES, Superelement};
use super::system::SolveError;

/// A pad whose answer to every load is known.
pub struct Pad {
    /// The pad's description.
    pub device: Device,
    degree: usize,
    /// The modules' superelements.
    pub modules: [Arc<Superelement>; MODULES],
    pub(super) assembly: Assembly,
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
        let assembly = Assembly::of(device, degree, &feet(device), &modules)?;
        Ok(Self { device: device.clone(), degree, modules, assembly })
    }

    /// What each channel reads, in µV/N.
    pub fn signals(&self) -> [ForceMaps; CHANNELS] {
        self.contact_maps(&self.signal_weights(&self.modules))
    }

    /// The sums of each channel's bridge, in the signals' unit, µV/N.
    pub fn bridge_sums(&self) -> [ForceMaps; CHANNELS] {
        let weights =
            self.channel_weights(|module, axis| Readings::of(&self.device).sum(&self.modules[module], axis));
        self.contact_maps(&weights)
    }

    /// The force of the plate on each module along its axes x, y, z (z is negative for a pressed one), in N/N;
    /// in the order of the channels.
    pub fn reactions(&self) -> [ForceMaps; CHANNELS] {
        let weights = self.channel_weights(|module, axis| self.modules[module].stiffness[axis]);
        self.contact_maps(&weights)
    }

    /// The plate's displacement under 1 N at a place (axis 0: along +x, 1: along +y, 2: pressing): polynomials of
    /// u, v, w, R α, R β in millimetres.
    pub fn deflection(&self, place_mm: [f64; 2], axis: usize) -> [Polynomial; FIELDS] {
        let (radius, lever) = (self.device.plate.radius_mm(), lever(&self.device));
        let jets = tactpad_numeric::zernike::jets(self.degree, place_mm.map(|mm| mm / radius));
        let patch = self.device.contact.patch_radius_mm / radius;
        let mut load = Mat::zeros(self.assembly.plate.unknowns(), 1);
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
        let field = self.assembly.solve(&load);
        std::array::from_fn(|block| part(field.as_ref(), 0, block, size))
    }

    /// Movements of a module's foot (its modes, mm) in a displacement of the plate from [`Self::deflection`].
    pub fn foot_modes(&self, module: usize, deflection: &[Polynomial; FIELDS]) -> [f64; MODES] {
        let all: Vec<f64> = deflection.iter().flat_map(|field| field.coefficients.iter().copied()).collect();
        std::array::from_fn(|mode| {
            let row = self.assembly.couplings.row(module * MODES + mode);
            row.iter().zip(&all).map(|(q, x)| q * x).sum()
        })
    }

    /// Highest degree of the plate's polynomials.
    pub(super) const fn degree(&self) -> usize {
        self.degree
    }

    /// What the channels read while the plate has these shapes, one column for each; µV.
    pub(super) fn signals_of(&self, shapes: &Mat<f64>) -> Mat<f64> {
        self.signal_weights(&self.modules).transpose() * (&self.assembly.couplings * shapes)
    }

    /// How far the foot of each module moves along its axes x, y, z under a force on the plate (z is negative for a pressed
    /// one), mm/N; in the order of the channels.
    pub fn foot_movements(&self) -> [ForceMaps; CHANNELS] {
        // Foot mode `axis` is the even movement along that axis.
        let weights =
            self.channel_weights(|_, axis| std::array::from_fn(|mode| f64::from(u8::from(mode == axis))));
        self.contact_maps(&weights)
    }

    fn contact_maps(&self, weights: &Mat<f64>) -> [ForceMaps; CHANNELS] {
        let fields = self.assembly.respond(weights);
        std::array::from_fn(|channel| contact_map(&self.device, &fields, channel))
    }

    /// The channels as weights of V's rows, one column for each; of the pad's modules, or of changes of them.
    pub(super) fn signal_weights<M: Borrow<Superelement>>(&self, modules: &[M; MODULES]) -> Mat<f64> {
        let readings = Readings::of(&self.device);
        self.channel_weights(|module, axis| readings.signal(modules[module].borrow(), axis))
    }

    /// V of a device that has another number than this one, but the same plate polynomials.
    pub(super) fn couplings_of(&self, device: &Device) -> Mat<f64> {
        couplings(device, self.degree, &feet(device))
    }

    fn channel_weights(&self, of_module: impl Fn(usize, usize) -> [f64; MODES]) -> Mat<f64> {
        self.assembly.weights(MODULES, CHANNELS / MODULES, of_module)
    }
}

/// Where the device's modules meet its plate.
fn feet(device: &Device) -> [Foot; MODULES] {
    std::array::from_fn(|module| Foot::of(device, module))
}
