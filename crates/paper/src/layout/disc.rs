//! The area that discs cover together.

use std::f64::consts::{PI, TAU};

/// A disc in the plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disc {
    /// Centre.
    pub x_mm: f64,
    /// Centre.
    pub y_mm: f64,
    /// Radius; a disc whose radius is not above zero covers nothing.
    pub radius_mm: f64,
}

/// Area of the union of the discs, in square millimetres; exact but for rounding.
///
/// Green's theorem along the outline, which consists of those arcs of the circles that lie in no other disc:
/// ½ ∮ (x dy − y dx). Discs may touch, contain each other or be the same; numbers that are not finite give no
/// meaningful area.
pub fn union_area_mm2(discs: &[Disc]) -> f64 {
    (0..discs.len()).map(|index| outline_area_mm2(discs, index)).sum()
}

/// Contribution of one disc's arcs to the integral.
fn outline_area_mm2(discs: &[Disc], index: usize) -> f64 {
    let Some(disc) = discs.get(index).filter(|disc| disc.radius_mm > 0.0) else { return 0.0 };
    let mut covered = covered_arcs(discs, index, disc);
    covered.sort_by(|a, b| a.0.total_cmp(&b.0));
    covered.push((TAU, TAU));
    let (mut area, mut free_from) = (0.0, 0.0_f64);
    for (from, to) in covered {
        if from > free_from {
            area += disc.arc_area_mm2(free_from, from);
        }
        free_from = free_from.max(to);
    }
    area
}

/// The parts of the circle that other discs cover, as angles from 0 to 2π.
fn covered_arcs(discs: &[Disc], index: usize, disc: &Disc) -> Vec<(f64, f64)> {
    let mut covered = Vec::with_capacity(2 * discs.len());
    for (other_index, other) in discs.iter().enumerate().filter(|(other, _)| *other != index) {
        // Of two discs that are the same, the first has the outline.
        let half = disc.covered_half_angle(other, other_index < index);
        let middle = (other.y_mm - disc.y_mm).atan2(other.x_mm - disc.x_mm);
        let from = (middle - half).rem_euclid(TAU);
        let to = from + 2.0 * half;
        covered.push((from, to.min(TAU)));
        if to > TAU {
            covered.push((0.0, to - TAU));
        }
    }
    covered
}

impl Disc {
    /// Half of the angle of this disc's circle that `other` covers: π where it covers all of it, 0 where nothing.
    ///
    /// The comparisons take differences of radii, which do not round where they are small. The angle comes from the
    /// point where the circles meet, with one formula for its distance from the line of centres: so both circles
    /// end their arcs in the same point, and the outline is closed however nearly they touch or coincide.
    fn covered_half_angle(&self, other: &Self, other_wins_ties: bool) -> f64 {
        let (sum, excess) = (self.radius_mm + other.radius_mm, other.radius_mm - self.radius_mm);
        let distance = (other.x_mm - self.x_mm).hypot(other.y_mm - self.y_mm);
        if other.radius_mm <= 0.0 || distance >= sum {
            0.0
        } else if distance <= excess && (excess > 0.0 || other_wins_ties) {
            PI
        } else if distance <= -excess {
            0.0
        } else {
            let along = 0.5 * (distance - excess / distance * sum);
            // Heron's formula; the roots are taken one by one, since the product could be too small for a number.
            let narrow = (distance - excess).sqrt() * (distance + excess).sqrt() / distance;
            let across = 0.5 * ((sum + distance) * (sum - distance)).sqrt() * narrow;
            across.atan2(along)
        }
    }

