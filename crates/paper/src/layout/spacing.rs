//! The paper's layout problem: three discs, spread as far as each still reaches the others' centres.

use std::fmt;

use super::disc::{Disc, union_area_mm2};
use tactpad_core::quantity::MODULES;

/// Pairs of modules: d1 joins modules 0 and 1, d2 joins 1 and 2, d3 joins 2 and 0.
pub const PAIRS: usize = 3;

/// Smallest radius that is taken for a length in millimetres.
pub const RADIUS_MIN_MM: f64 = 0.001;

/// Largest radius that is taken for a length in millimetres.
pub const RADIUS_MAX_MM: f64 = 10_000.0;

/// Two areas are the same if they differ by less than this share: a thousand times what rounding does to one.
pub(super) const SAME_AREA: f64 = 1e-12;

/// Radii of the three effective regions, in millimetres, each within what [`RADIUS_MIN_MM`] says.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Radii {
    radii_mm: [f64; MODULES],
}

/// A radius that is no length for a pad.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RadiusError {
    /// Which one, from 1 as in R1, R2, R3.
    pub number: usize,
    /// The wanted one.
    pub radius_mm: f64,
}

impl fmt::Display for RadiusError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { number, radius_mm } = self;
        write!(f, "R{number} is {radius_mm} mm: write a radius from {RADIUS_MIN_MM} to {RADIUS_MAX_MM} mm")
    }
}

impl std::error::Error for RadiusError {}

/// Distances of the module centres, in the order of [`PAIRS`], and the area that the discs then cover.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Spacing {
    /// d1, d2, d3.
    pub distances_mm: [f64; PAIRS],
    /// Area of the union.
    pub area_mm2: f64,
}

impl Radii {
    /// Takes three radii.
    ///
    /// # Errors
    /// The first one that is not a number from [`RADIUS_MIN_MM`] to [`RADIUS_MAX_MM`].
    pub fn new(radii_mm: [f64; MODULES]) -> Result<Self, RadiusError> {
        let usable = RADIUS_MIN_MM..=RADIUS_MAX_MM;
        match radii_mm.iter().zip(1..).find(|(radius_mm, _)| !usable.contains(radius_mm)) {
            Some((&radius_mm, number)) => Err(RadiusError { number, radius_mm }),
            None => Ok(Self { radii_mm }),
        }
    }

    /// The radii, in the order of the modules.
    pub const fn mm(&self) -> [f64; MODULES] {
        self.radii_mm
    }

    /// The longest distance that the rule allows each pair: the smaller of its radii.
    ///
    /// The paper states d ≤ r for its equal radii; the smaller radius keeps what that is for, each centre within
    /// reach of the other module.
    pub fn limits_mm(&self) -> [f64; PAIRS] {
        let [r0, r1, r2] = self.radii_mm;
        [r0.min(r1), r1.min(r2), r2.min(r0)]
    }

    /// The covered area for distances that make a triangle, a flat one included.
    ///
    /// Distances that make none are drawn as the flat triangle nearest to them; see [`is_triangle`].
    pub fn spacing(&self, distances_mm: [f64; PAIRS]) -> Spacing {
        let [d1, d2, d3] = distances_mm;
        let along = if d1 > 0.0 { 0.5 * (d1 + (d3 - d2) * (d3 + d2) / d1) } else { d3 };
        let along = along.clamp(-d3, d3);
        let across = ((d3 - along) * (d3 + along)).max(0.0).sqrt();
        let centres = [[0.0, 0.0], [d1, 0.0], [along, across]];
        let discs = [0, 1, 2].map(|k| {
            let ([x_mm, y_mm], radius_mm) = (centres[k], self.radii_mm[k]);
            Disc { x_mm, y_mm, radius_mm }
        });
        Spacing { distances_mm, area_mm2: union_area_mm2(&discs) }
    }

