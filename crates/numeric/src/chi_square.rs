//! The chi-square distribution with whole degrees of freedom, central and not.
//!
//! Source: M. Abramowitz, I. A. Stegun, Handbook of Mathematical Functions (1964), 26.4.

use std::f64::consts::PI;

/// From so many degrees of freedom on the terms of the sum are too small for a number: the cube root of the square is then normal to
/// a ten-thousandth (26.4.14).
const MANY: usize = 1000;
/// Terms of the mixture beyond its mean, in standard deviations: what is left out is below 1e-12.
const TAIL_DEVIATIONS: f64 = 8.0;

/// Q(x | d): the probability that a sum of `freedom` squared standard normal numbers exceeds `square`. 1 for a negative
/// square and for one that is not a number; 0 without freedom.
pub fn exceeded(square: f64, freedom: usize) -> f64 {
    if freedom == 0 {
        return if square > 0.0 { 0.0 } else { 1.0 };
    }
    if square.is_nan() || square <= 0.0 {
        return 1.0;
    }
    if freedom > MANY {
        return exceeded_of_many(square, freedom);
    }
    let half = 0.5 * square;
    // Q(x|1) = erfc √(x/2), Q(x|2) = exp(−x/2), Q(x|d + 2) = Q(x|d) + (x/2)^(d/2) exp(−x/2)/Γ(d/2 + 1). (26.4.4 – 26.4.8)
    let exponential = libm::exp(-half);
    let (mut sum, mut term, mut d) = if freedom % 2 == 1 {
        (libm::erfc(libm::sqrt(half)), libm::sqrt(half) * exponential / (0.5 * libm::sqrt(PI)), 1)
    } else {
        (exponential, half * exponential, 2)
    };
    while d < freedom {
        sum += term;
        d += 2;
        term *= half / (0.5 * d as f64);
    }
    sum
}

/// Q(x | d) ≈ Q(z) of a standard normal number, z = ((x/d)^⅓ − (1 − 2/(9d)))/√(2/(9d)).
fn exceeded_of_many(square: f64, freedom: usize) -> f64 {
    let (d, variance) = (freedom as f64, 2.0 / (9.0 * freedom as f64));
    let z = (libm::cbrt(square / d) - (1.0 - variance)) / libm::sqrt(variance);
    0.5 * libm::erfc(z / libm::sqrt(2.0))
}

/// The square that is exceeded with this probability; 4,096 at most.
pub fn quantile(probability: f64, freedom: usize) -> f64 {
    bisected(|square| exceeded(square, freedom) > probability)
}

/// The noncentrality at which a square with `freedom` exceeds `threshold` with this probability; 0 where chance alone does, and 4,096 at most.
pub fn noncentrality(threshold: f64, freedom: usize, power: f64) -> f64 {
    bisected(|noncentrality| exceeded_off_centre(threshold, freedom, noncentrality) < power)
}

/// Q(x | d, λ): the same where the normal numbers have means whose squares add up to `noncentrality`.
fn exceeded_off_centre(square: f64, freedom: usize, noncentrality: f64) -> f64 {
    // Σⱼ exp(−λ/2) (λ/2)ʲ/j! Q(x|d + 2j). (26.4.25)
    let mean = 0.5 * noncentrality;
    let reach = TAIL_DEVIATIONS * libm::sqrt(mean) + 2.0 * TAIL_DEVIATIONS;
    let first = (mean - reach).max(0.0) as usize;
    let log_weight = |j: f64| {
        let power = if j == 0.0 { 0.0 } else { j * libm::log(mean.max(f64::MIN_POSITIVE)) };
        power - mean - libm::lgamma(j + 1.0)
    };
    (first..=(mean + reach) as usize)
        .map(|j| libm::exp(log_weight(j as f64)) * exceeded(square, freedom + 2 * j))
        .sum()
}

/// The largest number, up to 4,096, for which a condition that holds below it holds.
fn bisected(holds: impl Fn(f64) -> bool) -> f64 {
    let (mut low, mut high) = (0.0, 4096.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if holds(middle) { low = middle } else { high = middle }
    }
    low
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn many_degrees_of_freedom_go_on_from_few() {
        for square in [900.0, 1000.0, 1050.0, 1150.0] {
            let (exact, near) = (exceeded(square, MANY), exceeded_of_many(square, MANY));
            assert!((exact - near).abs() < 1e-4, "{square}: {exact} {near}");
        }
        assert!((exceeded(2000.0, 2000) - 0.4958).abs() < 1e-3);
        assert!(exceeded(2400.0, 2000) < 1e-8);
    }

    #[test]
    fn tables_are_met() {
        // Abramowitz and Stegun, table 26.8.
        for (freedom, probability, square) in [
            (1, 0.05, 3.841_46),
            (2, 0.01, 9.210_34),
            (3, 0.001, 16.2662),
            (5, 0.5, 4.351_46),
            (10, 0.9, 4.865_18),
        ] {
            assert!((quantile(probability, freedom) - square).abs() < 1e-4, "{freedom} {probability}");
            assert!((exceeded(square, freedom) / probability - 1.0).abs() < 1e-4, "{freedom} {probability}");
        }
        assert_eq!((exceeded(-1.0, 3), exceeded(f64::NAN, 3), exceeded(1.0, 0)), (1.0, 1.0, 0.0));
    }

    #[test]
    fn the_power_of_one_degree_is_that_of_a_shifted_normal_number() {
        // A normal number of mean m exceeds z with Φ(m − z): 0.9 at m = z + 1.28155, the other side being far away.
        let (z, m) = (3.0, 3.0 + 1.281_552);
        assert!((noncentrality(z * z, 1, 0.9) / (m * m) - 1.0).abs() < 1e-5);
        assert!((exceeded_off_centre(7.0, 3, 0.0) / exceeded(7.0, 3) - 1.0).abs() < 1e-12);
        assert!((exceeded_off_centre(900.0, 2, 900.0) - 0.5).abs() < 0.03, "its mean is d + λ");
        assert_eq!(noncentrality(1e-9, 2, 0.5), 0.0);
    }
}
