//! The first measurements of a new pad, in stream time, on a virtual pad whose hands do what is asked.
#![allow(clippy::unwrap_used, reason = "a test that cannot set its scene fails")]

use firmware_proto::frame::Message;
use firmware_proto::link::{MessageReceiver, encode_message};
use firmware_proto::sample::{Sample, Status};
use firmware_proto::{CHANNELS, ENCODED_MAX};
use tactpad::firmware_proto;
use tactpad::lab::bench::guide::{BenchGuide, BenchStep};
use tactpad::lab::bench::report::BenchReport;
use tactpad::lab::bench::rest::InputFault;
use tactpad::lab::bench::touch::Touch;
use tactpad::numeric::random::SplitMix64;
use tactpad::pad::device::Device;
use tactpad::pad::device::behaviour::Mains;
use tactpad::pad::field::PadField;
use tactpad::pad::wiring::permutation::SignedPermutation;
use tactpad::pipeline::call::Call;
use tactpad::quantity::CHANNEL_NAMES;
use tactpad::time::HostInstant;
use tactpad::virtual_pad::firmware::VirtualPad;
use tactpad::virtual_pad::freehand::Calibrator;

const WEIGHT_G: f64 = 8.5;
/// No session lasts longer.
const LIMIT_US: u64 = 120_000_000;

/// The nominal pad with noise and offsets.
fn ordinary(random: &mut SplitMix64) -> Device {
    let mut device = Device::nominal();
    for offset_uv in device.modules.iter_mut().flat_map(|module| &mut module.offset_uv) {
        *offset_uv = 1_500.0 * f64::from(random.uniform());
    }
    for gain in device.modules.iter_mut().flat_map(|module| &mut module.gain) {
        *gain = 1.0 + 0.08 * f64::from(random.uniform());
    }
    device.behaviour.noise.additive_uv = [6.0; CHANNELS];
    device
}

fn any_wiring(random: &mut SplitMix64) -> SignedPermutation {
    let all = SignedPermutation::single_mistakes();
    let mut draw = || all[(random.next_bits() % all.len() as u64) as usize];
    let mistakes = [draw(), draw(), draw()];
    mistakes.into_iter().fold(SignedPermutation::IDENTITY, |wiring, mistake| mistake.after(&wiring))
}

/// A frame as a pad sends it whose channels are wired so.
fn sent(bytes: &[u8], wiring: &SignedPermutation) -> Vec<u8> {
    let mut receiver = MessageReceiver::new();
    let mut out = Vec::new();
    for message in bytes.iter().filter_map(|byte| receiver.push(*byte)) {
        let mut message = message.unwrap();
        if let Message::Sample(sample) = &mut message {
            *sample = wired(sample, wiring);
        }
        let mut frame = [0; ENCODED_MAX];
        let count = encode_message(&message, &mut frame);
        out.extend(&frame[..count]);
    }
    out
}

fn wired(sample: &Sample, wiring: &SignedPermutation) -> Sample {
    let (mut counts, mut status) = ([0; CHANNELS], Status(sample.status.0 & 0xfe00));
    for (channel, (input, is_reversed)) in wiring.sources().into_iter().enumerate() {
        counts[input] = if is_reversed { -sample.counts[channel] } else { sample.counts[channel] };
        if sample.status.is_out_of_range(channel) {
            status = status.with_out_of_range(input);
        }
    }
    Sample { counts, status, ..*sample }
}

/// What is found of a pad whose channels are sent so.
fn measured(device: &Device, wiring: &SignedPermutation, seed: u64) -> BenchReport {
    let (nominal, field) = (Device::nominal(), PadField::nominal());
    let mut pad = VirtualPad::of(Calibrator::rest(), device, &field, seed);
    pad.introduce();
    let mut hands = Calibrator::new(seed);
    let mut guide = BenchGuide::new(&nominal, &field, Some(WEIGHT_G));
    let (mut begun, mut bytes, mut is_taken_away) = (*guide.step(), Vec::new(), false);
    while *guide.step() != BenchStep::Done {
        let now_us = pad.due_us();
        assert!(now_us < LIMIT_US, "seed {seed}: {:?}", guide.step());
        bytes.clear();
        pad.emit(now_us, &mut bytes);
        let bytes = sent(&bytes, wiring);
        guide.apply(HostInstant::default().plus_us(now_us), Call::Bytes(&bytes));
        match (begun, *guide.step()) {
            (BenchStep::Weigh { .. }, BenchStep::Weigh { touch: Touch::Held { held_s } })
                if held_s > 2.0 && !is_taken_away =>
            {
                is_taken_away = true;
                pad.lay(hands.take_away());
            }
            (BenchStep::Weigh { .. }, BenchStep::Weigh { .. })
            | (BenchStep::Rest { .. }, BenchStep::Rest { .. }) => {}
            (_, step @ BenchStep::Weigh { .. }) => {
                pad.lay(hands.lay([0.0; 2], WEIGHT_G));
                begun = step;
            }
            (BenchStep::Do { deed: one, is_again: was, .. }, BenchStep::Do { deed, is_again, .. })
                if one == deed && was == is_again => {}
            (_, step @ BenchStep::Do { deed, .. }) => {
                let meant = deed.meant(&nominal);
                let place_mm = [meant.x_mm, meant.y_mm].map(f64::from);
                pad.play(hands.press_at(place_mm, [meant.fx_n, meant.fy_n].map(f64::from)));
                begun = step;
            }
            (_, step) => begun = step,
        }
    }
    BenchReport::of(&guide.result().unwrap(), Some(WEIGHT_G), &nominal, &field)
}

