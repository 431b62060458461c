//! Which figures the table shows, and what the paper published of them.

use super::Needs;
use super::figures::Figures;
use super::resolution::Resolution;
use super::table3::NETWORK_SIMULATED;

/// Largest deviation from a published figure that counts as met.
const BOUND_PERCENT: f64 = 15.0;

/// The same for the network of the paper's Table 3.
const NETWORK_BOUND_PERCENT: f64 = 20.0;

/// One line of the table.
#[derive(Clone, Copy)]
pub struct Line {
    /// Its name in JSON and in conflicts.
    pub key: &'static str,
    /// The label in the table.
    pub name: &'static str,
    /// Unit of the value.
    pub unit: &'static str,
    /// The paper's value, and its tolerance.
    pub published: Option<Published>,
    /// The value in the line's unit.
    pub value: fn(&Figures) -> Result<f64, Needs>,
}

/// A figure of the paper.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Published {
    /// In the line's unit.
    pub value: f64,
    /// Largest deviation that is inside.
    pub bound_percent: f64,
    /// Whether another published figure may stand in its way.
    pub openness: Openness,
}

/// Whether a line may be given up for others.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Openness {
    /// It must be met.
    Firm,
    /// It may be shown to be in conflict with others.
    MayConflict,
}

/// The lines in the order of the issue: published ones, then the others.
pub const LINES: &[Line] = &[
    firm("fem_z", "FEM against pad, 1 N: z channels", "%", 11.0, |f| of(&f.fem, |fem| 100.0 * fem.z_share)),
    firm("fem_xy", "FEM against pad, 1 N: x, y channels", "%", 32.0, |f| {
        of(&f.fem, |fem| 100.0 * fem.xy_share)
    }),
    firm("thermal_drift", "thermal drift per 10 °C", "µV", 300.0, |f| {
        of(&f.thermal_drift, |d| d.uv_per_10_c)
    }),
    contestable("decoded_drift_fx", "drift decoded per 10 °C: Fx", "N", 0.117, |f| {
        of(&f.decoded_drift, |d| d.force_n[0])
    }),
    contestable("decoded_drift_fy", "drift decoded per 10 °C: Fy", "N", 0.102, |f| {
        of(&f.decoded_drift, |d| d.force_n[1])
    }),
    contestable("decoded_drift_fz", "drift decoded per 10 °C: Fz", "N", 0.191, |f| {
        of(&f.decoded_drift, |d| d.force_n[2])
    }),
    contestable("decoded_drift_place", "drift decoded per 10 °C: place", "mm", 0.13, |f| {
        of(&f.decoded_drift, |d| d.place_mm)
    }),
    contestable("spread_0.5", "spread of location at 0.5 N", "mm", 1.32, |f| {
        of(&f.location_spread, |s| s[0].spread_mm)
    }),
    contestable("spread_1", "spread of location at 1 N", "mm", 1.06, |f| {
        of(&f.location_spread, |s| s[1].spread_mm)
    }),
    contestable("spread_3", "spread of location at 3 N", "mm", 0.82, |f| {
        of(&f.location_spread, |s| s[2].spread_mm)
    }),
    contestable("spread_5", "spread of location at 5 N", "mm", 0.87, |f| {
        of(&f.location_spread, |s| s[3].spread_mm)
    }),
    firm("repeatability", "repeatability, of 5 N", "%", 1.3, |f| of(&f.repeatability, |r| 100.0 * r.share)),
    firm("hysteresis", "hysteresis, of 5 N", "%", 3.1, |f| of(&f.hysteresis, |h| 100.0 * h.share)),
    contestable("resolution", "force resolution, 1 s means", "mN", 5.0, |f| {
        let step_n = |found: &Resolution| found.unloaded_step_n.ok_or(Needs::Rows(UNLOADED));
        Ok(1e3 * f.resolution.as_ref().map_err(|needs| *needs).and_then(step_n)?)
    }),
    firm("ageing", "change after 50,000 cycles of 1 N", "%", 19.0, |f| {
        of(&f.ageing, |a| 100.0 * a.change_share.abs())
    }),
    network(
        "simulation_place",
        "network on simulation alone: distance",
        "mm",
        NETWORK_SIMULATED.position_mae_mm,
        |f| of(&f.simulation_only, |e| e.place_distance_mm),
    ),
    network(
        "simulation_force",
        "network on simulation alone: force",
        "N",
        NETWORK_SIMULATED.force_mae_n,
        |f| of(&f.simulation_only, |e| e.force_mae_n),
    ),
    other("simulation_axis", "network on simulation alone: x, y", "mm", |f| {
        of(&f.simulation_only, |e| e.place_mae_mm)
    }),
    other("rmse_fx", "RMSE of Fx", "N", |f| of(&f.decoded, |e| e.force_rmse_n[0])),
    other("rmse_fy", "RMSE of Fy", "N", |f| of(&f.decoded, |e| e.force_rmse_n[1])),
    other("rmse_fz", "RMSE of Fz", "N", |f| of(&f.decoded, |e| e.force_rmse_n[2])),
    other("rmse_resultant", "RMSE of the resultant force", "N", |f| of(&f.decoded, |e| e.resultant_rmse_n)),
    other("thermal_nonlinearity", "thermal drift: off its line", "%", |f| {
        of(&f.thermal_drift, |d| 100.0 * d.nonlinearity_share)
    }),
    other("resolution_loaded", "force resolution under a held load", "mN", |f| {
        of(&f.resolution, |r| 1e3 * r.step_n)
    }),
    other("resolution_without_drift", "the same, drift removed", "mN", |f| {
        of(&f.resolution, |r| 1e3 * r.without_drift_n)
    }),
    other("sensitivity_z", "sensitivity, z channels, mean of all places", "µV/N", |f| {
        of(&f.sensitivity, |s| s.z_uv_per_n)
    }),
    other("sensitivity_xy", "sensitivity, x, y channels, mean of all places", "µV/N", |f| {
        of(&f.sensitivity, |s| s.xy_uv_per_n)
    }),
    other("step_delay", "step response: delay", "ms", |f| of(&f.step_response, |s| s.delay_ms)),
    other("step_rise", "step response: 10–90 % rise", "ms", |f| of(&f.step_response, |s| s.rise_ms)),
    other("bandwidth", "bandwidth of the stream, −3 dB", "Hz", |f| {
        of(&f.step_response, |s| s.bandwidth_hz)
    }),
    other("holding_error_1", "force held, 1 N: mean error", "mN", |f| {
        of(&f.force_holding, |h| 1e3 * h[0].mean_error_n)
    }),
    other("holding_error_3", "force held, 3 N: mean error", "mN", |f| {
        of(&f.force_holding, |h| 1e3 * h[1].mean_error_n)
    }),
    other("holding_spread_1", "force held, 1 N: standard deviation", "mN", |f| {
        of(&f.force_holding, |h| 1e3 * h[0].deviation_n)
    }),
    other("holding_spread_3", "force held, 3 N: standard deviation", "mN", |f| {
        of(&f.force_holding, |h| 1e3 * h[1].deviation_n)
    }),
    other("holding_spread_5", "force held, 5 N: standard deviation", "mN", |f| {
        of(&f.force_holding, |h| 1e3 * h[2].deviation_n)
    }),
];

