//! A six-axis load cell, a beam with strain gauges, and a capacitive cell.
//!
//! ```text
//! load cell    yₖ = Σₐ Cₖₐ Lₐ,                          and 0.3 % of a product of loads that the model has not
//! beam         yₖ = s ∫ F (x − p)₊ dp over the gauge,   and the lever that bending takes off, which the model has not
//! capacitor    yₖ = ε A/(g − F/k − F (x aₖ + y bₖ)/c),  and its fringe, which the model has not
//! ```

use super::Hidden;
use crate::random::Random;

/// How many kinds there are.
pub(super) const KINDS: usize = 3;
/// Seconds from row to row.
const STEP_S: f64 = 20.0;

/// Loads and places of a row: x, y, Fx, Fy, Fz, Mx, My, Mz.
type Row = [f64; 8];

/// A sensor and the rows that it was measured in.
pub(super) struct Sensor {
    kind: usize,
    pub(super) channels: Vec<&'static str>,
    rows: Vec<Row>,
    temps_c: Vec<f64>,
    /// The load cell's calibration, channel by channel.
    matrix: Vec<[f64; 6]>,
}

/// What the capacitive cell's own simulation can vary: its gap in µm, and the stiffness in N/µm.
#[derive(Clone, Copy)]
struct Own {
    gap_um: f64,
    n_per_um: f64,
}

const OWN: Own = Own { gap_um: 200.0, n_per_um: 0.2 };

impl Sensor {
    pub(super) fn new(kind: usize, rows: usize, seed: u64) -> Self {
        let random = &mut Random::new(seed, "foreign sensor");
        let tenths =
            |random: &mut Random, low: f64, high: f64| (10.0 * random.between(low, high)).round() / 10.0;
        let row = |random: &mut Random| -> Row {
            match kind {
                0 => {
                    let [fx, fy] = [0; 2].map(|_| random.between(-20.0, 20.0));
                    let fz = random.between(-60.0, 5.0);
                    let [mx, my, mz] = [0; 3].map(|_| random.between(-1.0, 1.0));
                    [0.0, 0.0, fx, fy, fz, mx, my, mz]
                }
                1 => [tenths(random, 20.0, 180.0), 0.0, 0.0, 0.0, random.between(1.0, 30.0), 0.0, 0.0, 0.0],
                _ => {
                    let [x, y] = [0; 2].map(|_| tenths(random, -15.0, 15.0));
                    [x, y, 0.0, 0.0, random.between(0.2, 10.0), 0.0, 0.0, 0.0]
                }
            }
        };
        let rows: Vec<Row> = (0..rows).map(|_| row(random)).collect();
        let temps_c =
            (0..rows.len()).map(|at| 25.0 + 3.0 * (at as f64 / 40.0).sin() + 0.3 * random.normal()).collect();
        let scales = [20.0, 20.0, 10.0, 800.0, 800.0, 900.0];
        let channels = match kind {
            0 => vec!["s0_uv", "s1_uv", "s2_uv", "s3_uv", "s4_uv", "s5_uv"],
            1 => vec!["g0", "g1", "g2", "g3"],
            _ => vec!["c0_pf", "c1_pf", "c2_pf", "c3_pf"],
        };
        let matrix = channels.iter().map(|_| scales.map(|scale| scale * random.normal())).collect();
        Self { kind, channels, rows, temps_c, matrix }
    }

    /// Whether the generator has a formula of this effect.
    pub(super) fn knows(effect: &str) -> bool {
        [
            "channel_gain",
            "excitation_gain",
            "channel_crosstalk",
            "gauge_nonlinearity",
            "zero_drift",
            "thermal_zero",
            "thermal_gain",
            "reference_gain",
            "reference_zero",
            "stage_offset",
            "gap",
            "spring",
        ]
        .contains(&effect)
    }