    /// The optimum in closed form: every distance as long as the limits and the triangle inequality let it be.
    ///
    /// No search is needed, because discs that move apart never cover less, whatever their radii: if no distance
    /// shrinks, the area of the union does not (Kneser and Poulsen's conjecture, proved for the plane). With radii
    /// a ≤ b ≤ c the distances are a, a and the smaller of b and 2a. Where b > 2a the triangle is flat: the
    /// smallest module stands between the others.
    ///
    /// Source: K. Bezdek and R. Connelly, "Pushing disks apart: the Kneser-Poulsen conjecture in the plane",
    /// J. reine angew. Math. 553, 2002.
    pub fn widest(&self) -> Spacing {
        self.spacing(widest_triangle(self.limits_mm()))
    }

    /// Between what each distance of an optimal layout lies. A range of length zero means that the distance is
    /// determined; any other, that some of it is free because a disc lies within the others.
    ///
    /// The lower end is the shortest distance at which the other two can still be chosen so that the area is the
    /// optimum's. Areas that differ by less than a share of 10⁻¹² count as the same.
    pub fn optimal_ranges_mm(&self) -> [[f64; 2]; PAIRS] {
        let best = self.widest();
        std::array::from_fn(|pair| {
            let longest = best.distances_mm[pair];
            let suffices =
                |distance_mm| self.best_with(pair, distance_mm) >= best.area_mm2 * (1.0 - SAME_AREA);
            [shortest(longest, suffices), longest]
        })
    }

    /// The largest area if one distance is given: the other two as long as they can be.
    fn best_with(&self, pair: usize, distance_mm: f64) -> f64 {
        let mut limits = self.limits_mm();
        limits[pair] = distance_mm;
        self.spacing(widest_triangle(limits)).area_mm2
    }
}

/// Whether three distances can lie between three points.
pub fn is_triangle([d1, d2, d3]: [f64; PAIRS]) -> bool {
    d1 <= d2 + d3 && d2 <= d3 + d1 && d3 <= d1 + d2
}

/// The triangle whose sides are all as long as the limits allow. There is one that is longest in every side: only
/// the longest limit can be too long for a triangle, and it is cut to the sum of the others.
fn widest_triangle([d1, d2, d3]: [f64; PAIRS]) -> [f64; PAIRS] {
    [d1.min(d2 + d3), d2.min(d3 + d1), d3.min(d1 + d2)]
}

