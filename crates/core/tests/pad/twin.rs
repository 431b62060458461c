//! The imperfect twin, each imperfection against its closed form: alone, on the nominal pad.

use std::f64::consts::TAU;
use std::sync::OnceLock;

use tactpad_core::pad::device::Device;
use tactpad_core::pad::device::behaviour::{Behaviour, Crosstalk, ModuleCrosstalk, OnChannels};
use tactpad_core::pad::field::PadField;
use tactpad_core::pad::twin::life::{Life, LifeError};
use tactpad_core::pad::twin::pad::{Circumstances, TwinPad};
use tactpad_core::quantity::{CHANNELS, Contact};
use tactpad_numeric::memory::{PlayOperator, Relaxation};
use tactpad_numeric::statistics::{mean, population_deviation};

const PRESS: Contact = Contact { x_mm: 3.0, y_mm: -7.0, fx_n: 0.4, fy_n: -0.2, fz_n: 2.0 };
const REST: Contact = Contact { x_mm: 0.0, y_mm: 0.0, fx_n: 0.0, fy_n: 0.0, fz_n: 0.0 };
const AROUND: Circumstances = Circumstances { temperature_c: 25.0, cycles: 0.0 };

fn pad_of(change: impl Fn(&mut Behaviour), seed: u64) -> TwinPad {
    let mut device = Device::nominal();
    change(&mut device.behaviour);
    TwinPad::new(&device, field(), seed)
}

fn field() -> &'static PadField {
    static FIELD: OnceLock<PadField> = OnceLock::new();
    FIELD.get_or_init(PadField::nominal)
}

fn ideal_uv(contact: &Contact) -> [f64; CHANNELS] {
    field().signals.strain_uv(contact).uv.map(f64::from)
}

/// Readings of one contact, `period_s` apart; nine columns.
fn readings(pad: &mut TwinPad, count: usize, period_s: f64, contact: &Contact) -> Vec<[f64; CHANNELS]> {
    (0..count).map(|_| pad.read(period_s, contact, &AROUND)).collect()
}

fn column(rows: &[[f64; CHANNELS]], channel: usize) -> Vec<f64> {
    rows.iter().map(|row| row[channel]).collect()
}

fn assert_near(found: f64, wanted: f64, tolerance: f64, what: &str) {
    assert!((found - wanted).abs() <= tolerance, "{what}: {found} instead of {wanted}");
}

#[test]
fn a_pad_without_imperfections_reads_its_field() {
    let mut pad = pad_of(|_| (), 1);
    assert_eq!(pad.read(0.001, &PRESS, &AROUND), ideal_uv(&PRESS));
    assert_eq!(pad.read(1e4, &REST, &AROUND), [0.0; CHANNELS]);
}

#[test]
fn white_noise_is_as_large_as_said_and_is_forgotten_at_once() {
    let mut pad = pad_of(|it| it.noise.additive_uv = std::array::from_fn(|channel| channel as f64), 3);
    let rows = readings(&mut pad, 40_000, 1e-3, &REST);
    for channel in 0..CHANNELS {
        let noise = column(&rows, channel);
        assert_near(population_deviation(&noise), channel as f64, 0.012 * channel as f64, "deviation");
        let product = mean(noise.iter().zip(&noise[1..]).map(|(one, next)| one * next));
        assert_near(product, 0.0, 0.02 * (channel * channel) as f64, "next to next");
    }
    let product = mean(rows.iter().map(|row| row[7] * row[8]));
    assert_near(product, 0.0, 0.02 * 56.0, "channels do not share it");
}

#[test]
fn relative_noise_grows_with_the_signal_and_lasts() {
    let change = |it: &mut Behaviour| (it.noise.share, it.noise.share_time_s) = ([0.02; CHANNELS], 0.1);
    let mut pad = pad_of(change, 4);
    let rows = readings(&mut pad, 60_000, 0.05, &PRESS);
    let signal = ideal_uv(&PRESS)[2];
    let relative: Vec<f64> = column(&rows, 2).iter().map(|uv| uv / signal - 1.0).collect();
    assert_near(population_deviation(&relative), 0.02, 5e-4, "deviation");
    let kept = mean(relative.iter().zip(&relative[1..]).map(|(one, next)| one * next)) / 4e-4;
    assert_near(kept, (-0.5_f64).exp(), 0.03, "what is left after half a time constant");
    assert!(
        readings(&mut pad, 10, 0.05, &REST).iter().all(|row| *row == [0.0; CHANNELS]),
        "no signal, no noise"
    );
}

