//! The live core from wire bytes to events, in virtual time.

use crate::rig::{Rig, frame, profile};
use firmware_proto::ENCODED_MAX;
use firmware_proto::frame::Message;
use firmware_proto::identity::{Identity, SerialNumber};
use firmware_proto::link::encode_message;
use firmware_proto::sample::Status;
use tactpad::pipeline::Phase;
use tactpad::pipeline::mapping::profile::Command;
use tactpad::pipeline::mapping::read::check::{OutputChoice, read};
use tactpad::pipeline::refusal::Refusal;
use tactpad::quantity::Contact;

const RIGHT: Contact = Contact { x_mm: 20.0, y_mm: 0.0, fx_n: 0.0, fy_n: 0.0, fz_n: 1.0 };

/// A rig that holds "right" when the test begins.
fn holding_right() -> Rig {
    let mut rig = Rig::rested(profile("super-mario"));
    rig.hold(RIGHT, 200);
    assert_eq!(rig.take_events(), ["ABS_HAT0X=1"]);
    rig
}

#[test]
fn places_become_directions() {
    for (x_mm, y_mm, down, up) in [
        (20.0, 0.0, "ABS_HAT0X=1", "ABS_HAT0X=0"),
        (-20.0, 0.0, "ABS_HAT0X=-1", "ABS_HAT0X=0"),
        (0.0, 20.0, "ABS_HAT0Y=-1", "ABS_HAT0Y=0"),
        (0.0, -20.0, "ABS_HAT0Y=1", "ABS_HAT0Y=0"),
    ] {
        let mut rig = Rig::rested(profile("super-mario"));
        rig.press(x_mm, y_mm, 1.0, 100);
        rig.rest(100);
        assert_eq!(rig.take_events(), [down, up]);
    }
}

#[test]
fn the_zero_takes_at_most_half_a_second() {
    let mut rig = Rig::new(profile("super-mario"));
    rig.rest(499);
    assert_eq!(rig.pipeline.phase(), Phase::Playing);
    rig.hold(RIGHT, 50);
    assert_eq!(rig.take_events(), ["ABS_HAT0X=1"]);
}

#[test]
fn short_presses_tap_and_long_ones_hold() {
    let mut rig = Rig::rested(profile("super-mario"));
    rig.press(0.0, 0.0, 3.0, 200);
    rig.rest(200);
    assert_eq!(rig.take_events(), ["BTN_SOUTH=1", "BTN_SOUTH=0"]);
    rig.press(0.0, 0.0, 3.0, 600);
    assert_eq!(rig.take_events(), ["BTN_EAST=1"]);
    rig.rest(100);
    assert_eq!(rig.take_events(), ["BTN_EAST=0"]);
}

#[test]
fn a_tap_is_down_for_the_minimum_press() {
    let mut rig = Rig::rested(profile("super-mario"));
    rig.press(0.0, 0.0, 3.0, 100);
    rig.rest(200);
    let [(down_ms, ..), (up_ms, ..)] = &rig.events[..] else { panic!("{:?}", rig.events) };
    assert!((up_ms - down_ms - 40.0).abs() < 1.5, "{down_ms} to {up_ms}");
}

#[test]
fn contra_jumps_with_the_normal_force_and_fires_with_the_shear() {
    let mut rig = Rig::rested(profile("contra"));
    rig.hold(Contact { fy_n: 2.0, ..RIGHT }, 200);
    rig.rest(100);
    let events = rig.take_events();
    assert!(events.contains(&"BTN_EAST=1".to_owned()), "{events:?}");
    assert!(!events.contains(&"BTN_SOUTH=1".to_owned()), "{events:?}");
    rig.press(0.0, 0.0, 3.0, 100);
    rig.rest(100);
    assert_eq!(rig.take_events(), ["BTN_SOUTH=1", "BTN_SOUTH=0"]);
}

