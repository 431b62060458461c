//! Kills and unplugs at drawn moments: what was down is up 200 ms later.
//!
//! `TACTPAD_KILLS` and `TACTPAD_UNPLUGS` say how often, `TACTPAD_KILLS_FROM` and `TACTPAD_UNPLUGS_FROM` by which draw first.

use std::env;

use evdev::{AbsoluteAxisCode, KeyCode};
use rustix::process::Signal;
use tactpad::numeric::random::SplitMix64;

use crate::bridge::Bridge;
use crate::clock::{MS, monotonic_ns, wait_until};
use crate::pad::{NONE, PRESS, PRESS_RIGHT, Pad, RIGHT};
use crate::reader::{Reader, find};

/// Nothing is down any more after this time.
const UP_MS: u64 = 200;

/// A pad that was plugged in plays after this time: it is looked for four times a second, and lies still for half a second.
const PLAYS_MS: u64 = 750;

/// It is told how far this is each time after so many.
const TOLD: u64 = 100;

/// The draws that `name` asks for, or fifty.
fn draws(name: &str) -> impl Iterator<Item = u64> {
    let number = |name: &str| env::var(name).ok().map(|text| text.parse::<u64>().expect("a number"));
    let (from, count) = (number(&format!("{name}_FROM")).unwrap_or(0), number(name).unwrap_or(50));
    (from..from + count).inspect(move |draw| {
        if *draw > from && draw.is_multiple_of(TOLD) {
            println!("{name}: {draw} of {} are done", from + count);
        }
    })
}

/// Presses and lifts until a drawn moment.
fn play(random: &mut SplitMix64, pad: &mut Pad) {
    let mut below = |end: u64| random.next_bits() % end;
    for _ in 0..=below(2) {
        let touch = [RIGHT, PRESS, PRESS_RIGHT][below(3) as usize];
        pad.hold(touch, below(400));
        if below(3) == 0 {
            pad.hold(NONE, below(100));
        }
    }
}

/// A bridge that is ended in any way takes what it holds with it.
pub(crate) fn kills() {
    // Of SEGV and BUS Rust takes the first, to look whether a stack is full.
    let signals =
        [Signal::KILL, Signal::ABORT, Signal::ILL, Signal::TRAP, Signal::SYS, Signal::TERM, Signal::INT];
    for draw in draws("TACTPAD_KILLS") {
        let mut random = SplitMix64::named(draw, "kill");
        let signal = signals[(random.next_bits() % signals.len() as u64) as usize];
        let Bridge { mut pad, mut program, mut reader } = Bridge::start("super-mario", KeyCode::BTN_SOUTH);
        play(&mut random, &mut pad);
        program.signal(signal);
        pad.hold(PRESS_RIGHT, UP_MS);
        assert!(program.has_ended(), "draw {draw}: {signal:?} does not end it");
        reader.read_available();
        assert!(
            reader.device.get_key_state().is_err(),
            "draw {draw}: the device is there {UP_MS} ms after {signal:?}"
        );
        assert_eq!(find(KeyCode::BTN_SOUTH), None, "draw {draw}: so is its node");
    }
}

/// A pad that is pulled out holds nothing, and plays when it is back.
pub(crate) fn unplugs() {
    let Bridge { mut pad, mut program, mut reader } = Bridge::start("super-mario", KeyCode::BTN_SOUTH);
    let path = pad.path().to_owned();
    for draw in draws("TACTPAD_UNPLUGS") {
        let mut random = SplitMix64::named(draw, "unplug");
        play(&mut random, &mut pad);
        let unplugged_ns = pad.unplug();
        wait_until(monotonic_ns() + UP_MS * MS);
        check_up_since(unplugged_ns, &mut reader, draw);
        wait_until(monotonic_ns() + random.next_bits() % 600 * MS);
        assert!(!program.has_ended(), "draw {draw}: the bridge waits for the pad");
        pad = Pad::plug_in();
        assert_eq!(pad.path(), path, "the kernel gives the lowest free number");
        pad.hold(NONE, PLAYS_MS);
        reader.read_available();
        reader.seen.clear();
        pad.hold(RIGHT, UP_MS);
        pad.hold(NONE, UP_MS);
        reader.read_available();
        assert_eq!(reader.edges(), [("ABS_HAT0X", 1), ("ABS_HAT0X", 0)], "draw {draw}: the pad plays");
    }
}

fn check_up_since(since_ns: u64, reader: &mut Reader, draw: u64) {
    reader.read_available();
    assert!(!reader.gone, "draw {draw}: the device stays");
    for change in reader.seen.iter().filter(|change| change.at_ns > since_ns) {
        assert_eq!(change.value, 0, "draw {draw}: {} goes down without a pad", change.name);
    }
    let keys = reader.device.get_key_state().expect("the device stays");
    assert_eq!(keys.iter().next(), None, "draw {draw}");
    for (axis, state) in reader.device.get_absinfo().expect("the device stays") {
        let is_hat = [AbsoluteAxisCode::ABS_HAT0X, AbsoluteAxisCode::ABS_HAT0Y].contains(&axis);
        assert!(!is_hat || state.value() == 0, "draw {draw}: {axis:?} is {}", state.value());
    }
}
