//! Polynomials on the unit disc that are orthogonal over it: Zernike's circle polynomials.
//!
//! The polynomials of degree n are U(n, 0) … U(n, n), all of them up to degree N span every polynomial in x and y up
//! to that degree: (N + 1)(N + 2)/2 in all, ordered by degree. They are real and not normalised: the square's
//! integral over the disc is π/(n+1)·½, or π/(n+1) for the ones that depend on the radius alone.
//! Source: T. B. Andersen, Efficient and robust recurrence relations for the Zernike circle polynomials and their
//! derivatives in Cartesian coordinates, Optics Express 26 (2018) 18878.

use std::f64::consts::PI;

/// A value and its derivatives along x and y.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Jet {
    /// The value.
    pub value: f64,
    /// ∂/∂x.
    pub dx: f64,
    /// ∂/∂y.
    pub dy: f64,
}

impl Jet {
    const ONE: Self = Self { value: 1.0, dx: 0.0, dy: 0.0 };

    /// Multiplies by x, of which `at` is the value.
    fn times_x(self, at: f64) -> Self {
        Self { value: at * self.value, dx: self.value + at * self.dx, dy: at * self.dy }
    }

    fn times_y(self, at: f64) -> Self {
        Self { value: at * self.value, dx: at * self.dx, dy: self.value + at * self.dy }
    }

    fn plus(self, factor: f64, other: Self) -> Self {
        Self {
            value: self.value + factor * other.value,
            dx: self.dx + factor * other.dx,
            dy: self.dy + factor * other.dy,
        }
    }
}

/// Number of polynomials up to a degree.
pub const fn count(degree: usize) -> usize {
    (degree + 1) * (degree + 2) / 2
}

/// All polynomials up to `degree` with their derivatives at a place of the plane (beyond the unit disc, too).
pub fn jets(degree: usize, [x, y]: [f64; 2]) -> Vec<Jet> {
    let mut all: Vec<Jet> = Vec::with_capacity(count(degree));
    all.push(Jet::ONE);
    for n in 1..=degree {
        for m in 0..=n {
            let jet = next(&all, n, m, x, y);
            all.push(jet);
        }
    }
    all
}

/// U(n, m) from the polynomials of lower degree (Andersen 2018, equations for U by cases of m).
fn next(all: &[Jet], n: usize, m: usize, x: f64, y: f64) -> Jet {
    let u = |n: usize, m: usize| all[n * (n + 1) / 2 + m];
    if n == 1 {
        return if m == 0 { Jet::ONE.times_y(y) } else { Jet::ONE.times_x(x) };
    }
    if m == 0 {
        return u(n - 1, 0).times_x(x).plus(1.0, u(n - 1, n - 1).times_y(y));
    }
    if m == n {
        return u(n - 1, n - 1).times_x(x).plus(-1.0, u(n - 1, 0).times_y(y));
    }
    if 2 * m == n {
        let doubled = u(n - 1, m).times_x(x).plus(1.0, u(n - 1, m - 1).times_y(y));
        return doubled.plus(1.0, doubled).plus(-1.0, u(n - 2, m - 1));
    }
    let mut jet =
        u(n - 1, n - 1 - m).times_y(y).plus(1.0, u(n - 1, m - 1).times_x(x)).plus(-1.0, u(n - 2, m - 1));
    if 2 * m + 1 != n {
        jet = jet.plus(1.0, u(n - 1, m).times_x(x));
    }
    if 2 * m != n + 1 {
        jet = jet.plus(-1.0, u(n - 1, n - m).times_y(y));
    }
    jet
}

/// The integrals of the squares over the unit disc.
pub fn norms(degree: usize) -> Vec<f64> {
    let norm = |n: usize, m: usize| if 2 * m == n { PI / (n + 1) as f64 } else { PI / (2 * (n + 1)) as f64 };
    (0..=degree).flat_map(|n| (0..=n).map(move |m| norm(n, m))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const DEGREE: usize = 14;

    #[test]
    fn the_first_polynomials_are_the_known_ones() {
        let (x, y) = (0.3, -0.4);
        let values: Vec<f64> = jets(3, [x, y]).iter().map(|jet| jet.value).collect();
        let r2 = x * x + y * y;
        let known = [1.0, y, x, 2.0 * x * y, 2.0 * r2 - 1.0, x * x - y * y];
        for (value, wanted) in values.iter().zip(known) {
            assert!((value - wanted).abs() < 1e-15, "{values:?}");
        }
        assert!(values.iter().any(|value| (value - (3.0 * r2 - 2.0) * x).abs() < 1e-15), "{values:?}");
    }

    #[test]
    fn derivatives_are_differences() {
        let (at, step) = ([0.35, 0.6], 1e-6);
        let moved = |dx: f64, dy: f64| jets(DEGREE, [at[0] + dx, at[1] + dy]);
        let (east, west, north, south) =
            (moved(step, 0.0), moved(-step, 0.0), moved(0.0, step), moved(0.0, -step));
        for (k, jet) in jets(DEGREE, at).iter().enumerate() {
            assert!(((east[k].value - west[k].value) / (2.0 * step) - jet.dx).abs() < 1e-7);
            assert!(((north[k].value - south[k].value) / (2.0 * step) - jet.dy).abs() < 1e-7);
        }
    }
}
