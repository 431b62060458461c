//! The study of size by the simulated pads.

use std::fmt;
use std::sync::Arc;

use rayon::prelude::*;

use super::precision::{Press, over_plate};
use super::sizes::{CONVERTER_HZ, Size, SizeStudy, SizedPad};
use crate::damping::DAMPING_RATIO;
use tactpad_core::pad::device::Device;
use tactpad_core::pad::field::ForceMaps;
use tactpad_core::pad::influence::InfluenceField;
use tactpad_core::quantity::{CHANNELS, MODULES};
use tactpad_mechanics::mesh::Fineness;
use tactpad_mechanics::pad::Pad;
use tactpad_mechanics::simulator::{PLATE_DEGREE, SIGNALS_PER_RADIUS, Simulator, splines};
use tactpad_mechanics::superelement::{FootMass, Superelement};
use tactpad_mechanics::system::SolveError;
use tactpad_mechanics::vibration::natural_motions;
use tactpad_numeric::oscillator::Oscillator;
use tactpad_numeric::zernike::{Jet, jets};

/// A newton, straight down.
const PRESS_N: [f64; 3] = [0.0, 0.0, 1.0];

/// Grid lines of the feet's splines on the plate's radius: feet sink smoothly.
const FEET_PER_RADIUS: f64 = 12.0;

/// How far apart the places are at which feet are watched; between them they sink by nearly the same.
const RINGS: usize = 40;
const RAYS: usize = 120;

impl SizeStudy {
    /// Pads of all sizes of the grid with the device's modules: `noise_uv` is each channel's standard deviation. `progress` hears what is
    /// done.
    ///
    /// # Errors
    /// What the solver says.
    pub fn of(
        device: &Device,
        noise_uv: f64,
        mut progress: impl FnMut(usize, usize, fmt::Arguments<'_>),
    ) -> Result<Self, SolveError> {
        let sized: Vec<(Size, Device)> =
            Size::all().filter_map(|size| size.on(device).map(|sized| (size, sized))).collect();
        progress(0, sized.len(), format_args!("solving the modules"));
        let mut simulator = Simulator::new(Fineness::STANDARD);
        let masses = simulator.masses(device)?;
        let modules = simulator.pad(device)?.modules;
        let parts = Parts { modules, masses, press: Press { force_n: PRESS_N, noise_uv } };
        let mut pads = Vec::with_capacity(sized.len());
        for together in sized.chunks(rayon::current_num_threads()) {
            let judged = together.par_iter().map(|(size, sized)| parts.judged(*size, sized));
            pads.extend(judged.collect::<Result<Vec<_>, _>>()?);
            progress(pads.len(), sized.len(), format_args!("{} of {} pads", pads.len(), sized.len()));
        }
        Ok(Self::of_pads(pads, noise_uv))
    }
}

/// What all sizes share.
struct Parts {
    modules: [Arc<Superelement>; MODULES],
    masses: [Arc<FootMass>; MODULES],
    press: Press,
}

impl Parts {
    fn judged(&self, size: Size, device: &Device) -> Result<SizedPad, SolveError> {
        let pad = Pad::of(device, PLATE_DEGREE, self.modules.clone())?;
        let signals = pad.signals();
        let middle = jets(PLATE_DEGREE, [0.0; 2]);
        let field = splines(device, SIGNALS_PER_RADIUS, &signals);
        let reach_mm = device.contact.max_centre_radius_mm;
        let motions = natural_motions(&pad, &self.masses)?;
        // A pad has natural motions, or the solver would have complained.
        let (first_hz, first_kind) =
            motions.first().map_or((f64::NAN, ""), |motion| (motion.frequency_hz, motion.kind().name()));
        let bandwidth_hz = Oscillator { frequency_hz: first_hz, damping_ratio: DAMPING_RATIO }.bandwidth_hz();
        let sinking = splines(device, FEET_PER_RADIUS, &pad.foot_movements());
        Ok(SizedPad {
            size,
            centre_radius_mm: device.sites.centre_radius_mm,
            sensitivity_uv_per_n: [2, 5, 8].iter().map(|channel| signals[*channel][2].value(&middle)).sum(),
            change_uv_per_n_mm: change_uv_per_n_mm(&signals, &middle, device.plate.radius_mm()),
            precision: over_plate(|x, y| field.gains(x as f32, y as f32), &self.press, reach_mm),
            first_hz,
            first_kind,
            plate_hz: size.plate_hz(device),
            bandwidth_hz,
            bandwidth_of_converters: 2.0 * bandwidth_hz / CONVERTER_HZ,
            grounding_n: device.stack.frame_thickness_mm / deepest_mm_per_n(&sinking, reach_mm),
        })
    }
}

/// √(Σ (∂s/∂x)²) of a press in the middle, whose polynomials have these jets in the place over the radius.
fn change_uv_per_n_mm(signals: &[ForceMaps; CHANNELS], middle: &[Jet], radius_mm: f64) -> f64 {
    let slope = |maps: &ForceMaps| -> f64 {
        maps[2].coefficients.iter().zip(middle).map(|(factor, jet)| factor * jet.dx).sum()
    };
    signals.iter().map(|maps| slope(maps).powi(2)).sum::<f64>().sqrt() / radius_mm
}

/// How far a foot sinks at most under 1 N, wherever it presses.
fn deepest_mm_per_n(sinking: &InfluenceField, reach_mm: f64) -> f64 {
    let places = (0..=RINGS).flat_map(|ring| {
        (0..RAYS).map(move |ray| {
            let (sin, cos) = (std::f64::consts::TAU * ray as f64 / RAYS as f64).sin_cos();
            let radius_mm = reach_mm * ring as f64 / RINGS as f64;
            [radius_mm * cos, radius_mm * sin]
        })
    });
    let sunk = places.map(|[x, y]| {
        let gains = sinking.gains(x as f32, y as f32);
        [2, 5, 8].iter().map(|foot| -gains.value[*foot][2]).fold(0.0, f64::max)
    });
    sunk.fold(0.0, f64::max)
}
