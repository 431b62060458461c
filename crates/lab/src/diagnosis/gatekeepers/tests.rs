//! Recordings with faults of their own: three channels of a made-up sensor, none of them a pad's.

use super::*;
use crate::diagnosis::data::target::Target;
use crate::effect::Effect;
use tactpad_inference::observations::Sample;
use tactpad_numeric::random::SplitMix64;

/// Three channels under loads of three axes, static, and what they should read.
fn pressed(rows: usize) -> (Observations, Vec<Vec<f64>>) {
    let mut random = SplitMix64::new(11);
    let mut draw = || f64::from(random.normal());
    let samples: Vec<Sample> = (0..rows)
        .map(|_| Sample {
            place_mm: [3.0 * draw(), 3.0 * draw()],
            load: [draw(), draw(), 3.0 + draw()],
            ..Sample::default()
        })
        .collect();
    let gains = [[90.0, 10.0, -30.0], [-20.0, 80.0, 40.0], [5.0, 15.0, 120.0]];
    let reading =
        |gain: &[f64; 3], sample: &Sample| -> f64 { gain.iter().zip(sample.load).map(|(g, n)| g * n).sum() };
    let expected: Vec<Vec<f64>> =
        gains.iter().map(|gain| samples.iter().map(|sample| reading(gain, sample)).collect()).collect();
    let readings = expected.iter().map(|of| of.iter().map(|f| 7.0 + f + 1.5 * draw()).collect()).collect();
    (observations(samples, readings), expected)
}

/// A series of slow presses at `rate_hz`, with noise.
fn stream(rows: usize, rate_hz: f64) -> Observations {
    let mut random = SplitMix64::new(12);
    let t_s = |row: usize| row as f64 / rate_hz;
    let press = |row: usize| libm::sin(0.9 * t_s(row)).powi(2);
    let sample = |row: usize| Sample {
        load: [0.0, 0.0, press(row)],
        trial: Some(row / 300),
        t_s: Some(t_s(row)),
        ..Sample::default()
    };
    let noisy = |gain: f64| (0..rows).map(|row| gain * press(row) + f64::from(random.normal())).collect();
    let readings = [100.0, -60.0, 40.0].map(noisy).to_vec();
    observations((0..rows).map(sample).collect(), readings)
}

fn observations(samples: Vec<Sample>, readings: Vec<Vec<f64>>) -> Observations {
    Observations {
        channels: (0..readings.len()).map(|channel| format!("c{channel}")).collect(),
        is_told: vec![vec![true; samples.len()]; readings.len()],
        numbers: (0..samples.len()).collect(),
        readings,
        samples,
    }
}

fn checks(gate: &Gate) -> Vec<(&'static str, Option<usize>)> {
    gate.notices.iter().map(|notice| (notice.check, notice.channel)).collect()
}

fn found(gate: &Gate) -> Vec<(Effect, Target)> {
    gate.findings.iter().map(|finding| (finding.effect, finding.target)).collect()
}

fn masked(gate: &Gate, channel: usize) -> usize {
    gate.observations.rows() - gate.told(channel).len()
}

#[test]
fn sound_recordings_pass_as_they_are() {
    let (table, expected) = pressed(300);
    for model in [Some(expected.as_slice()), None] {
        let gate = guarded(&table, model, |_| true);
        assert_eq!((checks(&gate), gate.observations), (vec![], table.clone()));
    }
    let gate = guarded(&stream(900, 45.0), None, |_| true);
    assert_eq!((checks(&gate), found(&gate)), (vec![], vec![]));
    assert!(
        gate.not_detected.iter().all(|it| (0.05..1.0).contains(&it.minimum_detectable[0].1)),
        "{:?}",
        gate.not_detected
    );
}

