//! From readings to the contact that must have been written: a model that knows contacts, row by row backwards.
//!
//! The contact u = (x, y, Fx, Fy, Fz) is sought that makes
//!
//! ```text
//! Σₖ wₖ (yₖ − fₖ(u))² + (x² + y²)/R² + (Fx² + Fy² + Fz²)/F²
//! ```
//!
//! least, by Gauss and Newton's method with slopes by differences. It starts at places all over the plate, each with its best
//! load, and goes on from those that misfit least: nothing is known of what was written. (K. Levenberg, Quarterly of Applied
//! Mathematics 2 (1944) 164, for the curvature that grows until a step makes it better.)

use tactpad_inference::model::Written;
use tactpad_numeric::linear::Factor;

/// A contact's numbers.
pub(crate) const UNKNOWNS: usize = 5;
/// Standard deviation of loads before anything is measured: no finger's is larger, and no reading feels it.
const LOAD: f64 = 100.0;
/// Rings of places to start from, as parts of the plate's radius, and places on each.
const RINGS: [f64; 2] = [0.4, 0.8];
const RING_PLACES: usize = 6;
/// Starts that are followed to their end.
const FOLLOWED: usize = 3;
/// Steps of each at most.
const STEPS_MAX: usize = 15;
/// A step that takes less than this off the misfit is the last: a hundredth of a standard deviation.
const STEP_END: f64 = 1e-4;
/// Differences that make slopes.
const BY_MM: f64 = 0.05;
const BY_LOAD: f64 = 0.05;
/// Damping factor: a failed step multiplies the added curvature by it, a good one divides.
const DAMPING: f64 = 8.0;
const DAMPING_FIRST: f64 = 1e-3;

/// A model that can say what any contact reads.
pub(crate) trait Forward {
    /// All that does not change with the load.
    type Site;
    /// A place, as it would be written.
    fn site(&self, place_mm: [f64; 2]) -> Self::Site;
    /// Readings of the channels in the circumstances of a row.
    fn reading(&self, row: usize, site: &Self::Site, load: [f64; 3]) -> Vec<f64>;
}

/// Readings of a row with their weights: one over the variance.
pub(crate) struct Weighted {
    pub(crate) readings: Vec<f64>,
    pub(crate) weights: Vec<f64>,
}

/// A model on a plate, with places to start from.
pub(crate) struct Inverse<F: Forward> {
    forward: F,
    radius_mm: f64,
    starts: Vec<([f64; 2], F::Site)>,
}

/// A contact on the way, with its site, residual and misfit.
struct Trial<S> {
    at: Written,
    site: S,
    left: Vec<f64>,
    misfit: f64,
}

/// ½ ∂²misfit/∂u² and −½ ∂misfit/∂u.
struct MisfitDerivatives {
    curvature: [[f64; UNKNOWNS]; UNKNOWNS],
    slope: Written,
}

impl<F: Forward> Inverse<F> {
    /// On a plate of this radius.
    pub(crate) fn new(forward: F, radius_mm: f64) -> Self {
        let ring = |part: &f64| {
            let radius_mm = part * radius_mm;
            (0..RING_PLACES).map(move |at| {
                let angle = std::f64::consts::TAU * at as f64 / RING_PLACES as f64;
                [radius_mm * libm::cos(angle), radius_mm * libm::sin(angle)]
            })
        };
        let places = std::iter::once([0.0; 2]).chain(RINGS.iter().flat_map(ring));
        let starts = places.map(|place_mm| (place_mm, forward.site(place_mm))).collect();
        Self { forward, radius_mm, starts }
    }

    /// The contact that makes the model read what was read in a row; none if that is no number.
    pub(crate) fn contact(&self, row: usize, read: &Weighted) -> Option<Written> {
        let mut starts: Vec<Trial<F::Site>> = self
            .starts
            .iter()
            .filter_map(|(place_mm, site)| self.loaded(row, read, *place_mm, site))
            .collect();
        starts.sort_by(|one, other| one.misfit.total_cmp(&other.misfit));
        let ends = starts.into_iter().take(FOLLOWED).filter_map(|start| self.followed(row, read, start));
        ends.min_by(|one, other| one.misfit.total_cmp(&other.misfit)).map(|best| best.at)
    }

