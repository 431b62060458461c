//! Channels that answer to nothing.
//!
//! A channel is dead if nothing of what any channel should read shows in it, where an ordinary channel would show it: by
//! Fisher's z = tanh⁻¹ r √(n − 3) of the correlation that an ordinary one had beside as much noise. A little leaks into an open
//! input; what is below a hundredth of its own signal is not an answer. Without a model only a channel is dead that never moves.
//!
//! Source: R. A. Fisher, Metron 1 (1921) 3; R. A. Fisher, Statistical Methods for Research Workers (1925), the F test.

use crate::diagnosis::data::target::Target;
use crate::diagnosis::gatekeepers::gate::{Gate, LEVEL};
use crate::diagnosis::gatekeepers::prediction::explained;
use crate::effect::Effect;
use tactpad_core::counted::counted;
use tactpad_numeric::chi_square;
use tactpad_numeric::statistics::squares;

/// No answer is smaller than this part of the signal.
const ANSWER_MIN: f64 = 0.01;
/// So many standard deviations an ordinary channel's answer must be visible by.
const TELLING: f64 = 8.0;

pub(crate) fn check(gate: &mut Gate) {
    let dead: Vec<(usize, f64)> =
        (0..gate.channels()).filter_map(|channel| Some((channel, silence(gate, channel)?))).collect();
    for (channel, p_value) in dead {
        let rows = gate.told(channel);
        let detail = format!(
            "{} follows no load, in none of its {}; the channel is left out and the others are diagnosed; plot it against a \
             neighbour, then look at its wire and its gauge",
            gate.name(channel),
            counted(rows.len(), "row")
        );
        let share = gate.mended(|gate| gate.mask(channel, &rows));
        gate.notice("dead", Some(channel), detail);
        gate.find(Effect::ChannelDead, Target::Channel(channel), p_value, share);
    }
}

/// The probability that an ordinary channel were as silent; none for one that is not, or of which nothing can be said.
fn silence(gate: &Gate, channel: usize) -> Option<f64> {
    let rows = gate.told(channel);
    let readings = gate.readings(channel, &rows);
    let Some(own) = gate.expected(channel, &rows) else {
        return is_still_alone(gate, channel, &readings).then_some(0.0);
    };
    let (signal, whole) = (squares(&own), squares(&readings));
    let count = rows.len() as f64;
    let z = (signal / (signal + whole)).sqrt().min(1.0 - 1e-12).atanh() * (count - 3.0).max(0.0).sqrt();
    if signal.is_nan() || signal <= 0.0 || z < TELLING {
        return None;
    }
    let regressors: Vec<Vec<f64>> =
        (0..gate.channels()).filter_map(|other| gate.expected(other, &rows)).collect();
    let part = explained(&readings, &regressors);
    let freedom = regressors.len();
    // n ln 1/(1 − R²) is χ² with a degree of freedom for each regressor. (M. S. Bartlett, 1947)
    let square = -(count - 1.0 - 0.5 * (freedom as f64 + 2.0)) * (1.0 - part).max(f64::MIN_POSITIVE).ln();
    let is_chance = chi_square::exceeded(square, freedom) > LEVEL;
    let is_faint = part * whole < ANSWER_MIN * ANSWER_MIN * signal;
    (is_chance || is_faint).then(|| chi_square::exceeded(z * z, 1))
}

/// Whether a channel stays the same to the last digit while others do not.
fn is_still_alone(gate: &Gate, channel: usize, readings: &[f64]) -> bool {
    let is_still = |readings: &[f64]| readings.windows(2).all(|pair| pair[0] == pair[1]);
    let moves = |other: usize| !is_still(&gate.readings(other, &gate.told(other)));
    readings.len() > 2
        && is_still(readings)
        && (0..gate.channels()).any(|other| other != channel && moves(other))
}
