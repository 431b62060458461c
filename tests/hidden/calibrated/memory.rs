//! Friction and creep that are none of the program's: it fits two play operators and one relaxation time.

use crate::plan::Row;

/// Height of the loop of a full stroke, up against down, as a share of full scale: the paper's 3.1 %.
const LOOP: f64 = 0.031;
/// Play operators whose thresholds have an exponential density: their number, its scale and their spacing, as shares of full
/// scale.
const PLAYS: usize = 12;
const SCALE: f64 = 0.06;
const SPACING: f64 = 0.02;
/// Bouc and Wen's loop: the stroke that turns it, as a share of full scale; its parts β and γ, of which the sum is 1, and its
/// exponent. With n = 1 and γ = 0 it would be a Prandtl loop.
const TURN: f64 = 0.08;
const BETA: f64 = 0.6;
const GAMMA: f64 = 0.4;
const EXPONENT: f64 = 1.5;
/// Steps for each of these strokes.
const STEPS: f64 = 20.0;
/// Creep: the share of a load after 20 s, and the time from which on it goes with the logarithm.
const CREPT: f64 = 0.03;
const ONSET_S: f64 = 0.5;
/// A sample is the mean of a second that begins when the dwell is over.
const READ_S: f64 = 1.0;

/// What a pad remembers of its loads.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Memory {
    Nothing,
    /// Twelve play operators.
    Plays,
    /// Bouc and Wen's loop.
    BoucWen,
    /// Creep as the logarithm of time.
    LogCreep,
}

impl Memory {
    /// Adds what is remembered to the strains of a whole recording, row for row. `full_scale` is each channel's.
    pub(super) fn remember(self, rows: &[Row], strains: &mut [[f64; 9]], full_scale: &[f64; 9]) {
        let added: Vec<[f64; 9]> = match self {
            Self::Nothing => return,
            Self::LogCreep => crept(rows, strains),
            Self::Plays | Self::BoucWen => {
                let channels: Vec<Vec<f64>> = (0..9)
                    .map(|channel| {
                        let path: Vec<f64> = strains.iter().map(|strain| strain[channel]).collect();
                        let lag = if self == Self::Plays { played } else { turned };
                        lag(rows, &path, full_scale[channel])
                    })
                    .collect();
                (0..rows.len()).map(|row| std::array::from_fn(|channel| channels[channel][row])).collect()
            }
        };
        for (strain, added) in strains.iter_mut().flatten().zip(added.iter().flatten()) {
            *strain += added;
        }
    }
}

/// The strains that a channel goes through on its way to a row: released, then from above where it unloads.
fn way(row: &Row, strain: f64) -> impl Iterator<Item = f64> {
    let above = row.unloading.then(|| strain * row.overload());
    std::iter::once(0.0).chain(above).chain([strain])
}

/// What play operators are behind the strain. The r-th has the weight w exp(-r/scale), and a full stroke's loop is
/// 2 Σ w r high.
fn played(rows: &[Row], path: &[f64], full_scale: f64) -> Vec<f64> {
    let thresholds = std::array::from_fn::<f64, PLAYS, _>(|play| (play as f64 + 0.5) * SPACING);
    let weights = thresholds.map(|threshold| (-threshold / SCALE).exp());
    let height: f64 =
        thresholds.iter().zip(weights).map(|(threshold, weight)| 2.0 * weight * threshold).sum();
    let mut states = [0.0; PLAYS];
    let lag = |(row, strain): (&Row, &f64)| {
        for at in way(row, *strain) {
            for (state, threshold) in states.iter_mut().zip(thresholds) {
                *state = f64::clamp(*state, at - threshold * full_scale, at + threshold * full_scale);
            }
        }
        let behind = states.iter().zip(weights).map(|(state, weight)| weight * (state - strain));
        LOOP / height * behind.sum::<f64>()
    };
    rows.iter().zip(path).map(lag).collect()
}

/// Bouc and Wen: dz/dx = (1 - |z|ⁿ (β sign(dx z) + γ))/r, so z goes to 1 going up and to -1 going down.
fn turned(rows: &[Row], path: &[f64], full_scale: f64) -> Vec<f64> {
    let turn = TURN * full_scale;
    let (mut at, mut z) = (0.0_f64, 0.0_f64);
    let lag = |(row, strain): (&Row, &f64)| {
        for to in way(row, *strain) {
            let steps = (STEPS * (to - at).abs() / turn).ceil().max(1.0);
            let step = (to - at) / steps / turn;
            for _ in 0..steps as usize {
                z += step * (1.0 - z.abs().powf(EXPONENT) * (BETA * (step * z).signum() + GAMMA));
            }
            at = to;
        }
        -LOOP / 2.0 * full_scale * z
    };
    rows.iter().zip(path).map(lag).collect()
}

/// Each load and each release goes on creeping by itself, as the logarithm of its age.
fn crept(rows: &[Row], strains: &[[f64; 9]]) -> Vec<[f64; 9]> {
    let course = |age_s: f64| (1.0 + age_s / ONSET_S).ln() / (1.0 + 20.0 / ONSET_S).ln();
    let one = |now: usize| {
        let mut added = [0.0; 9];
        let at_s = rows[now].time_s + READ_S / 2.0;
        for (earlier, row) in rows[..=now].iter().enumerate().filter(|(_, row)| row.loaded()) {
            let [loaded_s, released_s] = [row.time_s - row.dwell_s, row.time_s + READ_S];
            let released = if earlier == now { 0.0 } else { course(at_s - released_s) };
            let share = CREPT * (course(at_s - loaded_s) - released);
            added.iter_mut().zip(strains[earlier]).for_each(|(added, strain)| *added += share * strain);
        }
        added
    };
    (0..rows.len()).map(one).collect()
}

/// Half of full scale, once from below and once from full scale: both branches are far from where they turned.
#[test]
fn loops_are_as_high_as_they_should_be() {
    let up = super::pad::pressed(2.5, 2.0);
    let rows = [up.clone(), Row { unloading: true, ..up }];
    for lag in [played, turned] {
        let [up, down] = lag(&rows, &[0.5, 0.5], 1.0)[..] else { panic!("a lag for each row") };
        assert!(((down - up) / LOOP - 1.0).abs() < 0.01, "{up} {down}");
    }
}

#[test]
fn a_load_has_crept_by_its_share_after_twenty_seconds() {
    let rows = [super::pad::pressed(1.0, 20.0 - READ_S / 2.0)];
    let found = crept(&rows, &[[100.0; 9]]);
    assert!((found[0][0] - 100.0 * CREPT).abs() < 1e-9, "{found:?}");
}
