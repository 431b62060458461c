//! How well a pad would locate with fewer modules or more, and with every gauge read alone.

use super::conditioning::Conditioning;
use super::precision::Precision;

/// The most modules that a study takes.
pub const MODULES_MAX: usize = 12;

/// How a module's seven gauges are read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Wiring {
    /// In three half-bridges, as in the paper: x, y, z.
    Bridges,
    /// Each alone, in a bridge with a constant resistor of its own size.
    Gauges,
}

/// A pad with so many modules at equal angles.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Ringed {
    /// Modules.
    pub modules: usize,
    /// How each is read.
    pub wiring: Wiring,
    /// Readings of all modules.
    pub readings: usize,
    /// What its Jacobian can tell.
    #[serde(flatten)]
    pub conditioning: Conditioning,
    /// Its location errors over the plate.
    #[serde(flatten)]
    pub precision: Precision,
    /// The worst location error if one module is not read, but still carries: of the module that is missed most.
    pub worst_without_one_mm: f64,
}

/// Pads that differ in the number of modules, and in how these are read.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct ModuleCounts {
    /// The force of the press that is located.
    pub press_n: [f64; 3],
    /// Standard deviation of each reading, white and independent.
    pub noise_uv: f64,
    /// How far the modules stand from the axis.
    pub centre_radius_mm: f64,
    /// The lengths in which places are told for the condition number.
    pub plate_radius_mm: f64,
    /// Two for each number of modules that was asked for, in that order: bridges, gauges.
    pub rows: Vec<Ringed>,
}

/// By what factor `modules` ideal load cells under a rigid plate locate worse than three of them.
///
/// Each carries 1/n of a press in the mean, and has the same noise ε: the location error at distance r from the axis is
/// ε √(n (a² + r²))/F for n ≥ 3 cells at radius a.
pub fn load_sharing(modules: usize) -> f64 {
    (modules as f64 / 3.0).sqrt()
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;
    use crate::layout::precision::{Press, location_error_mm};
    use tactpad_core::pad::influence::Gains;

    /// A rigid plate on `count` load cells at radius `a`: Rᵢ/F = 1/n + 2 pᵢ·(x, y)/(n a²).
    fn cells(count: usize, a: f64, sensitivity: f64, [x, y]: [f64; 2]) -> Gains<Vec<[f64; 3]>> {
        let mut gains = Gains { value: vec![], dx: vec![], dy: vec![] };
        for cell in 0..count {
            let (sin, cos) = (cell as f64 / count as f64 * TAU).sin_cos();
            let arm = 2.0 / (count as f64 * a);
            gains.value.push([0.0, 0.0, sensitivity * (1.0 / count as f64 + arm * (cos * x + sin * y))]);
            gains.dx.push([0.0, 0.0, sensitivity * arm * cos]);
            gains.dy.push([0.0, 0.0, sensitivity * arm * sin]);
        }
        gains
    }

    #[test]
    fn more_load_cells_share_the_load_and_locate_worse() {
        let press = Press { force_n: [0.0, 0.0, 0.7], noise_uv: 6.0 };
        for count in [3, 4, 5, 6, 12] {
            let found = location_error_mm(&cells(count, 20.0, 1900.0, [11.0, -5.0]), &press);
            let three = location_error_mm(&cells(3, 20.0, 1900.0, [11.0, -5.0]), &press);
            let known = 6.0 / 1900.0 / 0.7 * (count as f64 * (400.0 + 146.0)).sqrt();
            assert!((found / known - 1.0).abs() < 1e-12, "{count}: {found} for {known}");
            assert!((found / three - load_sharing(count)).abs() < 1e-12);
        }
    }

    #[test]
    fn fewer_than_three_load_cells_locate_nothing() {
        let press = Press { force_n: [0.0, 0.0, 1.0], noise_uv: 6.0 };
        for count in [1, 2] {
            let gains = cells(count, 20.0, 1900.0, [3.0, 4.0]);
            assert_eq!(location_error_mm(&gains, &press), f64::INFINITY, "{count}");
        }
    }
}