#[test]
fn every_fault_ends_the_contact_at_once() {
    type Harm = fn(&mut Rig);
    let harms: [(&str, Harm); 6] = [
        ("lost frames", |rig| {
            rig.lose();
            rig.hold(RIGHT, 1);
        }),
        ("a repeated frame", |rig| {
            let sample = rig.sample(&RIGHT);
            rig.send(&sample);
            rig.send(&sample);
        }),
        ("a jump of the clock", |rig| {
            rig.now_us += 5_000_000;
            rig.hold(RIGHT, 1);
        }),
        ("a restart", |rig| {
            let mut sample = rig.sample(&RIGHT);
            (sample.sequence, sample.time_us) = (0, 0);
            rig.send(&sample);
        }),
        ("a saturated channel", |rig| {
            let mut sample = rig.sample(&RIGHT);
            sample.counts[2] = (1 << 23) - 1;
            rig.send(&sample);
        }),
        ("a supply fault", |rig| {
            let mut sample = rig.sample(&RIGHT);
            sample.status = Status(1 << 11);
            rig.send(&sample);
        }),
    ];
    for (name, harm) in harms {
        let mut rig = holding_right();
        let before = *rig.pipeline.health();
        harm(&mut rig);
        assert_eq!(rig.take_events(), ["ABS_HAT0X=0"], "{name}");
        let mut after = *rig.pipeline.health();
        (after.samples, after.contacts) = (before.samples, before.contacts);
        assert_ne!(after, before, "{name} is not counted");
    }
}

#[test]
fn presses_survive_a_line_that_loses_or_damages_single_frames() {
    // One frame in 40 does not arrive: fifteen presses are fifteen presses.
    for is_damaged in [false, true] {
        let mut rig = Rig::rested(profile("super-mario"));
        for number in 0..15 * 300 {
            let contact = if number % 300 < 150 { RIGHT } else { Contact::default() };
            let sample = rig.sample(&contact);
            let mut bytes = frame(&sample);
            match (number % 40 == 7, is_damaged) {
                (true, true) => bytes[30] ^= 0x10,
                (true, false) => continue,
                (false, _) => {}
            }
            rig.bytes(&bytes);
        }
        assert_eq!(rig.take_events(), ["ABS_HAT0X=1", "ABS_HAT0X=0"].repeat(15), "damaged: {is_damaged}");
        assert_eq!(rig.pipeline.health().frames_lost, 113);
    }
}

#[test]
fn a_contact_is_believed_again_after_fifty_sound_milliseconds() {
    let mut rig = holding_right();
    rig.lose();
    rig.hold(RIGHT, 50);
    assert_eq!(rig.take_events(), ["ABS_HAT0X=0"]);
    rig.hold(RIGHT, 1);
    assert_eq!(rig.take_events(), ["ABS_HAT0X=1"]);
}

#[test]
fn a_press_cut_short_by_a_fault_taps_nothing() {
    let mut rig = Rig::rested(profile("super-mario"));
    rig.press(0.0, 0.0, 3.0, 100);
    rig.lose();
    rig.rest(300);
    assert_eq!(rig.take_events(), Vec::<String>::new());
}

#[test]
fn a_press_that_goes_on_through_a_fault_stays_dead_until_it_ends() {
    let mut rig = Rig::rested(profile("super-mario"));
    rig.press(0.0, 0.0, 3.0, 100);
    rig.lose();
    rig.press(0.0, 0.0, 3.0, 700);
    rig.rest(100);
    assert_eq!(rig.take_events(), Vec::<String>::new());
    rig.press(0.0, 0.0, 3.0, 100);
    rig.rest(100);
    assert_eq!(rig.take_events(), ["BTN_SOUTH=1", "BTN_SOUTH=0"]);
}

#[test]
fn a_silent_pad_releases_everything_within_a_tenth_of_a_second() {
    let mut rig = holding_right();
    let last_ms = rig.now_us as f64 * 1e-3;
    rig.silence(99);
    let [(at_ms, code, 0)] = &rig.events[..] else { panic!("{:?}", rig.events) };
    assert!(code == "ABS_HAT0X" && (79.0..100.0).contains(&(at_ms - last_ms)), "{at_ms} after {last_ms}");
    assert_eq!(rig.pipeline.phase(), Phase::Waiting);
}

#[test]
fn noise_on_the_line_does_not_hide_silence() {
    let mut rig = holding_right();
    for _ in 0..99 {
        rig.now_us += 1_000;
        let byte = rig.random() as u8 | 1;
        rig.bytes(&[byte]);
    }
    assert!(rig.is_neutral());
}

#[test]
fn an_unplugged_pad_releases_everything_and_its_successor_is_tared() {
    let mut rig = holding_right();
    rig.pipeline.handle_unplugged(rig.host());
    rig.collect();
    assert_eq!(rig.take_events(), ["ABS_HAT0X=0"]);
    rig.offset = [5_000; 9];
    rig.rest(500);
    rig.hold(RIGHT, 50);
    assert_eq!(rig.take_events(), ["ABS_HAT0X=1"]);
}

