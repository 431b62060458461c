//! A module's effective region: where a press is carried by the module to more than a threshold.

use std::f64::consts::TAU;

use tactpad_numeric::statistics::{mean, population_deviation};

/// Smallest share of a press that counts as carried by a module, if nobody chooses another.
///
/// A hundredth: of the lightest press for which the paper states a scatter of the contact point, 0.5 N, that is
/// 5 mN, the force resolution that it states. Less than that cannot be told from nothing.
pub const THRESHOLD: f64 = 0.01;

/// Directions in which the isoline is looked for, evenly around the module.
const RAYS: usize = 720;

/// The first look along a ray; the crossing is then bisected.
const STEP_MM: f64 = 0.25;
const BISECTIONS: usize = 40;

/// The isoline of a module's reaction about the module's centre.
///
/// The paper takes it for a circle. The spread shows how far it is from one, and so does the share of directions in
/// which the plate ends before the isoline is met. On a plate that stands on three modules it is far from one:
/// statics alone makes the reaction fall linearly across the plate, so that the isoline is nearly a straight line,
/// and for a threshold near zero it runs through the other two modules. So its radius follows the modules' distance,
/// whatever that is.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Isoline {
    /// Mean distance from the module, over the directions in which the isoline is met: the paper's r.
    pub radius_mm: f64,
    /// Standard deviation of the distance over these directions.
    pub spread_mm: f64,
    /// Shortest distance.
    pub nearest_mm: f64,
    /// Longest distance.
    pub farthest_mm: f64,
    /// Share of all directions in which the isoline is met on the plate.
    pub share_on_plate: f64,
}

/// For each ray of [`isoline`], counter-clockwise from +x, the place in millimetres where it meets the isoline; nothing
/// where it does not.
pub type Outline = Vec<Option<[f64; 2]>>;

/// Follows straight rays from the module's centre to where the reaction first falls below the threshold.
///
/// `reaction` is the share of a press at a place (x, y) that the module carries, `centre_mm` the module's place, both in
/// the pad frame. Contacts lie within `plate_radius_mm` of the pad's axis; a ray ends there. `None` if the isoline
/// is met in no direction: the module stands outside, carries less than the threshold even of a press on its own
/// centre, or carries more wherever the plate is.
///
/// The first crossing bounds the region around the module. A press far away that lifts the module, and so has a
/// reaction of great magnitude again, belongs to no region.
///
/// Source: the paper, section 2.1: region A, threshold and isoline.
pub fn isoline(
    reaction: impl Fn(f64, f64) -> f64,
    centre_mm: [f64; 2],
    threshold: f64,
    plate_radius_mm: f64,
) -> Option<Isoline> {
    let met: Vec<f64> =
        distances_mm(reaction, centre_mm, threshold, plate_radius_mm).into_iter().flatten().collect();
    (!met.is_empty()).then(|| summary(&met))
}

/// The isoline itself, for pictures.
pub fn outline(
    reaction: impl Fn(f64, f64) -> f64,
    centre_mm: [f64; 2],
    threshold: f64,
    plate_radius_mm: f64,
) -> Outline {
    let met = distances_mm(reaction, centre_mm, threshold, plate_radius_mm);
    let place = |(ray, r): (usize, Option<f64>)| {
        let [cos, sin] = direction(ray);
        r.map(|r| [centre_mm[0] + r * cos, centre_mm[1] + r * sin])
    };
    met.into_iter().enumerate().map(place).collect()
}

/// For each ray the distance at which the reaction first falls below the threshold on the plate.
fn distances_mm(
    reaction: impl Fn(f64, f64) -> f64,
    centre_mm: [f64; 2],
    threshold: f64,
    plate_radius_mm: f64,
) -> Vec<Option<f64>> {
    let met = |ray: usize| {
        let [cos, sin] = direction(ray);
        let surplus = |r: f64| reaction(centre_mm[0] + r * cos, centre_mm[1] + r * sin) - threshold;
        crossing_mm(surplus, to_rim_mm(centre_mm, [cos, sin], plate_radius_mm)?)
    };
    (0..RAYS).map(met).collect()
}

fn direction(ray: usize) -> [f64; 2] {
    let (sin, cos) = (ray as f64 / RAYS as f64 * TAU).sin_cos();
    [cos, sin]
}

/// Length of the ray from a place to the plate's rim, if the place lies on the plate.
fn to_rim_mm([x, y]: [f64; 2], [cos, sin]: [f64; 2], plate_radius_mm: f64) -> Option<f64> {
    let (along, across) = (x * cos + y * sin, y * cos - x * sin);
    let half_chord = (plate_radius_mm * plate_radius_mm - across * across).max(0.0).sqrt();
    (x.hypot(y) <= plate_radius_mm).then_some(half_chord - along)
}

