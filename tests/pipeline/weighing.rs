//! The one-weight check in virtual time: what a known weight tells, what it presses (nothing), and what ends it.
#![allow(clippy::unwrap_used, reason = "a test that cannot set its scene fails")]

use firmware_proto::ENCODED_MAX;
use firmware_proto::frame::Message;
use firmware_proto::identity::{Identity, SerialNumber};
use firmware_proto::link::encode_message;
use firmware_proto::sample::Status;
use tactpad::numeric::memory::{PlayOperator, Relaxation};
use tactpad::pad::field::PadField;
use tactpad::pad::weight::Weight;
use tactpad::pipeline::call::{Call, OwnedCall};
use tactpad::pipeline::capture::head::Head;
use tactpad::pipeline::capture::reader::CaptureReader;
use tactpad::pipeline::capture::writer::CaptureWriter;
use tactpad::pipeline::compensation::Compensation;
use tactpad::pipeline::control::OutputEvent;
use tactpad::pipeline::weighing::Progress;
use tactpad::pipeline::weighing::factor::Weighed;
use tactpad::pipeline::weighing::refusal::WeighError;
use tactpad::pipeline::{NoProbe, Phase, Pipeline, shipped};
use tactpad::quantity::{CHANNELS, Contact};
use tactpad::time::HostInstant;

use crate::rig::{Rig, frame, profile};

/// 200 g, far enough from the middle that it would be a direction.
const WEIGHT: Contact = Contact { x_mm: 15.0, y_mm: -2.0, fx_n: 0.0, fy_n: 0.0, fz_n: 1.961_33 };
const RIGHT: Contact = Contact { x_mm: 20.0, y_mm: 0.0, fx_n: 0.0, fy_n: 0.0, fz_n: 1.0 };
const NOTHING: Contact = Contact { x_mm: 0.0, y_mm: 0.0, fx_n: 0.0, fy_n: 0.0, fz_n: 0.0 };

/// What happens to a rig.
type Story = fn(&mut Rig);

fn weight() -> Weight {
    Weight::of_g(200.0).unwrap()
}

/// A rig at rest whose pad has this gain left.
fn aged(gain: f32) -> Rig {
    let mut rig = Rig::new(profile("super-mario"));
    rig.gain = gain;
    rig.noise = 300;
    rig.rest(500);
    rig
}

fn weigh(rig: &mut Rig) {
    rig.pipeline.weigh(rig.host(), weight());
    rig.collect();
}

fn outcome(rig: &Rig) -> Option<Result<Weighed, WeighError>> {
    match rig.pipeline.weighing()?.progress {
        Progress::Ended(outcome) => Some(outcome),
        Progress::Waiting | Progress::Resting => None,
    }
}

fn refused(rig: &Rig) -> Option<WeighError> {
    outcome(rig)?.err()
}

/// A rig that has weighed, and from which the weight was taken away.
fn weighed(gain: f32) -> Rig {
    let mut rig = aged(gain);
    weigh(&mut rig);
    rig.hold(WEIGHT, 2_300);
    rig.rest(300);
    assert!((rig.pipeline.gain() - f64::from(gain)).abs() < 0.002, "{:?}", outcome(&rig));
    rig
}

/// The force that a press of 1 N is taken for.
fn pressed_n(rig: &mut Rig) -> f32 {
    rig.hold(RIGHT, 200);
    let found_n = rig.pipeline.contact().map_or(0.0, |contact| contact.fz_n);
    rig.rest(200);
    found_n
}

