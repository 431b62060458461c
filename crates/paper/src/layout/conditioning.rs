//! How well readings tell place and force of a press apart: rank and condition number of the Jacobian.

use faer::Mat;

use super::precision::{DEPENDENT, Press, under};
use tactpad_core::pad::influence::Gains;

/// Unknowns of a press: x, y, Fx, Fy, Fz.
pub const UNKNOWNS: usize = 5;

/// What a Jacobian can tell, at its worst and at its best place.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Conditioning {
    /// The least and the greatest rank. Below [`UNKNOWNS`] some change of place and force together reads as nothing.
    pub rank: [usize; 2],
    /// The least and the greatest condition number; infinite where the rank is below [`UNKNOWNS`].
    pub condition: [f64; 2],
}

/// Rank and condition number of the Jacobian of a press, whose place is told in lengths of `radius_mm` and whose force
/// in shares of its magnitude.
///
/// The readings change by J d(x/R, y/R, Fx/F, Fy/F, Fz/F) with J = [R ∂G/∂x F⃗, R ∂G/∂y F⃗, F G], so that all columns are
/// in microvolts. The condition number σ₁/σ₅ of its singular values is what the greatest signal of a change of one
/// size is of the smallest. Singular values below rounding count as zero.
///
/// Without force, or if a number is not finite, the rank is 0. Source: G. H. Golub, C. F. Van Loan, Matrix
/// Computations, sections 2.4 and 5.4.
pub fn rank_and_condition<R: AsRef<[[f64; 3]]>>(
    gains: &Gains<R>,
    press: &Press,
    radius_mm: f64,
) -> (usize, f64) {
    let along = [&gains.dx, &gains.dy].map(|slopes| under(slopes.as_ref(), press.force_n));
    let magnitude_n = press.force_n.iter().map(|n| n * n).sum::<f64>().sqrt();
    let value = gains.value.as_ref();
    let jacobian = Mat::from_fn(value.len(), UNKNOWNS, |reading, unknown| match unknown {
        0 | 1 => radius_mm * along[unknown][reading],
        _ => magnitude_n * value[reading][unknown - 2],
    });
    let singular_uv = jacobian.singular_values().unwrap_or_default();
    let largest_uv = singular_uv.first().copied().unwrap_or(0.0);
    let rank = singular_uv.iter().filter(|uv| **uv > DEPENDENT * largest_uv).count();
    match singular_uv.get(UNKNOWNS - 1) {
        Some(smallest_uv) if rank == UNKNOWNS => (rank, largest_uv / smallest_uv),
        _ => (rank, f64::INFINITY),
    }
}

impl Conditioning {
    /// Over places whose gains are known; `radius_mm` as in [`rank_and_condition`]. Of no places, both ranks are 0.
    pub fn over<'g, R: AsRef<[[f64; 3]]> + 'g>(
        gains: impl Iterator<Item = &'g Gains<R>>,
        press: &Press,
        radius_mm: f64,
    ) -> Self {
        let found = gains.map(|gains| rank_and_condition(gains, press, radius_mm));
        let one = |(rank, condition): (usize, f64)| Self { rank: [rank; 2], condition: [condition; 2] };
        found.map(one).reduce(Self::and).unwrap_or_else(|| one((0, f64::INFINITY)))
    }

    /// Of two sets of places.
    fn and(self, other: Self) -> Self {
        let ([r, s], [c, d]) = (self.rank, self.condition);
        Self {
            rank: [r.min(other.rank[0]), s.max(other.rank[1])],
            condition: [c.min(other.condition[0]), d.max(other.condition[1])],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::precision::tests::load_cells;
    use super::*;
    use tactpad_core::pad::field::PadField;

    const PRESS: Press = Press { force_n: [0.0, 0.0, 1.0], noise_uv: 6.0 };
    const RADIUS_MM: f64 = 30.0;

    #[test]
    fn load_cells_have_rank_three() {
        let field = load_cells(20.0, 1900.0);
        for (x, y) in [(0.0, 0.0), (12.0, -7.0)] {
            let (rank, condition) = rank_and_condition(&field(x, y), &PRESS, RADIUS_MM);
            assert_eq!((rank, condition), (3, f64::INFINITY), "they read no tangential force");
        }
    }

    #[test]
    fn singular_values_of_a_known_jacobian() {
        // s = (x/R, 2 y/R, 3 Fx, 4 Fy, 5 Fz): condition number 5, whatever R and F are.
        let place = |factor: f64, row: usize, at: usize| if row == at { factor } else { 0.0 };
        for (radius_mm, force_n) in [(30.0, 1.0), (10.0, 4.0)] {
            let slope = |row: usize, at: usize, factor: f64| {
                [0.0, 0.0, place(factor / (radius_mm * force_n), row, at)]
            };
            let rows = |row: fn(usize) -> [f64; 3]| (0..5).map(row).collect::<Vec<_>>();
            let mut gains = Gains {
                value: rows(|row| {
                    std::array::from_fn(|axis| if row == axis + 2 { (row + 1) as f64 } else { 0.0 })
                }),
                dx: vec![],
                dy: vec![],
            };
            gains.value.iter_mut().flatten().for_each(|uv| *uv /= force_n);
            gains.dx = (0..5).map(|row| slope(row, 0, 1.0)).collect();
            gains.dy = (0..5).map(|row| slope(row, 1, 2.0)).collect();
            let press = Press { force_n: [0.0, 0.0, force_n], noise_uv: 6.0 };
            let (rank, condition) = rank_and_condition(&gains, &press, radius_mm);
            assert_eq!(rank, 5);
            assert!((condition - 5.0).abs() < 1e-12, "{condition}");
        }
    }

    #[test]
    fn the_nominal_pad_has_full_rank_everywhere_it_is_touched() {
        let field = PadField::nominal().signals;
        let gains: Vec<Gains> = super::super::precision::places(29.0)
            .map(|place| field.gains(place.at_mm[0] as f32, place.at_mm[1] as f32))
            .collect();
        let found = Conditioning::over(gains.iter(), &PRESS, RADIUS_MM);
        assert_eq!(found.rank, [5, 5]);
        assert!(found.condition[0] > 1.0 && found.condition[1] < 100.0, "{found:?}");
    }

    #[test]
    fn nothing_is_told_without_force_or_readings() {
        let gains = load_cells(20.0, 1900.0)(3.0, 4.0);
        let still = Press { force_n: [0.0; 3], noise_uv: 6.0 };
        assert_eq!(rank_and_condition(&gains, &still, RADIUS_MM), (0, f64::INFINITY));
        let lost = Press { force_n: [0.0, 0.0, f64::NAN], noise_uv: 6.0 };
        assert_eq!(rank_and_condition(&gains, &lost, RADIUS_MM).1, f64::INFINITY);
        let none: Gains<Vec<[f64; 3]>> = Gains { value: vec![], dx: vec![], dy: vec![] };
        assert_eq!(rank_and_condition(&none, &PRESS, RADIUS_MM), (0, f64::INFINITY));
        let nowhere = Conditioning::over(std::iter::empty::<&Gains>(), &PRESS, RADIUS_MM);
        assert_eq!(nowhere.rank, [0, 0]);
    }
}
