//! The paper's layout problem, solved as the paper solves it: by a particle swarm.

use std::array;
use std::f64::consts::LN_2;

use super::spacing::{PAIRS, Radii, Spacing};
use tactpad_numeric::random::SplitMix64;

const PARTICLES: usize = 40;
const ROUNDS: usize = 100;

/// ω: so much of its speed a particle keeps.
///
/// Source: M. Clerc, "Standard particle swarm optimisation", 2012, for the variants of 2006 and 2007.
const INERTIA: f64 = 0.5 / LN_2;

/// c: a particle is pulled towards a best place by up to so many times its distance from it. Source: as for [`INERTIA`].
const PULL: f64 = 0.5 + LN_2;

/// The layout that a swarm of 40 particles finds in 100 rounds. The same seed gives the same layout.
///
/// The particles move in the unit cube, every point of which is a layout that keeps the rule, and which has a point
/// for every such layout. So there is no penalty to weigh, and no particle that the triangle inequality throws out.
/// With the discs in the order of their radii a ≤ b ≤ c, the three numbers are d(ab)/a, d(ac)/a, and where d(bc)
/// lies between the shortest and the longest distance that the other two and its own limit leave. That interval
/// is never empty: |d(ab) − d(ac)| ≤ a ≤ b. Its ends are the flat triangles.
///
/// Source: the paper, section 2.1.
pub fn solve(radii: &Radii, seed: u64) -> Spacing {
    let layouts = Layouts::of(radii);
    layouts.at(&layouts.course(seed).best)
}

/// The swarm's best cost after each of its rounds, in mm²: the negative of the largest area that it has found.
pub fn costs(radii: &Radii, seed: u64) -> Vec<f64> {
    Layouts::of(radii).course(seed).costs
}

/// The same of a swarm that looks for the distances themselves, from 0 to twice their limits, where a penalty keeps the
/// rule: the problem as the paper writes it.
pub fn penalised_costs(radii: &Radii, seed: u64) -> Vec<f64> {
    let farthest_mm = radii.limits_mm().map(|limit_mm| 2.0 * limit_mm);
    swarmed([[0.0; PAIRS], farthest_mm], seed, |wanted_mm| penalised_mm2(radii, wanted_mm)).costs
}

/// What a swarm has found.
struct Course {
    best: [f64; PAIRS],
    /// Best cost after each round.
    costs: Vec<f64>,
}

/// Looks for the least cost in a box: v ← ω v + c u₁ (p − x) + c u₂ (g − x), x ← x + v, with a particle's best place p, the
/// swarm's best g and u₁, u₂ evenly distributed in 0..1. A particle that is thrown beyond a side stays at it.
fn swarmed([low, high]: [[f64; PAIRS]; 2], seed: u64, cost: impl Fn(&[f64; PAIRS]) -> f64) -> Course {
    let mut random = SplitMix64::new(seed);
    let mut place =
        || array::from_fn(|axis| low[axis] + f64::from(random.fraction()) * (high[axis] - low[axis]));
    let mut particles: Vec<Particle> = (0..PARTICLES)
        .map(|_| {
            let (at, other): ([f64; PAIRS], [f64; PAIRS]) = (place(), place());
            let speed = array::from_fn(|axis| 0.5 * (other[axis] - at[axis]));
            Particle { at, speed, best: at, least: cost(&at) }
        })
        .collect();
    let of_all = |particles: &[Particle]| {
        let least = particles.iter().min_by(|a, b| a.least.total_cmp(&b.least));
        least.map_or((low, f64::INFINITY), |particle| (particle.best, particle.least))
    };
    let (mut best, mut costs) = (of_all(&particles).0, Vec::with_capacity(ROUNDS));
    for _ in 0..ROUNDS {
        for Particle { at, speed, best: own, least } in &mut particles {
            for axis in 0..PAIRS {
                let mut pull = |to: f64| PULL * f64::from(random.fraction()) * (to - at[axis]);
                speed[axis] = INERTIA * speed[axis] + pull(own[axis]) + pull(best[axis]);
                at[axis] = (at[axis] + speed[axis]).clamp(low[axis], high[axis]);
            }
            let here = cost(at);
            if here < *least {
                (*own, *least) = (*at, here);
            }
        }
        let least;
        (best, least) = of_all(&particles);
        costs.push(least);
    }
    Course { best, costs }
}

