//! A pad that warms in play: the pipeline follows what its decoder knows of the temperature.
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a test may stop at what it did not expect")]

use crate::played::Played;
use tactpad::pad::device::Device;
use tactpad::pad::field::PadField;
use tactpad::pipeline::call::Call;
use tactpad::pipeline::capture::head::Head;
use tactpad::pipeline::capture::reader::CaptureReader;
use tactpad::pipeline::capture::writer::CaptureWriter;
use tactpad::pipeline::compensation::Compensation;
use tactpad::pipeline::compensation::thermal::Thermal;
use tactpad::pipeline::contact::Decoder;
use tactpad::pipeline::contact::inverse::Inverse;
use tactpad::pipeline::contact::uncertainty::Noise;
use tactpad::pipeline::control::OutputEvent;
use tactpad::pipeline::{NoProbe, Pipeline};
use tactpad::quantity::{CHANNELS, Contact};
use tactpad::time::HostInstant;

/// Channels differ: what they have in common reads as a force, the rest as another place.
const THERMAL: Thermal = Thermal {
    reference_c: 25.0,
    zero_uv_per_c: [30.0, -40.0, 60.0, 35.0, -30.0, 50.0, 45.0, -35.0, 55.0],
    gain_per_c: [-5e-4; CHANNELS],
};

const FINGER: Contact = Contact { x_mm: 6.0, y_mm: -9.0, fx_n: 0.2, fy_n: 0.1, fz_n: 2.0 };

fn decoder(thermal: Option<Thermal>) -> Decoder {
    let noise = Noise::of_channels([3.0; CHANNELS], [0.002; CHANNELS]);
    let compensation = Compensation { thermal, ..Compensation::NONE };
    Decoder::from(Inverse::new(PadField::nominal().signals, noise)).compensated_by(compensation)
}

/// A pad that was tared at 25 °C.
fn played(thermal: Option<Thermal>) -> Played {
    let mut device = Device::nominal();
    device.behaviour.noise.additive_uv = [3.0; CHANNELS];
    let Thermal { reference_c, zero_uv_per_c, gain_per_c } = THERMAL;
    let own = &mut device.behaviour.thermal;
    (own.reference_c, own.zero_uv_per_c, own.gain_per_c) = (reference_c, zero_uv_per_c, gain_per_c);
    let mut played = Played::new(decoder(thermal), &device, &PadField::nominal(), 1);
    played.rest(600);
    played
}

/// Holds the finger while the pad changes evenly by so much; the decoded contact, as the mean of each tenth of a second.
fn held(played: &mut Played, ms: u64, change_c: f64) -> Vec<[f64; 5]> {
    let tenth = |played: &mut Played| {
        let mut mean = [0.0; 5];
        for _ in 0..100 {
            played.around.temperature_c += change_c / ms as f64;
            played.millisecond(&[FINGER]);
            let found = numbers(played.pipeline.contact().unwrap());
            mean.iter_mut().zip(found).for_each(|(mean, number)| *mean += number / 100.0);
        }
        mean
    };
    (0..ms / 100).map(|_| tenth(played)).collect()
}

fn numbers(contact: &Contact) -> [f64; 5] {
    let Contact { x_mm, y_mm, fx_n, fy_n, fz_n } = *contact;
    [x_mm, y_mm, fx_n, fy_n, fz_n].map(f64::from)
}

/// The largest errors of place (mm) and Fz (N).
fn worst(contacts: &[[f64; 5]]) -> [f64; 2] {
    let wanted = numbers(&FINGER);
    contacts.iter().fold([0.0; 2], |[mm, n]: [f64; 2], found| {
        let off_mm = libm::hypot(found[0] - wanted[0], found[1] - wanted[1]);
        [mm.max(off_mm), n.max((found[4] - wanted[4]).abs())]
    })
}

/// A finger that stays: the first moment, until the filter shows it.
fn begin(played: &mut Played) {
    (0..100).for_each(|_| played.millisecond(&[FINGER]));
}

/// The worst of a hold in whose first 20 s the pad warms by 5 °C, and of its end; and whether the pad is free after the lift.
fn warmed(thermal: Option<Thermal>) -> ([f64; 2], [f64; 2], bool) {
    let mut played = played(thermal);
    begin(&mut played);
    let mut contacts = held(&mut played, 20_000, 5.0);
    contacts.extend(held(&mut played, 10_000, 0.0));
    played.rest(100);
    (worst(&contacts), worst(&contacts[250..]), played.pipeline.contact().is_none())
}

