//! What a profile costs: `cargo bench --bench mapping`. A contact may take 300 ns, a profile of 500 lines 5 ms.

use std::fmt::Write as _;
use std::hint::black_box;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use tactpad::pipeline::mapping::live::engine::Engine;
use tactpad::pipeline::mapping::profile::Profile;
use tactpad::pipeline::mapping::read::check::{self, OutputChoice};
use tactpad::pipeline::mapping::read::shipped;
use tactpad::quantity::Contact;
use tactpad::time::StreamInstant;
use tactpad::virtual_pad::script::Script;

const PLAYED_US: u64 = 20_000_000;

/// Twenty seconds of the scripted player at 1 kHz.
fn contacts(profile: &Profile) -> Vec<Option<Contact>> {
    let script = Script::for_profile(profile, PLAYED_US);
    let contact = |us| Some(script.contact_at(us)).filter(|contact| contact.fz_n >= 0.15);
    (0..PLAYED_US).step_by(1_000).map(contact).collect()
}

fn mapping(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("mapping a contact");
    for name in shipped::names() {
        let read = shipped::text(name).and_then(|text| check::read(text, OutputChoice::AsWritten).0);
        let Some(profile) = read else { panic!("{name} is in order") };
        let contacts = contacts(&profile);
        let (mut engine, mut at_us) = (Engine::new(profile), 0);
        group.throughput(Throughput::Elements(contacts.len() as u64));
        group.bench_function(name, |bencher| {
            bencher.iter(|| {
                let mut held = 0;
                for contact in &contacts {
                    at_us += 1_000;
                    held += engine.step(StreamInstant::from_us(at_us), black_box(contact.as_ref())).len();
                    engine.forget_verdicts();
                }
                held
            });
        });
    }
}

/// A profile with as many tables as there may be, and 500 lines.
fn long_profile() -> String {
    let mut text =
        String::from("schema = 1\nname = \"Long\"\noutput = \"keyboard\"\n[dpad]\nhysteresis_mm = 2.5\n");
    for number in 0..16 {
        let from_deg = number * 22;
        let _ = write!(
            text,
            "[[zone]]\nname = \"zone {number}\"\nfrom_deg = {from_deg}\nto_deg = {}\ninner_radius_mm = 10\n\
             hysteresis_deg = 4\nhysteresis_mm = 1.5\n[[program]]\nclass = \"Game {number}\"\n",
            from_deg + 20
        );
    }
    for number in 0..16 {
        let _ = write!(
            text,
            "# What button {number} does.\n[[button]]\nforce = \"fz\"\nzone = \"zone {number}\"\npress_n = 2.0\n\
             release_n = 1.4\ndwell_ms = 60\ndwell_mm = 4\nlong_press_ms = 500\ndouble_press_ms = 250\n\
             tap = {{ gamepad = \"BTN_SOUTH\", keyboard = \"KEY_F{}\" }}\n\
             double = {{ gamepad = \"BTN_EAST\", keyboard = \"KEY_LEFTCTRL+KEY_C\", toggle = true }}\n\
             hold = {{ gamepad = \"BTN_WEST\", keyboard = \"KEY_X\", turbo_ms = 120 }}\n",
            number + 1
        );
    }
    let lines = text.lines().count();
    text + &"# A line that says nothing to the program.\n".repeat(500 - lines)
}

fn loading(criterion: &mut Criterion) {
    let text = long_profile();
    assert_eq!(text.lines().count(), 500);
    let (profile, found) = check::read(&text, OutputChoice::AsWritten);
    assert!(profile.is_some(), "{found:?}");
    criterion.bench_function("loading a profile of 500 lines", |bencher| {
        bencher.iter(|| check::read(black_box(&text), OutputChoice::AsWritten));
    });
}

criterion_group!(benches, mapping, loading);
criterion_main!(benches);
