//! From devices to their pads, keeping every solved module: a device that differs in one module costs one solution.

use std::sync::Arc;

use crate::device::{Device, Gauge, Material, Side, Stack};
use crate::field::{ForceMaps, PadField, Sensitivity};
use crate::influence::{InfluenceField, MAPS};
use crate::quantity::{CHANNELS, MODULES};
use crate::zernike::{count, jets};

use super::mesh::{Fineness, Layer};
use super::pad::Pad;
use super::sensitivity::sensitivities;
use super::superelement::{LayerDerivatives, Solution, Superelement};
use super::system::SolveError;

/// Highest degree of the plate's polynomials: they resolve 2 to 3 mm, below which a plate of a millimetre is no plate.
/// The study is in `docs/mechanics.md`.
pub const PLATE_DEGREE: usize = 56;

/// Grid lines of the signals' splines on the plate's radius. A millimetre on the nominal plate: they differ from the
/// polynomials by less than the mesh does from the truth.
const SIGNALS_PER_RADIUS: f64 = 30.0;

/// The same for the bridges' sums, which count for a thousandth of a signal.
const SUMS_PER_RADIUS: f64 = 12.0;

/// Everything that a module's solution follows from.
#[derive(Clone, Debug, PartialEq)]
struct Blueprint {
    stack: Stack,
    gauges: Vec<Gauge>,
    materials: [Material; Layer::ALL.len()],
    open: Option<Side>,
}

impl Blueprint {
    fn of(device: &Device, module: usize) -> Self {
        let state = &device.modules[module];
        Self {
            stack: device.stack,
            gauges: device.gauges.to_vec(),
            materials: Layer::ALL.map(|layer| layer.material(device, state)),
            open: state.frame_open,
        }
    }
}

struct Solved {
    blueprint: Blueprint,
    superelement: Arc<Superelement>,
    layers: Option<Arc<Vec<LayerDerivatives>>>,
}

/// Makes pads of devices, and remembers the modules it has solved.
pub struct Simulator {
    fineness: Fineness,
    solved: Vec<Solved>,
}

impl Simulator {
    /// With the given mesh.
    pub const fn new(fineness: Fineness) -> Self {
        Self { fineness, solved: Vec::new() }
    }

    /// The device's pad.
    ///
    /// # Errors
    /// What the solver says about memory, or a stiffness that is not positive definite.
    pub fn pad(&mut self, device: &Device) -> Result<Pad, SolveError> {
        let mut modules = Vec::with_capacity(MODULES);
        for module in 0..MODULES {
            modules.push(Arc::clone(&self.solved(device, module)?.superelement));
        }
        let [a, b, c] = [0, 1, 2].map(|module| Arc::clone(&modules[module]));
        Pad::of(device, PLATE_DEGREE, [a, b, c])
    }

    /// How the channels of the device's pad change with its numbers.
    ///
    /// # Errors
    /// As for [`Self::pad`].
    pub fn sensitivities(&mut self, device: &Device) -> Result<Vec<Sensitivity>, SolveError> {
        let mut layers = Vec::with_capacity(MODULES);
        for module in 0..MODULES {
            layers.push(self.layers(device, module)?);
        }
        let pad = self.pad(device)?;
        Ok(sensitivities(&pad, &[0, 1, 2].map(|module| Arc::clone(&layers[module]))))
    }

    /// Everything that is kept of the device's pad.
    ///
    /// # Errors
    /// As for [`Self::pad`].
    pub fn field(&mut self, device: &Device) -> Result<PadField, SolveError> {
        let sensitivities = self.sensitivities(device)?;
        let pad = self.pad(device)?;
        let signals = splines(device, SIGNALS_PER_RADIUS, &pad.signals());
        let sums = splines(device, SUMS_PER_RADIUS, &pad.bridge_sums());
        Ok(PadField { signals, sums, sensitivities })
    }

    fn solved(&mut self, device: &Device, module: usize) -> Result<&mut Solved, SolveError> {
        let blueprint = Blueprint::of(device, module);
        let known = self.solved.iter().position(|solved| solved.blueprint == blueprint);
        let index = match known {
            Some(index) => index,
            None => {
                let solution = Solution::of(device, &device.modules[module], self.fineness)?;
                let superelement = Arc::new(solution.superelement());
                self.solved.push(Solved { blueprint, superelement, layers: None });
                self.solved.len() - 1
            }
        };
        Ok(&mut self.solved[index])
    }

    fn layers(&mut self, device: &Device, module: usize) -> Result<Arc<Vec<LayerDerivatives>>, SolveError> {
        let fineness = self.fineness;
        let solved = self.solved(device, module)?;
        if let Some(layers) = &solved.layers {
            return Ok(Arc::clone(layers));
        }
        let solution = Solution::of(device, &device.modules[module], fineness)?;
        let layers = Arc::new(solution.derivatives()?);
        solved.layers = Some(Arc::clone(&layers));
        Ok(layers)
    }
}

/// Splines through the polynomials of a device's channels, for contacts up to the farthest one.
///
/// Farther out a contact's disc reaches over the plate's rim, where the polynomials grow without meaning; so nothing
/// is asked of them there.
pub fn splines(device: &Device, lines_per_radius: f64, maps: &[ForceMaps; CHANNELS]) -> InfluenceField {
    let radius_mm = device.plate.diameter_mm / 2.0;
    let farthest_mm = device.contact.max_centre_radius_mm;
    // Polynomial by polynomial, so that all maps are summed side by side.
    let rows: Vec<[f64; MAPS]> = (0..count(PLATE_DEGREE)).map(|k| row(maps, k)).collect();
    InfluenceField::sampled(radius_mm / lines_per_radius, farthest_mm, farthest_mm, |place| {
        let jets = jets(PLATE_DEGREE, place.map(|mm| mm / radius_mm));
        let mut values = [0.0; MAPS];
        for (row, jet) in rows.iter().zip(&jets) {
            values.iter_mut().zip(row).for_each(|(value, coefficient)| *value += coefficient * jet.value);
        }
        values
    })
}

/// The coefficients of one circle polynomial in all maps.
fn row(maps: &[ForceMaps; CHANNELS], k: usize) -> [f64; MAPS] {
    let mut row = [0.0; MAPS];
    row.iter_mut().zip(maps.iter().flatten()).for_each(|(to, map)| {
        *to = map.coefficients.get(k).copied().unwrap_or(0.0);
    });
    row
}