/// Where the surplus first changes from positive to not positive, up to `end` included.
fn crossing_mm(surplus: impl Fn(f64) -> f64, end: f64) -> Option<f64> {
    let steps = (end / STEP_MM).ceil().max(1.0) as usize;
    let at = |step: usize| end * (step as f64 / steps as f64);
    let inside = |r: f64| surplus(r) > 0.0;
    let first = (0..=steps).find(|&step| !inside(at(step)))?;
    if first == 0 {
        return None;
    }
    let (mut low, mut high) = (at(first - 1), at(first));
    for _ in 0..BISECTIONS {
        let middle = 0.5 * (low + high);
        if inside(middle) { low = middle } else { high = middle }
    }
    Some(high)
}

fn summary(met_mm: &[f64]) -> Isoline {
    Isoline {
        radius_mm: mean(met_mm),
        spread_mm: population_deviation(met_mm),
        nearest_mm: met_mm.iter().copied().fold(f64::INFINITY, f64::min),
        farthest_mm: met_mm.iter().copied().fold(0.0, f64::max),
        share_on_plate: met_mm.len() as f64 / RAYS as f64,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn near(found: f64, wanted: f64, tolerance: f64) -> bool {
        (found - wanted).abs() <= tolerance
    }

    #[test]
    fn a_reaction_that_falls_with_the_distance_has_a_circle() {
        let centre = [4.0, -3.0];
        let fading = |x: f64, y: f64| (-(x - 4.0).hypot(y + 3.0) / 5.0).exp();
        let found = isoline(fading, centre, 0.1, 60.0).unwrap();
        let wanted = 5.0 * 10.0_f64.ln();
        assert!(near(found.radius_mm, wanted, 1e-9) && found.spread_mm < 1e-9, "{found:?}");
        assert!(near(found.nearest_mm, wanted, 1e-9) && near(found.farthest_mm, wanted, 1e-9));
        assert_eq!(found.share_on_plate, 1.0);
        let outline: Vec<[f64; 2]> = outline(fading, centre, 0.1, 60.0).into_iter().flatten().collect();
        assert_eq!(outline.len(), RAYS);
        assert!(outline.iter().all(|[x, y]| near((x - 4.0).hypot(y + 3.0), wanted, 1e-9)));
    }

    #[test]
    fn a_plate_on_three_points_has_a_straight_isoline() {
        // Lever arms: the module at (a, 0) carries 1/3 + 2x/(3a). With threshold t the isoline is x = a(3t − 1)/2.
        let (a, rim, threshold) = (20.0_f64, 29.0_f64, 0.01);
        let found = isoline(|x, _| 1.0 / 3.0 + 2.0 * x / (3.0 * a), [a, 0.0], threshold, rim).unwrap();
        let line = 0.5 * a * (3.0 * threshold - 1.0);
        let (near_mm, half) = (a - line, (rim * rim - line * line).sqrt());
        let widest = (half / near_mm).atan();
        // The mean of near/cos over the angles that meet the line before the rim.
        let mean = near_mm * (half / near_mm).asinh() / widest;
        assert!(near(found.nearest_mm, near_mm, 1e-9), "{found:?}");
        assert!(near(found.farthest_mm, near_mm.hypot(half), 0.3), "{found:?}");
        assert!(near(found.radius_mm, mean, 0.05), "{found:?} for {mean}");
        assert!(near(found.share_on_plate, widest / std::f64::consts::PI, 2.0 / RAYS as f64), "{found:?}");
    }

    #[test]
    fn the_rim_ends_a_ray() {
        let rim = |centre, direction| to_rim_mm(centre, direction, 29.0);
        assert!(near(rim([20.0, 0.0], [1.0, 0.0]).unwrap(), 9.0, 1e-12));
        assert!(near(rim([20.0, 0.0], [-1.0, 0.0]).unwrap(), 49.0, 1e-12));
        assert!(near(rim([20.0, 0.0], [0.0, 1.0]).unwrap(), 21.0, 1e-12));
        assert_eq!(rim([20.0, 22.0], [0.0, 1.0]), None);
    }

    #[test]
    fn the_first_crossing_counts() {
        // Positive to 3, negative to 6, positive again: a press there lifts the module.
        let surplus = |r: f64| (r - 3.0) * (r - 6.0);
        assert!(near(crossing_mm(surplus, 10.0).unwrap(), 3.0, 1e-9));
        assert!(near(crossing_mm(surplus, 3.0).unwrap(), 3.0, 1e-9), "on the rim itself");
        assert_eq!(crossing_mm(surplus, 2.99), None);
    }

    #[test]
    fn no_isoline_is_no_radius() {
        assert_eq!(isoline(|_, _| 1.0, [20.0, 0.0], 0.01, 29.0), None, "above it everywhere");
        assert_eq!(isoline(|_, _| 0.0, [20.0, 0.0], 0.01, 29.0), None, "below it at the module");
        assert_eq!(isoline(|x, _| x, [40.0, 0.0], 0.01, 29.0), None, "a module beside the plate");
        assert_eq!(isoline(|_, _| f64::NAN, [20.0, 0.0], 0.01, 29.0), None);
        assert_eq!(isoline(|_, _| 1.0, [f64::NAN, 0.0], 0.01, 29.0), None);
    }
}
