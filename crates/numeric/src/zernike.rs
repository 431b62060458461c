//! Polynomials on the unit disc that are orthogonal over it: Zernike's circle polynomials.
//!
//! The polynomials of degree n are U(n, 0) … U(n, n), all of them up to degree N span every polynomial in x and y up
//! to that degree: (N + 1)(N + 2)/2 in all, ordered by degree. They are real and not normalised: the square's
//! integral over the disc is π/(n+1)·½, or π/(n+1) for the ones that depend on the radius alone.
//!
//! With l = |n − 2m|, U(n, m) is R(r) sin lθ for n > 2m and R(r) cos lθ otherwise, R being Zernike's radial
//! polynomial of degree n and order l, which is 1 at the rim.
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

    /// Multiplies by x, of which `at` is the value: (x f)ₓ = f + x fₓ, (x f)ᵧ = x fᵧ.
    fn times_x(self, at: f64) -> Self {
        Self { value: at * self.value, dx: self.value + at * self.dx, dy: at * self.dy }
    }

    /// Multiplies by y, of which `at` is the value: (y f)ₓ = y fₓ, (y f)ᵧ = f + y fᵧ.
    fn times_y(self, at: f64) -> Self {
        Self { value: at * self.value, dx: at * self.dx, dy: self.value + at * self.dy }
    }

    /// self + factor · other.
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

/// The values of the first `N` polynomials at a place of the plane, without asking for memory.
pub fn values<const N: usize>([x, y]: [f64; 2]) -> [f64; N] {
    let mut all = [Jet::ONE; N];
    let degrees = (1..).flat_map(|n| (0..=n).map(move |m| (n, m)));
    for (at, (n, m)) in (1..N).zip(degrees) {
        all[at] = next(&all[..at], n, m, x, y);
    }
    all.map(|jet| jet.value)
}

/// U(n, m) from the polynomials of lower degree (Andersen 2018, equations for U by cases of m).
fn next(all: &[Jet], n: usize, m: usize, x: f64, y: f64) -> Jet {
    let u = |n: usize, m: usize| all[n * (n + 1) / 2 + m];
    // U(1, 0) = y, U(1, 1) = x.
    if n == 1 {
        return if m == 0 { Jet::ONE.times_y(y) } else { Jet::ONE.times_x(x) };
    }
    // U(n, 0) = x U(n−1, 0) + y U(n−1, n−1).
    if m == 0 {
        return u(n - 1, 0).times_x(x).plus(1.0, u(n - 1, n - 1).times_y(y));
    }
    // U(n, n) = x U(n−1, n−1) − y U(n−1, 0).
    if m == n {
        return u(n - 1, n - 1).times_x(x).plus(-1.0, u(n - 1, 0).times_y(y));
    }
    // U(2m, m) = 2x U(n−1, m) + 2y U(n−1, m−1) − U(n−2, m−1).
    if 2 * m == n {
        let doubled = u(n - 1, m).times_x(x).plus(1.0, u(n - 1, m - 1).times_y(y));
        return doubled.plus(1.0, doubled).plus(-1.0, u(n - 2, m - 1));
    }
    // U(n, m) = x U(n−1, m) + y U(n−1, n−1−m) + x U(n−1, m−1) − y U(n−1, n−m) − U(n−2, m−1), without the first term where
    // n = 2m + 1 and without the fourth where n = 2m − 1.
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

/// The angular part of a polynomial.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wave {
    /// R(r) cos lθ.
    Cos,
    /// R(r) sin lθ.
    Sin,
}

/// ∫ of each polynomial's square over the disc, up to a degree: π/(n+1), and half of that where it turns with θ.
pub fn square_integrals(degree: usize) -> Vec<f64> {
    let of = |n: usize, m: usize| PI / (n + 1) as f64 / if n == 2 * m { 1.0 } else { 2.0 };
    (0..=degree).flat_map(|n| (0..=n).map(move |m| of(n, m))).collect()
}

/// Index of the polynomial of degree n and angular order l; `None` where there is none (l > n, other parity, or a
/// sine of order 0).
pub fn index(degree: usize, order: usize, wave: Wave) -> Option<usize> {
    let exists = order <= degree && (degree - order).is_multiple_of(2) && (order, wave) != (0, Wave::Sin);
    let m = match wave {
        Wave::Cos => (degree + order) / 2,
        Wave::Sin => degree.saturating_sub(order) / 2,
    };
    exists.then_some(degree * (degree + 1) / 2 + m)
}

/// A polynomial over the disc by its coefficients, lowest degree first.
#[derive(Clone, Debug, PartialEq)]
pub struct Polynomial {
    /// Coefficients of the circle polynomials.
    pub coefficients: Vec<f64>,
}

impl Polynomial {
    /// Its value, given the circle polynomials at a place.
    pub fn value(&self, jets: &[Jet]) -> f64 {
        self.coefficients.iter().zip(jets).map(|(c, jet)| c * jet.value).sum()
    }

    /// Its value and slopes, given the circle polynomials at a place.
    pub fn jet(&self, jets: &[Jet]) -> Jet {
        let zero = Jet { value: 0.0, dx: 0.0, dy: 0.0 };
        self.coefficients.iter().zip(jets).fold(zero, |sum, (c, jet)| sum.plus(*c, *jet))
    }