#[test]
fn pausing_releases_and_ignores_contacts_until_the_player_goes_on() {
    let mut rig = holding_right();
    rig.pipeline.pause(rig.host());
    rig.collect();
    rig.hold(RIGHT, 300);
    assert_eq!(rig.take_events(), ["ABS_HAT0X=0"]);
    rig.pipeline.resume();
    rig.hold(RIGHT, 10);
    assert_eq!(rig.take_events(), ["ABS_HAT0X=1"]);
}

/// A profile whose short press is BTN_SOUTH, and whose long one pauses and goes on.
const PAUSES: &str = r#"
schema = 1
name = "Pauses"
output = "gamepad"
[dpad]
[[button]]
force = "fz"
press_n = 2
tap = { gamepad = "BTN_SOUTH", keyboard = "KEY_Z" }
hold = { bridge = "pause" }
"#;

#[test]
fn a_press_can_pause_and_go_on_and_does_nothing_else_meanwhile() {
    let mut rig = Rig::rested(read(PAUSES, OutputChoice::AsWritten).0.unwrap());
    let long = Contact { fz_n: 3.0, ..RIGHT };
    rig.hold(long, 600);
    assert_eq!(std::mem::take(&mut rig.commands), [Command::TogglePause]);
    rig.pipeline.pause(rig.host());
    rig.collect();
    rig.hold(long, 600);
    rig.rest(100);
    // A short press is no command: it does nothing in a pause.
    rig.hold(long, 100);
    rig.rest(100);
    assert_eq!(rig.take_events(), ["ABS_HAT0X=1", "ABS_HAT0X=0"]);
    rig.hold(long, 600);
    assert_eq!(std::mem::take(&mut rig.commands), [Command::TogglePause]);
    rig.pipeline.resume();
    rig.hold(long, 600);
    rig.rest(100);
    assert_eq!(rig.take_events(), ["ABS_HAT0X=1", "ABS_HAT0X=0"], "the press that went on taps nothing");
    assert_eq!(rig.commands, []);
}

#[test]
fn a_profile_change_releases_only_what_differs() {
    let mut rig = Rig::rested(profile("contra"));
    rig.hold(Contact { fz_n: 3.0, ..RIGHT }, 200);
    assert_eq!(rig.take_events(), ["ABS_HAT0X=1", "BTN_SOUTH=1"]);
    let mut directions_only = profile("contra");
    directions_only.buttons.clear();
    rig.pipeline.set_profile(rig.host(), directions_only);
    rig.collect();
    rig.hold(Contact { fz_n: 3.0, ..RIGHT }, 200);
    assert_eq!(rig.take_events(), ["BTN_SOUTH=0"]);
}

#[test]
fn a_pad_that_tells_its_scale_is_believed() {
    let mut rig = Rig::new(profile("super-mario"));
    let identity = Identity {
        serial_number: SerialNumber::from_ascii("T-1").unwrap(),
        channels: 9,
        count_bits: 24,
        rate_hz: 1_000,
        picovolts_per_count: 1_000,
    };
    let mut bytes = [0; ENCODED_MAX];
    let length = encode_message(&Message::Identity(identity), &mut bytes);
    rig.bytes(&bytes[..length]);
    rig.rest(500);
    // A tenth of the microvolts per count: the rig's 3 N are 0.3 N now, too little for the button.
    rig.press(0.0, 0.0, 3.0, 200);
    rig.rest(200);
    assert_eq!(rig.take_events(), Vec::<String>::new());
    assert_eq!(rig.pipeline.identity(), Some(&identity));
}

/// Version 2, kind 1, no payload; the checksum is sound.
const NEWER: [u8; 8] = [0x07, 0x02, 0x01, 0xeb, 0x40, 0xe8, 0x04, 0x00];

#[test]
fn frames_of_a_newer_version_among_others_are_counted_and_skipped() {
    let mut rig = holding_right();
    for _ in 0..50 {
        rig.bytes(&NEWER);
        rig.hold(RIGHT, 100);
    }
    assert_eq!(rig.take_events(), Vec::<String>::new());
    assert_eq!((rig.pipeline.refusal(), rig.pipeline.health().frames_newer), (None, 50));
}

