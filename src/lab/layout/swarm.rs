//! The paper's layout problem, solved as the paper solves it: by a particle swarm.

use std::sync::{Arc, Mutex, PoisonError};

use argmin::core::observers::{Observe, ObserverMode};
use argmin::core::{CostFunction, Error, Executor, KV, State};
use argmin::solver::particleswarm::ParticleSwarm;
use rand_xoshiro::Xoshiro256PlusPlus;
use rand_xoshiro::rand_core::SeedableRng;

use super::spacing::{PAIRS, Radii, Spacing};

const PARTICLES: usize = 40;
const ROUNDS: u64 = 100;

/// The layout that a swarm of 40 particles finds in 100 rounds. The same seed gives the same layout.
///
/// The particles move in the unit cube, every point of which is a layout that keeps the rule, and which has a point
/// for every such layout. So there is no penalty to weigh, and no particle that the triangle inequality throws out.
/// With the discs in the order of their radii a ≤ b ≤ c, the three numbers are d(ab)/a, d(ac)/a, and where d(bc)
/// lies between the shortest and the longest distance that the other two and its own limit leave. That interval
/// is never empty: |d(ab) − d(ac)| ≤ a ≤ b. Its ends are the flat triangles.
///
/// Source: the paper, section 2.1; argmin's solver, with its own weights.
///
/// # Errors
/// What the solver reports. Layouts always have an area, so nothing is known to make it fail.
pub fn solve(radii: &Radii, seed: u64) -> Result<Spacing, Error> {
    Ok(observed(radii, seed)?.0)
}

/// The largest area that the swarm has found after each of its rounds, in mm²: the negative of its best cost.
///
/// # Errors
/// As for [`solve`].
pub fn course(radii: &Radii, seed: u64) -> Result<Vec<f64>, Error> {
    Ok(observed(radii, seed)?.1)
}

/// The layout that a swarm finds, and its way there.
fn observed(radii: &Radii, seed: u64) -> Result<(Spacing, Vec<f64>), Error> {
    let layouts = Layouts::of(radii);
    let course = Course::default();
    let cube = (vec![0.0; PAIRS], vec![1.0; PAIRS]);
    let swarm =
        ParticleSwarm::new(cube, PARTICLES).with_rng_generator(Xoshiro256PlusPlus::seed_from_u64(seed));
    let run = Executor::new(layouts.clone(), swarm).configure(|state| state.max_iters(ROUNDS));
    let mut outcome = run.add_observer(course.clone(), ObserverMode::Always).timer(false).run()?;
    let best = outcome.state.take_individual().map(|particle| particle.position);
    let areas_mm2 = course.areas_mm2.lock().unwrap_or_else(PoisonError::into_inner).clone();
    Ok((layouts.at(&best.unwrap_or_default()), areas_mm2))
}

/// Writes down the best area of each round. The solver keeps its observers, so the list is shared.
#[derive(Clone, Default)]
struct Course {
    areas_mm2: Arc<Mutex<Vec<f64>>>,
}

impl<S: State<Float = f64>> Observe<S> for Course {
    fn observe_iter(&mut self, state: &S, _: &KV) -> Result<(), Error> {
        let mut areas_mm2 = self.areas_mm2.lock().unwrap_or_else(PoisonError::into_inner);
        areas_mm2.push(-state.get_best_cost());
        Ok(())
    }
}

/// The layouts that keep the rule, as points of the unit cube.
#[derive(Clone)]
struct Layouts {
    radii: Radii,
    /// The discs from the smallest to the largest.
    order: [usize; 3],
}

impl Layouts {
    fn of(radii: &Radii) -> Self {
        let mut order = [0, 1, 2];
        order.sort_by(|&a, &b| radii.mm()[a].total_cmp(&radii.mm()[b]));
        Self { radii: *radii, order }
    }

    fn at(&self, point: &[f64]) -> Spacing {
        let [a, b, c] = self.order;
        let share = |axis: usize| point.get(axis).copied().unwrap_or(1.0);
        let (smallest, middle) = (self.radii.mm()[a], self.radii.mm()[b]);
        let (ab, ac) = (share(0) * smallest, share(1) * smallest);
        let (nearest, farthest) = ((ab - ac).abs(), middle.min(ab + ac));
        let mut distances_mm = [0.0; PAIRS];
        distances_mm[opposite(c)] = ab;
        distances_mm[opposite(b)] = ac;
        distances_mm[opposite(a)] = nearest + share(2) * (farthest - nearest);
        self.radii.spacing(distances_mm)
    }
}