const UNLOADED: &str = "a trial without load for 30 s or longer";

type Value = fn(&Figures) -> Result<f64, Needs>;

const fn published(value: f64, bound_percent: f64, openness: Openness) -> Option<Published> {
    Some(Published { value, bound_percent, openness })
}

const fn firm(key: &'static str, name: &'static str, unit: &'static str, paper: f64, value: Value) -> Line {
    Line { key, name, unit, published: published(paper, BOUND_PERCENT, Openness::Firm), value }
}

const fn contestable(
    key: &'static str,
    name: &'static str,
    unit: &'static str,
    paper: f64,
    value: Value,
) -> Line {
    Line { key, name, unit, published: published(paper, BOUND_PERCENT, Openness::MayConflict), value }
}

const fn network(
    key: &'static str,
    name: &'static str,
    unit: &'static str,
    paper: f64,
    value: Value,
) -> Line {
    Line { key, name, unit, published: published(paper, NETWORK_BOUND_PERCENT, Openness::MayConflict), value }
}

const fn other(key: &'static str, name: &'static str, unit: &'static str, value: Value) -> Line {
    Line { key, name, unit, published: None, value }
}

fn of<T>(found: &Result<T, Needs>, value: impl Fn(&T) -> f64) -> Result<f64, Needs> {
    found.as_ref().map(value).map_err(|needs| *needs)
}

impl Published {
    /// Deviation of a value from the published one, as a share of that.
    pub fn difference_percent(&self, value: f64) -> f64 {
        100.0 * (value / self.value - 1.0)
    }

    /// Whether a value is near enough.
    pub fn holds(&self, value: f64) -> bool {
        self.difference_percent(value).abs() <= self.bound_percent
    }
}