/// One of a swarm.
struct Particle {
    at: [f64; PAIRS],
    speed: [f64; PAIRS],
    /// Where its cost was the least.
    best: [f64; PAIRS],
    least: f64,
}

/// The layouts that keep the rule, as points of the unit cube.
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

    /// The course of a swarm that looks for the largest area.
    fn course(&self, seed: u64) -> Course {
        swarmed([0.0, 1.0].map(|end| [end; PAIRS]), seed, |point| -self.at(point).area_mm2)
    }

    fn at(&self, point: &[f64; PAIRS]) -> Spacing {
        let [a, b, c] = self.order;
        let (smallest, middle) = (self.radii.mm()[a], self.radii.mm()[b]);
        let (ab, ac) = (point[0] * smallest, point[1] * smallest);
        let (nearest, farthest) = ((ab - ac).abs(), middle.min(ab + ac));
        let mut distances_mm = [0.0; PAIRS];
        distances_mm[opposite(c)] = ab;
        distances_mm[opposite(b)] = ac;
        distances_mm[opposite(a)] = nearest + point[2] * (farthest - nearest);
        self.radii.spacing(distances_mm)
    }
}

/// The pair to which a disc does not belong.
const fn opposite(disc: usize) -> usize {
    (disc + 1) % PAIRS
}

/// Cost of any three distances, mm²: −A(d′) + λ Σ (d − d′), with the area A and λ the sum of the radii. d′ are the distances
/// cut to their limits, the longest also to what the other two leave it, so that they make a triangle. Where the rule holds
/// d′ = d; nowhere is the cost below that of the layout d′.
fn penalised_mm2(radii: &Radii, wanted_mm: &[f64; PAIRS]) -> f64 {
    let limits_mm = radii.limits_mm();
    let mut kept_mm: [f64; PAIRS] = array::from_fn(|pair| wanted_mm[pair].min(limits_mm[pair]));
    let longest = (0..PAIRS).max_by(|a, b| kept_mm[*a].total_cmp(&kept_mm[*b])).unwrap_or(0);
    let others_mm: f64 = kept_mm.iter().sum::<f64>() - kept_mm[longest];
    kept_mm[longest] = kept_mm[longest].min(others_mm);
    let broken_mm: f64 = wanted_mm.iter().zip(kept_mm).map(|(wanted, kept)| wanted - kept).sum();
    let dearness_mm: f64 = radii.mm().iter().sum();
    dearness_mm * broken_mm - radii.spacing(kept_mm).area_mm2
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
        let (found, best) = (solve(radii, seed), radii.widest());
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
            let found = solve(&equal, seed);
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
        assert_eq!(solve(&free, 7), solve(&free, 7));
        assert_ne!(solve(&free, 7), solve(&free, 8), "a free layout shows the seed");
    }

    #[test]
    fn best_costs_never_rise_and_both_searches_end_at_the_optimum() {
        for radii in [radii([33.0; 3]), radii([3.0, 4.0, 5.0])] {
            let optimum_mm2 = radii.widest().area_mm2;
            for seed in 1..5 {
                let costs_mm2 = [costs(&radii, seed), penalised_costs(&radii, seed)];
                for costs_mm2 in &costs_mm2 {
                    assert_eq!(costs_mm2.len(), ROUNDS);
                    assert!(costs_mm2.windows(2).all(|pair| pair[1] <= pair[0]), "{costs_mm2:?}");
                    assert!(costs_mm2.iter().all(|cost| -cost <= optimum_mm2 * (1.0 + 1e-12)));
                }
                let [cube, penalised] = costs_mm2.map(|costs_mm2| -costs_mm2[99]);
                assert_eq!(cube, solve(&radii, seed).area_mm2);
                assert!(
                    (penalised / optimum_mm2 - 1.0).abs() < 1e-3,
                    "seed {seed}: {penalised} {optimum_mm2}"
                );
            }
        }
    }

    #[test]
    fn a_penalty_is_zero_exactly_where_the_rule_holds() {
        let radii = radii([3.0, 4.0, 5.0]);
        let cost = |distances_mm: [f64; 3]| penalised_mm2(&radii, &distances_mm);
        let kept = [2.5, 3.5, 2.0];
        assert_eq!(cost(kept), -radii.spacing(kept).area_mm2);
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