#[test]
fn no_recording_is_too_poor() {
    let hostile = |value: &dyn Fn(usize) -> f64, t_s: &dyn Fn(usize) -> f64, rows: usize| {
        let sample = |row: usize| Sample {
            load: [value(row); 3],
            trial: Some(0),
            t_s: Some(t_s(row)),
            ..Sample::default()
        };
        observations((0..rows).map(sample).collect(), vec![(0..rows).map(value).collect(); 3])
    };
    let huge = |row: usize| if row.is_multiple_of(2) { f64::MAX } else { f64::MIN };
    for rows in [0, 1, 2, 3, 100] {
        for value in [&|_| 5.0, &huge, &|_| f64::NAN, &|_| f64::INFINITY, &|row| row as f64]
            as [&dyn Fn(usize) -> f64; 5]
        {
            for t_s in [&|_| 1.0, &|row| row as f64, &|row| -(row as f64), &|_| f64::NAN, &huge]
                as [&dyn Fn(usize) -> f64; 5]
            {
                let table = hostile(value, t_s, rows);
                for model in [None, Some(table.readings.as_slice())] {
                    let gate = guarded(&table, model, |_| true);
                    assert_eq!(gate.observations.rows(), rows);
                    assert!(gate.observations.readings.iter().flatten().all(|y| y.is_finite()));
                }
            }
        }
    }
    let mut nothing = pressed(50).0;
    nothing.is_told.iter_mut().flatten().for_each(|is_told| *is_told = false);
    assert_eq!(checks(&guarded(&nothing, Some(&nothing.readings.clone()), |_| true)), vec![]);
}

#[test]
fn wires_are_found_and_put_back() {
    let (table, expected) = pressed(300);
    let mut swapped = table.clone();
    swapped.readings.swap(0, 2);
    let gate = guarded(&swapped, Some(&expected), |_| true);
    assert_eq!(found(&gate), vec![(Effect::ChannelsSwapped, Target::Channels { into: 0, from: 2 })]);
    assert_eq!(gate.observations.readings, table.readings);
    assert!(gate.findings[0].share > 0.9 && gate.findings[0].p_value < 1e-9);
    let mut turned = table.clone();
    turned.readings[1].iter_mut().for_each(|y| *y = -*y);
    let gate = guarded(&turned, Some(&expected), |_| true);
    assert_eq!(found(&gate), vec![(Effect::ChannelPolarity, Target::Channel(1))]);
    assert_eq!(gate.observations.readings, table.readings);
}

#[test]
fn a_channel_that_follows_nothing_has_no_weight() {
    let (mut table, expected) = pressed(300);
    let mut random = SplitMix64::new(3);
    table.readings[1].iter_mut().for_each(|y| *y = -33.0 + 0.3 * f64::from(random.normal()));
    let gate = guarded(&table, Some(&expected), |_| true);
    assert_eq!((found(&gate), masked(&gate, 1)), (vec![(Effect::ChannelDead, Target::Channel(1))], 300));
    // A small gain is none: a tenth of the answer is an answer.
    let (mut table, expected) = pressed(300);
    table.readings[1].iter_mut().for_each(|y| *y *= 0.1);
    assert_eq!(found(&guarded(&table, Some(&expected), |_| true)), vec![]);
    table.readings[1].fill(4.0);
    assert_eq!(found(&guarded(&table, None, |_| true)), vec![(Effect::ChannelDead, Target::Channel(1))]);
}

#[test]
fn limits_are_found_with_and_without_a_model() {
    let (mut table, expected) = pressed(400);
    table.readings[2].iter_mut().for_each(|y| *y = y.clamp(-1e9, 480.0));
    let clipped = table.readings[2].iter().filter(|y| **y == 480.0).count();
    for model in [Some(expected.as_slice()), None] {
        let gate = guarded(&table, model, |_| true);
        assert_eq!(
            (found(&gate), masked(&gate, 2)),
            (vec![(Effect::AdcClipping, Target::Channel(2))], clipped)
        );
        let limit = gate.findings[0].parameters[0];
        assert!(limit.interval95[0] <= 480.0 && limit.interval95[1] >= 480.0, "{limit:?}");
    }
    // Coarse steps alone are no limit.
    table.readings[2] = pressed(400).0.readings[2].iter().map(|y| 40.0 * (y / 40.0).round()).collect();
    assert_eq!(found(&guarded(&table, Some(&expected), |_| true)), vec![]);
}