    /// A place with its best load, as if readings were in proportion to that.
    fn loaded(
        &self,
        row: usize,
        read: &Weighted,
        place_mm: [f64; 2],
        site: &F::Site,
    ) -> Option<Trial<F::Site>> {
        let none = self.forward.reading(row, site, [0.0; 3]);
        let slopes: Vec<Vec<f64>> = (0..3)
            .map(|axis| {
                let mut load = [0.0; 3];
                load[axis] = 1.0;
                let one = self.forward.reading(row, site, load);
                one.iter().zip(&none).map(|(one, none)| one - none).collect()
            })
            .collect();
        let mut curvature = [[0.0; 3]; 3];
        let mut right = [0.0; 3];
        for i in 0..3 {
            for j in 0..=i {
                curvature[i][j] = products(&read.weights, &slopes[i], &slopes[j]);
            }
            curvature[i][i] += 1.0 / (LOAD * LOAD);
            let due: Vec<f64> = read.readings.iter().zip(&none).map(|(y, none)| y - none).collect();
            right[i] = products(&read.weights, &slopes[i], &due);
        }
        let [fx, fy, fz] = Factor::of(&curvature)?.solve(&right);
        self.trial(row, read, [place_mm[0], place_mm[1], fx, fy, fz])
    }

    /// Where steps from a start end.
    fn followed(&self, row: usize, read: &Weighted, start: Trial<F::Site>) -> Option<Trial<F::Site>> {
        let (mut best, mut damping) = (start, DAMPING_FIRST);
        let mut normal = self.normal(row, read, &best);
        for _ in 0..STEPS_MAX {
            let mut damped = normal.curvature;
            (0..UNKNOWNS).for_each(|k| damped[k][k] *= 1.0 + damping);
            let step = Factor::of(&damped)?.solve(&normal.slope);
            let at = std::array::from_fn(|k| best.at[k] + step[k]);
            let next = self.trial(row, read, self.within(at))?;
            let gained = best.misfit - next.misfit;
            if gained > 0.0 {
                best = next;
                if gained < STEP_END {
                    break;
                }
                damping /= DAMPING;
                normal = self.normal(row, read, &best);
            } else if gained > -STEP_END {
                break;
            } else {
                damping *= DAMPING;
            }
        }
        Some(best)
    }

    fn trial(&self, row: usize, read: &Weighted, at: Written) -> Option<Trial<F::Site>> {
        let site = self.forward.site([at[0], at[1]]);
        let read_here = self.forward.reading(row, &site, [at[2], at[3], at[4]]);
        let left: Vec<f64> = read.readings.iter().zip(read_here).map(|(y, f)| y - f).collect();
        let prior: f64 =
            at.iter().zip(self.precisions()).map(|(value, precision)| precision * value * value).sum();
        let misfit = products(&read.weights, &left, &left) + prior;
        misfit.is_finite().then_some(Trial { at, site, left, misfit })
    }

    /// The misfit's slope and curvature about a trial.
    fn normal(&self, row: usize, read: &Weighted, trial: &Trial<F::Site>) -> MisfitDerivatives {
        let [x, y, fx, fy, fz] = trial.at;
        let here = self.forward.reading(row, &trial.site, [fx, fy, fz]);
        let slopes: Vec<Vec<f64>> = (0..UNKNOWNS)
            .map(|k| {
                let mut moved = [x, y, fx, fy, fz];
                let by = if k < 2 { BY_MM } else { BY_LOAD };
                moved[k] += by;
                let load = [moved[2], moved[3], moved[4]];
                let there = if k < 2 {
                    self.forward.reading(row, &self.forward.site([moved[0], moved[1]]), load)
                } else {
                    self.forward.reading(row, &trial.site, load)
                };
                there.iter().zip(&here).map(|(there, here)| (there - here) / by).collect()
            })
            .collect();
        // JᵀWJ + Λ and JᵀW r − Λ u, Λ being the prior's precision.
        let precisions = self.precisions();
        let mut normal = MisfitDerivatives { curvature: [[0.0; UNKNOWNS]; UNKNOWNS], slope: [0.0; UNKNOWNS] };
        for i in 0..UNKNOWNS {
            for j in 0..=i {
                normal.curvature[i][j] = products(&read.weights, &slopes[i], &slopes[j]);
            }
            normal.curvature[i][i] += precisions[i];
            normal.slope[i] = products(&read.weights, &slopes[i], &trial.left) - precisions[i] * trial.at[i];
        }
        normal
    }

    /// Λ: one over the variances of the prior.
    fn precisions(&self) -> Written {
        let [place, load] = [self.radius_mm, LOAD].map(|deviation| 1.0 / (deviation * deviation));
        [place, place, load, load, load]
    }

    /// The nearest contact on the plate.
    fn within(&self, [x, y, fx, fy, fz]: Written) -> Written {
        let share = (self.radius_mm / libm::hypot(x, y)).min(1.0);
        [share * x, share * y, fx, fy, fz]
    }
}

/// Σₖ wₖ aₖ bₖ over the channels that count.
fn products(weights: &[f64], left: &[f64], right: &[f64]) -> f64 {
    let terms = weights.iter().zip(left.iter().zip(right)).filter(|(weight, _)| **weight > 0.0);
    terms.map(|(weight, (left, right))| weight * left * right).sum()
}