/// The smallest distance in 0..=`longest` that suffices, if every longer one does: bisection until it stands.
fn shortest(longest: f64, suffices: impl Fn(f64) -> bool) -> f64 {
    if suffices(0.0) {
        return 0.0;
    }
    let (mut low, mut high) = (0.0, longest);
    loop {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            return high;
        }
        if suffices(middle) { high = middle } else { low = middle }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    fn radii(radii_mm: [f64; 3]) -> Radii {
        Radii::new(radii_mm).unwrap()
    }

    fn assert_near(found: [f64; 3], wanted: [f64; 3], tolerance: f64) {
        assert!(
            found.iter().zip(wanted).all(|(f, w)| (f - w).abs() <= tolerance),
            "{found:?} for {wanted:?}"
        );
    }

    #[test]
    fn equal_radii_make_the_papers_triangle() {
        let best = radii([34.6; 3]).widest();
        assert_eq!(best.distances_mm, [34.6; 3]);
        let wanted = (1.5 * PI + 3.0_f64.sqrt()) * 34.6 * 34.6;
        assert!((best.area_mm2 / wanted - 1.0).abs() < 1e-14);
        for [low, high] in radii([34.6; 3]).optimal_ranges_mm() {
            assert!(high - low < 1e-9, "determined: {low} … {high}");
        }
    }

    #[test]
    fn unequal_radii_are_as_far_apart_as_the_smaller_one_reaches() {
        assert_eq!(radii([3.0, 4.0, 5.0]).widest().distances_mm, [3.0, 4.0, 3.0]);
        assert_eq!(radii([5.0, 3.0, 4.0]).widest().distances_mm, [3.0, 3.0, 4.0]);
        // Twice the smallest radius is less than the middle one: flat, the smallest module between the others.
        assert_eq!(radii([1.0, 3.0, 4.0]).widest().distances_mm, [1.0, 2.0, 1.0]);
        assert_eq!(radii([4.0, 1.0, 3.0]).widest().distances_mm, [1.0, 1.0, 2.0]);
    }

    #[test]
    fn what_lies_within_another_disc_leaves_distances_free() {
        // A disc of 1 whose centre is within 1 of that of a disc of 3 lies in it; so do all of 1, 1.2 and 3.
        let free = radii([1.0, 1.2, 3.0]).optimal_ranges_mm();
        assert_near(free.map(|[low, _]| low), [0.0; 3], 0.0);
        assert_near(free.map(|[_, high]| high), [1.0, 1.2, 1.0], 0.0);
        // 1 lies in 2.5, but 1.9 does not: only the pair of the large discs is determined. The small disc may be
        // anywhere within 1 of both centres, which are 1.9 apart.
        let [[low1, high1], [low2, high2], [low3, high3]] = radii([1.0, 1.9, 2.5]).optimal_ranges_mm();
        assert_near([low1, low2, low3], [0.9, 1.9, 0.9], 1e-9);
        assert_near([high1, high2, high3], [1.0, 1.9, 1.0], 1e-12);
        // Flat, and the small disc lies in both others, yet it holds them together: all is determined.
        let flat = radii([1.0, 3.0, 4.0]).optimal_ranges_mm();
        assert_near(flat.map(|[low, _]| low), [1.0, 2.0, 1.0], 1e-8);
    }

    #[test]
    fn distances_are_those_of_the_discs() {
        // Far apart the order of the radii does not matter, overlapping it does: d1 joins 0 and 1.
        let three = radii([1.0, 2.0, 4.0]);
        let lens = |a: f64, b: f64, d: f64| {
            let (ca, cb) = ((d * d + a * a - b * b) / (2.0 * d * a), (d * d + b * b - a * a) / (2.0 * d * b));
            a * a * (ca.acos() - ca * (1.0 - ca * ca).sqrt())
                + b * b * (cb.acos() - cb * (1.0 - cb * cb).sqrt())
        };
        let sum = 21.0 * PI;
        for (distances, lens) in [
            ([2.5, 100.0, 101.0], lens(1.0, 2.0, 2.5)),
            ([101.0, 5.0, 100.0], lens(2.0, 4.0, 5.0)),
            ([100.0, 101.0, 4.5], lens(4.0, 1.0, 4.5)),
        ] {
            let area = three.spacing(distances).area_mm2;
            assert!((area - (sum - lens)).abs() < 1e-11, "{distances:?}: {area} for {}", sum - lens);
        }
    }

    #[test]
    fn degenerate_triangles_are_drawn() {
        let three = radii([1.0, 2.0, 4.0]);
        assert!((three.spacing([0.0, 0.0, 0.0]).area_mm2 - 16.0 * PI).abs() < 1e-12);
        assert!((three.spacing([0.0, 9.0, 9.0]).area_mm2 - 20.0 * PI).abs() < 1e-12);
        assert!((three.spacing([9.0, 9.0, 0.0]).area_mm2 - 20.0 * PI).abs() < 1e-12);
        assert!((three.spacing([10.0, 10.0, 20.0]).area_mm2 - 21.0 * PI).abs() < 1e-12);
    }

    #[test]
    fn what_is_no_length_is_refused() {
        for (bad, text) in [(0.0, "0 mm"), (-3.0, "-3 mm"), (f64::NAN, "NaN mm"), (1e9, "1000000000 mm")] {
            let error = Radii::new([20.0, bad, 20.0]).unwrap_err();
            assert_eq!(error.number, 2);
            assert!(error.to_string().starts_with(&format!("R2 is {text}: write")), "{error}");
        }
        assert!(Radii::new([RADIUS_MIN_MM, RADIUS_MAX_MM, 1.0]).is_ok());
    }
}