/// The wiring that mends one.
fn told(report: &BenchReport) -> SignedPermutation {
    report.wiring.as_ref().map_or(SignedPermutation::IDENTITY, |text| text.parse().unwrap())
}

#[test]
fn a_session_finds_noise_the_weight_and_the_wiring_of_pads_at_random() {
    let mut decided = 0;
    for seed in 0..24 {
        let mut random = SplitMix64::named(seed, "bench");
        let device = ordinary(&mut random);
        let wiring = if seed < 4 { SignedPermutation::IDENTITY } else { any_wiring(&mut random) };
        let report = measured(&device, &wiring, seed);
        for input in &report.inputs {
            assert!(
                (input.rest.noise_uv - 6.0).abs() < 0.5 && input.rest.hum.is_none(),
                "seed {seed}: {input:?}"
            );
            assert_eq!(input.rest.fault, None, "seed {seed}: {input:?}");
        }
        // What is told is true, whatever else stays open.
        for (channel, (input, is_reversed)) in report.channels.iter().zip(wiring.sources()) {
            let is_right = channel.sent_as.is_none_or(|it| it == CHANNEL_NAMES[input])
                && channel.is_reversed.is_none_or(|it| it == is_reversed);
            assert!(is_right, "seed {seed}: {channel:?}, sent {wiring:?}");
        }
        if report.open.is_empty() {
            decided += 1;
            assert_eq!(told(&report), wiring, "seed {seed}");
            assert_eq!(
                report.is_good(),
                wiring == SignedPermutation::IDENTITY,
                "seed {seed}: {:?}",
                report.faults
            );
            let weight = report.weight.as_ref().unwrap();
            let force_n = f64::from(weight.decoded.unwrap().fz_n);
            assert!((force_n / weight.force_n - 1.0).abs() < 0.2, "seed {seed}: {weight:?}");
            assert!(weight.resolution_n > 0.001 && weight.resolution_n < 0.02, "seed {seed}: {weight:?}");
        }
    }
    assert!(decided >= 22, "{decided} of 24 were decided");
}

#[test]
fn inputs_that_tell_nothing_are_named_and_the_others_measured() {
    for seed in 100..112 {
        let mut random = SplitMix64::named(seed, "bench");
        let mut device = ordinary(&mut random);
        let wiring = any_wiring(&mut random);
        let channel = (random.next_bits() % CHANNELS as u64) as usize;
        let fault = match seed % 4 {
            0 => {
                device.modules[channel / 3].gain[channel % 3] = 0.0;
                Some(InputFault::Silent)
            }
            1 => {
                device.modules[channel / 3].offset_uv[channel % 3] = 40_000.0;
                Some(InputFault::OutOfRange)
            }
            2 => {
                device.behaviour.noise.additive_uv[channel] = 2_000.0;
                Some(InputFault::Noisy)
            }
            _ => {
                let mut amplitude_uv = [0.0; CHANNELS];
                amplitude_uv[channel] = 25.0;
                device.behaviour.mains = Mains { amplitude_uv, frequency_hz: 50.0 };
                None
            }
        };
        let input = wiring.sources()[channel].0;
        let report = measured(&device, &wiring, seed);
        for (k, measured) in report.inputs.iter().enumerate() {
            let wanted = fault.filter(|_| k == input);
            assert_eq!(measured.rest.fault, wanted, "seed {seed}: {measured:?}");
        }
        assert!(
            report.faults.iter().any(|it| it.starts_with(CHANNEL_NAMES[input])),
            "seed {seed}: {:?}",
            report.faults
        );
        if fault.is_none() {
            let hum = report.inputs[input].rest.hum.unwrap();
            assert!(
                (hum.amplitude_uv - 25.0).abs() < 3.0 && hum.frequency_hz == 50.0,
                "seed {seed}: {hum:?}"
            );
        }
        for (channel, (input, is_reversed)) in report.channels.iter().zip(wiring.sources()) {
            let is_right = channel.sent_as.is_none_or(|it| it == CHANNEL_NAMES[input])
                && channel.is_reversed.is_none_or(|it| it == is_reversed);
            assert!(is_right, "seed {seed}: {channel:?}, sent {wiring:?}");
        }
    }
}