#[test]
fn mains_are_a_sine_in_all_channels_together() {
    let change = |it: &mut Behaviour| {
        (it.mains.amplitude_uv, it.mains.frequency_hz) = ([10.0; CHANNELS], 50.0);
        it.mains.amplitude_uv[1] = -5.0;
    };
    let rows = readings(&mut pad_of(change, 5), 1000, 1e-3, &REST);
    assert_near(
        population_deviation(&column(&rows, 0)),
        10.0 / 2.0_f64.sqrt(),
        1e-6,
        "rms over whole periods",
    );
    assert!(rows.iter().all(|row| (row[1] + 0.5 * row[0]).abs() < 1e-9 && row[8] == row[0]));
    // 50 Hz, seen 45 times a second, turns 5 times a second.
    let rows = readings(&mut pad_of(change, 5), 90, 1.0 / 45.0, &REST);
    let seen = column(&rows, 0);
    assert!(seen.iter().zip(&seen[9..]).all(|(one, later)| (one - later).abs() < 1e-6));
}

#[test]
fn zeros_drift_evenly_and_walk() {
    let mut pad = pad_of(|it| it.noise.drift_uv_per_h = [36.0; CHANNELS], 6);
    let rows = readings(&mut pad, 100, 10.0, &REST);
    assert!((1..).zip(&rows).all(|(row, uv)| (uv[4] - 0.1 * f64::from(row)).abs() < 1e-9));
    let ends: Vec<f64> = (0..4000)
        .map(|seed| pad_of(|it| it.noise.walk_uv = [50.0; CHANNELS], seed).read(900.0, &REST, &AROUND)[0])
        .collect();
    assert_near(population_deviation(&ends), 25.0, 1.0, "after a quarter of an hour");
}

#[test]
fn ageing_loses_what_is_said_at_the_cycle_that_is_said() {
    let change = |it: &mut Behaviour| {
        it.ageing.share = [0.19; CHANNELS];
        (it.ageing.cycles, it.ageing.onset_cycles) = (50_000.0, 100.0);
    };
    let mut pad = pad_of(change, 7);
    let signal = ideal_uv(&PRESS)[5];
    let mut left = |cycles: f64| pad.read(1.0, &PRESS, &Circumstances { cycles, ..AROUND })[5] / signal;
    assert_near(left(0.0), 1.0, 1e-12, "new");
    assert_near(left(50_000.0), 0.81, 1e-12, "old");
    assert_near(left(5_000.0), 1.0 - 0.19 * 51.0_f64.ln() / 501.0_f64.ln(), 1e-12, "in between");
}

#[test]
fn temperature_moves_zero_and_gain() {
    let change = |it: &mut Behaviour| {
        (it.thermal.zero_uv_per_c, it.thermal.zero_uv_per_c2) = ([30.0; CHANNELS], [0.1; CHANNELS]);
        it.thermal.gain_per_c = [-2e-4; CHANNELS];
    };
    let mut pad = pad_of(change, 8);
    let warm = Circumstances { temperature_c: 45.0, ..AROUND };
    let zero_uv = 30.0 * 20.0 + 0.1 * 400.0;
    assert_near(pad.read(1.0, &REST, &warm)[0], zero_uv, 1e-9, "zero");
    let signal = ideal_uv(&PRESS)[0];
    assert_near(pad.read(1.0, &PRESS, &warm)[0], zero_uv + signal * (1.0 - 2e-4 * 20.0), 1e-9, "gain");
}

