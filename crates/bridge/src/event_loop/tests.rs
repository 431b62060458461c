//! The loop by hand, in virtual time.

use std::sync::atomic::{AtomicUsize, Ordering};

use super::virtual_time::{ASKED, ASLEEP, Edge, MessageLog, Play, bridge};
use super::*;
use crate::opening::OpenedPad;
use crate::sink::null::NullSink;
use crate::state::State;
use crate::transport::opener::PadError;
use tactpad_core::pad::field::PadField;
use tactpad_core::quantity::Contact;

/// A bridge whose pad never comes, what it tells, and how often it looked for the pad.
fn without_pad() -> (Bridge, MessageLog, Arc<AtomicUsize>) {
    let (messages, looked) = (MessageLog::default(), Arc::new(AtomicUsize::new(0)));
    let looking = Arc::clone(&looked);
    let pad = OpenedPad::absent(Box::new(move || {
        looking.fetch_add(1, Ordering::Relaxed);
        Err(PadError::NotThere("no".into()))
    }));
    let now_ns = Box::leak(Box::default());
    (bridge(now_ns, pad, Box::new(NullSink::NOWHERE), &messages, Vec::new()), messages, looked)
}

/// Lets the bridge wake when it wants to until `end`; how often it did.
fn wake_ups(bridge: &mut Bridge, end: HostInstant) -> usize {
    let mut count = 0;
    while let Some(now) = bridge.next_deadline().filter(|now| *now < end) {
        assert_eq!(bridge.turn(now, ASLEEP).unwrap(), None);
        count += 1;
    }
    count
}

#[test]
fn without_a_pad_it_wakes_at_most_five_times_a_second_and_still_looks_and_tells() {
    let (mut bridge, messages, looked) = without_pad();
    let snapshot = bridge.snapshot();
    let begin = bridge.snapshot_at;
    assert_eq!(bridge.turn(begin, ASLEEP).unwrap(), None);
    assert_eq!(messages.0.lock().unwrap().len(), 1, "who starts it reads at once what it waits for");
    let count = wake_ups(&mut bridge, begin.plus_us(10_000_000));
    assert!(count <= 50, "{count} times in ten seconds");
    let looked = looked.load(Ordering::Relaxed);
    assert!(looked >= 35, "it looked {looked} times");
    assert_eq!(*messages.0.lock().unwrap(), ["waiting for the pad: plug it in"]);
    assert!(snapshot.lock().unwrap().at >= begin.plus_us(9_000_000), "the picture is old");
}