#[test]
fn codes_are_masked_and_what_only_looks_like_one_is_not() {
    for code in [9999.0, f64::NAN, -1.0, 0.0] {
        let mut table = stream(900, 45.0);
        (5..900).step_by(9).for_each(|row| table.readings[0][row] = code);
        let gate = guarded(&table, None, |_| true);
        assert_eq!((checks(&gate), masked(&gate, 0)), (vec![("missing", Some(0))], 100), "{code}");
    }
    for wild in [1e6, -1e6] {
        let (mut table, expected) = pressed(200);
        table.readings[0][17] = wild;
        let gate = guarded(&table, Some(&expected), |_| true);
        assert_eq!((checks(&gate), masked(&gate, 0)), (vec![("missing", Some(0))], 1), "{wild}");
    }
    // Rest between static loads, to the last digit, in all channels.
    let (mut table, _) = pressed(200);
    table.readings.iter_mut().for_each(|of| of.iter_mut().step_by(2).for_each(|y| *y = 0.0));
    assert_eq!(checks(&guarded(&table, None, |_| true)), vec![]);
}

#[test]
fn a_channel_that_is_stuck_for_a_while_is_masked_there() {
    let mut table = stream(900, 45.0);
    let value = table.readings[1][400];
    table.readings[1][400..460].fill(value);
    let gate = guarded(&table, None, |_| true);
    assert_eq!((checks(&gate), masked(&gate, 1)), (vec![("stuck", Some(1))], 60));
}

#[test]
fn held_channels_and_clocks_that_run_apart_are_told() {
    let mut table = stream(900, 45.0);
    (0..900).for_each(|row| table.readings[2][row] = table.readings[2][row - row % 3]);
    let gate = guarded(&table, None, |_| true);
    assert_eq!((checks(&gate), masked(&gate, 2)), (vec![("rates", Some(2))], 600));
    let mut table = stream(900, 45.0);
    table.samples.iter_mut().for_each(|sample| sample.label_t_s = sample.t_s.map(|t_s| 0.003 + 1.004 * t_s));
    assert_eq!(checks(&guarded(&table, None, |_| true)), vec![("clocks", None)]);
}

#[test]
fn times_are_sorted_split_and_freed_of_doubles() {
    let sound = stream(900, 45.0);
    let mut table = sound.as_whole(
        &(0..900)
            .map(|row| match row {
                50 => 51,
                51 => 50,
                _ => row,
            })
            .collect::<Vec<_>>(),
    );
    let gate = guarded(&table, None, |_| true);
    assert_eq!((checks(&gate), &gate.observations), (vec![("time", None)], &sound));
    table = sound.clone();
    table.samples[77].t_s = table.samples[76].t_s;
    let gate = guarded(&table, None, |_| true);
    assert_eq!((checks(&gate), masked(&gate, 0)), (vec![("time", None)], 1));
    table = sound;
    (450..600).for_each(|row| table.samples[row].t_s = table.samples[row].t_s.map(|t_s| t_s - 8.0));
    let gate = guarded(&table, None, |_| true);
    assert_eq!(checks(&gate), vec![("time", None)]);
    assert_eq!(
        (gate.observations.samples[449].trial, gate.observations.samples[450].trial),
        (Some(1), Some(3))
    );
}

#[test]
fn steps_above_the_noise_are_told() {
    let mut table = stream(900, 45.0);
    table.readings[0].iter_mut().for_each(|y| *y = 8.0 * (*y / 8.0).round());
    assert_eq!(checks(&guarded(&table, None, |_| true)), vec![("steps", Some(0))]);
}