#[test]
fn couplings_add_shares_of_others() {
    let change = |it: &mut Behaviour| {
        it.crosstalk = vec![Crosstalk { channel: 0, with: 2, share: 0.03 }];
        it.module_crosstalk = vec![ModuleCrosstalk { module: 2, with: 1, share: -0.05 }];
    };
    let (read, ideal) = (pad_of(change, 9).read(1.0, &PRESS, &AROUND), ideal_uv(&PRESS));
    assert_near(read[0] - ideal[0], 0.03 * ideal[2], 1e-9, "crosstalk");
    for axis in 0..3 {
        assert_near(read[6 + axis] - ideal[6 + axis], -0.05 * ideal[3 + axis], 1e-9, "module crosstalk");
    }
}

#[test]
fn memory_acts_on_the_strain_before_the_gain() {
    let mut device = Device::nominal();
    device.modules[0].gain = [2.0; 3];
    device.behaviour.hysteresis = vec![OnChannels::all(PlayOperator { threshold: 50.0, share: 0.1 })];
    device.behaviour.creep = vec![OnChannels::all(Relaxation { time_s: 5.0, share: 0.04 })];
    let mut pad = TwinPad::new(&device, field(), 1);
    let strain_uv = ideal_uv(&PRESS)[2];
    assert!(strain_uv > 200.0);
    assert_near(pad.read(0.0, &PRESS, &AROUND)[2], 2.0 * (strain_uv - 5.0), 1e-9, "friction at once");
    let crept_uv = 0.04 * strain_uv * (1.0 - (-2.0_f64).exp());
    assert_near(pad.read(10.0, &PRESS, &AROUND)[2], 2.0 * (strain_uv - 5.0 + crept_uv), 1e-9, "creep later");
}

#[test]
fn the_converter_has_an_end_and_steps() {
    let change = |it: &mut Behaviour| (it.sampling.range_uv, it.sampling.step_uv) = (1000.0, 8.0);
    let read = pad_of(change, 1).read(1.0, &PRESS, &AROUND);
    let ideal = ideal_uv(&PRESS);
    assert!(ideal.iter().any(|uv| uv.abs() > 1000.0) && ideal.iter().any(|uv| uv.abs() < 900.0));
    for (read, ideal) in read.into_iter().zip(ideal) {
        assert_near(read, ideal.clamp(-1000.0, 1000.0), 4.0, "nearest step");
        assert!((read / 8.0).fract() == 0.0 || read.abs() == 1000.0, "{read}");
    }
}

#[test]
fn skewed_channels_show_the_past() {
    let change = |it: &mut Behaviour| it.sampling.skew_us[5] = 2500.0;
    let mut pad = pad_of(change, 1);
    let pressed = |seconds: f64| Contact { fz_n: (1.0 + (TAU * seconds).sin()) as f32, ..PRESS };
    for millisecond in 1..2000 {
        let at_s = f64::from(millisecond) * 1e-3;
        let read = pad.read(1e-3, &pressed(at_s), &AROUND);
        assert_near(read[4], ideal_uv(&pressed(at_s))[4], 1e-9, "in time");
        if millisecond > 10 {
            assert_near(read[5], ideal_uv(&pressed(at_s - 2.5e-3))[5], 0.1, "late");
        }
    }
}

#[test]
fn the_seed_decides_and_nothing_else() {
    let noisy = |it: &mut Behaviour| {
        it.noise.additive_uv = [3.0; CHANNELS];
        it.thermal.zero_scatter_uv_per_c = 5.0;
    };
    let warm = Circumstances { temperature_c: 35.0, ..AROUND };
    let read = |seed| pad_of(noisy, seed).read(1.0, &PRESS, &warm);
    assert_eq!(read(12), read(12));
    assert_ne!(read(12), read(13));
    let last = readings(&mut pad_of(noisy, 12), 5, 0.1, &PRESS).last().copied().unwrap();
    assert_eq!(last, *readings(&mut pad_of(noisy, 12), 5, 0.1, &PRESS).last().unwrap());
}