#[test]
fn a_pad_that_speaks_nothing_but_a_newer_version_is_refused() {
    let mut rig = holding_right();
    for seconds in [1.9, 0.2] {
        assert_eq!(rig.pipeline.refusal(), None);
        for _ in 0..(10.0 * seconds) as u32 {
            rig.bytes(&NEWER);
            rig.silence(100);
        }
    }
    assert_eq!(rig.take_events(), ["ABS_HAT0X=0"]);
    rig.bytes(&NEWER);
    assert_eq!(rig.pipeline.refusal(), Some(&Refusal::NewerVersion(2)));
}

#[test]
fn a_few_newer_frames_hours_apart_refuse_no_pad() {
    let mut rig = Rig::new(profile("super-mario"));
    for _ in 0..5 {
        rig.bytes(&NEWER);
        rig.silence(3_600_000);
    }
    assert_eq!((rig.pipeline.refusal(), rig.pipeline.health().frames_newer), (None, 5));
}

#[test]
fn a_timeout_after_silence_only_releases() {
    let mut rig = Rig::rested(profile("super-mario"));
    while rig.events.is_empty() {
        rig.hold(RIGHT, 1);
    }
    assert_eq!(rig.take_events(), ["ABS_HAT0X=1"]);
    // The other side is wanted, but the minimum press still holds this one when the host falls asleep.
    rig.hold(Contact { x_mm: -20.0, ..RIGHT }, 20);
    assert_eq!(rig.take_events(), Vec::<String>::new());
    rig.now_us += 500_000;
    rig.pipeline.handle_timeout(rig.host());
    rig.collect();
    assert_eq!(rig.take_events(), ["ABS_HAT0X=0"]);
}

#[test]
fn a_profile_change_does_not_revive_a_press_that_a_fault_or_a_pause_cut_short() {
    for pause in [false, true] {
        let mut rig = Rig::rested(profile("contra"));
        let press = Contact { fz_n: 3.0, ..Contact::default() };
        rig.hold(press, 200);
        assert_eq!(rig.take_events(), ["BTN_SOUTH=1"]);
        if pause {
            rig.pipeline.pause(rig.host());
        } else {
            rig.pipeline.release_all(rig.host());
        }
        rig.collect();
        rig.pipeline.set_profile(rig.host(), profile("contra"));
        rig.collect();
        rig.pipeline.resume();
        rig.hold(press, 200);
        assert_eq!(rig.take_events(), ["BTN_SOUTH=0"], "pause: {pause}");
        rig.rest(100);
        rig.hold(press, 200);
        assert_eq!(rig.take_events(), ["BTN_SOUTH=1"], "pause: {pause}");
    }
}

#[test]
fn a_dead_channel_ends_the_contact_where_the_pad_is_noisy() {
    let mut rig = Rig::new(profile("super-mario"));
    rig.noise = 600;
    rig.rest(500);
    rig.hold(RIGHT, 200);
    assert_eq!(rig.take_events(), ["ABS_HAT0X=1"]);
    let dead = rig.sample(&RIGHT).counts[3];
    rig.sequence -= 1;
    for _ in 0..100 {
        let mut sample = rig.sample(&RIGHT);
        sample.counts[3] = dead;
        rig.send(&sample);
    }
    assert_eq!(rig.take_events(), ["ABS_HAT0X=0"]);
    assert_eq!((rig.pipeline.phase(), rig.pipeline.health().channels_stuck), (Phase::Faulty, 1));
}

#[test]
fn drift_while_idle_is_followed() {
    let mut rig = Rig::rested(profile("super-mario"));
    for _ in 0..600 {
        rig.rest(100);
        // 300 µV per minute, ten times a room that warms up.
        rig.offset = rig.offset.map(|offset| offset + 50);
    }
    assert_eq!(rig.take_events(), Vec::<String>::new());
    rig.hold(RIGHT, 50);
    assert_eq!(rig.take_events(), ["ABS_HAT0X=1"]);
}

#[test]
fn the_same_calls_give_the_same_events() {
    let play = || {
        let mut rig = Rig::new(profile("contra"));
        rig.noise = 900;
        rig.rest(500);
        for step in 0..200_u64 {
            let turn = (step % 12) as f32;
            rig.press(20.0 - turn * 3.0, turn * 2.0, (step % 5) as f32 * 0.8, 7 + step % 40);
            if step % 17 == 0 {
                rig.silence(step % 120);
            }
            if step % 31 == 0 {
                rig.bytes(&[1, 2, 3, 0]);
            }
        }
        rig.events
    };
    let events = play();
    assert!(events.len() > 50);
    assert_eq!(events, play());
}