    /// The polynomial of its means over discs of `radius` (in units of the unit disc's) about each place.
    ///
    /// The mean of f over a disc of radius a is Σ (a/2)²ᵏ/(k!(k+1)!) ∇²ᵏ f, a finite sum for a polynomial.
    pub fn disc_mean(&self, radius: f64) -> Self {
        let mut term = self.clone();
        let mut mean = self.clone();
        let mut k = 1.0;
        while term.coefficients.iter().any(|c| *c != 0.0) {
            let factor = radius * radius / 4.0 / (k * (k + 1.0));
            term = term.laplacian();
            for (sum, c) in mean.coefficients.iter_mut().zip(&mut term.coefficients) {
                *c *= factor;
                *sum += *c;
            }
            k += 1.0;
        }
        mean
    }

    /// ∂²/∂x² + ∂²/∂y².
    ///
    /// In z = x + iy, ∂/∂z of R(n, l) exp(ilθ) is the sum of (p + 1) R(p, l−1) exp(i(l−1)θ) over
    /// p = n−1, n−3, … down to |l−1|, and ∂/∂z* is the same with l+1. ∇² = 4 ∂²/∂z∂z*, which keeps the wave.
    fn laplacian(&self) -> Self {
        let mut result = vec![0.0; self.coefficients.len()];
        let degree = degree_of(self.coefficients.len());
        for order in 0..=degree {
            for wave in [Wave::Cos, Wave::Sin] {
                laplacian_of_wave(&self.coefficients, degree, order, wave, &mut result);
            }
        }
        Self { coefficients: result }
    }
}

/// The greatest degree among this number of polynomials.
fn degree_of(polynomials: usize) -> usize {
    (0..).find(|degree| count(degree + 1) > polynomials).unwrap_or(0)
}

/// From the highest degree down, running sums: first over ∂/∂z (order l − 1), then over ∂/∂z* back to order l. With the
/// coefficients c of order l
///
/// ```text
/// (∇²c)ₙ = 4 (n + 1) Σ (p + 1) Σ c_q,    p = n + 1, n + 3, …,    q = p + 1, p + 3, …
/// ```
fn laplacian_of_wave(from: &[f64], degree: usize, order: usize, wave: Wave, to: &mut [f64]) {
    // `sum` is Σ c_q, `sum_of_sums` Σ (p + 1) Σ c_q.
    let (mut sum, mut sum_of_sums) = (0.0, 0.0);
    let top = degree - (degree + order) % 2;
    for n in (order..=top).rev().step_by(2) {
        let Some(slot) = index(n, order, wave) else { continue };
        to[slot] = 4.0 * (n + 1) as f64 * sum_of_sums;
        sum += from[slot];
        // p = n − 1.
        if n >= 1 {
            sum_of_sums += n as f64 * sum;
        }
    }
}

/// The integrals of the squares over the unit disc: π/(n + 1) for order 0, half of that for all others.
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
    fn values_alone_are_the_same() {
        let place = [0.55, -0.61];
        let wanted: Vec<f64> = jets(9, place).iter().map(|jet| jet.value).collect();
        assert_eq!(values::<{ count(9) }>(place).as_slice(), wanted);
        // Any number of them, from the first one on.
        assert_eq!(values::<8>(place).as_slice(), &wanted[..8]);
        assert_eq!(values::<0>(place), [0.0; 0]);
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

    #[test]
    fn indices_name_the_waves() {
        let (radius, angle) = (0.7_f64, 0.4_f64);
        let values = jets(5, [radius * angle.cos(), radius * angle.sin()]);
        let radial = 5.0 * radius.powi(5) - 4.0 * radius.powi(3);
        let value = |wave| values[index(5, 3, wave).unwrap()].value;
        assert!((value(Wave::Cos) - radial * (3.0 * angle).cos()).abs() < 1e-14);
        assert!((value(Wave::Sin) - radial * (3.0 * angle).sin()).abs() < 1e-14);
        assert_eq!(index(4, 0, Wave::Sin), None);
        assert_eq!(index(4, 3, Wave::Cos), None);
        assert_eq!(index(2, 4, Wave::Cos), None);
        let all = (0..=5).flat_map(|n| (0..=n).map(move |l| (n, l)));
        let mut named: Vec<usize> =
            all.flat_map(|(n, l)| [Wave::Cos, Wave::Sin].map(|wave| index(n, l, wave))).flatten().collect();
        named.sort_unstable();
        assert!(named.into_iter().eq(0..count(5)));
    }

    #[test]
    fn disc_means_agree_with_sampling() {
        // On circles about the place with the radii of a Gauss rule in the square of the radius.
        let (at, radius) = ([0.5, -0.7], 0.1);
        let rule = [(0.069_431_844, 0.173_927_42), (0.330_009_48, 0.326_072_58)];
        let radii = rule.iter().flat_map(|(x, w)| [(*x, *w), (1.0 - x, *w)]);
        let places: Vec<([f64; 2], f64)> = radii
            .flat_map(|(square, weight)| {
                (0..16).map(move |ray| {
                    let angle = std::f64::consts::TAU * f64::from(ray) / 16.0;
                    let r = radius * f64::sqrt(square);
                    ([at[0] + r * angle.cos(), at[1] + r * angle.sin()], weight / 16.0)
                })
            })
            .collect();
        let here = jets(DEGREE, at);
        for j in 0..here.len() {
            let mut coefficients = vec![0.0; here.len()];
            coefficients[j] = 1.0;
            let mean = Polynomial { coefficients }.disc_mean(radius).value(&here);
            let sampled: f64 =
                places.iter().map(|(place, weight)| weight * jets(DEGREE, *place)[j].value).sum();
            assert!((mean - sampled).abs() < 1e-7, "{j}: {mean} {sampled}");
        }
    }
}
