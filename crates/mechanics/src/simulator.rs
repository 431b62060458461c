//! From devices to their pads, keeping every solved module: a device that differs in one module costs one solution.

use std::sync::Arc;

use tactpad_core::pad::changes::{FieldChange, Flaw};
use tactpad_core::pad::device::{Device, Gauge, Material, Side, Stack};
use tactpad_core::pad::field::{ForceMaps, PadField, Sensitivity};
use tactpad_core::pad::influence::{InfluenceField, MAPS};
use tactpad_core::quantity::{CHANNELS, MODULES};
use tactpad_numeric::zernike::jets;

use super::assembly::add;
use super::deformed::ModeShapes;
use super::mesh::{Fineness, Layer};
use super::pad::Pad;
use super::sensitivity::sensitivities;
use super::superelement::{FootMass, LayerDerivatives, Solution, Superelement};
use super::system::SolveError;
use super::vibration::{NaturalMotion, natural_motions};

/// Highest degree of the plate's polynomials: they resolve about twice the plate's thickness,
/// and more of them change no channel by more than 0.4 %.
///
pub const PLATE_DEGREE: usize = 56;

/// Grid lines of the signals' splines on the plate's radius. A millimetre on the nominal plate: they differ from the
/// polynomials by less than the mesh does from the truth.
pub const SIGNALS_PER_RADIUS: f64 = 30.0;

/// The same for the bridges' sums, which count for a thousandth of a signal.
const SUMS_PER_RADIUS: f64 = 12.0;

/// Everything that a module's solution follows from.
#[derive(Clone, Debug, PartialEq)]
struct Blueprint {
    stack: Stack,
    gauges: Vec<Gauge>,
    materials: [Material; Layer::ALL.len()],
    open: Option<Side>,
    debonded: Option<(Side, f64)>,
}

impl Blueprint {
    fn of(device: &Device, module: usize) -> Self {
        let state = &device.modules[module];
        Self {
            stack: device.stack,
            gauges: device.gauges.to_vec(),
            materials: Layer::ALL.map(|layer| layer.material(device, state)),
            open: state.frame_open,
            debonded: state.debonded(),
        }
    }
}

