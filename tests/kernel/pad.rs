//! A pad at the other end of a pseudo-terminal, with a finger that the test moves.

use std::os::fd::{AsFd, OwnedFd};
use std::sync::LazyLock;

use rustix::fs::{Mode, OFlags};
use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};
use rustix::termios::{OptionalActions, tcgetattr, tcsetattr};
use tactpad::pad::field::PadField;
use tactpad::quantity::Contact;

use crate::clock::{MS, monotonic_ns, readable_before, stamp_ns};
use crate::wire::sample_frame;

/// A pad that says nothing of its converter has counts of 0.01 µV.
const COUNTS_PER_UV: f64 = 100.0;

/// Of the nominal pad; reading it takes longer than a sample.
static FIELD: LazyLock<PadField> = LazyLock::new(PadField::nominal);

/// A finger on the plate: where, and how hard it presses.
#[derive(Clone, Copy)]
pub(crate) struct Touch {
    /// Along +x, to the right.
    pub(crate) x_mm: f64,
    /// Along +y, up.
    pub(crate) y_mm: f64,
    /// Into the plate.
    pub(crate) fz_n: f64,
}

/// No finger.
pub(crate) const NONE: Touch = Touch { x_mm: 0.0, y_mm: 0.0, fz_n: 0.0 };
/// A light touch right of the centre, and so on.
pub(crate) const RIGHT: Touch = Touch { x_mm: 12.0, y_mm: 0.0, fz_n: 1.0 };
pub(crate) const LEFT: Touch = Touch { x_mm: -12.0, ..RIGHT };
pub(crate) const UP: Touch = Touch { x_mm: 0.0, y_mm: 12.0, fz_n: 1.0 };
pub(crate) const DOWN: Touch = Touch { y_mm: -12.0, ..UP };
/// A firm press on the centre, where there is no direction.
pub(crate) const PRESS: Touch = Touch { fz_n: 3.0, ..NONE };
/// A firm press right of the centre: direction and button.
pub(crate) const PRESS_RIGHT: Touch = Touch { fz_n: 3.0, ..RIGHT };

impl Touch {
    /// The nine counts of the nominal pad. Nothing pushes sideways.
    #[expect(clippy::cast_possible_truncation, reason = "a finger's counts fit in 24 bits")]
    pub(crate) fn counts(self) -> [i32; 9] {
        let Self { x_mm, y_mm, fz_n } = self;
        let [x_mm, y_mm, fz_n] = [x_mm, y_mm, fz_n].map(|number| number as f32);
        let contact = Contact { x_mm, y_mm, fz_n, ..Contact::default() };
        let strain = FIELD.signals.strain_uv(&contact);
        strain.uv.map(|uv| (f64::from(uv) * COUNTS_PER_UV).round() as i32)
    }
}

/// Nanoseconds from one sample to the next: of a thousand samples a second, or of as many as `TACTPAD_TEST_RATE_HZ`
/// says. A guest that emulates every instruction keeps up with a hundred.
pub(crate) fn period_ns() -> u64 {
    let rate = std::env::var("TACTPAD_TEST_RATE_HZ").unwrap_or_else(|_| "1000".into());
    let rate_hz: u64 = rate.parse().expect("TACTPAD_TEST_RATE_HZ is a number of samples a second");
    assert!((100..=1_000).contains(&rate_hz), "TACTPAD_TEST_RATE_HZ is {rate_hz}, not 100 to 1000");
    1_000 * MS / rate_hz
}

/// The pad: 1000 samples a second (see [`period_ns`]) while it streams, silent otherwise. It answers no command.
pub(crate) struct Pad {
    line: OwnedFd,
    // Held open so that the line keeps its raw mode and exists before the bridge opens it.
    _far_end: OwnedFd,
    path: String,
    sequence: u32,
    started_ns: u64,
    time_ms: u64,
    last_write_ns: u64,
}

impl Pad {
    /// Makes a pad; it says nothing yet.
    pub(crate) fn plug_in() -> Self {
        // Not for children: a line that they hold open cannot be unplugged.
        let flags = OpenptFlags::RDWR | OpenptFlags::NOCTTY | OpenptFlags::CLOEXEC;
        let line = openpt(flags).expect("a pseudo-terminal");
        grantpt(&line).expect("grantpt");
        unlockpt(&line).expect("unlockpt");
        let path = ptsname(&line, Vec::new()).expect("its name").into_string().expect("an ASCII name");
        let flags = OFlags::RDWR | OFlags::NOCTTY | OFlags::CLOEXEC;
        let far_end = rustix::fs::open(path.as_str(), flags, Mode::empty()).expect("its other end");
        let mut mode = tcgetattr(&far_end).expect("its mode");
        mode.make_raw();
        tcsetattr(&far_end, OptionalActions::Now, &mode).expect("raw mode");
        LazyLock::force(&FIELD);
        let started_ns = monotonic_ns();
        Self { line, _far_end: far_end, path, sequence: 0, started_ns, time_ms: 0, last_write_ns: 0 }
    }

    /// The port to open for this pad.
    pub(crate) fn path(&self) -> &str {
        &self.path
    }

    /// When the last frame was written, on the clock of the kernel's event stamps.
    pub(crate) fn last_write_ns(&self) -> u64 {
        self.last_write_ns
    }

    /// The next frame: a millisecond of the pad's time after the one before, or more if the pad was silent.
    pub(crate) fn next_frame(&mut self, touch: Touch) -> Vec<u8> {
        let elapsed_ms = (monotonic_ns() - self.started_ns) / MS;
        self.time_ms = elapsed_ms.max(self.time_ms + 1);
        let frame = sample_frame(self.sequence, self.time_ms * 1_000, touch.counts());
        self.sequence += 1;
        frame
    }

    /// Writes `frame` whole, in one system call.
    pub(crate) fn write(&mut self, frame: &[u8]) {
        assert_eq!(rustix::io::write(&self.line, frame), Ok(frame.len()), "the line takes a frame at once");
        self.last_write_ns = stamp_ns();
    }

    /// Streams `touch` for `for_ms` milliseconds.
    pub(crate) fn hold(&mut self, touch: Touch, for_ms: u64) {
        let (start_ns, period_ns) = (monotonic_ns(), period_ns());
        for frame in 1..=for_ms * MS / period_ns {
            self.stream_one(touch, start_ns + frame * period_ns);
        }
    }

    /// Streams `touch` until `done` says so.
    pub(crate) fn hold_until(
        &mut self,
        what: &str,
        touch: Touch,
        limit_ms: u64,
        mut done: impl FnMut() -> bool,
    ) {
        let limit_ns = monotonic_ns() + limit_ms * MS;
        let period_ns = period_ns();
        while !done() {
            let now_ns = monotonic_ns();
            assert!(now_ns < limit_ns, "{what}: not within {limit_ms} ms");
            self.stream_one(touch, now_ns + period_ns);
        }
    }

    /// Pulls the plug; returns the stamp of that moment.
    pub(crate) fn unplug(self) -> u64 {
        stamp_ns()
    }

    /// Writes a frame, then takes what the bridge says until the next one is due.
    pub(crate) fn stream_one(&mut self, touch: Touch, next_ns: u64) {
        let frame = self.next_frame(touch);
        self.write(&frame);
        while readable_before(next_ns, self.line.as_fd()) {
            rustix::io::read(&self.line, &mut [0; 256]).expect("the bridge's commands");
        }
    }
}
