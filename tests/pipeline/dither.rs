//! A hand that trembles on a boundary, or about a threshold, changes nothing more than once.

use tactpad::pipeline::mapping::live::engine::Engine;
use tactpad::pipeline::mapping::live::intent::Intents;
use tactpad::pipeline::mapping::profile::{Force, Profile};
use tactpad::pipeline::mapping::read::check::{OutputChoice, read};
use tactpad::pipeline::mapping::read::shipped;
use tactpad::quantity::Contact;
use tactpad::time::StreamInstant;

/// A minute at 1 kHz.
const MINUTE_MS: u64 = 60_000;

fn profiles() -> impl Iterator<Item = (&'static str, Profile)> {
    shipped::names().filter_map(|name| Some((name, read(shipped::text(name)?, OutputChoice::AsWritten).0?)))
}

/// −1 to 1, at 5 and 7.3 Hz as hands do, with their beat.
fn tremor(ms: u64) -> f32 {
    let t_s = ms as f32 * 1e-3;
    0.5 * (libm::sinf(31.4 * t_s) + libm::sinf(45.9 * t_s))
}

/// How often what is held changes within a minute of such contacts.
fn changes(profile: &Profile, contact: impl Fn(f32) -> Contact) -> usize {
    let mut engine = Engine::new(profile.clone());
    let step = |ms: u64, engine: &mut Engine| {
        engine.step(StreamInstant::from_us(1_000 * ms), Some(&contact(tremor(ms))))
    };
    let mut held: Intents = step(0, &mut engine);
    let mut changes = 0;
    for ms in 1..MINUTE_MS {
        let levels = step(ms, &mut engine);
        changes += usize::from(levels != held);
        held = levels;
    }
    changes
}

/// At these places between the centre and the rim: 0 is just outside the centre's circle.
fn a_direction_changes_once_at_most(radii_mm: &[f32]) {
    let mut boundaries = 0;
    for (name, profile) in profiles() {
        let Some(dpad) = &profile.dpad else { continue };
        for radius_mm in radii_mm.iter().map(|radius_mm| radius_mm.max(dpad.centre_radius_mm + 1.0)) {
            // Boundaries of all modes lie at multiples of 7.5° or beside them.
            for angle_deg in (0..48).map(|step| 7.5 * step as f32) {
                let at = |tremor: f32| {
                    let angle = angle_deg.to_radians() + tremor / radius_mm;
                    let (x_mm, y_mm) = (radius_mm * libm::cosf(angle), radius_mm * libm::sinf(angle));
                    Contact { x_mm, y_mm, fz_n: 1.0, ..Contact::default() }
                };
                assert!(changes(&profile, at) <= 1, "{name}: {angle_deg}° at {radius_mm} mm");
                boundaries += 1;
            }
        }
    }
    assert!(boundaries > 100, "{boundaries}");
}

#[test]
fn one_millimetre_on_a_boundary_changes_a_direction_once_at_most() {
    a_direction_changes_once_at_most(&[0.0]);
}

#[test]
#[ignore = "proof: 15 s: farther out, too"]
fn one_millimetre_on_a_boundary_changes_a_direction_once_at_most_anywhere() {
    a_direction_changes_once_at_most(&[0.0, 15.0, 25.0]);
}

fn pushed(force: Force, n: f32) -> Contact {
    let none = Contact::default();
    match force {
        Force::Fz => Contact { fz_n: n, ..none },
        Force::FxPositive => Contact { fx_n: n, ..none },
        Force::FxNegative => Contact { fx_n: -n, ..none },
        Force::FyPositive => Contact { fy_n: n, ..none },
        Force::FyNegative => Contact { fy_n: -n, ..none },
    }
}

#[test]
fn a_tenth_of_a_newton_about_a_threshold_presses_once_at_most() {
    let mut thresholds = 0;
    for (name, profile) in profiles() {
        let profile = Profile { dpad: None, pointer: None, ..profile };
        for button in &profile.buttons {
            for about_n in [button.press_n, button.release_n] {
                let at = |tremor: f32| pushed(button.force, about_n + 0.1 * tremor);
                // Down, and for a long press once more.
                assert!(changes(&profile, at) <= 2, "{name}: {:?} about {about_n} N", button.force);
                thresholds += 1;
            }
        }
    }
    assert!(thresholds >= 8, "{thresholds}");
}
