//! The simulated pad as the verb needs it: its modules' reactions, and how well it locates with its modules elsewhere.

use std::sync::Arc;

use rayon::prelude::*;

use crate::cli::Failure;
use crate::cli::progress::Progress;
use crate::device::Device;
use crate::layout::placement::{self, Candidate, Placement, Range, Search};
use crate::layout::precision::Press;
use crate::layout::region::{Isoline, Outline, isoline, outline};
use crate::mechanics::mesh::Fineness;
use crate::mechanics::pad::Pad;
use crate::mechanics::simulator::{PLATE_DEGREE, Simulator, splines};
use crate::mechanics::superelement::Superelement;
use crate::mechanics::system::SolveError;
use crate::quantity::MODULES;

/// A newton, straight down. Another force in this direction only scales the errors.
const PRESS_N: [f64; 3] = [0.0, 0.0, 1.0];

/// Grid lines of the splines on the plate's radius. The bounds of the nominal pad differ by less than a hundredth of a
/// percent from those that the polynomials themselves give, in a fifth of the time.
const LINES_PER_RADIUS: f64 = 15.0;

/// A device's pad, and pads of the same parts with the modules elsewhere: the modules are solved once.
pub(super) struct Study<'d> {
    device: &'d Device,
    press: Press,
    pad: Pad,
    progress: Progress,
    tried: usize,
}

impl<'d> Study<'d> {
    /// Solves the device's modules and puts the plate on them: the long part.
    pub(super) fn of(device: &'d Device, noise_uv: f64) -> Result<Self, Failure> {
        let mut progress = Progress::begin();
        progress.step("solving the modules");
        let pad = Simulator::new(Fineness::STANDARD).pad(device).map_err(|error| failed(&error))?;
        let press = Press { force_n: PRESS_N, noise_uv };
        Ok(Self { device, press, pad, progress, tried: 0 })
    }

    /// The press whose location errors are told.
    pub(super) const fn press_n(&self) -> [f64; 3] {
        self.press.force_n
    }

    /// Each module's effective region: its isoline in figures and as places.
    pub(super) fn regions(&self, threshold: f64) -> [(Option<Isoline>, Outline); MODULES] {
        let carried = splines(self.device, LINES_PER_RADIUS, &self.pad.reactions());
        let (poses, rim_mm) = (self.device.poses(), self.device.contact.max_centre_radius_mm);
        std::array::from_fn(|module| {
            // The force on a pressed module points down: its z is negative.
            let share = |x: f64, y: f64| -carried.gains(x as f32, y as f32).value[3 * module + 2][2];
            let centre_mm = poses[module].centre_mm;
            (isoline(share, centre_mm, threshold, rim_mm), outline(share, centre_mm, threshold, rim_mm))
        })
    }

    /// How well the pad locates with its modules placed so.
    pub(super) fn candidate(&self, placement: Placement) -> Result<Candidate, Failure> {
        judged(self.device, &self.pad.modules, &self.press, placement)
    }

    /// Looks for the placement with the smallest worst error.
    pub(super) fn search(&mut self) -> Result<Search, Failure> {
        let range = Range::of(&self.device.plate, &self.device.stack);
        placement::search(&range, |placements| self.candidates(placements))
    }

    /// As many at a time as there are processors.
    fn candidates(&mut self, placements: &[Placement]) -> Result<Vec<Candidate>, Failure> {
        let mut found = Vec::with_capacity(placements.len());
        for together in placements.chunks(rayon::current_num_threads()) {
            self.progress.step(format_args!("{} placements of the modules tried", self.tried));
            let (device, modules, press) = (self.device, &self.pad.modules, &self.press);
            let judged = together.par_iter().map(|placement| judged(device, modules, press, *placement));
            found.extend(judged.collect::<Result<Vec<_>, _>>()?);
            self.tried += together.len();
        }
        Ok(found)
    }
}

fn judged(
    device: &Device,
    modules: &[Arc<Superelement>; MODULES],
    press: &Press,
    placement: Placement,
) -> Result<Candidate, Failure> {
    let Some(placed) = placement.on(device) else {
        return Ok(Candidate { placement, precision: None });
    };
    let pad = Pad::of(&placed, PLATE_DEGREE, modules.clone()).map_err(|error| failed(&error))?;
    let field = splines(&placed, LINES_PER_RADIUS, &pad.signals());
    let field = |x: f64, y: f64| field.gains(x as f32, y as f32);
    Ok(Candidate::judged(placement, press, placed.contact.max_centre_radius_mm, Some(field)))
}

fn failed(error: &SolveError) -> Failure {
    Failure::Failed(format!("the simulator: {error}"))
}