    pub(super) fn labels(&self) -> Vec<(&'static str, Vec<f64>)> {
        let of = |at: usize| self.rows.iter().map(|row| row[at]).collect::<Vec<f64>>();
        let names: &[(&str, usize)] = match self.kind {
            0 => &[("fx_n", 2), ("fy_n", 3), ("fz_n", 4), ("mx_nm", 5), ("my_nm", 6), ("mz_nm", 7)],
            1 => &[("x_mm", 0), ("fz_n", 4)],
            _ => &[("x_mm", 0), ("y_mm", 1), ("fz_n", 4)],
        };
        let mut labels: Vec<_> = names.iter().map(|(name, at)| (*name, of(*at))).collect();
        labels.push(("t_s", (0..self.rows.len()).map(|at| STEP_S * at as f64).collect()));
        labels.push(("temp_c", self.temps_c.clone()));
        labels
    }

    /// What the handed-over model says.
    pub(super) fn predicted(&self) -> Vec<Vec<f64>> {
        self.columns(&self.rows, OWN, 0.0)
    }

    /// Largest less least reading of each channel.
    pub(super) fn ranges(&self) -> Vec<f64> {
        let range = |of: &Vec<f64>| {
            let (low, high) = of
                .iter()
                .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(*v), high.max(*v)));
            high - low
        };
        self.predicted().iter().map(range).collect()
    }

    /// By each of its own numbers, the derivatives of the channels.
    pub(super) fn derivatives(&self) -> Vec<(&'static str, Vec<Vec<f64>>)> {
        if self.kind != 2 {
            return Vec::new();
        }
        let slope = |above: Own, below: Own, width: f64| {
            let [above, below] = [above, below].map(|own| self.columns(&self.rows, own, 0.0));
            let channels = above.into_iter().zip(below);
            channels.map(|(a, b)| a.iter().zip(b).map(|(a, b)| (a - b) / width).collect()).collect()
        };
        let gap = |by: f64| Own { gap_um: OWN.gap_um + by, ..OWN };
        let spring = |by: f64| Own { n_per_um: OWN.n_per_um + by, ..OWN };
        vec![("gap", slope(gap(1.0), gap(-1.0), 2.0)), ("spring", slope(spring(2e-3), spring(-2e-3), 4e-3))]
    }

    pub(super) fn effects(&self) -> &'static str {
        if self.kind != 2 {
            return "";
        }
        "[gap]\nunit = \"um\"\nlow = -100.0\nhigh = 100.0\nprior_deviation = 5.0\nfamily = \"mechanical\"\n\
         [spring]\nunit = \"n_per_um\"\nlow = -0.15\nhigh = 0.5\nprior_deviation = 0.01\nfamily = \"mechanical\"\n"
    }

    /// What is read without noise and zeros.
    pub(super) fn truth(&self, hidden: Option<&Hidden>) -> Vec<Vec<f64>> {
        let (mut rows, mut own) = (self.rows.clone(), OWN);
        let size = hidden.map_or(0.0, |it| it.size);
        match hidden.map(|it| (it.effect.as_str(), it.parameter.as_str())) {
            // Written over true load.
            Some(("reference_gain", _)) => {
                rows.iter_mut().for_each(|row| row[2..5].iter_mut().for_each(|n| *n /= 1.0 + size));
            }
            // Written minus true load.
            Some(("reference_zero", parameter)) => {
                let at = 2 + ["fx_n", "fy_n", "fz_n"].iter().position(|name| *name == parameter).unwrap();
                rows.iter_mut().for_each(|row| row[at] -= size);
            }
            // True minus written place.
            Some(("stage_offset", parameter)) => {
                let at = usize::from(parameter == "y_mm");
                rows.iter_mut().for_each(|row| row[at] += size);
            }
            Some(("gap", _)) => own.gap_um += size,
            Some(("spring", _)) => own.n_per_um += size,
            _ => {}
        }
        let mut channels = self.columns(&rows, own, 1.0);
        let Some(Hidden { effect, target, with, .. }) = hidden else { return channels };
        let place = |name: &str| self.channels.iter().position(|channel| *channel == name);
        let hours = |row: usize| STEP_S * row as f64 / 3600.0;
        let mean_c = self.temps_c.iter().sum::<f64>() / self.temps_c.len() as f64;
        let above_c = |row: usize| self.temps_c[row] - mean_c;
        let from = with.as_deref().and_then(place).map(|from| channels[from].clone());
        let is_target = |at: usize| target == "all" || place(target) == Some(at);
        for (_, channel) in channels.iter_mut().enumerate().filter(|(at, _)| is_target(*at)) {
            let rest = self.predicted_at_rest(place(target).unwrap_or(0));
            let most = channel.iter().fold(0.0, |most: f64, value| most.max((value - rest).abs()));
            for (row, value) in channel.iter_mut().enumerate() {
                match effect.as_str() {
                    "channel_gain" | "excitation_gain" => *value *= 1.0 + size,
                    "channel_crosstalk" => *value += size * from.as_ref().unwrap()[row],
                    "gauge_nonlinearity" => *value += 0.01 * size * (*value - rest).powi(2) / most,
                    "zero_drift" => *value += size * hours(row),
                    "thermal_zero" => *value += size * above_c(row),
                    "thermal_gain" => *value *= 1.0 + size * above_c(row),
                    _ => {}
                }
            }
        }
        channels
    }

    /// What a channel reads without load.
    fn predicted_at_rest(&self, channel: usize) -> f64 {
        self.columns(&[[0.0; 8]], OWN, 0.0)[channel][0]
    }

    /// Readings at rows; `beyond` is 1 with what the handed-over model lacks.
    fn columns(&self, rows: &[Row], own: Own, beyond: f64) -> Vec<Vec<f64>> {
        let reading = |channel: usize, row: &Row| match self.kind {
            0 => self.load_cell(channel, row, beyond),
            1 => beam(channel, row, beyond),
            _ => capacitor(channel, row, own, beyond),
        };
        (0..self.channels.len())
            .map(|channel| rows.iter().map(|row| reading(channel, row)).collect())
            .collect()
    }

    fn load_cell(&self, channel: usize, row: &Row, beyond: f64) -> f64 {
        let linear: f64 = self.matrix[channel].iter().zip(&row[2..]).map(|(c, load)| c * load).sum();
        let size = self.matrix[channel].iter().map(|c| c.abs()).sum::<f64>() / 6.0;
        linear + beyond * 3e-3 * size * row[2] * row[4] / 40.0
    }
}

fn beam(channel: usize, row: &Row, beyond: f64) -> f64 {
    let (place_mm, half_mm) = ([10.0, 60.0, 110.0, 160.0][channel], 5.0);
    let [x_mm, force_n] = [row[0], row[4]];
    // Bending shortens the lever, by a part that grows with load and length.
    let x_mm = x_mm * (1.0 - beyond * 8e-4 * force_n / 30.0 * (x_mm / 180.0).powi(2));
    // Mean of (x − p)₊ over the gauge.
    let [high, low] = [x_mm - place_mm + half_mm, x_mm - place_mm - half_mm].map(|d: f64| d.max(0.0));
    0.9 * force_n * (high * high - low * low) / (4.0 * half_mm)
}

fn capacitor(channel: usize, row: &Row, Own { gap_um, n_per_um }: Own, beyond: f64) -> f64 {
    let [a, b] = [[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]][channel];
    let force_n = row[4];
    let left_um = gap_um - force_n / n_per_um - 0.02 * force_n * (row[0] * a + row[1] * b);
    // ε₀ A/g of 400 mm², in pF, with a fringe.
    3.54 / left_um * 1e3 * (1.0 + beyond * 0.005 * (left_um - gap_um) / gap_um)
}
