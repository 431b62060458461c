//! Integrals over the disc: the products of Zernike's polynomials that make up the plate's stiffness.

use std::f64::consts::{PI, TAU};

use faer::{Mat, Scale};

use crate::zernike::{count, jets, norms};

/// Places and weights that integrate every polynomial up to `degree` over the unit disc.
pub fn disc_rule(degree: usize) -> Vec<([f64; 2], f64)> {
    let rays = degree + 1;
    let radial = gauss_legendre(degree / 2 + 1);
    let mut rule = Vec::with_capacity(rays * radial.len());
    for (node, weight) in radial {
        // r dr over 0 … 1 with r² = (1 + node)/2.
        let radius = f64::midpoint(1.0, node).sqrt();
        for ray in 0..rays {
            let angle = TAU * ray as f64 / rays as f64;
            rule.push(([radius * angle.cos(), radius * angle.sin()], weight / 4.0 * TAU / rays as f64));
        }
    }
    rule
}

/// Gauss's rule with `points` places on [−1, 1], by Newton's method on the Legendre polynomial.
pub fn gauss_legendre(points: usize) -> Vec<(f64, f64)> {
    let rule = |index: usize| {
        let mut x = (PI * (index as f64 + 0.75) / (points as f64 + 0.5)).cos();
        let mut slope = 1.0;
        for _ in 0..20 {
            let (value, before) = legendre_pair(points, x);
            slope = points as f64 * (x * value - before) / (x * x - 1.0);
            x -= value / slope;
        }
        (x, 2.0 / ((1.0 - x * x) * slope * slope))
    };
    (0..points).map(rule).collect()
}

/// Legendre polynomials of degree `degree` and `degree − 1`.
fn legendre_pair(degree: usize, x: f64) -> (f64, f64) {
    (1..=degree).fold((1.0, 0.0), |(value, before), n| {
        let n = n as f64;
        (((2.0 * n - 1.0) * x * value - (n - 1.0) * before) / n, value)
    })
}

/// Products of the polynomials and their derivatives, integrated over the unit disc.
#[derive(Clone, Debug)]
pub struct Grams {
    /// Highest degree.
    pub degree: usize,
    /// ∫ φᵢ φⱼ.
    pub values: Mat<f64>,
    /// ∫ φᵢ ∂ₓφⱼ and ∫ φᵢ ∂ᵧφⱼ.
    pub slopes: [Mat<f64>; 2],
    /// ∫ ∂ₐφᵢ ∂ᵦφⱼ as `[a][b]`.
    pub gradients: [[Mat<f64>; 2]; 2],
}

impl Grams {
    /// All products up to a degree, exactly.
    pub fn of(degree: usize) -> Self {
        let rule = disc_rule(2 * degree);
        let (rows, columns) = (rule.len(), count(degree));
        let mut sampled = [(); 3].map(|()| Mat::zeros(rows, columns));
        for (row, (place, weight)) in rule.iter().enumerate() {
            for (column, jet) in jets(degree, *place).into_iter().enumerate() {
                for (matrix, value) in sampled.iter_mut().zip([jet.value, jet.dx, jet.dy]) {
                    matrix[(row, column)] = weight.sqrt() * value;
                }
            }
        }
        let product = |a: usize, b: usize| sampled[a].transpose() * &sampled[b];
        Self {
            degree,
            values: product(0, 0),
            slopes: [product(0, 1), product(0, 2)],
            gradients: [[product(1, 1), product(1, 2)], [product(2, 1), product(2, 2)]],
        }
    }

    /// The matrix that takes a polynomial's coefficients to those of its mean over discs of `radius` (in units of
    /// the unit disc's radius) about each place.
    ///
    /// The mean of f over a disc of radius a is Σ (a/2)²ᵏ/(k!(k+1)!) ∇²ᵏ f, a finite sum for a polynomial.
    pub fn disc_mean(&self, radius: f64) -> Mat<f64> {
        let norms = norms(self.degree);
        let derivative =
            |axis: usize| Mat::from_fn(norms.len(), norms.len(), |i, j| self.slopes[axis][(i, j)] / norms[i]);
        let [dx, dy] = [0, 1].map(derivative);
        let laplacian = &dx * &dx + &dy * &dy;
        let mut term = Mat::<f64>::identity(norms.len(), norms.len());
        let mut mean = term.clone();
        for k in 1..=self.degree / 2 {
            let factor = radius * radius / 4.0 / (k * (k + 1)) as f64;
            term = &laplacian * &term;
            term *= Scale(factor);
            mean += &term;
        }
        mean
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const DEGREE: usize = 14;

    #[test]
    fn they_are_orthogonal_with_the_stated_norms() {
        let grams = Grams::of(DEGREE);
        let norms = norms(DEGREE);
        for (i, norm) in norms.iter().enumerate() {
            for j in 0..norms.len() {
                let wanted = if i == j { *norm } else { 0.0 };
                assert!((grams.values[(i, j)] - wanted).abs() < 1e-13, "{i} {j}");
            }
        }
    }

    #[test]
    fn disc_means_agree_with_a_rule_over_the_disc() {
        let (grams, radius, at) = (Grams::of(DEGREE), 0.1, [0.5, -0.7]);
        let mean = grams.disc_mean(radius);
        let here = jets(DEGREE, at);
        for j in 0..here.len() {
            let averaged: f64 = (0..here.len()).map(|i| here[i].value * mean[(i, j)]).sum();
            let sampled: f64 = disc_rule(DEGREE)
                .iter()
                .map(|([x, y], w)| w * jets(DEGREE, [at[0] + radius * x, at[1] + radius * y])[j].value)
                .sum();
            assert!((averaged - sampled / PI).abs() < 1e-12, "{j}: {averaged} {}", sampled / PI);
        }
    }

    #[test]
    fn gauss_integrates_powers() {
        for points in 1..12 {
            let integral =
                |power: i32| gauss_legendre(points).iter().map(|(x, w)| w * x.powi(power)).sum::<f64>();
            assert!((integral(0) - 2.0).abs() < 1e-13);
            let highest = 2 * points as i32 - 2;
            assert!((integral(highest) - 2.0 / f64::from(highest + 1)).abs() < 1e-13);
        }
    }
}
