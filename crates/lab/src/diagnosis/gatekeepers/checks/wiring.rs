//! Channels in each other's place, and channels of the wrong sign.
//!
//! Each channel is held against what every channel should read. u = 1 − r² is the share of its variance that is left. Two
//! channels are exchanged if that is likelier, ½ n ln [(uₖₖ uₗₗ)/(uₖₗ uₗₖ)] (with normal residuals the likelihood goes with
//! u^(−n/2)), and leaves each of them at most half. A sign shows in none of this: it is that of r in the right place.

use crate::diagnosis::data::target::Target;
use crate::diagnosis::gatekeepers::gate::{Gate, LEVEL};
use crate::effect::Effect;
use tactpad_numeric::chi_square;
use tactpad_numeric::statistics::{correlation, squares};

/// No less than this is left: what sound pads of a kind differ by is not told apart.
const LEFT_MIN: f64 = 0.05;
/// An exchange leaves at most this part of what was left.
const LEFT_OF: f64 = 0.5;
/// A channel has the wrong sign from this correlation on.
const REVERSED: f64 = -0.5;

pub(crate) fn check(gate: &mut Gate) {
    if gate.expected.is_none() {
        return;
    }
    for _ in 0..gate.channels() {
        let Some((log_odds, pair)) = likeliest(gate) else { break };
        exchange(gate, pair, log_odds);
    }
    (0..gate.channels()).for_each(|channel| turn(gate, channel));
}

/// The correlation of a channel with what another one should read.
fn follows(gate: &Gate, channel: usize, other: usize) -> Option<f64> {
    let rows = gate.told(channel);
    let expected = gate.expected(other, &rows)?;
    let is_judged =
        rows.len() > 3 && squares(&expected) > 0.0 && squares(&gate.readings(channel, &rows)) > 0.0;
    is_judged.then(|| correlation(&gate.readings(channel, &rows), &expected))
}

/// The pair of channels whose exchange is likeliest, if that is likely enough, and the logarithm of the odds.
fn likeliest(gate: &Gate) -> Option<(f64, [usize; 2])> {
    let channels = gate.channels();
    let left: Vec<Vec<Option<f64>>> = (0..channels)
        .map(|k| (0..channels).map(|l| Some((1.0 - follows(gate, k, l)?.powi(2)).max(LEFT_MIN))).collect())
        .collect();
    let pairs = (0..channels).flat_map(|one| (one + 1..channels).map(move |other| [one, other]));
    let odds = |[one, other]: [usize; 2]| {
        let own = [left[one][one]?, left[other][other]?];
        let crossed = [left[one][other]?, left[other][one]?];
        let is_better = crossed.iter().zip(&own).all(|(crossed, own)| *crossed <= LEFT_OF * own);
        let count = gate.told(one).len().min(gate.told(other).len()) as f64;
        let log_odds = 0.5 * count * (own[0] * own[1] / (crossed[0] * crossed[1])).ln();
        is_better.then_some((log_odds, [one, other]))
    };
    let needed = (0.5 * (channels * channels) as f64 / LEVEL).ln();
    let best = pairs.filter_map(odds).max_by(|one, other| one.0.total_cmp(&other.0));
    best.filter(|(log_odds, _)| *log_odds > needed)
}

fn exchange(gate: &mut Gate, [one, other]: [usize; 2], log_odds: f64) {
    let [name, with] = [one, other].map(|channel| gate.name(channel).to_owned());
    let share = gate.mended(|gate| {
        gate.observations.readings.swap(one, other);
        gate.observations.is_told.swap(one, other);
    });
    let detail = format!(
        "{name} reads what {with} should, and {with} what {name} should; the two are changed back in all rows; check the plug, \
         or the columns' names"
    );
    gate.notice("swapped", Some(one), detail);
    let target = Target::Channels { into: one, from: other };
    gate.find(Effect::ChannelsSwapped, target, (-log_odds).exp().max(f64::MIN_POSITIVE), share);
}

/// Turns the sign of a channel that goes against its own.
fn turn(gate: &mut Gate, channel: usize) {
    let Some(r) = follows(gate, channel, channel) else { return };
    let count = gate.told(channel).len() as f64;
    let z = r.clamp(-1.0 + 1e-12, 1.0 - 1e-12).atanh() * (count - 3.0).max(0.0).sqrt();
    let p_value = chi_square::exceeded(z * z, 1);
    if r > REVERSED || p_value * gate.channels() as f64 > LEVEL {
        return;
    }
    let share = gate.mended(|gate| gate.observations.readings[channel].iter_mut().for_each(|y| *y = -*y));
    let detail = format!(
        "{} falls where it should rise (correlation {r:.2}); its sign is turned in all rows; exchange the two wires of its \
         bridge, or the sign in the column",
        gate.name(channel)
    );
    gate.notice("polarity", Some(channel), detail);
    gate.find(Effect::ChannelPolarity, Target::Channel(channel), p_value, share);
}
