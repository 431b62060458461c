//! Where the modules should stand for the smallest worst error of a located contact.

use super::precision::{Precision, Press, over_plate};
use super::spacing::Spacing;
use tactpad_core::pad::device::{Device, Plate, Stack};
use tactpad_core::pad::influence::Gains;
use tactpad_core::quantity::MODULES;
use tactpad_numeric::statistics::mean;

/// The grid's steps are at most these.
const RADIUS_STEP_MM: f64 = 2.0;
const ROTATION_STEP_DEG: f64 = 15.0;

/// The refinement ends when both of its steps are below these.
const RADIUS_STEP_MIN_MM: f64 = 0.1;
const ROTATION_STEP_MIN_DEG: f64 = 1.0;

/// Placements that differ by less, in millimetres and in degrees, are the same.
const SAME: f64 = 1e-9;

/// The varied numbers: where the modules stand and how they are turned, all three alike.
///
/// Their sites stay 120° apart. Turning all sites together turns the plate and changes no error over it.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Placement {
    /// Distance of the module centres from the pad's axis.
    pub centre_radius_mm: f64,
    /// Turn of every module about its own axis, counter-clockwise seen from above; on top of what the device's
    /// `[[module]]` tables say.
    pub rotation_deg: f64,
}

impl Placement {
    /// How a device's modules stand as it is.
    pub const fn of(device: &Device) -> Self {
        Self { centre_radius_mm: device.sites.centre_radius_mm, rotation_deg: 0.0 }
    }

    /// The device with its modules placed so; nothing if it could not be built, by the rules for device files.
    pub fn on(&self, device: &Device) -> Option<Device> {
        let mut placed = device.clone();
        placed.sites.centre_radius_mm = self.centre_radius_mm;
        for module in &mut placed.modules {
            let turned_deg = module.rotation_deg + self.rotation_deg;
            module.rotation_deg = if turned_deg > 180.0 { turned_deg - 360.0 } else { turned_deg };
        }
        Device::from_toml(&placed.to_toml()).0
    }

    /// Where the paper's rule puts the modules: around the axis, as far apart as the spacing says in the mean, not
    /// turned.
    pub fn by_rule(spacing: &Spacing) -> Self {
        let distance_mm = mean(spacing.distances_mm);
        Self { centre_radius_mm: distance_mm / 3.0_f64.sqrt(), rotation_deg: 0.0 }
    }
}

/// A placement and how well contacts are located with it.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Candidate {
    /// The placement.
    #[serde(flatten)]
    pub placement: Placement,
    /// Its errors over the plate; none if no such pad can be built.
    pub precision: Option<Precision>,
}

/// The grid with which the search begins; both ends of each range are on it.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Range {
    /// Centre radii, from and to.
    pub centre_radius_mm: [f64; 2],
    /// Steps between them.
    pub radius_steps: usize,
    /// Rotations, from and to. For modules with two planes of symmetry 0° to 90° are all that differ.
    pub rotation_deg: [f64; 2],
    /// Steps between them.
    pub rotation_steps: usize,
}

/// The whole search, for plots.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Search {
    /// The range that was searched.
    pub range: Range,
    /// The grid: all rotations of the first radius, then of the next.
    pub grid: Vec<Candidate>,
    /// The points that were tried around its best one, in order.
    pub refinement: Vec<Candidate>,
    /// The candidate with the smallest worst error; nothing if no pad of the range can be built.
    pub best: Option<Candidate>,
}

impl Candidate {
    /// Judges one placement by the field of gains of the pad that is built so, if it can be built.
    pub fn judged(
        placement: Placement,
        press: &Press,
        contact_radius_mm: f64,
        field: Option<impl Fn(f64, f64) -> Gains>,
    ) -> Self {
        Self { placement, precision: field.map(|field| over_plate(field, press, contact_radius_mm)) }
    }
}