#[test]
fn the_mains_are_found_where_they_fold_to_and_taken_out() {
    for (rate_hz, line_hz) in [(45.0, 50.02), (45.0, 59.97), (200.0, 50.0), (38.0, 60.03)] {
        let sound = stream(900, rate_hz);
        let mut table = sound.clone();
        let times: Vec<f64> = table.samples.iter().filter_map(|sample| sample.t_s).collect();
        let wave = |t_s: &f64| 3.0 * libm::sin(std::f64::consts::TAU * line_hz * t_s + 1.0);
        table.readings[1].iter_mut().zip(times.iter().map(wave)).for_each(|(y, wave)| *y += wave);
        let gate = guarded(&table, None, |_| true);
        assert_eq!(found(&gate), vec![(Effect::MainsPickup, Target::Channel(1))], "{rate_hz} {line_hz}");
        for (number, truth) in gate.findings[0].parameters.iter().zip([3.0, line_hz]) {
            let [low, high] = number.interval95;
            assert!(low < truth && truth < high && high - low < 0.6, "{number:?}");
        }
        let left = gate.observations.readings[1].iter().zip(&sound.readings[1]).map(|(y, f)| (y - f).powi(2));
        assert!(left.sum::<f64>() / 900.0 < 0.1);
    }
    // The samples' own rate folds the line to nothing.
    let gate = guarded(&stream(900, 50.0), None, |_| true);
    assert_eq!(gate.findings, vec![]);
}

#[test]
fn what_the_press_does_itself_is_not_the_mains() {
    let mut table = stream(900, 45.0);
    for row in 0..900 {
        let shake = libm::sin(std::f64::consts::TAU * 5.0 * row as f64 / 45.0);
        table.samples[row].load[2] += 0.1 * shake;
        table.readings[0][row] += 10.0 * shake;
    }
    assert_eq!(found(&guarded(&table, None, |_| true)), vec![]);
}

/// In states of these lengths by turns, a channel reads `gain` times as much in every second.
fn loosened(readings: &mut [f64], gain: f64, lengths: [usize; 2]) {
    let period = lengths[0] + lengths[1];
    let loose = readings.iter_mut().enumerate().filter(|(row, _)| row % period >= lengths[0]);
    // What it reads without load stays.
    loose.for_each(|(_, y)| *y = 7.0 + gain * (*y - 7.0));
}

#[test]
fn a_gain_that_jumps_and_comes_back_is_a_loose_connector() {
    for (gain, lengths) in [(0.8, [50, 20]), (1.3, [30, 31]), (0.1, [90, 6])] {
        let (mut observations, expected) = pressed(600);
        loosened(&mut observations.readings[1], gain, lengths);
        let gate = guarded(&observations, Some(&expected), |_| true);
        assert_eq!(found(&gate), [(Effect::ChannelIntermittent, Target::Channel(1))], "{gain}");
        assert_eq!(checks(&gate), [("intermittent", Some(1))]);
        let stated = &gate.findings[0].parameters[0];
        let [low, high] = stated.interval95;
        assert!((low..=high).contains(&gain), "{gain}: {stated:?}");
        let period = lengths[0] + lengths[1];
        let right =
            (0..600).filter(|row| gate.observations.is_told[1][*row] == (row % period < lengths[0])).count();
        assert!(right > 590, "{gain}: {right}");
    }
}

#[test]
fn what_is_no_loose_connector_is_not_called_one() {
    let spoilt: [fn(&mut Observations); 5] = [
        |_| (),
        // One gain, another from the middle on, and one that goes away slowly.
        |it| it.readings[1].iter_mut().for_each(|y| *y *= 1.3),
        |it| it.readings[1].iter_mut().skip(300).for_each(|y| *y *= 1.3),
        |it| it.readings[1].iter_mut().enumerate().for_each(|(row, y)| *y *= 1.0 - 5e-4 * row as f64),
        // The supply, which all channels have.
        |it| it.readings.iter_mut().for_each(|of| loosened(of, 0.8, [50, 20])),
    ];
    for (at, spoil) in spoilt.iter().enumerate() {
        let (mut observations, expected) = pressed(600);
        observations.samples.iter_mut().enumerate().for_each(|(row, it)| it.t_s = Some(row as f64));
        spoil(&mut observations);
        let gate = guarded(&observations, Some(&expected), |_| true);
        assert_eq!(found(&gate), [], "{at}");
    }
}
