//! How precisely a contact can be located at best: the Cramér–Rao bound.

use std::borrow::Borrow;
use std::f64::consts::TAU;

use tactpad_core::pad::influence::Gains;

/// What is left of a vector after projection, relative to it, below which it counts as dependent on the others:
/// well above rounding, far below any difference that noise would leave.
pub(super) const DEPENDENT: f64 = 1e-10;

/// The contacts over which a bound is taken: rings this far apart, with this many places on each.
const RING_STEP_MM: f64 = 0.5;
const PLACES: usize = 120;

/// The press that is to be located, and the noise of the channels that report it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Press {
    /// Force on the plate: Fx, Fy, and Fz positive into the plate.
    pub force_n: [f64; 3],
    /// Standard deviation of each channel; white, and independent between channels.
    pub noise_uv: f64,
}

/// The bound over all places of the plate, and what it takes.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Precision {
    /// The largest error; infinite where a contact cannot be located at all.
    pub worst_mm: f64,
    /// Where it is.
    pub worst_at_mm: [f64; 2],
    /// Root of the mean square over the area.
    pub rms_mm: f64,
    /// The largest signal of any channel for the press, wherever it is: what converter and gauges must bear. Modules
    /// near the axis locate better and are loaded more.
    pub largest_uv: f64,
}

/// The smallest error with which an unbiased decoder can locate the press, if force and place are unknown.
///
/// The channels read s = G(x, y) F plus noise σ. With J = [∂G/∂x F, ∂G/∂y F, G] the covariance of x, y, Fx, Fy, Fz
/// is at least σ² (JᵀJ)⁻¹. Returned is the root of the trace of its block for x and y: the root-mean-square distance
/// between where the press is and where it seems to be. That is the Euclidean error, √2 times the error of one
/// coordinate where both are alike.
///
/// A force that no channel reads stays unknown and does not matter. The error is infinite where the place cannot
/// be told from a change of the force, without force, or if a number is not finite.
///
/// Source: C. R. Rao, "Information and the accuracy attainable in the estimation of statistical parameters", 1945;
/// with white noise on a known response, the Fisher information is JᵀJ/σ².
pub fn location_error_mm<R: AsRef<[[f64; 3]]>>(gains: &Gains<R>, press: &Press) -> f64 {
    let mut basis: Vec<Vec<f64>> = Vec::with_capacity(4);
    for axis in 0..3 {
        let column = gains.value.as_ref().iter().map(|row| row[axis]).collect();
        basis.extend(unit(independent_part(column, &basis)));
    }
    // What a small move changes that no force could. The block of the inverse is the inverse of these vectors' Gram
    // matrix [[a, b], [b, c]]; its trace is (a + c) / (ac − b²), and ac − b² = a · |part of y independent of x|².
    let along_x = independent_part(under(gains.dx.as_ref(), press.force_n), &basis);
    let along_y = independent_part(under(gains.dy.as_ref(), press.force_n), &basis);
    let (a, c) = (squared(&along_x), squared(&along_y));
    let Some(direction) = unit(along_x) else { return f64::INFINITY };
    let across = independent_part(along_y, &[direction]);
    let variance = (a + c) / (a * squared(&across));
    if variance.is_finite() { press.noise_uv * variance.sqrt() } else { f64::INFINITY }
}

/// Signals under a force; with slopes, per millimetre.
pub(super) fn under(gains: &[[f64; 3]], force_n: [f64; 3]) -> Vec<f64> {
    gains.iter().map(|row| row.iter().zip(force_n).map(|(gain, force_n)| gain * force_n).sum()).collect()
}

/// The component of a vector that is orthogonal to an orthonormal basis (Gram and Schmidt); zero if that is only rounding.
///
/// The projection is taken out twice, which leaves the rest orthogonal to rounding however small it is (W. Kahan's
/// "twice is enough", in B. N. Parlett, "The Symmetric Eigenvalue Problem", section 6.9).
fn independent_part(mut vector: Vec<f64>, basis: &[Vec<f64>]) -> Vec<f64> {
    let whole = squared(&vector);
    for direction in basis.iter().chain(basis) {
        let along: f64 = vector.iter().zip(direction).map(|(r, d)| r * d).sum();
        vector.iter_mut().zip(direction).for_each(|(r, d)| *r -= along * d);
    }
    if squared(&vector) <= DEPENDENT * DEPENDENT * whole {
        vector.fill(0.0);
    }
    vector
}