/// Looks for the placement whose worst location error is smallest.
///
/// `judge` gets placements that do not depend on each other, and returns a candidate for each, in their order; some
/// hundred for a usual range. First comes the whole grid, then what is around the best so far. There, the eight neighbours at half of the grid's steps are tried; the search moves to the best of
/// them, or halves the steps, until they are below 0.1 mm and 1°. The worst error has kinks where the worst place
/// jumps, so nothing that needs its slope is used. The result is a local optimum of the best cell of the grid;
/// refinement stays within the range.
///
/// Of equally good candidates the first counts. Noise and force only scale the error: they do not move the optimum
/// of a linear pad, but the direction of the force does.
pub fn search<E>(
    range: &Range,
    mut judge: impl FnMut(&[Placement]) -> Result<Vec<Candidate>, E>,
) -> Result<Search, E> {
    let grid = judge(&range.grid())?;
    let mut best = smallest(&grid);
    let mut refinement = Vec::new();
    let [mut radius_step, mut rotation_step] = range.steps().map(|step| 0.5 * step);
    while let Some(centre) = best
        && (radius_step >= RADIUS_STEP_MIN_MM || rotation_step >= ROTATION_STEP_MIN_DEG)
    {
        // What was tried before is not better than the best so far.
        let around = range.around(centre.placement, radius_step, rotation_step);
        let is_fresh = |placement: &Placement| refinement.iter().all(|tried| !is_at(tried, placement));
        let fresh: Vec<_> = around.into_iter().filter(is_fresh).collect();
        let tried = judge(&fresh)?;
        match smallest(&tried).filter(|found| worst_mm(found) < worst_mm(&centre)) {
            Some(better) => best = Some(better),
            None => (radius_step, rotation_step) = (0.5 * radius_step, 0.5 * rotation_step),
        }
        refinement.extend(tried);
    }
    Ok(Search { range: *range, grid, refinement, best })
}

impl Search {
    /// The best among the tried candidates and this one whose signals are not larger than this one's.
    pub fn best_beside(&self, given: &Candidate) -> Candidate {
        let largest_uv = given.precision.map_or(0.0, |precision| precision.largest_uv);
        let tried = self.grid.iter().chain(&self.refinement);
        let quiet = tried.filter(|tried| tried.precision.is_some_and(|found| found.largest_uv <= largest_uv));
        smallest([given].into_iter().chain(quiet)).unwrap_or(*given)
    }

    /// Whether the best candidate stands at an end of the radii, so that it is the range that holds it.
    pub fn best_is_at_an_end(&self) -> bool {
        let ends = self.range.centre_radius_mm;
        self.best.is_some_and(|best| ends.contains(&best.placement.centre_radius_mm))
    }
}

impl Range {
    /// What can be varied under a plate: from where modules cannot meet however they are turned, to where a film's
    /// long side would reach the rim; not everything between can be built. Steps of at most 2 mm and 15°.
    pub fn of(plate: &Plate, stack: &Stack) -> Self {
        let diagonal = stack.film_length_x_mm.hypot(stack.film_width_y_mm);
        let narrow = stack.film_length_x_mm.min(stack.film_width_y_mm);
        // Three sites at radius a are √3 a apart.
        let nearest = diagonal / (MODULES as f64).sqrt();
        let farthest = (0.5 * (plate.diameter_mm - narrow)).max(nearest);
        Self {
            centre_radius_mm: [nearest, farthest],
            radius_steps: ((farthest - nearest) / RADIUS_STEP_MM).ceil() as usize,
            rotation_deg: [0.0, 90.0],
            rotation_steps: (90.0 / ROTATION_STEP_DEG) as usize,
        }
    }

    fn steps(&self) -> [f64; 2] {
        let step = |[from, to]: [f64; 2], steps: usize| (to - from) / steps.max(1) as f64;
        [step(self.centre_radius_mm, self.radius_steps), step(self.rotation_deg, self.rotation_steps)]
    }

    fn grid(&self) -> Vec<Placement> {
        let [radius_step, rotation_step] = self.steps();
        let radii = (0..=self.radius_steps).map(|k| self.centre_radius_mm[0] + k as f64 * radius_step);
        let at = |centre_radius_mm: f64| {
            (0..=self.rotation_steps).map(move |k| {
                let rotation_deg = self.rotation_deg[0] + k as f64 * rotation_step;
                Placement { centre_radius_mm, rotation_deg }
            })
        };
        radii.flat_map(at).collect()
    }

    /// The neighbours of a placement, as far as they lie in the range and differ from it.
    fn around(&self, centre: Placement, radius_step: f64, rotation_step: f64) -> Vec<Placement> {
        let mut around = Vec::with_capacity(8);
        for along in [-1.0, 0.0, 1.0] {
            for turn in [-1.0, 0.0, 1.0] {
                let placement = Placement {
                    centre_radius_mm: within(
                        centre.centre_radius_mm + along * radius_step,
                        self.centre_radius_mm,
                    ),
                    rotation_deg: within(centre.rotation_deg + turn * rotation_step, self.rotation_deg),
                };
                if placement != centre && !around.contains(&placement) {
                    around.push(placement);
                }
            }
        }
        around
    }
}

