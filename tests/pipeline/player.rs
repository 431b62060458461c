//! The scripted player means what the bridge understands: its own list of events, made from the gestures' meaning,
//! against the events of the pipeline, on many noisy pads.

use firmware_proto::ENCODED_MAX;
use firmware_proto::command::Command;
use firmware_proto::link::encode_command;
use tactpad::pipeline::control::{Code, OutputDevice};
use tactpad::pipeline::mapping::profile::Profile;
use tactpad::pipeline::mapping::read::check::{self, OutputChoice};
use tactpad::pipeline::mapping::read::shipped;
use tactpad::pipeline::{NoProbe, Pipeline};
use tactpad::time::HostInstant;
use tactpad::virtual_pad::firmware::VirtualPad;
use tactpad::virtual_pad::script::Script;

const DURATION_US: u64 = 10_000_000;

/// The events of a noisy pad that plays the script, and how far the pointer went: right, left, down, up.
fn play(profile: Profile, script: Script, seed: u64) -> (Vec<(OutputDevice, Code, i32)>, [i32; 4]) {
    let mut pad = VirtualPad::new(script, seed);
    let mut pipeline = Pipeline::new(tactpad::pipeline::shipped::decoder(), profile);
    let mut question = [0; ENCODED_MAX];
    let length = encode_command(&Command::Identify, &mut question);
    pad.receive(&question[..length]);
    let (mut seen, mut ways) = (Vec::new(), [0; 4]);
    let mut bytes = Vec::new();
    for ms in 1..=DURATION_US / 1_000 {
        bytes.clear();
        pad.emit(ms * 1_000, &mut bytes);
        let mut rest = &bytes[..];
        while !rest.is_empty() {
            let now = HostInstant::default().plus_us(ms * 1_000);
            let taken = pipeline.handle_bytes(now, rest, &mut NoProbe);
            for event in pipeline.events() {
                match event.code {
                    Code::Relative(axis) => {
                        ways[2 * usize::from(axis) + usize::from(event.value < 0)] += event.value.abs();
                    }
                    Code::Key(_) | Code::Axis(_) => seen.push((event.device, event.code, event.value)),
                }
            }
            rest = &rest[taken..];
        }
    }
    (seen, ways)
}

/// On noisy pads of these seeds.
fn what_is_meant_comes_out(seeds: u64) {
    for name in shipped::names() {
        for output in [OutputChoice::AsWritten, OutputChoice::Keyboard] {
            let read = shipped::text(name).and_then(|text| check::read(text, output).0);
            let Some(profile) = read else { panic!("{name} is in order") };
            let script = Script::for_profile(&profile, DURATION_US);
            if script.contacts() == 0 {
                // Its directions want nearly as much force as its buttons: a person's weight, which no finger holds so well.
                assert_eq!(name, "board-standing");
                continue;
            }
            // On the way of the pointer there is no event to expect, only at its buttons.
            let events = if profile.pointer.is_some() || profile.dpad.is_none() { 8 } else { 20 };
            let contacts = if profile.access.bounce_us > 0 { 6 } else { 10 };
            assert!(script.contacts() >= contacts && script.expected().len() >= events, "{name}");
            for seed in 0..seeds {
                let (seen, ways) = play(profile.clone(), script.clone(), seed);
                // At 16 mm the pointer has 268 counts per second, and the finger stays there for a tenth of one.
                let steered = ways.iter().all(|&counts| counts > 26);
                assert_eq!(steered, profile.pointer.is_some(), "{name}, seed {seed}: {ways:?}");
                assert_eq!(steered, ways != [0; 4], "{name}, seed {seed}: {ways:?}");
                assert_eq!(seen, script.expected(), "{name}, {output:?}, seed {seed}");
            }
        }
    }
}

#[test]
fn what_the_player_means_is_what_comes_out() {
    what_is_meant_comes_out(2);
}

#[test]
#[ignore = "proof: 20 s: each profile on twelve noisy pads instead of two"]
fn what_the_player_means_is_what_comes_out_of_many_pads() {
    what_is_meant_comes_out(12);
}

