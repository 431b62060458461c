//! Gauges, wires and converters.

use std::f64::consts::TAU;

use crate::plan::Row;
use crate::random::Random;
use crate::truth::{Truth, channel};

/// What the electronics do to signals before their noise. `full_scale` is each channel's largest signal.
pub(crate) fn conduct(
    truths: &[Truth],
    rows: &[Row],
    signals: &mut [[f64; 9]],
    full_scale: &[f64; 9],
    random: &mut Random,
) {
    for truth in truths {
        match truth.effect.as_str() {
            "channel_skew" => late(truth, rows, signals),
            "channel_intermittent" => come_loose(truth, signals, random),
            _ => {}
        }
        let source = truth.with.as_deref().and_then(channel).unwrap_or_default();
        let targets = truth.channels();
        for signal in signals.iter_mut() {
            for channel in &targets {
                let value = signal[*channel];
                signal[*channel] = match truth.effect.as_str() {
                    "channel_gain" | "excitation_gain" => value * truth.value("gain"),
                    "channel_crosstalk" => value + truth.value("share") * signal[source],
                    "gauge_nonlinearity" => {
                        let bend = truth.value("second_order_percent_fs") / 100.0;
                        value + bend * value * value / full_scale[*channel]
                    }
                    _ => value,
                };
            }
        }
    }
}

/// What is added at the end: zeros, and the mains.
pub(crate) fn add(truths: &[Truth], rows: &[Row], signals: &mut [[f64; 9]], random: &mut Random) {
    for truth in truths {
        let phase = random.unit();
        for (row, signal) in rows.iter().zip(signals.iter_mut()) {
            let pickup = match truth.effect.as_str() {
                "channel_offset" => truth.value("offset_uv"),
                // A static sample is a mean over a second, in which the mains cancel.
                "mains_pickup" if row.in_trial_s.is_some() => {
                    let turns = phase + truth.value("frequency_hz") * row.time_s;
                    truth.value("amplitude_uv") * (TAU * turns.fract()).sin()
                }
                _ => continue,
            };
            truth.channels().into_iter().for_each(|channel| signal[channel] += pickup);
        }
    }
}

/// What wires and converters do to a channel with all that is on it.
pub(crate) fn convert(truths: &[Truth], signals: &mut [[f64; 9]], random: &mut Random) {
    for truth in truths {
        let other = truth.with.as_deref().and_then(channel).unwrap_or_default();
        let own = truth.channels()[0];
        let stuck = random.between(-40.0, 40.0);
        for signal in signals.iter_mut() {
            match truth.effect.as_str() {
                // An open input floats near a level of its own, with the converter's own noise.
                "channel_dead" => signal[own] = stuck + 0.3 * random.normal(),
                "channel_polarity" => signal[own] = -signal[own],
                "channels_swapped" => signal.swap(own, other),
                "adc_clipping" => {
                    let limit = truth.value("limit_uv").abs();
                    signal[own] = signal[own].clamp(-limit, limit);
                }
                _ => {}
            }
        }
    }
}

/// A connector is sound for some sixty rows at a time, and loose for some twenty.
fn come_loose(truth: &Truth, signals: &mut [[f64; 9]], random: &mut Random) {
    let (mut is_loose, mut left) = (false, 0);
    for signal in signals {
        if left == 0 {
            is_loose = !is_loose;
            // Ages of a process without memory.
            left = 1 + (-(if is_loose { 20.0 } else { 60.0 }) * random.unit().max(1e-9).ln()) as usize;
        }
        left -= 1;
        if is_loose {
            truth.channels().into_iter().for_each(|channel| signal[channel] *= truth.value("gain"));
        }
    }
}

/// By what the noise of a channel is larger than it should be.
pub(crate) fn noise_factor(truths: &[Truth], channel: usize) -> f64 {
    let loud = |truth: &&Truth| truth.effect == "noise_excess" && truth.channels().contains(&channel);
    truths.iter().filter(loud).map(|truth| truth.value("factor")).product()
}

/// A late channel shows what was there before, on a line between the rows of a trial.
fn late(truth: &Truth, rows: &[Row], signals: &mut [[f64; 9]]) {
    let by_s = truth.value("skew_us") * 1e-6;
    for channel in truth.channels() {
        let seen: Vec<f64> = signals.iter().map(|signal| signal[channel]).collect();
        for index in 0..rows.len() {
            let same = |other: usize| {
                rows.get(other).is_some_and(|row| row.in_trial_s.is_some() && row.trial == rows[index].trial)
            };
            let neighbour = if by_s > 0.0 { index.wrapping_sub(1) } else { index + 1 };
            if same(index) && same(neighbour) {
                let share = by_s / (rows[index].time_s - rows[neighbour].time_s);
                signals[index][channel] += share * (seen[neighbour] - seen[index]);
            }
        }
    }
}