/// Whether a candidate is this placement, but for rounding.
fn is_at(candidate: &Candidate, placement: &Placement) -> bool {
    let Placement { centre_radius_mm, rotation_deg } = candidate.placement;
    let near = |a: f64, b: f64| (a - b).abs() < SAME;
    near(centre_radius_mm, placement.centre_radius_mm) && near(rotation_deg, placement.rotation_deg)
}

fn within(value: f64, [from, to]: [f64; 2]) -> f64 {
    value.min(to).max(from)
}

fn worst_mm(candidate: &Candidate) -> f64 {
    candidate.precision.map_or(f64::INFINITY, |precision| precision.worst_mm)
}

/// The first of the candidates with the smallest worst error, if one can be built.
fn smallest<'a>(candidates: impl IntoIterator<Item = &'a Candidate>) -> Option<Candidate> {
    let built = candidates.into_iter().filter(|candidate| candidate.precision.is_some());
    built.min_by(|a, b| worst_mm(a).total_cmp(&worst_mm(b))).copied()
}

#[cfg(test)]
mod tests {
    use std::convert::Infallible;

    use super::*;
    use crate::layout::precision::tests::{load_cell_error_mm, load_cells};

    const PRESS: Press = Press { force_n: [0.0, 0.0, 1.0], noise_uv: 6.0 };
    const RANGE: Range = Range {
        centre_radius_mm: [8.0, 26.0],
        radius_steps: 9,
        rotation_deg: [0.0, 90.0],
        rotation_steps: 6,
    };

    #[test]
    fn the_range_of_the_nominal_pad() {
        let plate = Plate { diameter_mm: 60.0, thickness_mm: 1.0 };
        let stack = Stack {
            film_length_x_mm: 9.8,
            film_width_y_mm: 5.4,
            frame_width_mm: 0.8,
            frame_thickness_mm: 0.2,
            pi_thickness_mm: 0.125,
            adh_thickness_mm: 0.05,
            fpc_thickness_mm: 0.13,
            post_length_x_mm: 2.0,
            post_width_y_mm: 1.4,
            post_height_mm: 1.2,
            bond_thickness_mm: 0.1,
        };
        let Range { centre_radius_mm: [nearest, farthest], radius_steps, rotation_deg, rotation_steps } =
            Range::of(&plate, &stack);
        // Films of 9.8 × 5.4 mm cannot meet if their centres are 11.19 mm apart.
        assert!((nearest * 3.0_f64.sqrt() - (9.8_f64 * 9.8 + 5.4 * 5.4).sqrt()).abs() < 1e-12);
        assert!((farthest - 27.3).abs() < 1e-12, "2.7 mm from the rim");
        assert_eq!((radius_steps, rotation_deg, rotation_steps), (11, [0.0, 90.0], 6));
    }

    /// The search with a judge of single placements that knows no errors.
    fn searched(mut judge: impl FnMut(Placement) -> Candidate) -> Search {
        let all = |placements: &[Placement]| {
            Ok::<_, Infallible>(placements.iter().map(|placement| judge(*placement)).collect())
        };
        search(&RANGE, all).unwrap()
    }

    /// A candidate whose worst error is given.
    fn valued(placement: Placement, worst_mm: f64) -> Candidate {
        let largest_uv = 4e4 / placement.centre_radius_mm;
        let precision = Precision { worst_mm, worst_at_mm: [0.0; 2], rms_mm: worst_mm, largest_uv };
        Candidate { placement, precision: Some(precision) }
    }

    #[test]
    fn the_bottom_of_a_bowl_with_kinks_is_found() {
        for (radius, rotation) in [(13.37, 41.0), (8.0, 90.0), (25.9, 3.3)] {
            let bowl = |at: Placement| {
                let (u, v) = ((at.centre_radius_mm - radius) / 2.0, (at.rotation_deg - rotation) / 15.0);
                valued(at, 1.0 + (u + 0.5 * v).abs().max((v - 0.3 * u).abs()))
            };
            let found = searched(bowl).best.unwrap().placement;
            assert!((found.centre_radius_mm - radius).abs() < 0.2, "{found:?}");
            assert!((found.rotation_deg - rotation).abs() < 2.0, "{found:?}");
        }
    }