#[test]
fn another_profile_is_taken_and_one_that_cannot_be_read_is_told() {
    let (mut bridge, messages, _) = without_pad();
    let now = bridge.snapshot_at;
    let sender = bridge.requests.sender().unwrap();
    let mut ask = |name: Option<&str>| {
        let answer = sender.send_for_reply(Request::Profile(name.map(str::to_owned))).unwrap();
        bridge.turn(now, ASKED).unwrap();
        let profile = bridge.take_snapshot(now).status.profile.clone();
        (answer.try_recv().unwrap(), profile)
    };
    assert_eq!(ask(Some("tetris")), (done(), "Tetris".into()));
    assert_eq!(ask(None), (r#"{"error":"there is none","ok":false}"#.into(), "Tetris".into()));
    let waits = "waiting for the pad: plug it in";
    assert_eq!(
        *messages.0.lock().unwrap(),
        ["profile Tetris", waits, "there is none\nthe profile in use stays"]
    );
}

#[test]
fn what_a_press_asks_for_is_done() {
    let (mut bridge, messages, _) = without_pad();
    let now = bridge.snapshot_at;
    let mut ask = |command| {
        bridge.driver.commands.push(command);
        bridge.run_commands(now).unwrap();
        bridge.turn(now, ASKED).unwrap();
        (bridge.driver.pipeline.phase(), bridge.take_snapshot(now).status.profile)
    };
    assert_eq!(ask(Command::TogglePause).0, Phase::Paused);
    assert_eq!(ask(Command::TogglePause).0, Phase::Waiting);
    assert_eq!(ask(Command::Profile("tetris".try_into().unwrap())).1, "Tetris");
    assert_eq!(ask(Command::NextProfile).1, "Tetris");
    let told = messages.0.lock().unwrap();
    assert_eq!(*told, ["profile Tetris", "there is no next one\nthe profile in use stays"]);
}

/// From where the finger comes or goes: the filter's six samples.
const EDGE_MAX_US: u64 = 6_000;

/// What a press must come to, and when at the latest.
fn is_edge(edges: &[Edge], value: i32, after_max_us: u64) -> bool {
    matches!(edges, [(code, is, after_us)] if code == "BTN_SOUTH" && *is == value && *after_us <= after_max_us)
}

#[test]
fn every_press_goes_out_and_comes_back_in_time() {
    let mut play = Play::start();
    for number in 0..200 {
        let down = play.press(3.0, 50 + number % 7);
        let up = play.press(0.0, 60 + number % 11);
        assert!(is_edge(&down, 1, EDGE_MAX_US) && is_edge(&up, 0, EDGE_MAX_US), "{number}: {down:?} {up:?}");
    }
}

#[test]
fn silence_releases_after_80_ms_and_not_before() {
    let mut play = Play::start();
    assert!(is_edge(&play.press(3.0, 100), 1, EDGE_MAX_US));
    // The last frame is a millisecond old.
    assert_eq!(play.wait(79), []);
    assert!(is_edge(&play.wait(100), 0, 0), "as soon as 80 ms are over");
}

#[test]
fn a_pad_that_is_pulled_out_holds_nothing_any_more() {
    let mut play = Play::start();
    assert!(is_edge(&play.press(3.0, 100), 1, EDGE_MAX_US));
    assert!(is_edge(&play.pull_out(), 0, 0), "at once");
}

#[test]
fn a_sequence_number_of_eight_bits_is_told_before_what_comes_of_it() {
    let mut play = Play::waiting();
    play.plug_in();
    play.wait(300);
    let tells =
        |play: &Play, begin: &str| play.messages.0.lock().unwrap().iter().any(|line| line.starts_with(begin));
    for ms in 0..6_000_u64 {
        let fz_n = if ms > 1_000 && ms % 500 < 300 { 2.0 } else { 0.0 };
        play.press(fz_n, 1);
        play.sequence &= 255;
        assert!(ms < 300 || tells(&play, "after sequence number 255"), "{ms} ms");
    }
    assert!(!tells(&play, "lift the finger"));
}

/// A pad that lost a tenth of its frames, whose channel stood or whose clock was too fast, and then says nothing.
#[test]
fn a_pad_that_falls_silent_is_told_to_be_silent_whatever_its_line_had() {
    let losing = |play: &mut Play| {
        play.press(0.0, 9);
        play.sample(&Contact::default());
        play.wait(1);
    };
    is_told_before_silence("10.0 %", losing);
    is_told_before_silence("channel m2y reads 1234", |play| {
        play.wiring = Box::new(|_, counts| counts[7] = 1_234);
        play.press(0.0, 10);
    });
    is_told_before_silence("the pad's clock", |play| {
        play.us_per_ms = 3_000;
        play.press(0.0, 10);
    });
}

/// That what is wrong with this line is told, and then that it is silent.
fn is_told_before_silence(begin: &str, line: impl Fn(&mut Play)) {
    let mut play = Play::start();
    (0..500).for_each(|_| line(&mut play));
    let told = play.messages.clone();
    let last = || told.0.lock().unwrap().last().cloned().unwrap_or_default();
    assert!(last().starts_with(begin), "{}", last());
    play.wait(3_000);
    assert_eq!(last(), State::Silent.sentence());
}

#[test]
fn another_channel_that_stands_is_told_at_once() {
    let mut play = Play::start();
    for (channel, name) in [(3, "m1x"), (7, "m2y"), (0, "m0x")] {
        play.wiring = Box::new(move |_, counts| counts[channel] = 1_234);
        play.press(0.0, 3_000);
        let told = play.messages.0.lock().unwrap();
        assert!(told.iter().any(|line| line.starts_with(&format!("channel {name} reads 1234"))), "{told:?}");
    }
}

/// Without it the difference between what it read then and what it reads now looks like a finger.
#[test]
fn a_channel_that_answers_again_has_the_zero_measured_anew() {
    let mut play = Play::waiting();
    play.plug_in();
    play.wait(300);
    let pressed = PadField::nominal().signals.strain_uv(&Contact { fz_n: 3.0, ..Contact::default() }).uv;
    let stuck = move |number: u32, counts: &mut [i32; 9]| {
        if number < 5_000 {
            for channel in [2, 5, 8] {
                counts[channel] = (-100.0 * pressed[channel]) as i32;
            }
        }
    };
    play.wiring = Box::new(stuck);
    play.press(0.0, 5_000);
    assert_eq!(play.press(0.0, 2_000), []);
    assert!(is_edge(&play.press(3.0, 100), 1, EDGE_MAX_US));
}

/// What a pad's clock shows has passed while its samples waited.
fn no_clock_is_accused(wait: impl Fn(&mut Play, u64)) {
    for ms in [100, 1_000, 3_000, 7_000, 60_000] {
        let mut play = Play::start();
        wait(&mut play, ms);
        play.press(0.0, 3_000);
        let told = play.messages.0.lock().unwrap();
        assert!(!told.iter().any(|line| line.starts_with("the pad's clock")), "{ms} ms: {told:?}");
    }
}

#[test]
fn a_machine_that_stood_still_does_not_accuse_the_pads_clock() {
    no_clock_is_accused(|play, ms| drop(play.starve(&Contact::default(), ms, None)));
}

#[test]
fn samples_that_a_hub_kept_do_not_accuse_the_pads_clock() {
    no_clock_is_accused(|play, ms| play.stall(&Contact::default(), ms));
}

#[test]
fn a_program_ends_its_own_bridge_without_signals() {
    let (mut bridge, ..) = without_pad();
    bridge.requests.sender().unwrap().send(Request::End).unwrap();
    assert_eq!(bridge.run().unwrap(), Ending::Requested);
}