/// The vector's direction; none for the zero vector.
fn unit(mut vector: Vec<f64>) -> Option<Vec<f64>> {
    let length = squared(&vector).sqrt();
    vector.iter_mut().for_each(|component| *component /= length);
    (length > 0.0).then_some(vector)
}

fn squared(vector: &[f64]) -> f64 {
    vector.iter().map(|component| component * component).sum()
}

/// A place of the plate that stands for an area around it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AreaPlace {
    /// Where it is.
    pub at_mm: [f64; 2],
    /// Its share of the area, relative to the others'.
    pub weight: f64,
}

/// The contacts within `contact_radius_mm` of the pad's axis over which a bound is taken.
///
/// The places stand on rings half a millimetre apart, 3° apart on each. On the nominal pad no place between them is
/// worse by 1 %.
pub fn places(contact_radius_mm: f64) -> impl Iterator<Item = AreaPlace> {
    let rings = (contact_radius_mm / RING_STEP_MM).ceil().max(1.0) as usize;
    (0..=rings).flat_map(move |ring| {
        let radius = contact_radius_mm * ring as f64 / rings as f64;
        // The trapezoidal rule along the radius: a ring's area is as its radius, the last one has half of it.
        let weight = if ring == rings { 0.5 * radius } else { radius };
        (0..PLACES).map(move |place| {
            let (sin, cos) = (place as f64 / PLACES as f64 * TAU).sin_cos();
            AreaPlace { at_mm: [radius * cos, radius * sin], weight }
        })
    })
}

/// The bound over contacts within `contact_radius_mm` of the pad's axis.
pub fn over_plate(field: impl Fn(f64, f64) -> Gains, press: &Press, contact_radius_mm: f64) -> Precision {
    let read = |place: AreaPlace| (place, field(place.at_mm[0], place.at_mm[1]));
    Precision::over(places(contact_radius_mm).map(read), press)
}

impl Precision {
    /// The bound over [`places`] whose gains are known.
    pub fn over<R: AsRef<[[f64; 3]]>>(
        contacts: impl Iterator<Item = (AreaPlace, impl Borrow<Gains<R>>)>,
        press: &Press,
    ) -> Self {
        let mut found = Self { worst_mm: 0.0, worst_at_mm: [0.0; 2], rms_mm: 0.0, largest_uv: 0.0 };
        let (mut weighted, mut weights) = (0.0, 0.0);
        for (AreaPlace { at_mm, weight }, gains) in contacts {
            let error_mm = found.take(at_mm, gains.borrow(), press);
            weights += weight;
            // The centre has no area; an infinite error there must not make the sum undefined.
            weighted += if weight > 0.0 { weight * error_mm * error_mm } else { 0.0 };
        }
        found.rms_mm = (weighted / weights).sqrt();
        found
    }