    #[test]
    fn the_whole_scan_is_kept_in_order() {
        let mut asked = Vec::new();
        let found = searched(|at| {
            asked.push(at);
            valued(at, at.centre_radius_mm)
        });
        assert_eq!(found.grid.len(), 10 * 7);
        assert_eq!(
            (found.grid[6].placement.centre_radius_mm, found.grid[6].placement.rotation_deg),
            (8.0, 90.0)
        );
        assert_eq!(found.grid[7].placement.centre_radius_mm, 10.0);
        let kept: Vec<_> = found.grid.iter().chain(&found.refinement).map(|c| c.placement).collect();
        assert_eq!(kept, asked);
        assert!((1..asked.len()).all(|last| !asked[..last].contains(&asked[last])), "nothing is asked twice");
        assert!(asked.iter().all(|at| (8.0..=26.0).contains(&at.centre_radius_mm)));
        assert!(asked.iter().all(|at| (0.0..=90.0).contains(&at.rotation_deg)));
        assert_eq!(found.best.unwrap().placement, Placement { centre_radius_mm: 8.0, rotation_deg: 0.0 });
        assert!(found.best_is_at_an_end());
        let at_13 = |worst_mm: f64| {
            let placement = Placement { centre_radius_mm: 13.0, rotation_deg: 0.0 };
            found.best_beside(&valued(placement, worst_mm)).placement.centre_radius_mm
        };
        assert_eq!(at_13(15.0), 14.0, "the first of the grid's radii above 13");
        assert_eq!(at_13(13.5), 13.0, "nothing of the grid is better and as quiet");
    }

    #[test]
    fn what_cannot_be_built_is_passed_over() {
        let wall = |at: Placement| match at.centre_radius_mm {
            radius if radius > 17.3 => Candidate { placement: at, precision: None },
            radius => valued(at, 30.0 - radius),
        };
        let found = searched(wall);
        assert!((found.best.unwrap().placement.centre_radius_mm - 17.3).abs() < 0.2);
        let nothing = searched(|placement| Candidate { placement, precision: None });
        assert!(nothing.best.is_none() && nothing.refinement.is_empty() && nothing.grid.len() == 70);
    }

    #[test]
    fn a_device_is_placed_and_what_cannot_be_built_is_none() {
        let mut device = Device::nominal();
        device.modules[1].rotation_deg = 170.0;
        assert_eq!(Placement::of(&device), Placement { centre_radius_mm: 20.0, rotation_deg: 0.0 });
        assert_eq!(Placement::of(&device).on(&device), Some(device.clone()));
        let placed = Placement { centre_radius_mm: 15.5, rotation_deg: 30.0 }.on(&device).unwrap();
        assert_eq!(placed.sites.centre_radius_mm, 15.5);
        assert_eq!(placed.modules.map(|module| module.rotation_deg), [30.0, -160.0, 30.0]);
        for (centre_radius_mm, rotation_deg) in [(27.3, 0.0), (3.0, 0.0), (25.0, 90.0)] {
            let impossible = Placement { centre_radius_mm, rotation_deg };
            assert_eq!(impossible.on(&device), None, "{impossible:?}");
        }
    }

    #[test]
    fn the_rule_puts_the_modules_at_the_corners_of_its_triangle() {
        let side = 20.0 * 3.0_f64.sqrt();
        let found = Placement::by_rule(&Spacing { distances_mm: [side; 3], area_mm2: 0.0 });
        assert!((found.centre_radius_mm - 20.0).abs() < 1e-12 && found.rotation_deg == 0.0);
    }

    #[test]
    fn load_cells_belong_as_near_the_axis_as_they_may_stand() {
        // Noise counts per newton, so the closed form's a² + r² is smallest for the smallest a; turns do not matter.
        let judge = |at: Placement| {
            Candidate::judged(at, &PRESS, 29.0, Some(load_cells(at.centre_radius_mm, 1900.0)))
        };
        let found = searched(judge);
        let best = found.best.unwrap();
        assert_eq!(best.placement, Placement { centre_radius_mm: 8.0, rotation_deg: 0.0 });
        let wanted = load_cell_error_mm(8.0, 29.0, 6.0 / 1900.0, 1.0);
        assert!((best.precision.unwrap().worst_mm / wanted - 1.0).abs() < 1e-12);
        let unbuilt = Candidate::judged(best.placement, &PRESS, 29.0, None::<fn(f64, f64) -> Gains>);
        assert_eq!(unbuilt, Candidate { precision: None, ..best });
    }
}