#[test]
fn a_pad_that_warms_under_a_finger_keeps_its_zero() {
    let [known, plain] = [Some(THERMAL), None].map(warmed);
    println!("5 °C, mm and N: worst, at the end, free after: {known:?}; without {plain:?}");
    let ([mm, n], [end_mm, end_n], is_free) = known;
    // On the way there the thermometer is a second late: a quarter of a degree.
    assert!(mm < 0.15 && n < 0.02, "{mm} mm, {n} N");
    assert!(end_mm < 0.03 && end_n < 0.005 && is_free, "{end_mm} mm, {end_n} N, {is_free}");
    let ([plain_mm, plain_n], _, plain_is_free) = plain;
    assert!(plain_mm > 1.0 && plain_n > 0.2 && !plain_is_free, "{plain_mm} mm, {plain_n} N, {plain_is_free}");
}

#[test]
fn a_zero_taken_cold_holds_on_a_warm_pad() {
    // Nothing is heard for two minutes, and play goes on at once.
    let back = |thermal| {
        let mut played = played(thermal);
        played.now_ms += 120_000;
        played.around.temperature_c = 40.0;
        played.rest(60);
        played
    };
    assert!(back(None).pipeline.contact().is_some(), "without it the pad seems touched");
    let mut played = back(Some(THERMAL));
    assert!(played.pipeline.contact().is_none(), "{:?}", played.pipeline.contact());
    let [mm, n] = worst(&[numbers(&played.press(&[FINGER], 300).unwrap())]);
    assert!(mm < 0.1 && n < 0.01, "{mm} mm, {n} N");
}

#[test]
fn a_thermometer_that_fails_under_a_finger_changes_nothing() {
    let failures: [fn(f64) -> Option<f64>; 4] =
        [|_| None, |_| Some(85.0), |_| Some(-327.0), |temp_c| Some(temp_c - 20.0)];
    for (index, failure) in failures.into_iter().enumerate() {
        let mut played = played(Some(THERMAL));
        begin(&mut played);
        let mut contacts = held(&mut played, 1_000, 0.0);
        for told_c in [failure, Some] {
            played.told_c = told_c;
            contacts.extend(held(&mut played, 3_000, 0.0));
        }
        let [mm, n] = worst(&contacts);
        assert!(mm < 0.1 && n < 0.01, "{index}: {mm} mm, {n} N");
    }
}

#[test]
fn a_capture_of_a_pad_that_warms_replays_to_the_same_events() {
    let mut played = played(Some(THERMAL));
    played.pipeline = Pipeline::new(decoder(Some(THERMAL)), played.pipeline.profile().clone());
    let (mut capture, mut live) = (Vec::new(), Vec::new());
    let head = Head { decoder: decoder(Some(THERMAL)).to_bytes("warm"), profile: None };
    assert!(head.decoder.is_some());
    let mut writer = CaptureWriter::begin(&mut capture, HostInstant::default(), &head).unwrap();
    for ms in 0..6_000 {
        played.around.temperature_c += 1e-3;
        let contacts = if ms % 1_000 < 600 { &[][..] } else { &[FINGER][..] };
        let frame = played.frame(contacts);
        let now = HostInstant::default().plus_us(1_000 * played.now_ms);
        writer.write(now, Call::Bytes(&frame)).unwrap();
        apply(&mut played.pipeline, now, Call::Bytes(&frame), &mut live);
    }
    drop(writer);
    assert!(live.len() >= 10, "{} groups", live.len());
    assert_eq!(replayed(&capture, &played.pipeline), live);
}

type Groups = Vec<(HostInstant, Vec<OutputEvent>)>;

fn apply(pipeline: &mut Pipeline, now: HostInstant, call: Call<'_>, groups: &mut Groups) {
    let mut left = Some(call);
    while let Some(call) = left {
        left = pipeline.apply(now, call, &mut NoProbe);
        if !pipeline.events().is_empty() {
            groups.push((now, pipeline.events().to_vec()));
        }
    }
}

/// What a capture's own decoder makes of its calls, with the profile of `like`.
fn replayed(capture: &[u8], like: &Pipeline) -> Groups {
    let mut capture = CaptureReader::new(capture).unwrap();
    let mut pipeline = Pipeline::new(capture.head().read_decoder().unwrap(), like.profile().clone());
    let mut groups = Groups::new();
    while let Some(call) = capture.next_call() {
        let (now, call) = call.unwrap();
        apply(&mut pipeline, now, call, &mut groups);
    }
    groups
}