    /// Takes one place into account; returns the error there.
    fn take<R: AsRef<[[f64; 3]]>>(&mut self, at_mm: [f64; 2], gains: &Gains<R>, press: &Press) -> f64 {
        let signals = under(gains.value.as_ref(), press.force_n);
        self.largest_uv = signals.iter().fold(self.largest_uv, |largest, signal| largest.max(signal.abs()));
        let error_mm = location_error_mm(gains, press);
        if error_mm > self.worst_mm {
            (self.worst_mm, self.worst_at_mm) = (error_mm, at_mm);
        }
        error_mm
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use tactpad_core::pad::field::PadField;

    const PRESS: Press = Press { force_n: [0.0, 0.0, 1.0], noise_uv: 6.0 };

    /// Places of three modules at radius `a`.
    fn sites(a: f64) -> [[f64; 2]; 3] {
        [0.0, 1.0, 2.0].map(|k| {
            let (sin, cos) = (k * TAU / 3.0).sin_cos();
            [a * cos, a * sin]
        })
    }

    /// A rigid plate on three load cells that read only the normal force, `sensitivity` µV/N each.
    pub(crate) fn load_cells(a: f64, sensitivity: f64) -> impl Fn(f64, f64) -> Gains {
        move |x, y| {
            let mut gains = Gains { value: [[0.0; 3]; 9], dx: [[0.0; 3]; 9], dy: [[0.0; 3]; 9] };
            for (cell, [px, py]) in sites(a).into_iter().enumerate() {
                let arm = 2.0 / (3.0 * a * a);
                let channel = 3 * cell + 2;
                gains.value[channel][2] = sensitivity * (1.0 / 3.0 + arm * (px * x + py * y));
                gains.dx[channel][2] = sensitivity * arm * px;
                gains.dy[channel][2] = sensitivity * arm * py;
            }
            gains
        }
    }

    /// x = Σ pR / F: with noise ε on each force, δx = Σ (p − x) ε / F, so the mean square of the distance is
    /// ε² Σ |p − x|² / F² = 3 ε² (a² + r²) / F².
    pub(crate) fn load_cell_error_mm(a: f64, r: f64, noise_n: f64, force_n: f64) -> f64 {
        noise_n / force_n * (3.0 * (a * a + r * r)).sqrt()
    }

    #[test]
    fn three_load_cells_have_the_closed_form() {
        for (a, x, y, force_n) in [(20.0, 0.0, 0.0, 1.0), (20.0, 12.0, -7.0, 0.3), (5.0, -28.0, 3.0, 5.0)] {
            let press = Press { force_n: [0.4, -0.2, force_n], noise_uv: 6.0 };
            let found = location_error_mm(&load_cells(a, 1900.0)(x, y), &press);
            let wanted = load_cell_error_mm(a, x.hypot(y), 6.0 / 1900.0, force_n);
            assert!((found / wanted - 1.0).abs() < 1e-12, "{found} for {wanted}");
        }
    }

    #[test]
    fn over_the_plate_the_load_cells_integrate_in_closed_form() {
        let found = over_plate(load_cells(20.0, 1900.0), &PRESS, 29.0);
        let noise_n = 6.0 / 1900.0;
        let rim = load_cell_error_mm(20.0, 29.0, noise_n, 1.0);
        assert!((found.worst_mm / rim - 1.0).abs() < 1e-12, "{found:?}");
        assert!((found.worst_at_mm[0].hypot(found.worst_at_mm[1]) - 29.0).abs() < 1e-12);
        // The mean of r² over a disc is half of its radius squared; the trapezoidal rule comes within 10⁻⁴.
        let rms = load_cell_error_mm(20.0, 29.0 / 2.0_f64.sqrt(), noise_n, 1.0);
        assert!((found.rms_mm / rms - 1.0).abs() < 1e-3, "{found:?} for {rms}");
        // A press at the rim beyond a cell loads it with 1/3 + 2·29/(3·20) of its force.
        assert!((found.largest_uv - 1900.0 * (1.0 / 3.0 + 29.0 / 30.0)).abs() < 1e-9, "{found:?}");
    }

    #[test]
    fn a_place_that_cannot_be_located_is_the_worst() {
        // At the centre all slopes vanish; the centre has no area, so the rms stays finite.
        let blind = |x: f64, y: f64| {
            let mut gains = load_cells(20.0, 1900.0)(x, y);
            let scale = x.hypot(y).min(1.0);
            gains.dx = gains.dx.map(|row| row.map(|slope| slope * scale));
            gains
        };
        let found = over_plate(blind, &PRESS, 29.0);
        assert_eq!((found.worst_mm, found.worst_at_mm), (f64::INFINITY, [0.0, 0.0]));
        assert!(found.rms_mm.is_finite() && found.rms_mm > 0.0);
    }

    /// The nominal pad's field.
    fn nominal() -> impl Fn(f64, f64) -> Gains {
        let field = PadField::nominal().signals;
        move |x, y| field.gains(x as f32, y as f32)
    }

    /// Solves A x = b by elimination with pivots; A is a matrix of 5 × 5.
    fn solved(mut a: [[f64; 5]; 5], mut b: [f64; 5]) -> [f64; 5] {
        for k in 0..5 {
            let pivot = (k..5).max_by(|&i, &j| a[i][k].abs().total_cmp(&a[j][k].abs())).unwrap();
            a.swap(k, pivot);
            b.swap(k, pivot);
            for row in k + 1..5 {
                let factor = a[row][k] / a[k][k];
                let pivot_row = a[k];
                for (value, pivot) in a[row].iter_mut().zip(pivot_row) {
                    *value -= factor * pivot;
                }
                b[row] -= factor * b[k];
            }
        }
        for k in (0..5).rev() {
            b[k] = (b[k] - (k + 1..5).map(|column| a[k][column] * b[column]).sum::<f64>()) / a[k][k];
        }
        b
    }

    /// Columns ∂s/∂(x, y, Fx, Fy, Fz) at a state x, y, Fx, Fy, Fz.
    fn jacobian(gains: &Gains, state: [f64; 5]) -> [[f64; 5]; 9] {
        let force = [state[2], state[3], state[4]];
        let (dx, dy) = (under(&gains.dx, force), under(&gains.dy, force));
        std::array::from_fn(|c| [dx[c], dy[c], gains.value[c][0], gains.value[c][1], gains.value[c][2]])
    }

    fn normal_matrix(jacobian: &[[f64; 5]; 9]) -> [[f64; 5]; 5] {
        std::array::from_fn(|i| std::array::from_fn(|j| jacobian.iter().map(|row| row[i] * row[j]).sum()))
    }

    #[test]
    fn it_is_the_inverse_of_the_whole_information_matrix() {
        let field = nominal();
        for (x, y) in [(0.3, 0.1), (10.0, 4.0), (-25.0, 9.0), (20.0, 0.0), (-14.0, -24.0)] {
            let (gains, press) = (field(x, y), Press { force_n: [0.2, -0.1, 1.0], noise_uv: 6.0 });
            let information = normal_matrix(&jacobian(&gains, [x, y, 0.2, -0.1, 1.0]));
            let variance = |k: usize| solved(information, std::array::from_fn(|i| f64::from(i == k)))[k];
            let wanted = 6.0 * (variance(0) + variance(1)).sqrt();
            let found = location_error_mm(&gains, &press);
            assert!((found / wanted - 1.0).abs() < 1e-6, "{found} for {wanted} at {x}, {y}");
        }
    }

    /// A smooth, curved response in closed form: nine bumps at different places with different signs.
    fn bumps(x: f64, y: f64) -> Gains {
        let mut gains = Gains { value: [[0.0; 3]; 9], dx: [[0.0; 3]; 9], dy: [[0.0; 3]; 9] };
        for channel in 0..9 {
            for axis in 0..3 {
                let phase = 1.7 * channel as f64 + 2.3 * axis as f64;
                let (px, py) = (15.0 * phase.cos(), 15.0 * (1.3 * phase).sin());
                let height =
                    900.0 * (0.5 + phase.sin()) * (-((x - px).powi(2) + (y - py).powi(2)) / 800.0).exp();
                gains.value[channel][axis] = height;
                gains.dx[channel][axis] = -height * (x - px) / 400.0;
                gains.dy[channel][axis] = -height * (y - py) / 400.0;
            }
        }
        gains
    }

    /// Gauss and Newton's least squares from the truth on, ten steps.
    fn fitted(signals: &[f64], truth: [f64; 5]) -> [f64; 5] {
        let mut state = truth;
        for _ in 0..10 {
            let gains = bumps(state[0], state[1]);
            let jacobian = jacobian(&gains, state);
            let model = under(&gains.value, [state[2], state[3], state[4]]);
            let gradient = std::array::from_fn(|k| {
                jacobian.iter().enumerate().map(|(c, row)| row[k] * (signals[c] - model[c])).sum()
            });
            let step = solved(normal_matrix(&jacobian), gradient);
            state = std::array::from_fn(|k| state[k] + step[k]);
        }
        state
    }

    #[test]
    fn least_squares_over_many_noisy_presses_attains_it() {
        const TRIALS: usize = 20_000;
        let (truth, press) =
            ([6.0, -9.0, 0.5, -0.3, 2.0], Press { force_n: [0.5, -0.3, 2.0], noise_uv: 6.0 });
        let gains = bumps(truth[0], truth[1]);
        let clean = under(&gains.value, press.force_n);
        let mut state = 1_u64;
        // The multiplier is Knuth's (MMIX); the sum of twelve uniform numbers has variance 1.
        let mut uniform = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 53) as f64
        };
        let mut sum = 0.0;
        for _ in 0..TRIALS {
            let noise = |s: &f64| s + 6.0 * ((0..12).map(|_| uniform()).sum::<f64>() - 6.0);
            let signals: Vec<f64> = clean.iter().map(noise).collect();
            let found = fitted(&signals, truth);
            sum += (found[0] - truth[0]).powi(2) + (found[1] - truth[1]).powi(2);
        }
        let (measured, bound) = ((sum / TRIALS as f64).sqrt(), location_error_mm(&gains, &press));
        // 20,000 trials scatter by 0.5 %; the curvature of the response adds less than that at this noise.
        assert!((measured / bound - 1.0).abs() < 0.02, "{measured} for {bound}");
    }

    #[test]
    fn no_place_between_the_grids_is_worse() {
        // The table's contacts end at 29 mm; a quarter of a millimetre is for the slopes.
        let (field, radius) = (nominal(), 28.5);
        let worst = over_plate(&field, &PRESS, radius).worst_mm;
        for step in 0..20_000 {
            // The golden section spreads the places evenly over the area.
            let (share, turns) =
                ((f64::from(step) + 0.5) / 20_000.0, f64::from(step) * 0.618_033_988_749_895);
            let (sin, cos) = (turns * TAU).sin_cos();
            let (x, y) = (radius * share.sqrt() * cos, radius * share.sqrt() * sin);
            let error = location_error_mm(&field(x, y), &PRESS);
            assert!(error < 1.01 * worst, "{error} at {x}, {y}, worst {worst}");
        }
    }

    #[test]
    fn the_error_is_as_noise_over_force() {
        let gains = nominal()(7.0, -3.0);
        let one = location_error_mm(&gains, &PRESS);
        let louder = location_error_mm(&gains, &Press { noise_uv: 18.0, ..PRESS });
        let lighter = location_error_mm(&gains, &Press { force_n: [0.0, 0.0, 0.5], ..PRESS });
        assert!((louder / one - 3.0).abs() < 1e-12 && (lighter / one - 2.0).abs() < 1e-12);
        assert!(one > 0.005 && one < 1.0, "{one}");
    }

    #[test]
    fn what_cannot_be_located_has_an_infinite_error() {
        let cells = load_cells(20.0, 1900.0)(3.0, 4.0);
        let error = |gains: &Gains, force_n| location_error_mm(gains, &Press { force_n, noise_uv: 6.0 });
        assert_eq!(error(&cells, [0.0; 3]), f64::INFINITY, "no force");
        assert_eq!(error(&cells, [1.0, 1.0, 0.0]), f64::INFINITY, "forces that no cell reads");
        assert_eq!(error(&cells, [0.0, 0.0, f64::NAN]), f64::INFINITY);
        let mut two = cells;
        (two.value[2], two.dx[2], two.dy[2]) = ([0.0; 3], [0.0; 3], [0.0; 3]);
        assert_eq!(error(&two, [0.0, 0.0, 1.0]), f64::INFINITY, "a cell is missing");
        let even = Gains { value: cells.value, dx: cells.value, dy: cells.dy };
        assert_eq!(error(&even, [0.0, 0.0, 1.0]), f64::INFINITY, "a move looks like more force");
    }
}
