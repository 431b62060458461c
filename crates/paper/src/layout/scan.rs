//! The study of the simulated pad: its modules' reactions, and how well it locates with its modules elsewhere.

use std::fmt;
use std::sync::Arc;

use rayon::prelude::*;

use super::placement::{self, Candidate, Placement, Range, Search};
use super::precision::Press;
use super::region::{Isoline, Outline, isoline, outline};
use super::spacing::Radii;
use super::study::{Simulated, SpacingAnswers, StudyError};
use tactpad_core::pad::device::Device;
use tactpad_core::quantity::MODULES;
use tactpad_mechanics::mesh::Fineness;
use tactpad_mechanics::pad::Pad;
use tactpad_mechanics::simulator::{PLATE_DEGREE, Simulator, splines};
use tactpad_mechanics::superelement::Superelement;
use tactpad_mechanics::system::SolveError;

/// A newton, straight down. Another force in this direction only scales the errors.
pub(super) const PRESS_N: [f64; 3] = [0.0, 0.0, 1.0];

/// Grid lines of the splines on the plate's radius. The bounds of the nominal pad differ by less than a hundredth of a
/// percent from those that the polynomials themselves give, in a fifth of the time.
const LINES_PER_RADIUS: f64 = 15.0;

impl Simulated {
    /// The effective regions of the simulated pad, the paper's rule for them, and the search for better placements:
    /// `threshold` is a share of a press, `noise_uv` each channel's standard deviation, and `seed` draws the swarm.
    /// `progress` hears what is done.
    ///
    /// # Errors
    /// As [`StudyError`] lists.
    pub fn of(
        device: &Device,
        threshold: f64,
        noise_uv: f64,
        seed: u64,
        progress: impl FnMut(fmt::Arguments<'_>),
    ) -> Result<(SpacingAnswers, Self), StudyError> {
        let mut scan = Scan::of(device, noise_uv, progress).map_err(StudyError::Unsolved)?;
        let regions = scan.regions(threshold);
        let isolines = regions.each_ref().map(|(isoline, _)| *isoline);
        let spacing = SpacingAnswers::of(&radii(&isolines, threshold)?, seed);
        let placed = [Placement::of(device), Placement::by_rule(&spacing.closed_form)];
        let [as_built, by_rule] = placed.map(|placement| scan.candidate(placement));
        let simulated = Self {
            threshold,
            noise_uv,
            isolines,
            outlines: regions.map(|(_, outline)| outline),
            press_n: scan.press_n(),
            as_built: as_built.map_err(StudyError::Unsolved)?,
            by_rule: by_rule.map_err(StudyError::Unsolved)?,
            search: scan.search().map_err(StudyError::Unsolved)?,
        };
        Ok((spacing, simulated))
    }
}

/// A device's pad, and pads of the same parts with the modules elsewhere: the modules are solved once.
struct Scan<'d, P> {
    device: &'d Device,
    press: Press,
    pad: Pad,
    /// Hears what is done.
    progress: P,
    tried: usize,
}

impl<'d, P: FnMut(fmt::Arguments<'_>)> Scan<'d, P> {
    /// Solves the device's modules and puts the plate on them: the long part.
    fn of(device: &'d Device, noise_uv: f64, mut progress: P) -> Result<Self, SolveError> {
        progress(format_args!("solving the modules"));
        let pad = Simulator::new(Fineness::STANDARD).pad(device)?;
        let press = Press { force_n: PRESS_N, noise_uv };
        Ok(Self { device, press, pad, progress, tried: 0 })
    }

    /// The press whose location errors are told.
    const fn press_n(&self) -> [f64; 3] {
        self.press.force_n
    }

    /// Each module's effective region: its isoline in figures and as places.
    fn regions(&self, threshold: f64) -> [(Option<Isoline>, Outline); MODULES] {
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
    fn candidate(&self, placement: Placement) -> Result<Candidate, SolveError> {
        judged(self.device, &self.pad.modules, &self.press, placement)
    }

    /// Looks for the placement with the smallest worst error.
    fn search(&mut self) -> Result<Search, SolveError> {
        let range = Range::of(&self.device.plate, &self.device.stack);
        placement::search(&range, |placements| self.candidates(placements))
    }

    /// As many at a time as there are processors.
    fn candidates(&mut self, placements: &[Placement]) -> Result<Vec<Candidate>, SolveError> {
        let mut found = Vec::with_capacity(placements.len());
        for together in placements.chunks(rayon::current_num_threads()) {
            (self.progress)(format_args!("{} placements of the modules tried", self.tried));
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
) -> Result<Candidate, SolveError> {
    let Some(placed) = placement.on(device) else {
        return Ok(Candidate { placement, precision: None });
    };
    let pad = Pad::of(&placed, PLATE_DEGREE, modules.clone())?;
    let field = splines(&placed, LINES_PER_RADIUS, &pad.signals());
    let field = |x: f64, y: f64| field.gains(x as f32, y as f32);
    Ok(Candidate::judged(placement, press, placed.contact.max_centre_radius_mm, Some(field)))
}

/// The paper's r of each module.
fn radii(isolines: &[Option<Isoline>; MODULES], threshold: f64) -> Result<Radii, StudyError> {
    let [Some(r1), Some(r2), Some(r3)] = isolines.map(|isoline| isoline.map(|isoline| isoline.radius_mm))
    else {
        return Err(StudyError::NoRegion { threshold });
    };
    Radii::new([r1, r2, r3]).map_err(StudyError::Radius)
}
