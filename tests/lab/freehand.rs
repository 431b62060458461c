//! Hands that play freely: what is recorded of them, decoded again, is what they did.
#![allow(clippy::unwrap_used, reason = "a test that cannot set its scene fails")]
#![allow(clippy::print_stdout, reason = "the figures are what one looks for")]

use tactpad::pad::device::Device;
use tactpad::pad::field::PadField;
use tactpad::pad::twin::life::Life;
use tactpad::pipeline::capture::head::Head;
use tactpad::pipeline::capture::reader::CaptureReader;
use tactpad::pipeline::capture::writer::CaptureWriter;
use tactpad::pipeline::mapping::read::ReadProfile;
use tactpad::pipeline::mapping::read::check::OutputChoice;
use tactpad::pipeline::mapping::read::shipped as profiles;
use tactpad::pipeline::{NoProbe, Pipeline, shipped};
use tactpad::quantity::Contact;
use tactpad::time::HostInstant;
use tactpad::virtual_pad::firmware::VirtualPad;
use tactpad::virtual_pad::freehand::{Weights, play, presses};
use tactpad::virtual_pad::recording::{Recorded, record, record_weights};
use tactpad::virtual_pad::script::Script;

const DURATION_US: u64 = 40_000_000;
/// Lighter touches come and go.
const TOUCH_N: f32 = 0.3;

fn profile() -> ReadProfile {
    ReadProfile::read(profiles::text("super-mario").unwrap(), OutputChoice::AsWritten).0.unwrap()
}

/// A capture of a pad without imperfections, and the true contact of each sample.
fn recording(script: Script, weights: Option<&Weights>) -> (Vec<u8>, Vec<Contact>, Recorded) {
    let (device, field) = (Device::nominal(), PadField::nominal());
    let mut pad = VirtualPad::going_on(script, &device, &field, Life::new(&device, 4), 4);
    let head = Head { decoder: shipped::bytes("inverse").map(Into::into), profile: Some(profile()) };
    let mut capture = CaptureWriter::begin(Vec::new(), HostInstant::default(), &head).unwrap();
    let mut truth = Vec::new();
    pad.introduce();
    let mut see = |_: u64, contact: &Contact| {
        truth.push(*contact);
        Ok(())
    };
    let recorded = record(&mut pad, DURATION_US, &mut capture, &mut see).unwrap();
    if let Some(weights) = weights {
        let (laid, placements) = record_weights(&mut pad, weights, &mut capture, &mut see).unwrap();
        assert_eq!((laid.touches, placements[0].at_us), (5, DURATION_US + weights.placements[0].at_us));
    }
    assert_eq!(pad.into_life().around.cycles, (recorded.touches + weights.map_or(0, |_| 5)) as f64);
    (std::mem::take(capture.get_mut()), truth, recorded)
}

/// The decoded contact of each sample.
fn decoded(capture: &[u8]) -> Vec<Option<Contact>> {
    let mut reader = CaptureReader::new(capture).unwrap();
    let decoder = reader.head().read_decoder().unwrap();
    let mut pipeline = Pipeline::new(decoder, profile().profile().clone());
    let mut contacts = Vec::new();
    while let Some(call) = reader.next_call() {
        let (now, call) = call.unwrap();
        let mut left = Some(call);
        while let Some(call) = left {
            left = pipeline.apply(now, call, &mut NoProbe);
        }
        contacts.push(pipeline.contact().copied());
    }
    assert_eq!((pipeline.health().frames_lost, pipeline.health().samples), (0, contacts.len() as u64));
    contacts
}

#[test]
fn what_hands_do_is_decoded_as_they_did_it() {
    let scripts = [
        ("play", play(profile().profile(), DURATION_US, 26.0, 4)),
        ("presses", presses(DURATION_US, 26.0, 4)),
    ];
    for (name, script) in scripts {
        let (capture, truth, recorded) = recording(script.clone(), None);
        let contacts = decoded(&capture);
        assert_eq!((contacts.len(), truth.len(), recorded.samples), (40_000, 40_000, 40_000));
        assert!(
            truth[..1_000].iter().all(|contact| contact.fz_n == 0.0),
            "{name}: the first second is untouched"
        );
        let (mut sum_mm, mut count, mut missed) = (0.0, 0_u32, 0_u32);
        // The profile's mean of six samples is two and a half samples late.
        for (found, truth) in contacts[3..].iter().zip(&truth).filter(|(_, truth)| truth.fz_n > TOUCH_N) {
            match found {
                Some(found) => {
                    sum_mm += libm::hypotf(found.x_mm - truth.x_mm, found.y_mm - truth.y_mm);
                    count += 1;
                }
                None => missed += 1,
            }
        }
        let mean_mm = sum_mm / count as f32;
        println!(
            "{name}: {} touches, {mean_mm:.3} mm, {missed} of {count} samples without a contact",
            recorded.touches
        );
        assert!((15..80).contains(&recorded.touches), "{name}: {}", recorded.touches);
        assert!(mean_mm < 0.5 && missed < count / 50, "{name}: {mean_mm} mm, {missed} of {count}");
        assert_eq!(recording(script, None).0, capture, "{name}: the same bytes");
    }
}

#[test]
fn a_weight_rests_on_its_marks_with_its_force() {
    let weights = Weights::new(200.0, 4);
    let (capture, truth, _) = recording(presses(DURATION_US, 26.0, 4), Some(&weights));
    let contacts = decoded(&capture);
    for placement in &weights.placements {
        let at_ms = ((DURATION_US + placement.at_us) / 1_000) as usize;
        for ms in [at_ms - 950, at_ms, at_ms + 950] {
            let [x_mm, y_mm] = placement.mark_mm;
            for contact in [truth[ms], contacts[ms].unwrap()] {
                assert!(
                    libm::hypotf(contact.x_mm - x_mm, contact.y_mm - y_mm) < 0.8,
                    "{placement:?}: {contact:?}"
                );
                assert!((contact.fz_n - 1.961).abs() < 0.02, "{placement:?}: {contact:?}");
            }
        }
        assert_eq!(contacts[at_ms - 1_500], None, "lifted before");
    }
}