#[test]
fn a_weight_tells_what_the_pad_has_lost_and_presses_nothing() {
    let mut rig = aged(0.81);
    assert!((pressed_n(&mut rig) - 0.81).abs() < 0.02);
    rig.hold(RIGHT, 200);
    rig.take_events();
    weigh(&mut rig);
    assert_eq!(rig.take_events(), ["ABS_HAT0X=0"], "what was held is released at once");
    rig.hold(RIGHT, 200);
    rig.rest(300);
    assert_eq!(rig.pipeline.phase(), Phase::Weighing);
    rig.hold(WEIGHT, 1_000);
    assert_eq!(rig.pipeline.weighing().unwrap().progress, Progress::Resting);
    assert_eq!(rig.pipeline.gain(), 1.0);
    rig.hold(WEIGHT, 1_000);
    let found = outcome(&rig).unwrap().unwrap();
    assert!((found.factor - 0.81).abs() < 0.002 && (found.x_mm - 15.0).abs() < 0.2, "{found:?}");
    assert_eq!(rig.pipeline.gain(), found.factor);
    rig.hold(WEIGHT, 5_000);
    assert_eq!(
        (rig.pipeline.phase(), rig.pipeline.contact()),
        (Phase::Weighing, None),
        "it still lies there"
    );
    assert_eq!(rig.take_events(), [""; 0], "a weight presses nothing");
    rig.rest(300);
    assert_eq!(rig.pipeline.phase(), Phase::Playing);
    assert!((pressed_n(&mut rig) - 1.0).abs() < 0.02);
    assert_eq!(rig.take_events(), ["ABS_HAT0X=1", "ABS_HAT0X=0"]);
}

#[test]
fn every_decoder_that_plays_is_mended_and_a_second_weight_finds_nothing_more() {
    for (name, decoder) in crate::decoders::each() {
        if decoder.cannot_play().is_some() {
            continue;
        }
        let mut rig = Rig::new(profile("super-mario"));
        rig.pipeline = Pipeline::new(decoder.clone(), profile("super-mario"));
        (rig.gain, rig.noise) = (0.9, 300);
        rig.rest(500);
        weigh(&mut rig);
        rig.hold(WEIGHT, 2_300);
        rig.rest(300);
        let first = outcome(&rig).unwrap().unwrap_or_else(|error| panic!("{name}: {error}")).factor;
        // A fresh pad's forces are not exact with any of them: what is mended is this weight's.
        let fresh_n = decoder.decode(&PadField::nominal().signals.strain_uv(&WEIGHT)).fz_n;
        let wanted = 0.9 * f64::from(fresh_n) / weight().force_n();
        // Not all of them are linear in the force.
        assert!((first / wanted - 1.0).abs() < 0.02, "{name}: {first}, not {wanted}");
        weigh(&mut rig);
        rig.hold(WEIGHT, 2_300);
        let second = outcome(&rig).unwrap().unwrap().factor;
        assert!((second / first - 1.0).abs() < 0.02, "{name}: {first}, then {second}");
    }
}

#[test]
fn friction_and_creep_follow_the_gain() {
    let plays = [PlayOperator { threshold: 600.0, share: 0.05 }; CHANNELS];
    let compensation = Compensation {
        hysteresis: [plays, [PlayOperator::NONE; CHANNELS]],
        creep: Relaxation { time_s: 8.0, share: 0.01 },
        ..Compensation::NONE
    };
    let mut rig = Rig::new(profile("super-mario"));
    rig.pipeline = Pipeline::new(shipped::decoder().compensated_by(compensation), profile("super-mario"));
    rig.gain = 0.8;
    rig.rest(500);
    (0..5).for_each(|_| {
        rig.press(0.0, 0.0, 4.0, 300);
        rig.rest(300);
    });
    let before = rig.pipeline.strain().copied().unwrap();
    weigh(&mut rig);
    rig.hold(WEIGHT, 2_300);
    rig.rest(1);
    assert!(outcome(&rig).unwrap().is_ok());
    rig.rest(1_000);
    let after = rig.pipeline.strain().copied().unwrap();
    // The untouched pad stays where it is: what its states make it read has not jumped.
    let off_uv = before.uv.iter().zip(after.uv).map(|(one, other)| (one - other).abs()).fold(0.0, f32::max);
    assert!(off_uv < 15.0, "{off_uv} µV");
    assert!(!rig.pipeline.warning().is_some_and(|warning| warning.lasts()));
}

