//! Readings that stop at a limit of the converter.
//!
//! Many rows read the extreme value to the last digit. By the rows just inside, of which m lie over a width D, λ = m q/D of them
//! would fall into a cell as wide as the converter's step q; that c do has at most the probability exp(c − λ − c ln(c/λ))
//! (Chernoff's bound of Poisson's law). And they should have been larger: by the model, or by what the other channels read.

use super::steps::least_gap;
use crate::diagnosis::data::target::Target;
use crate::diagnosis::gatekeepers::gate::{Gate, LEVEL};
use crate::diagnosis::gatekeepers::prediction::Fitted;
use crate::diagnosis::report::Estimate;
use crate::effect::Effect;
use tactpad_core::counted::counted;
use tactpad_numeric::statistics::{mean, population_deviation};

/// Fewest rows at a limit.
const ROWS_MIN: usize = 3;
/// The density just inside is that of so many rows, or as many as there are at the limit.
const INSIDE: usize = 20;
/// Density may rise towards a maximum that is none of the converter's.
const RISE: f64 = 4.0;

/// Readings that stop at a limit.
struct Rail {
    limit: f64,
    rows: Vec<usize>,
    p_value: f64,
    /// By how much they should have been larger, in the mean.
    missing: Option<f64>,
}

pub(crate) fn check(gate: &mut Gate) {
    for channel in 0..gate.channels() {
        let rails: Vec<Rail> = [1.0, -1.0].iter().filter_map(|side| rail(gate, channel, *side)).collect();
        let Some(fullest) = rails.iter().max_by_key(|rail| rail.rows.len()) else { continue };
        let half = 0.5 * least_gap(&gate.readings(channel, &gate.told(channel))).unwrap_or(0.0);
        let limit = fullest.limit.abs();
        let estimate = Estimate { name: "limit_uv", value: limit, interval95: [limit - half, limit + half] };
        let p_value = fullest.p_value;
        let share = gate.mended(|gate| rails.iter().for_each(|rail| gate.mask(channel, &rail.rows)));
        gate.find(Effect::AdcClipping, Target::Channel(channel), p_value, share).parameters = vec![estimate];
        for rail in rails {
            let larger = rail
                .missing
                .map(|it| format!(", where {it:.4} more was due in the mean"))
                .unwrap_or_default();
            let detail = format!(
                "{} stops at {} in {}{larger}; these have no weight; press less, or take a smaller gain",
                gate.name(channel),
                rail.limit,
                counted(rail.rows.len(), "row")
            );
            gate.notice("clipping", Some(channel), detail);
        }
    }
}

/// The limit above (`side` 1) or below (−1).
fn rail(gate: &Gate, channel: usize, side: f64) -> Option<Rail> {
    let told = gate.told(channel);
    let mut values: Vec<f64> = gate.readings(channel, &told).iter().map(|y| side * y).collect();
    values.sort_by(|one, other| other.total_cmp(one));
    let extreme = *values.first()?;
    let count = values.iter().take_while(|value| **value == extreme).count();
    let inside = &values[count..];
    if count < ROWS_MIN || inside.len() < ROWS_MIN {
        return None;
    }
    let near = inside.len().min(count.max(INSIDE));
    let width = extreme - inside[near - 1];
    let rate = RISE * near as f64 * (least_gap(&values)? / width).min(1.0);
    let count = count as f64;
    let p_value = if count > rate { (count - rate - count * (count / rate).ln()).exp() } else { 1.0 };
    let limit = side * extreme;
    let (rows, others): (Vec<usize>, Vec<usize>) =
        told.into_iter().partition(|row| gate.observations.readings[channel][*row] == limit);
    let missing = missing(gate, channel, &rows, &others).map(|[by, sure]| [side * by, sure]);
    let is_due = missing.is_none_or(|[by, sure]| by > sure);
    let is_rail = p_value * 2.0 * (gate.channels() as f64) < LEVEL && is_due;
    is_rail.then(|| Rail {
        limit,
        rows,
        p_value: p_value.max(f64::MIN_POSITIVE),
        missing: missing.map(|it| it[0].abs()),
    })
}

/// By how much the rows at a limit should have been larger in the mean, and the threshold from which that is no chance: four
/// standard errors of what the rows inside miss their prediction by.
fn missing(gate: &Gate, channel: usize, rows: &[usize], others: &[usize]) -> Option<[f64; 2]> {
    let load = |axis: usize, rows: &[usize]| -> Vec<f64> {
        rows.iter().map(|row| gate.observations.samples[*row].load[axis]).collect()
    };
    let regressors = |rows: &[usize]| -> Vec<Vec<f64>> {
        let others = (0..gate.channels()).filter(|it| *it != channel).map(|it| gate.readings(it, rows));
        let own = gate.expected(channel, rows).map(|own| vec![own]);
        own.unwrap_or_else(|| others.chain((0..3).map(|axis| load(axis, rows))).collect())
    };
    let (inside, at) = (regressors(others), regressors(rows));
    let fitted = Fitted::of(&gate.readings(channel, others), &inside)?;
    let over = |rows: &[usize], regressors: &[Vec<f64>]| -> Vec<f64> {
        let readings = gate.readings(channel, rows);
        (0..rows.len()).map(|row| fitted.predicted(regressors, row) - readings[row]).collect()
    };
    let scatter = population_deviation(&over(others, &inside));
    (!at.is_empty()).then(|| [mean(over(rows, &at)), 4.0 * scatter / (rows.len() as f64).sqrt()])
}