/// A pad with every imperfection that goes on in time.
fn lively() -> Device {
    let mut device = Device::nominal();
    let it = &mut device.behaviour;
    it.hysteresis =
        [60.0, 300.0].map(|threshold| OnChannels::all(PlayOperator { threshold, share: 0.1 })).to_vec();
    it.creep = vec![OnChannels::all(Relaxation { time_s: 20.0, share: 0.05 })];
    it.ageing.share = [0.19; CHANNELS];
    it.noise.additive_uv = [5.0; CHANNELS];
    (it.noise.share, it.noise.share_time_s) = ([0.02; CHANNELS], 3.0);
    (it.noise.walk_uv, it.noise.drift_uv_per_h) = ([500.0; CHANNELS], [90.0; CHANNELS]);
    it.mains.amplitude_uv = [12.0; CHANNELS];
    it.sampling.skew_us = std::array::from_fn(|channel| 700.0 * channel as f64);
    it.thermal.zero_scatter_uv_per_c = 8.0;
    device
}

/// What a pad reads in half a second of a press that grows, at 1 kHz.
fn half_a_second(pad: &mut TwinPad, around: &Circumstances) -> Vec<[f64; CHANNELS]> {
    let press = |millisecond: u16| Contact { fz_n: 5e-3 * f32::from(millisecond), ..PRESS };
    (0..500).map(|millisecond| pad.read(1e-3, &press(millisecond), around)).collect()
}

#[test]
fn a_life_that_was_kept_goes_on_as_if_it_had_not_ended() {
    let device = lively();
    let around = Circumstances { temperature_c: 31.0, cycles: 700.0 };
    let mut whole = TwinPad::new(&device, field(), 21);
    half_a_second(&mut whole, &around);

    let mut first = TwinPad::new(&device, field(), 21);
    half_a_second(&mut first, &around);
    let bytes = Life { state: first.into_state(), around }.to_bytes(&device);
    let Life { state, around: kept } = Life::from_bytes(&bytes, &device).unwrap();
    assert_eq!((state.seed(), kept), (21, around));
    assert_near(state.age_s(), 0.5, 1e-9, "age");
    let mut second = TwinPad::going_on(&device, field(), state);
    let (read, wanted) = (half_a_second(&mut second, &kept), half_a_second(&mut whole, &around));
    assert_eq!(read, wanted, "bit by bit");
    assert_ne!(read, half_a_second(&mut TwinPad::new(&device, field(), 21), &around), "and not anew");
}

#[test]
fn cycles_pass_with_their_time_and_age_the_pad() {
    let device = lively();
    let old =
        Life::new(&device, 3).after_cycles(5_000.0, &device, field()).after_cycles(200.0, &device, field());
    assert_eq!(old.around.cycles, 5_200.0);
    assert_near(old.state.age_s(), 5_200.0, 1e-6, "a second each");
}

#[test]
fn a_life_is_refused_that_is_none_or_of_another_pad() {
    let device = lively();
    let mut pad = TwinPad::new(&device, field(), 1);
    half_a_second(&mut pad, &AROUND);
    let bytes = Life { state: pad.into_state(), around: AROUND }.to_bytes(&device);
    let refusal = |bytes: &[u8], device: &Device| Life::from_bytes(bytes, device).err();
    let mut other = device.clone();
    other.behaviour.creep[0].law.share = 0.06;
    assert_eq!(refusal(&bytes, &other), Some(LifeError::Device));
    let mut other_hand = device.clone();
    (other_hand.behaviour.finger.wander_mm, other_hand.behaviour.rig.stage_x_mm) = (1.0, 2.0);
    assert_eq!(refusal(&bytes, &other_hand), None, "another hand on another rig");
    assert_eq!(refusal(b"", &device), Some(LifeError::Version));
    assert_eq!(refusal(&device.to_toml().into_bytes(), &device), Some(LifeError::Version));
    for length in (22..bytes.len()).step_by(97) {
        assert_eq!(refusal(&bytes[..length], &device), Some(LifeError::Damaged), "{length} bytes");
    }
    for at in (22..bytes.len()).step_by(61) {
        let mut damaged = bytes.clone();
        damaged[at] ^= 1;
        assert_eq!(refusal(&damaged, &device), Some(LifeError::Damaged), "byte {at}");
    }
}