#[test]
fn where_no_weight_rests_it_gives_up_and_plays_on() {
    let moving = |rig: &mut Rig| {
        for step in 0..110_u16 {
            rig.hold(Contact { fz_n: 1.0 + 0.3 * f32::from(step % 4), ..WEIGHT }, 100);
        }
    };
    let cases: [(&str, Story, WeighError); 2] = [
        ("nothing", |rig| rig.rest(9_990), WeighError::NothingCame),
        (
            "taps",
            |rig| {
                (0..20).for_each(|_| {
                    rig.hold(WEIGHT, 300);
                    rig.rest(200);
                });
            },
            WeighError::NotSteady,
        ),
    ];
    for (what, play, error) in cases {
        let mut rig = aged(0.9);
        weigh(&mut rig);
        play(&mut rig);
        assert_eq!(rig.take_events(), [""; 0], "{what}");
        rig.rest(100);
        assert_eq!((refused(&rig), rig.pipeline.gain()), (Some(error), 1.0), "{what}");
        assert!((pressed_n(&mut rig) - 0.9).abs() < 0.02, "{what}");
        assert_eq!(rig.take_events(), ["ABS_HAT0X=1", "ABS_HAT0X=0"], "{what}");
    }
    let mut rig = aged(0.9);
    weigh(&mut rig);
    moving(&mut rig);
    assert_eq!(refused(&rig), Some(WeighError::NotSteady));
    assert_eq!((rig.take_events(), rig.is_neutral()), (vec![], true), "it still lies there");
}

#[test]
fn a_load_that_comes_in_time_may_rest_beyond_it() {
    let mut rig = aged(0.9);
    weigh(&mut rig);
    rig.rest(9_600);
    rig.hold(WEIGHT, 2_300);
    assert!(outcome(&rig).unwrap().is_ok());
}

#[test]
fn what_is_not_the_weight_is_refused_and_changes_nothing() {
    let heavy = Contact { fz_n: 2.5 * WEIGHT.fz_n, x_mm: 2.0, ..WEIGHT };
    let light = Contact { fz_n: 0.4 * WEIGHT.fz_n, ..WEIGHT };
    let off = Contact { x_mm: 28.9, ..WEIGHT };
    for (load, wanted) in [(heavy, "check the weight"), (light, "check the weight"), (off, "farther inwards")]
    {
        let mut rig = aged(1.0);
        weigh(&mut rig);
        rig.hold(load, 2_300);
        let said = refused(&rig).map(|error| error.to_string()).unwrap_or_default();
        assert!(said.contains(wanted), "{load:?}: {said}");
        assert_eq!(rig.pipeline.gain(), 1.0);
    }
    // Half the weight on each of two feet. The decoder of a calibrated pad notices that.
    let noise =
        tactpad::pipeline::contact::uncertainty::Noise::of_channels([5.0; CHANNELS], [0.02; CHANNELS]);
    let field = PadField::nominal().signals;
    let inverse = tactpad::pipeline::contact::inverse::Inverse::new(field.clone(), noise);
    let mut rig = Rig::new(profile("super-mario"));
    rig.pipeline = Pipeline::new(inverse.into(), profile("super-mario"));
    rig.rest(500);
    weigh(&mut rig);
    let other = Contact { x_mm: -15.0, y_mm: 6.0, fz_n: 0.98, ..NOTHING };
    for _ in 0..2_300 {
        let mut sample = rig.sample(&Contact { fz_n: 0.98, ..WEIGHT });
        let more = field.strain_uv(&other).uv.map(|uv| (uv / 0.01) as i32);
        sample.counts.iter_mut().zip(more).for_each(|(count, more)| *count += more);
        rig.send(&sample);
    }
    assert_eq!(refused(&rig), Some(WeighError::NotOneLoad));
}