/// The pair to which a disc does not belong.
const fn opposite(disc: usize) -> usize {
    (disc + 1) % PAIRS
}

impl CostFunction for Layouts {
    type Param = Vec<f64>;
    type Output = f64;

    /// The solver looks for the smallest cost: less area costs more.
    fn cost(&self, point: &Vec<f64>) -> Result<f64, Error> {
        Ok(-self.at(point).area_mm2)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lab::layout::spacing::is_triangle;

    fn radii(radii_mm: [f64; 3]) -> Radii {
        Radii::new(radii_mm).unwrap()
    }

    /// Sees that the swarm finds the optimal area, with distances that an optimal layout can have.
    fn assert_optimal(radii: &Radii, seed: u64) {
        let (found, best) = (solve(radii, seed).unwrap(), radii.widest());
        let scene = format!("{radii:?}, seed {seed}: {found:?} for {best:?}");
        assert!((found.area_mm2 / best.area_mm2 - 1.0).abs() < 1e-12, "{scene}");
        for (distance, [low, high]) in found.distances_mm.iter().zip(radii.optimal_ranges_mm()) {
            assert!(*distance >= low - 1e-7 * high && *distance <= high * (1.0 + 1e-15), "{scene}");
        }
    }

    #[test]
    fn every_seed_finds_the_papers_triangle() {
        let equal = radii([33.0; 3]);
        for seed in 0..300 {
            let found = solve(&equal, seed).unwrap();
            assert!(found.distances_mm.iter().all(|d| (d - 33.0).abs() < 1e-9), "{seed}: {found:?}");
        }
    }

    #[test]
    fn unequal_radii_flat_triangles_and_discs_within_others() {
        for radii_mm in [
            [3.0, 4.0, 5.0],
            [4.0, 3.9, 4.1],
            [5.0, 5.0, 3.0],
            [1.0, 1.9, 1.95],
            [4.0, 1.0, 3.0],
            [2.0, 1.0, 2.0],
            [1.0, 1.2, 3.0],
            [2.5, 1.0, 1.9],
            [0.01, 30.0, 35.0],
            [0.001, 10_000.0, 10_000.0],
        ] {
            for seed in 0..30 {
                assert_optimal(&radii(radii_mm), seed);
            }
        }
    }

    #[test]
    fn a_seed_repeats_itself() {
        let free = radii([1.0, 1.2, 3.0]);
        assert_eq!(solve(&free, 7).unwrap(), solve(&free, 7).unwrap());
        assert_ne!(solve(&free, 7).unwrap(), solve(&free, 8).unwrap(), "a free layout shows the seed");
    }

    #[test]
    fn a_course_never_falls_and_ends_where_the_answer_is() {
        let equal = radii([33.0; 3]);
        for seed in 1..5 {
            let course = course(&equal, seed).unwrap();
            assert_eq!(course.len(), ROUNDS as usize);
            assert!(course.windows(2).all(|pair| pair[0] <= pair[1]), "{course:?}");
            assert!(course[0] < course[99], "seed {seed} begins away from the optimum");
            assert_eq!(course.last(), Some(&solve(&equal, seed).unwrap().area_mm2));
        }
    }

    #[test]
    fn every_point_of_the_cube_keeps_the_rule() {
        let root = |n: f64, step: u32| (n.sqrt() * f64::from(step)).fract();
        for step in 0..3_000 {
            let radii = radii([2.0, 3.0, 5.0].map(|n| 0.1 + 9.0 * root(n, step).powi(2)));
            let point = [7.0, 11.0, 13.0].map(|n| (1.2 * root(n, step) - 0.1).clamp(0.0, 1.0));
            let distances = Layouts::of(&radii).at(&point).distances_mm;
            // A flat triangle may miss by rounding.
            let slack = distances.map(|d| d + 1e-14 * d.max(1.0));
            assert!(is_triangle(slack) || is_triangle(distances), "{radii:?} {point:?}: {distances:?}");
            assert!(distances.iter().zip(radii.limits_mm()).all(|(d, limit)| *d <= limit + 1e-14));
        }
    }
}
