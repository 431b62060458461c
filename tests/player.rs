//! The scripted player means what the bridge understands: its own list of events, made from the gestures' meaning,
//! against the events of the pipeline, on many noisy pads.

use firmware_proto::ENCODED_MAX;
use firmware_proto::command::Command;
use firmware_proto::link::encode_command;
use tactpad::contact::Decoder;
use tactpad::control::{Code, Device};
use tactpad::mapping::check::{self, OutputChoice};
use tactpad::mapping::profile::Profile;
use tactpad::mapping::shipped;
use tactpad::pipeline::{NoProbe, Pipeline};
use tactpad::time::HostInstant;
use tactpad::virtual_pad::firmware::VirtualPad;
use tactpad::virtual_pad::script::Script;

const DURATION_US: u64 = 10_000_000;

fn play(profile: Profile, script: Script, seed: u64) -> Vec<(Device, Code, i32)> {
    let mut pad = VirtualPad::new(script, seed);
    let mut pipeline = Pipeline::new(Decoder::shipped(), profile);
    let mut question = [0; ENCODED_MAX];
    let length = encode_command(&Command::Identify, &mut question);
    pad.receive(&question[..length]);
    let mut seen = Vec::new();
    let mut bytes = Vec::new();
    for ms in 1..=DURATION_US / 1_000 {
        bytes.clear();
        pad.emit(ms * 1_000, &mut bytes);
        let mut rest = &bytes[..];
        while !rest.is_empty() {
            let now = HostInstant::default().plus_us(ms * 1_000);
            let taken = pipeline.handle_bytes(now, rest, &mut NoProbe);
            seen.extend(pipeline.events().iter().map(|event| (event.device, event.code, event.value)));
            rest = &rest[taken..];
        }
    }
    seen
}

#[test]
fn what_the_player_means_is_what_comes_out() {
    for name in shipped::names() {
        for output in [OutputChoice::AsWritten, OutputChoice::Keyboard] {
            let read = shipped::text(name).and_then(|text| check::read(text, output).0);
            let Some(profile) = read else { panic!("{name} is in order") };
            let script = Script::for_profile(&profile, DURATION_US);
            assert!(script.contacts() >= 10 && script.expected().len() >= 20, "{name}");
            for seed in 0..12 {
                let seen = play(profile.clone(), script.clone(), seed);
                assert_eq!(seen, script.expected(), "{name}, {output:?}, seed {seed}");
            }
        }
    }
}