#[test]
fn one_fault_begins_anew_and_two_end_it() {
    let faulty = |rig: &mut Rig, times: usize| {
        weigh(rig);
        rig.hold(WEIGHT, 1_000);
        for _ in 0..times {
            rig.lose();
            rig.hold(WEIGHT, 200);
        }
        rig.hold(WEIGHT, 2_000);
    };
    let mut rig = aged(0.9);
    faulty(&mut rig, 1);
    assert!(outcome(&rig).unwrap().is_ok());
    let mut rig = aged(0.9);
    faulty(&mut rig, 2);
    assert_eq!(refused(&rig), Some(WeighError::Faults));
    assert!(rig.is_neutral(), "what lies there is no press");
    let mut rig = aged(0.9);
    weigh(&mut rig);
    rig.hold(WEIGHT, 1_000);
    for _ in 0..3 {
        let mut sample = rig.sample(&WEIGHT);
        sample.status = Status::OK.with_supply_fault();
        rig.send(&sample);
    }
    assert_eq!(refused(&rig), Some(WeighError::Faults));
}

#[test]
fn the_factor_belongs_to_the_pad() {
    let mut rig = weighed(0.9);
    let factor = rig.pipeline.gain();
    rig.pipeline.retare(rig.host());
    rig.rest(500);
    assert_eq!(rig.pipeline.gain(), factor, "another zero is no other pad");
    rig.pipeline.pause(rig.host());
    rig.pipeline.resume();
    rig.silence(300);
    rig.rest(300);
    assert_eq!(rig.pipeline.gain(), factor, "nor are a pause and a silence");
    assert!((pressed_n(&mut rig) - 1.0).abs() < 0.02);
    rig.pipeline.handle_unplugged(rig.host());
    rig.collect();
    rig.rest(500);
    assert_eq!(rig.pipeline.gain(), 1.0, "the next pad may be another one");
    assert!((pressed_n(&mut rig) - 0.9).abs() < 0.02);
}

fn identify(rig: &mut Rig, name: &str) {
    let mut bytes = [0; ENCODED_MAX];
    let identity = Identity {
        serial_number: SerialNumber::from_ascii(name).unwrap(),
        channels: 9,
        count_bits: 24,
        rate_hz: 1_000,
        picovolts_per_count: 10_000,
    };
    let length = encode_message(&Message::Identity(identity), &mut bytes);
    rig.bytes(&bytes[..length]);
}

#[test]
fn a_pad_of_another_name_on_the_same_line_has_its_own_gain_and_zero() {
    let mut rig = aged(0.9);
    identify(&mut rig, "A-1");
    rig.rest(300);
    weigh(&mut rig);
    rig.hold(WEIGHT, 2_300);
    rig.rest(300);
    let factor = rig.pipeline.gain();
    assert!((factor - 0.9).abs() < 0.002);
    identify(&mut rig, "A-1");
    assert_eq!(rig.pipeline.gain(), factor);
    identify(&mut rig, "A-2");
    assert_eq!(rig.pipeline.gain(), 1.0);
    rig.rest(1);
    assert_eq!(rig.pipeline.phase(), Phase::Taring);
}

#[test]
fn who_leaves_or_tares_ends_a_weighing_and_a_pause_does_not() {
    let interrupted: [Story; 3] = [
        |rig| rig.pipeline.handle_unplugged(rig.host()),
        |rig| rig.pipeline.retare(rig.host()),
        |rig| rig.silence(200),
    ];
    for interrupt in interrupted {
        let mut rig = aged(0.9);
        weigh(&mut rig);
        rig.hold(WEIGHT, 1_000);
        interrupt(&mut rig);
        assert_eq!(refused(&rig), Some(WeighError::Interrupted));
    }
    let mut rig = aged(0.9);
    rig.pipeline.pause(rig.host());
    weigh(&mut rig);
    rig.hold(WEIGHT, 2_300);
    assert!(outcome(&rig).unwrap().is_ok());
    rig.pipeline.resume();
    rig.hold(WEIGHT, 300);
    assert_eq!(rig.take_events(), [""; 0]);
}