#[test]
fn any_bytes_at_any_time_leave_nothing_held() {
    for seed in 1..200_u64 {
        let mut rig = Rig::rested(profile("contra"));
        (0..seed).for_each(|_| {
            rig.random();
        });
        for _ in 0..60 {
            match rig.random() % 6 {
                0 => rig.silence(seed % 90),
                1 => {
                    let bytes: Vec<u8> = (0..rig.random() % 200).map(|_| rig.random() as u8).collect();
                    rig.bytes(&bytes);
                }
                2 => {
                    let mut sample = rig.sample(&RIGHT);
                    sample.counts = sample.counts.map(|_| rig.random() as i32);
                    sample.time_us = rig.random();
                    sample.sequence = rig.random() as u32;
                    rig.send(&sample);
                }
                _ => {
                    let force_n = (rig.random() % 50) as f32 * 0.1;
                    rig.hold(Contact { fz_n: force_n, fy_n: force_n * 0.5, ..RIGHT }, 20);
                }
            }
        }
        rig.silence(200);
        assert!(rig.is_neutral(), "seed {seed} holds something");
        let mut times = rig.events.iter().map(|(ms, ..)| *ms);
        let mut last_ms = 0.0;
        assert!(times.all(|ms| std::mem::replace(&mut last_ms, ms) <= ms), "seed {seed}: time went back");
    }
}

/// A touch at which the pointer has its full speed, with room for the decoder's error.
const FAR_RIGHT: Contact = Contact { x_mm: 26.0, ..RIGHT };

/// A rig on whose way to the right the pointer is when the test begins.
fn moving_right() -> Rig {
    let mut rig = Rig::rested(profile("pointer"));
    rig.hold(FAR_RIGHT, 200);
    let rates: Vec<_> = rig.pipeline.held().map(|level| (level.code.to_string(), level.value)).collect();
    assert_eq!(rates[0], ("REL_X".to_owned(), 800));
    rig.moved = [0; 2];
    rig
}

#[test]
fn a_second_at_full_speed_is_the_speed_in_counts() {
    let mut rig = moving_right();
    rig.hold(FAR_RIGHT, 1_000);
    let [right, down] = rig.moved;
    // A step is at most every 4 ms, so up to 3.2 counts came from before or are still to come.
    assert!((800 - 4..=800 + 4).contains(&right) && down.abs() <= 4, "{:?}", rig.moved);
    rig.rest(100);
    let end = rig.moved;
    rig.rest(1_000);
    assert_eq!(rig.moved, end, "no finger, no movement");
    assert!(rig.is_neutral());
}

#[test]
fn nothing_moves_the_pointer_in_a_fault_a_silence_or_a_pause() {
    let doubts: [fn(&mut Rig); 4] = [
        |rig| rig.silence(1_000),
        |rig| {
            rig.lose();
            rig.hold(FAR_RIGHT, 1);
        },
        |rig| {
            let now = rig.host();
            rig.pipeline.pause(now);
            rig.hold(FAR_RIGHT, 500);
        },
        |rig| {
            let now = rig.host();
            rig.pipeline.handle_unplugged(now);
        },
    ];
    for doubt in doubts {
        let mut rig = moving_right();
        doubt(&mut rig);
        assert_eq!((rig.moved, rig.is_neutral()), ([0, 0], true));
    }
}

#[test]
fn after_lost_frames_the_pointer_goes_on_where_it_is() {
    let mut rig = moving_right();
    rig.lose();
    rig.hold(FAR_RIGHT, 50);
    assert_eq!(rig.moved, [0, 0], "not believed yet");
    rig.hold(FAR_RIGHT, 100);
    assert!((80 - 8..=80).contains(&rig.moved[0]), "and nothing is made up for: {:?}", rig.moved);
}

#[test]
fn the_pointer_drags() {
    let mut rig = moving_right();
    rig.hold(Contact { fz_n: 3.0, ..FAR_RIGHT }, 200);
    rig.rest(100);
    assert_eq!(rig.take_events(), ["BTN_LEFT=1", "BTN_LEFT=0"]);
    assert!(rig.moved[0] > 150, "{:?}", rig.moved);
}
