//! Hysteresis is taken off in play: the pipeline on a pad that remembers its presses.
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a test may stop at what it did not expect")]

use crate::played::Played;
use tactpad::numeric::memory::PlayOperator;
use tactpad::pad::device::Device;
use tactpad::pad::device::behaviour::OnChannels;
use tactpad::pad::field::PadField;
use tactpad::pipeline::compensation::Compensation;
use tactpad::pipeline::compensation::hysteresis::{Hysteresis, NO_HYSTERESIS};
use tactpad::pipeline::contact::Decoder;
use tactpad::pipeline::contact::inverse::Inverse;
use tactpad::pipeline::contact::uncertainty::Noise;
use tactpad::quantity::{CHANNELS, Contact};
use tactpad::time::HostInstant;

const THRESHOLD_UV: f64 = 800.0;
const SHARE: f64 = 0.0625;

fn pad() -> Device {
    let mut device = Device::nominal();
    device.behaviour.hysteresis = vec![OnChannels::all(PLAY)];
    device.behaviour.noise.additive_uv = [3.0; CHANNELS];
    device
}

const PLAY: PlayOperator = PlayOperator { threshold: THRESHOLD_UV, share: SHARE };

const KNOWN: Hysteresis = [[PLAY; CHANNELS], [PlayOperator::NONE; CHANNELS]];

fn played(hysteresis: Hysteresis) -> Played {
    let field = PadField::nominal();
    let noise = Noise::of_channels([3.0; CHANNELS], [0.002; CHANNELS]);
    let compensation = Compensation { hysteresis, ..Compensation::NONE };
    let decoder = Decoder::from(Inverse::new(field.signals.clone(), noise)).compensated_by(compensation);
    Played::new(decoder, &pad(), &field, 1)
}

/// Presses evenly over the plate and over the forces, others for each seed.
fn presses(seed: u32, count: u32) -> Vec<Contact> {
    // Multiples of irrational numbers fill the unit cube evenly.
    let part = |index: u32, step: f64| ((f64::from(100 * seed + index) * step).fract()) as f32;
    let press = |index: u32| {
        let along = |step: f64| 2.0 * part(index, step) - 1.0;
        let fz_n = 1.0 + 4.0 * part(index, 0.865_400);
        Contact {
            x_mm: 18.0 * along(0.748_922),
            y_mm: 18.0 * along(0.648_117),
            fx_n: 0.3 * fz_n * along(0.560_879),
            fy_n: 0.3 * fz_n * along(0.485_384),
            fz_n,
        }
    };
    (0..count).map(press).collect()
}

/// Mean errors of place (mm) and force (N) over presses of 300 ms with rests between them.
fn errors(played: &mut Played, presses: &[Contact]) -> [f64; 2] {
    let mut sums = [0.0; 2];
    for press in presses {
        let found = played.press(&[*press], 300).unwrap();
        played.rest(150 + 7 * (press.fz_n * 10.0) as u64);
        let off = |a: f32, b: f32| f64::from((a - b).abs());
        sums[0] += (off(found.x_mm, press.x_mm) + off(found.y_mm, press.y_mm)) / 2.0;
        sums[1] +=
            (off(found.fx_n, press.fx_n) + off(found.fy_n, press.fy_n) + off(found.fz_n, press.fz_n)) / 3.0;
    }
    sums.map(|sum| sum / presses.len() as f64)
}

/// With friction taken off, and without.
fn both(before: impl Fn(&mut Played), seed: u32) -> [[f64; 2]; 2] {
    [KNOWN, NO_HYSTERESIS].map(|hysteresis| {
        let mut played = played(hysteresis);
        before(&mut played);
        errors(&mut played, &presses(seed, 40))
    })
}

fn assert_several_times_closer(name: &str, [[mm, n], [plain_mm, plain_n]]: [[f64; 2]; 2]) {
    println!("{name}: {mm:.3} mm, {n:.4} N; without {plain_mm:.3} mm, {plain_n:.4} N");
    assert!(mm < plain_mm / 3.0 && n < plain_n / 3.0, "{name}");
}

#[test]
fn presses_come_out_several_times_closer() {
    assert_several_times_closer("from new", both(|played| played.rest(600), 1));
}

#[test]
fn a_pad_that_was_pressed_before_it_was_tared_is_soon_known() {
    let used = |played: &mut Played| {
        // Nobody listens while it is used: the pipeline hears it from here on.
        for press in presses(7, 20) {
            played.press(&[press], 300);
        }
        played.rest(600);
        let now = HostInstant::default().plus_us(1_000 * played.now_ms);
        played.pipeline.handle_unplugged(now);
        played.rest(600);
        errors(played, &presses(8, 10));
    };
    assert_several_times_closer("used before", both(used, 2));
}

#[test]
fn a_zero_taken_under_a_finger_leaves_nothing() {
    let tared_under_a_finger = |played: &mut Played| {
        let finger = Contact { x_mm: 5.0, y_mm: -8.0, fz_n: 3.0, ..Contact::default() };
        played.rest(600);
        played.press(&[finger], 300);
        played.pipeline.retare(HostInstant::default().plus_us(1_000 * played.now_ms));
        played.press(&[finger], 1_500);
        // The wrong zero is a pull now, and is taken anew.
        played.rest(3_000);
        errors(played, &presses(9, 10));
    };
    assert_several_times_closer("tared under a finger", both(tared_under_a_finger, 3));
}

#[test]
fn the_reference_does_not_drift_over_faults_pauses_and_idle_minutes() {
    let troubled = |played: &mut Played| {
        played.rest(600);
        for (index, press) in presses(5, 30).iter().enumerate() {
            played.press(&[*press], 300);
            let now = HostInstant::default().plus_us(1_000 * played.now_ms);
            match index % 3 {
                0 => drop(played.pipeline.handle_bytes(now, &[1, 2, 3, 0], &mut tactpad::pipeline::NoProbe)),
                1 => played.pipeline.pause(now),
                _ => played.pipeline.retare(now),
            }
            played.rest(600);
            played.pipeline.resume();
        }
        played.rest(60_000);
    };
    assert_several_times_closer("troubled", both(troubled, 4));
}
