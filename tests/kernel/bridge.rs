//! The bridge under test with a pad before it and a reader behind it.

use evdev::KeyCode;

use crate::pad::{NONE, Pad, Touch};
use crate::program::Running;
use crate::reader::{Reader, find};

/// The program under test.
pub(crate) const TACTPAD: &str = env!("CARGO_BIN_EXE_tactpad");

/// How long a device may take to appear.
const DEVICE_LIMIT_MS: u64 = 5_000;

/// How long the pad is left alone before the first touch, so that the bridge knows its zero.
const REST_MS: u64 = 500;

/// A pad, the bridge and a game's view of it.
pub(crate) struct Bridge {
    /// The pad that the bridge reads.
    pub(crate) pad: Pad,
    /// The bridge.
    pub(crate) program: Running,
    /// The device that the bridge made.
    pub(crate) reader: Reader,
}

impl Bridge {
    /// Starts the bridge with `profile` on a new pad and waits until it is ready. `key` tells its device from others.
    pub(crate) fn start(profile: &str, key: KeyCode) -> Self {
        Self::start_under(NONE, profile, key)
    }

    /// The same with a finger that lies on the pad all the time.
    pub(crate) fn start_under(finger: Touch, profile: &str, key: KeyCode) -> Self {
        let mut pad = Pad::plug_in();
        let address = format!("serial:{}", pad.path());
        let mut program =
            Running::start(TACTPAD, &["run", "--pad", &address, "--profile", profile, "--output", "uinput"]);
        pad.hold_until("the bridge's device", finger, DEVICE_LIMIT_MS, || {
            assert!(!program.has_ended(), "the bridge ended");
            find(key).is_some()
        });
        let reader = Reader::open(&find(key).expect("it was there a moment ago"));
        pad.hold(finger, REST_MS);
        Self { pad, program, reader }
    }
}
