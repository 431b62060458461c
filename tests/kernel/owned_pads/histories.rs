//! Whatever happens to a device and to the bridge, in an order drawn from a seed: what is pressed is let go, and a sound stroke plays.

use std::fmt::Write;

use evdev::raw_stream::RawDevice;
use evdev::{EventType, KeyCode};
use rustix::process::Signal;

use super::device::{Device, MT, PEN, SHAPES};
use super::{ask, comes_true, pause, start};
use crate::clock::{MS, stamp_ns};
use crate::program::Running;
use crate::reader::{Reader, find};

/// Histories of each device, and what happens in one.
const HISTORIES: u64 = 12;
const HAPPENINGS: u64 = 12;

/// The bridge looks for a device that is away, or that another program has, four times a second.
const FOUND_MS: u64 = 600;

/// After a device was found, or given back, a sound stroke plays within so long.
const PLAYS_MS: u64 = 500;

/// Numbers that follow from a seed.
struct Draw(u64);

impl Draw {
    fn below(&mut self, end: u64) -> u64 {
        // Marsaglia's xorshift.
        for (left, by) in [(true, 13), (false, 7), (true, 17)] {
            self.0 ^= if left { self.0 << by } else { self.0 >> by };
        }
        self.0 % end
    }

    fn share(&mut self) -> f64 {
        self.below(1_000) as f64 / 1_000.0
    }
}

/// A device, the bridge that plays it, and what they were through.
struct Play {
    device: Option<Device>,
    index: usize,
    other: Option<RawDevice>,
    program: Running,
    told: String,
}

impl Play {
    fn is_pen(&self) -> bool {
        SHAPES[self.index].source == "tablet"
    }

    fn happen(&mut self, draw: &mut Draw) {
        let number = draw.below(10);
        let (x, y, fz_n, ms) = (draw.share(), draw.share(), 4.0 * draw.share(), draw.below(300));
        let _ = write!(self.told, "{number} {x} {y} {fz_n:.2} {ms}; ");
        let is_pen = self.is_pen();
        let Some(device) = &mut self.device else {
            // It is back, at whatever node is free.
            self.device = Some(Device::plug_in(SHAPES[self.index]));
            return pause(ms);
        };
        match number {
            0 | 1 => device.touch(x, y, fz_n),
            2 => device.lift(),
            3 if is_pen => device.hover(x),
            4 if is_pen => device.leave(),
            3 | 4 => device.second(x, draw.below(2) == 0),
            5 if self.other.is_some() => self.other = None,
            5 => {
                let mut other = RawDevice::open(&device.node).expect("the device");
                // Fails where the bridge has it.
                self.other = other.grab().is_ok().then_some(other);
            }
            6 => (self.device, self.other) = (None, None),
            7 => ask(if draw.below(2) == 0 { "pause" } else { "resume" }),
            8 => {
                self.program.signal(Signal::STOP);
                pause(ms);
                let axis = if is_pen { PEN[0] } else { MT[0] };
                for k in 0..if draw.below(2) == 0 { 300 } else { 3 } {
                    device.emit(&[(EventType::ABSOLUTE, axis.0, 1_100 + k % 100)]);
                    if k == 1 && draw.below(2) == 0 {
                        device.lift();
                    }
                }
                self.program.signal(Signal::CONT);
            }
            _ => ask("panic"),
        }
        pause(ms);
    }

    /// Nothing touches the device any more, it is the bridge's, and the player goes on.
    fn settle(&mut self) {
        self.other = None;
        let device = self.device.get_or_insert_with(|| Device::plug_in(SHAPES[self.index]));
        if SHAPES[self.index].source == "tablet" {
            device.lift();
            device.leave();
        } else {
            device.second(0.5, false);
            device.lift();
        }
        ask("resume");
        pause(FOUND_MS + PLAYS_MS);
    }
}

/// Nothing is held of what a reader has seen.
fn is_neutral(gamepad: &Reader) -> bool {
    let mut last = std::collections::BTreeMap::new();
    last.extend(gamepad.edges());
    last.values().all(|value| *value == 0)
}

pub(crate) fn histories() {
    for index in [0, 2, 4] {
        let device = Device::plug_in(SHAPES[index]);
        let (program, mut gamepad) = start(SHAPES[index].source, &[]);
        let mut play = Play { device: Some(device), index, other: None, program, told: String::new() };
        for seed in 1..=HISTORIES {
            let mut draw = Draw(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15));
            play.told = format!("{}, seed {seed}: ", SHAPES[index].name);
            (0..HAPPENINGS).for_each(|_| play.happen(&mut draw));
            play.settle();
            gamepad.read_available();
            assert!(is_neutral(&gamepad), "{}{:?} {}", play.told, gamepad.edges(), play.program.complaints());
            gamepad.seen.clear();
            let device = play.device.as_mut().expect("it is there");
            let begin_ns = stamp_ns();
            // Somewhere that it has not been.
            device.touch(0.95 + 1e-3 * seed as f64, 0.5 + 1e-3 * seed as f64, 1.0 + 1e-2 * seed as f64);
            pause(200);
            device.lift();
            if play.is_pen() {
                play.device.as_mut().expect("it is there").leave();
            }
            pause(200);
            gamepad.read_available();
            let edges = gamepad.edges();
            assert_eq!(
                edges,
                [("ABS_HAT0X", 1), ("ABS_HAT0X", 0)],
                "{}{}",
                play.told,
                play.program.complaints()
            );
            let down_ms = (gamepad.seen[0].at_ns - begin_ns) / MS;
            assert!(down_ms < 100, "{}pressed after {down_ms} ms", play.told);
            gamepad.seen.clear();
            assert!(!play.program.has_ended(), "{}", play.told);
        }
        println!("{}: {HISTORIES} histories of {HAPPENINGS}", SHAPES[index].name);
        drop(play);
        comes_true("the gamepad goes", || find(KeyCode::BTN_SOUTH).is_none());
    }
}