/// Every kind of press that a profile may have, each where nothing else is pressed by the same force.
const LIVELY: &str = r#"
schema = 1
name = "Lively"
output = "gamepad"
[dpad]
mode = "8way"
centre_radius_mm = 10
[[zone]]
name = "middle"
outer_radius_mm = 6
[[zone]]
name = "ring"
inner_radius_mm = 12
[[button]]
zone = "middle"
force = "fz"
press_n = 1.2
light = { gamepad = "BTN_SOUTH", keyboard = "KEY_A" }
hard = { gamepad = "BTN_EAST", keyboard = "KEY_B" }
hard_press_n = 3.0
skip = "may"
[[button]]
zone = "ring"
force = "fz"
press_n = 1.5
hair_n = 0.25
out = { gamepad = "BTN_NORTH", keyboard = "KEY_C" }
[[button]]
force = "fx"
press_n = 0.8
out = { gamepad = "BTN_WEST", keyboard = "KEY_D", toggle = true }
[[button]]
force = "-fx"
press_n = 0.8
tap = { gamepad = "BTN_TL", keyboard = "KEY_E", sticky = true }
[[button]]
force = "fy"
press_n = 0.8
out = { gamepad = "BTN_TR", keyboard = "KEY_F", turbo_ms = 120 }
[[button]]
force = "-fy"
press_n = 0.8
dwell_ms = 300
tap = { gamepad = "BTN_START", keyboard = "KEY_G" }
hold = { gamepad = "BTN_SELECT", keyboard = "KEY_H" }
"#;

/// Double presses, and one of two stages that exclude each other.
const DOUBLE: &str = r#"
schema = 1
name = "Double"
output = "gamepad"
[[button]]
force = "fz"
press_n = 1.2
light = { gamepad = "BTN_SOUTH", keyboard = "KEY_A" }
hard = { gamepad = "BTN_EAST", keyboard = "KEY_B" }
hard_press_n = 3.0
skip = "must"
[[button]]
force = "fy"
press_n = 0.8
tap = { gamepad = "BTN_NORTH", keyboard = "KEY_C" }
double = { gamepad = "BTN_WEST", keyboard = "KEY_D" }
hold = { gamepad = "BTN_TL", keyboard = "KEY_E" }
"#;

/// Presses that this player leaves out, beside such that it shows; directions that must last, and a hand that may rest.
const LAYERED: &str = r#"
schema = 1
name = "Layered"
output = "gamepad"
[access]
slow_ms = 60
rest_n = 0.3
[dpad]
[[layer]]
name = "menu"
[[macro]]
name = "combo"
steps = [{ gamepad = "BTN_TL", keyboard = "KEY_Q" }]
[[button]]
force = "fz"
press_n = 2.0
tap = { gamepad = "BTN_SOUTH", keyboard = "KEY_A" }
hold = { gamepad = "BTN_EAST", keyboard = "KEY_B" }
[[button]]
force = "fx"
press_n = 0.8
out = { layer = "menu" }
[[button]]
force = "-fx"
press_n = 0.8
layer = "menu"
out = { gamepad = "BTN_TR", keyboard = "KEY_E" }
[[button]]
force = "fy"
press_n = 0.8
tap = { macro = "combo" }
hold = { bridge = "pause" }
"#;

#[test]
fn the_player_shows_each_kind_of_press_that_a_profile_has() {
    for (text, buttons) in [
        (LIVELY, &["SOUTH", "EAST", "NORTH", "WEST", "TL", "TR", "START", "SELECT"][..]),
        (LAYERED, &["SOUTH", "EAST"]),
        (DOUBLE, &["SOUTH", "EAST", "NORTH", "WEST", "TL"]),
    ] {
        let (profile, found) = check::read(text, OutputChoice::AsWritten);
        let Some(profile) = profile else { panic!("{found:?}") };
        let script = Script::for_profile(&profile, 2 * DURATION_US);
        for button in buttons {
            let code = format!("BTN_{button}");
            let downs = script.expected().iter().filter(|it| it.1.to_string() == code && it.2 == 1).count();
            assert!(downs > 0, "{}: {code} is left out", profile.name);
        }
        for seed in 0..4 {
            let (seen, _) = play(profile.clone(), Script::for_profile(&profile, DURATION_US), seed);
            let script = Script::for_profile(&profile, DURATION_US);
            assert_eq!(seen, script.expected(), "{}, seed {seed}", profile.name);
        }
    }
}