    /// ½ ∫ (x dy − y dx) along the arc from one angle to another.
    fn arc_area_mm2(&self, from: f64, to: f64) -> f64 {
        let around_centre = self.radius_mm * (to - from);
        let x_part = self.x_mm * (to.sin() - from.sin());
        let y_part = self.y_mm * (to.cos() - from.cos());
        0.5 * self.radius_mm * (around_centre + x_part - y_part)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn disc(x_mm: f64, y_mm: f64, radius_mm: f64) -> Disc {
        Disc { x_mm, y_mm, radius_mm }
    }

    fn assert_near(found: f64, wanted: f64, tolerance: f64) {
        assert!((found - wanted).abs() <= tolerance * wanted.abs().max(1.0), "{found} for {wanted}");
    }

    /// Three numbers in 0..1 that do not repeat.
    fn spread(step: usize) -> [f64; 9] {
        let roots = [2.0_f64, 3.0, 5.0, 7.0, 11.0, 13.0, 17.0, 19.0, 23.0].map(f64::sqrt);
        roots.map(|root| (root * (step + 1) as f64).fract())
    }

    /// The area by horizontal lines: the length that the discs cover of each, midpoint rule.
    fn by_lines(discs: &[Disc], lines: usize) -> f64 {
        let low = discs.iter().map(|d| d.y_mm - d.radius_mm).fold(f64::INFINITY, f64::min);
        let high = discs.iter().map(|d| d.y_mm + d.radius_mm).fold(f64::NEG_INFINITY, f64::max);
        let height = (high - low) / lines as f64;
        let length = |line: usize| {
            let y = low + (line as f64 + 0.5) * height;
            let mut chords: Vec<(f64, f64)> = discs
                .iter()
                .filter(|d| (y - d.y_mm).abs() < d.radius_mm)
                .map(|d| (d.x_mm, (d.radius_mm.powi(2) - (y - d.y_mm).powi(2)).sqrt()))
                .map(|(x, half)| (x - half, x + half))
                .collect();
            chords.sort_by(|a, b| a.0.total_cmp(&b.0));
            let (mut length, mut end) = (0.0, f64::NEG_INFINITY);
            for (from, to) in chords {
                length += (to - from.max(end)).max(0.0);
                end = end.max(to);
            }
            length
        };
        (0..lines).map(length).sum::<f64>() * height
    }

    #[test]
    fn three_discs_in_any_position_cover_what_lines_measure() {
        for step in 0..200 {
            let s = spread(step);
            let radius = |k: usize| 0.05 + 3.0 * s[6 + k].powi(2);
            let discs = [0, 1, 2].map(|k| disc(4.0 * s[2 * k], 4.0 * s[2 * k + 1], radius(k)));
            // The rule's error falls with the power 3/2 of the lines' distance, from the ends of the discs.
            assert_near(union_area_mm2(&discs), by_lines(&discs, 20_000), 2e-6);
        }
    }

    #[test]
    fn an_equilateral_triangle_of_side_r_covers_the_closed_form() {
        // Inclusion and exclusion: 3 discs − 3 lenses + a Reuleaux triangle = (3π/2 + √3) r².
        for radius in [1.0, 20.0, 1e-3, 1e4] {
            let height = radius * 0.75_f64.sqrt();
            let discs =
                [disc(0.0, 0.0, radius), disc(radius, 0.0, radius), disc(0.5 * radius, height, radius)];
            let wanted = (1.5 * PI + 3.0_f64.sqrt()) * radius * radius;
            assert!((union_area_mm2(&discs) / wanted - 1.0).abs() < 1e-14);
        }
    }

    #[test]
    fn two_discs_cover_their_sum_less_the_lens() {
        for distance in [1e-9_f64, 0.3, 1.0, 1.5, 1.999_999] {
            let lens = 2.0 * (0.5 * distance).acos() - 0.5 * distance * (4.0 - distance * distance).sqrt();
            let discs = [disc(-3.0, 7.0, 1.0), disc(-3.0, 7.0 + distance, 1.0)];
            assert_near(union_area_mm2(&discs), TAU - lens, 1e-13);
        }
    }

    #[test]
    fn contained_equal_and_touching_discs() {
        let big = disc(1.0, 2.0, 3.0);
        for inner in [disc(1.0, 2.0, 1.0), disc(3.0, 2.0, 1.0), disc(1.5, 1.0, 1.5), big] {
            for discs in [[inner, big, inner], [big, inner, big], [inner, inner, big], [big, big, inner]] {
                assert_near(union_area_mm2(&discs), 9.0 * PI, 1e-14);
            }
        }
        let apart = [disc(0.0, 0.0, 1.0), disc(2.0, 0.0, 1.0), disc(50.0, 0.0, 2.0)];
        assert_near(union_area_mm2(&apart), 6.0 * PI, 1e-14);
        assert_eq!(union_area_mm2(&[]), 0.0);
        assert_near(union_area_mm2(&[disc(0.0, 0.0, 1.0), disc(0.0, 0.0, 0.0)]), PI, 1e-15);
        assert_near(union_area_mm2(&[disc(0.0, 0.0, 1.0), disc(0.5, 0.0, -2.0)]), PI, 1e-15);
    }

    #[test]
    fn discs_that_rounding_makes_equal_count_once() {
        for gap in [1e-300, 1e-17, 1e-16, 3e-16, 1e-15, 1e-12] {
            for radius in [1.0, 1.0 + f64::EPSILON] {
                let discs = [disc(0.0, 0.0, 1.0), disc(gap, 0.0, radius), disc(0.0, gap, 1.0)];
                assert_near(union_area_mm2(&discs), PI, 1e-11);
            }
        }
    }
}