#[test]
fn without_a_pad_or_a_zero_nothing_is_weighed() {
    let mut rig = Rig::new(profile("super-mario"));
    weigh(&mut rig);
    assert_eq!(refused(&rig), Some(WeighError::NoPad));
    // A pad that is never left alone: it moves all the time.
    weigh_on_a_restless_pad();
}

fn weigh_on_a_restless_pad() {
    let mut rig = Rig::new(profile("super-mario"));
    rig.noise = 3_000_000;
    rig.rest(300);
    weigh(&mut rig);
    rig.rest(10_100);
    assert_eq!(refused(&rig), Some(WeighError::NoZero));
}

#[test]
fn nothing_allocates_while_it_weighs() {
    let mut rig = aged(0.9);
    weigh(&mut rig);
    let frames: Vec<Vec<u8>> = (0..2_500).map(|_| frame(&rig.sample(&WEIGHT))).collect();
    let mut pipeline = rig.pipeline.clone();
    let allocated = allocation_counter::measure(|| {
        for (at, frame) in frames.iter().enumerate() {
            let now = HostInstant::default().plus_us(500_000 + 1_000 * at as u64);
            let _ = pipeline.handle_bytes(now, frame, &mut NoProbe);
        }
    });
    assert!((pipeline.gain() - 0.9).abs() < 0.002);
    assert_eq!(allocated.count_total, 0);
}

/// Makes calls, keeps their events and what the pad's gain came to.
fn played<'a>(calls: impl Iterator<Item = (HostInstant, Call<'a>)>) -> (Vec<OutputEvent>, f64) {
    let mut pipeline = Pipeline::new(shipped::decoder(), profile("super-mario"));
    let mut events = Vec::new();
    for (now, call) in calls {
        let mut left = Some(call);
        while let Some(call) = left {
            left = pipeline.apply(now, call, &mut NoProbe);
            events.extend_from_slice(pipeline.events());
        }
    }
    (events, pipeline.gain())
}

#[test]
fn a_capture_has_the_weighing_and_replays_to_the_same_events() {
    let mut rig = Rig::new(profile("super-mario"));
    (rig.gain, rig.noise) = (0.85, 300);
    let mut calls: Vec<(HostInstant, OwnedCall)> = Vec::new();
    for (contact, ms) in
        [(NOTHING, 500), (RIGHT, 300), (WEIGHT, 2_600), (NOTHING, 300), (RIGHT, 300), (NOTHING, 200)]
    {
        for _ in 0..ms {
            let sample = rig.sample(&contact);
            calls.push((rig.host(), Call::Bytes(&frame(&sample)).into()));
        }
        if contact == RIGHT && calls.len() < 1_000 {
            calls.push((rig.host(), Call::Weigh(weight()).into()));
        }
    }
    let live = played(calls.iter().map(|(now, call)| (*now, call.as_call())));
    assert!((live.1 - 0.85).abs() < 0.002 && live.0.len() == 4, "{live:?}");

    let mut file = Vec::new();
    let mut writer = CaptureWriter::begin(&mut file, HostInstant::default(), &Head::default()).unwrap();
    calls.iter().for_each(|(now, call)| writer.write(*now, call.as_call()).unwrap());
    let mut reader = CaptureReader::new(&file[..]).unwrap();
    let mut read = Vec::new();
    while let Some(call) = reader.next_call() {
        let (now, call) = call.unwrap();
        read.push((now, OwnedCall::from(call)));
    }
    assert_eq!(read, calls);
    let again = played(read.iter().map(|(now, call)| (*now, call.as_call())));
    assert_eq!((again.0, again.1.to_bits()), (live.0, live.1.to_bits()));
}
