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
    let layouts = Layouts::of(radii);
    let (best, _) = swarmed(layouts.clone(), [0.0, 1.0].map(|end| [end; PAIRS]), seed)?;
    Ok(layouts.at(&best))
}

/// The swarm's best cost after each of its rounds, in mm²: the negative of the largest area that it has found.
///
/// # Errors
/// As for [`solve`].
pub fn costs(radii: &Radii, seed: u64) -> Result<Vec<f64>, Error> {
    Ok(swarmed(Layouts::of(radii), [0.0, 1.0].map(|end| [end; PAIRS]), seed)?.1)
}

/// The same of a swarm that looks for the distances themselves, from 0 to twice their limits, where a penalty keeps the
/// rule: the problem as the paper writes it.
///
/// # Errors
/// As for [`solve`].
pub fn penalised_costs(radii: &Radii, seed: u64) -> Result<Vec<f64>, Error> {
    let farthest_mm = radii.limits_mm().map(|limit_mm| 2.0 * limit_mm);
    Ok(swarmed(Penalised { radii: *radii }, [[0.0; PAIRS], farthest_mm], seed)?.1)
}

/// The best point of a box that a swarm finds, and its best cost after each round.
fn swarmed<C>(problem: C, [low, high]: [[f64; PAIRS]; 2], seed: u64) -> Result<(Vec<f64>, Vec<f64>), Error>
where
    C: CostFunction<Param = Vec<f64>, Output = f64>,
{
    let course = CostObserver::default();
    let swarm = ParticleSwarm::new((low.to_vec(), high.to_vec()), PARTICLES)
        .with_rng_generator(Xoshiro256PlusPlus::seed_from_u64(seed));
    let run = Executor::new(problem, swarm).configure(|state| state.max_iters(ROUNDS));
    let mut outcome = run.add_observer(course.clone(), ObserverMode::Always).timer(false).run()?;
    let best = outcome.state.take_individual().map(|particle| particle.position);
    let costs_mm2 = course.costs_mm2.lock().unwrap_or_else(PoisonError::into_inner).clone();
    Ok((best.unwrap_or_default(), costs_mm2))
}

/// Writes down the best cost of each round. The solver keeps its observers, so the list is shared.
#[derive(Clone, Default)]
struct CostObserver {
    costs_mm2: Arc<Mutex<Vec<f64>>>,
}

impl<S: State<Float = f64>> Observe<S> for CostObserver {
    fn observe_iter(&mut self, state: &S, _: &KV) -> Result<(), Error> {
        let mut costs_mm2 = self.costs_mm2.lock().unwrap_or_else(PoisonError::into_inner);
        costs_mm2.push(state.get_best_cost());
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

/// Any three distances, with a penalty for what they break.
struct Penalised {
    radii: Radii,
}

impl CostFunction for Penalised {
    type Param = Vec<f64>;
    type Output = f64;

    /// −A(d′) + λ Σ (d − d′), with the area A and λ the sum of the radii. d′ are the distances cut to their limits, the
    /// longest also to what the other two leave it, so that they make a triangle. Where the rule holds d′ = d; nowhere is
    /// the cost below that of the layout d′.
    fn cost(&self, wanted_mm: &Vec<f64>) -> Result<f64, Error> {
        let limits_mm = self.radii.limits_mm();
        let wanted_mm: [f64; PAIRS] = std::array::from_fn(|pair| wanted_mm.get(pair).copied().unwrap_or(0.0));
        let mut kept_mm: [f64; PAIRS] = std::array::from_fn(|pair| wanted_mm[pair].min(limits_mm[pair]));
        let longest = (0..PAIRS).max_by(|a, b| kept_mm[*a].total_cmp(&kept_mm[*b])).unwrap_or(0);
        let others_mm: f64 = kept_mm.iter().sum::<f64>() - kept_mm[longest];
        kept_mm[longest] = kept_mm[longest].min(others_mm);
        let broken_mm: f64 = wanted_mm.iter().zip(kept_mm).map(|(wanted, kept)| wanted - kept).sum();
        let dearness_mm: f64 = self.radii.mm().iter().sum();
        Ok(dearness_mm * broken_mm - self.radii.spacing(kept_mm).area_mm2)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::layout::spacing::is_triangle;

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
    fn best_costs_never_rise_and_both_searches_end_at_the_optimum() {
        for radii in [radii([33.0; 3]), radii([3.0, 4.0, 5.0])] {
            let optimum_mm2 = radii.widest().area_mm2;
            for seed in 1..5 {
                let costs_mm2 = [costs(&radii, seed).unwrap(), penalised_costs(&radii, seed).unwrap()];
                for costs_mm2 in &costs_mm2 {
                    assert_eq!(costs_mm2.len(), ROUNDS as usize);
                    assert!(costs_mm2.windows(2).all(|pair| pair[1] <= pair[0]), "{costs_mm2:?}");
                    assert!(costs_mm2.iter().all(|cost| -cost <= optimum_mm2 * (1.0 + 1e-12)));
                }
                let [cube, penalised] = costs_mm2.map(|costs_mm2| -costs_mm2[99]);
                assert_eq!(cube, solve(&radii, seed).unwrap().area_mm2);
                assert!(
                    (penalised / optimum_mm2 - 1.0).abs() < 1e-3,
                    "seed {seed}: {penalised} {optimum_mm2}"
                );
            }
        }
    }

    #[test]
    fn a_penalty_is_zero_exactly_where_the_rule_holds() {
        let problem = Penalised { radii: radii([3.0, 4.0, 5.0]) };
        let cost = |distances: [f64; 3]| problem.cost(&distances.to_vec()).unwrap();
        let kept = [2.5, 3.5, 2.0];
        assert_eq!(cost(kept), -problem.radii.spacing(kept).area_mm2);
        // A limit of 3 mm broken by 0.5: as the layout at the limit, and dearer.
        let at_limit = cost([3.0, 3.5, 2.0]);
        assert!((cost([3.5, 3.5, 2.0]) - at_limit - 0.5 * 12.0).abs() < 1e-9);
        // No triangle: the longest side is cut, and its excess costs.
        assert!((cost([1.0, 3.5, 1.0]) - cost([1.0, 2.0, 1.0]) - 1.5 * 12.0).abs() < 1e-9);
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