struct Solved {
    blueprint: Blueprint,
    superelement: Arc<Superelement>,
    layers: Option<Arc<Vec<LayerDerivatives>>>,
    shapes: Option<Arc<ModeShapes>>,
    mass: Option<Arc<FootMass>>,
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
        let modules = self.superelements(device)?;
        Pad::of(device, PLATE_DEGREE, modules)
    }

    /// The device's modules.
    ///
    /// # Errors
    /// As for [`Self::pad`].
    pub fn superelements(&mut self, device: &Device) -> Result<[Arc<Superelement>; MODULES], SolveError> {
        let mut modules = Vec::with_capacity(MODULES);
        for module in 0..MODULES {
            modules.push(self.superelement(device, module)?);
        }
        Ok([0, 1, 2].map(|module| Arc::clone(&modules[module])))
    }

    /// Solves a module with its derivatives, if it is not known yet: the long part of [`Self::sensitivities`] and
    /// [`Self::field`], which then find it done.
    ///
    /// # Errors
    /// As for [`Self::pad`].
    pub fn solve(&mut self, device: &Device, module: usize) -> Result<(), SolveError> {
        self.layers(device, module).map(|_| ())
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

    /// What a flaw of module 0 changes in the device's pad, whose signals are `whole`.
    ///
    /// # Errors
    /// As for [`Self::pad`].
    pub fn change(
        &mut self,
        device: &Device,
        whole: &[ForceMaps; CHANNELS],
        flaw: Flaw,
    ) -> Result<FieldChange, SolveError> {
        let mut maps = self.pad(&flaw.on(device))?.signals();
        add(&mut maps, -1.0, whole);
        Ok(FieldChange { flaw, maps })
    }

    fn known(&self, blueprint: &Blueprint) -> Option<&Solved> {
        self.solved.iter().find(|solved| solved.blueprint == *blueprint)
    }

    fn superelement(&mut self, device: &Device, module: usize) -> Result<Arc<Superelement>, SolveError> {
        let blueprint = Blueprint::of(device, module);
        if let Some(solved) = self.known(&blueprint) {
            return Ok(Arc::clone(&solved.superelement));
        }
        let solution = Solution::of(device, &device.modules[module], self.fineness)?;
        let superelement = Arc::new(solution.superelement());
        self.solved.push(Solved {
            blueprint,
            superelement: Arc::clone(&superelement),
            layers: None,
            shapes: None,
            mass: None,
        });
        Ok(superelement)
    }

    /// A module's derivatives, and with them its superelement: both come from one solution.
    fn layers(&mut self, device: &Device, module: usize) -> Result<Arc<Vec<LayerDerivatives>>, SolveError> {
        let blueprint = Blueprint::of(device, module);
        if let Some(layers) = self.known(&blueprint).and_then(|solved| solved.layers.as_ref()) {
            return Ok(Arc::clone(layers));
        }
        let solution = Solution::of(device, &device.modules[module], self.fineness)?;
        let superelement = Arc::new(solution.superelement());
        let layers = Arc::new(solution.derivatives()?);
        let known = self.known(&blueprint);
        let shapes = known.and_then(|solved| solved.shapes.clone());
        let mass = known.and_then(|solved| solved.mass.clone());
        self.keep(Solved { blueprint, superelement, layers: Some(Arc::clone(&layers)), shapes, mass });
        Ok(layers)
    }

    /// How a module moves with its foot.
    pub(super) fn shapes(&mut self, device: &Device, module: usize) -> Result<Arc<ModeShapes>, SolveError> {
        let blueprint = Blueprint::of(device, module);
        if let Some(shapes) = self.known(&blueprint).and_then(|solved| solved.shapes.as_ref()) {
            return Ok(Arc::clone(shapes));
        }
        let solution = Solution::of(device, &device.modules[module], self.fineness)?;
        let superelement = Arc::new(solution.superelement());
        let shapes = Arc::new(ModeShapes::of(solution));
        let known = self.known(&blueprint);
        let layers = known.and_then(|solved| solved.layers.clone());
        let mass = known.and_then(|solved| solved.mass.clone());
        self.keep(Solved { blueprint, superelement, layers, shapes: Some(Arc::clone(&shapes)), mass });
        Ok(shapes)
    }

    /// The slowest natural motions of the device's pad, from the slowest on.
    ///
    /// # Errors
    /// As for [`Self::pad`], and frequencies that do not settle.
    pub fn natural_motions(&mut self, device: &Device) -> Result<Vec<NaturalMotion>, SolveError> {
        let masses = self.masses(device)?;
        natural_motions(&self.pad(device)?, &masses)
    }

    /// The modules' masses for the movements of their feet.
    ///
    /// # Errors
    /// As for [`Self::pad`].
    pub fn masses(&mut self, device: &Device) -> Result<[Arc<FootMass>; MODULES], SolveError> {
        Ok([self.mass(device, 0)?, self.mass(device, 1)?, self.mass(device, 2)?])
    }

    fn mass(&mut self, device: &Device, module: usize) -> Result<Arc<FootMass>, SolveError> {
        let blueprint = Blueprint::of(device, module);
        if let Some(mass) = self.known(&blueprint).and_then(|solved| solved.mass.as_ref()) {
            return Ok(Arc::clone(mass));
        }
        let solution = Solution::of(device, &device.modules[module], self.fineness)?;
        let superelement = Arc::new(solution.superelement());
        let mass = Arc::new(solution.mass());
        let known = self.known(&blueprint);
        let layers = known.and_then(|solved| solved.layers.clone());
        let shapes = known.and_then(|solved| solved.shapes.clone());
        self.keep(Solved { blueprint, superelement, layers, shapes, mass: Some(Arc::clone(&mass)) });
        Ok(mass)
    }

    /// Puts a module in the place of what was known of it.
    fn keep(&mut self, solved: Solved) {
        self.solved.retain(|known| known.blueprint != solved.blueprint);
        self.solved.push(solved);
    }
}

/// Splines through the polynomials of a device's channels.
pub fn splines(device: &Device, lines_per_radius: f64, maps: &[ForceMaps; CHANNELS]) -> InfluenceField {
    let radius_mm = device.plate.radius_mm();
    InfluenceField::sampled(
        radius_mm / lines_per_radius,
        device.contact.max_centre_radius_mm,
        // Farther out the patch would reach over the rim, where the polynomials mean nothing.
        radius_mm - device.contact.patch_radius_mm,
        |place| {
            let jets = jets(PLATE_DEGREE, place.map(|mm| mm / radius_mm));
            let mut values = [0.0; MAPS];
            values.iter_mut().zip(maps.iter().flatten()).for_each(|(value, map)| *value = map.value(&jets));
            values
        },
    )
}
