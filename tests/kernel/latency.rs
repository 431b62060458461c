//! How long a D-pad edge takes from the pad's write to a game's read, against the least a bridge can do.
//!
//! Writer, reader and processor are the same for both, and both always run, turn by turn in blocks, so that whatever
//! the machine does meanwhile happens to both. Only their ratio means anything outside this machine.

use std::io::{BufRead, BufReader};
use std::os::fd::AsFd;
use std::path::Path;

use evdev::KeyCode;

use crate::bridge::Bridge;
use crate::clock::{MS, monotonic_ns, readable_before, stamp_ns};
use crate::pad::{NONE, Pad, RIGHT, Touch};
use crate::program::{Running, path};
use crate::reader::Reader;

/// No smoothing and no minimum press: what is left is the way itself.
const PROFILE: &str = r#"
schema = 1
name = "latency"
output = "gamepad"
filter_samples = 1
min_press_ms = 0

[dpad]
mode = "4way"
"#;

/// Edges of each of the two, where `TACTPAD_LATENCY_EDGES` names no other number.
const EDGES: usize = 1_000;

/// Edges in a turn; even, so that a turn ends with nothing held.
const EDGES_PER_BLOCK: usize = 200;

/// Frames between edges, a millisecond apart, that change nothing.
const SETTLING_FRAMES: usize = 5;

/// A pad that was kept from writing for so long may pass for silent, at 80 ms, by no fault of the bridge.
const STALL_MS: u64 = 40;

/// Frames without a finger after a stall, until everything is as at the start.
const RECOVERY_FRAMES: usize = 500;

/// An edge that takes longer is lost.
const EDGE_LIMIT_MS: u64 = 200;

/// In virtual time work takes none: only reading a clock does, a quarter of a microsecond. An edge that takes longer than
/// this was waiting for something.
const WAITED_NS: u64 = 100_000;

/// A pad, what reads it, and the device that comes of it.
struct Way {
    pad: Pad,
    reader: Reader,
    _program: Running,
    held: bool,
    /// How many events the settling frames make.
    settling_events: usize,
    took_ns: Vec<u64>,
}

/// Between the pad's write and the game's read of an edge the bridge waits for nothing.
pub(crate) fn waits_for_nothing() {
    let mut way = bridge();
    for number in 0..EDGES {
        for _ in 0..SETTLING_FRAMES {
            way.pad.stream_one(way.touch(), monotonic_ns() + MS);
        }
        assert!(way.edge().is_ok(), "edge {number} comes a millisecond after a frame");
    }
    let longest_ns = way.took_ns.iter().max().expect("edges");
    println!("{EDGES} edges; the longest took {longest_ns} ns of virtual time");
    assert!(*longest_ns <= WAITED_NS, "an edge took {longest_ns} ns, in which nobody worked");
}

/// The bridge's median is at most twice the echo's, and 20 µs.
pub(crate) fn against_an_echo() {
    let mut ways = [bridge(), echo()];
    let edges = std::env::var("TACTPAD_LATENCY_EDGES");
    let edges = edges.map_or(EDGES, |edges| edges.parse().expect("TACTPAD_LATENCY_EDGES is a number"));
    let mut stalls = 0;
    for _ in 0..edges.div_ceil(EDGES_PER_BLOCK) {
        for measured in 0..ways.len() {
            for _ in 0..EDGES_PER_BLOCK {
                while settle(&mut ways, measured).and_then(|()| ways[measured].edge()).is_err() {
                    stalls += 1;
                    recover(&mut ways);
                }
            }
        }
    }
    let [bridge, echo] = ways.map(|way| quantiles_us(way.took_ns));
    println!("{edges} edges; median, 95th and 99th percentile in us: bridge {bridge:.1?}, echo {echo:.1?}");
    println!(
        "ratio of the medians {:.2}; edges repeated after a stall of the machine: {stalls}",
        bridge[0] / echo[0]
    );
    assert!(bridge[0] <= 2.0 * echo[0] + 20.0, "the bridge's median is more than twice the echo's and 20 us");
}

fn bridge() -> Way {
    let profile = std::env::temp_dir().join("latency.toml");
    std::fs::write(&profile, PROFILE).expect("a profile");
    let Bridge { pad, program, reader } =
        Bridge::start(profile.to_str().expect("an ASCII path"), KeyCode::BTN_SOUTH);
    Way { pad, reader, _program: program, held: false, settling_events: 0, took_ns: Vec::new() }
}

fn echo() -> Way {
    let pad = Pad::plug_in();
    let mut program = Running::start(path("echo"), &[pad.path()]);
    let mut node = String::new();
    BufReader::new(program.take_output()).read_line(&mut node).expect("a line");
    let reader = Reader::open(Path::new(node.trim()));
    Way { pad, reader, _program: program, held: false, settling_events: SETTLING_FRAMES, took_ns: Vec::new() }
}

/// Frames that change nothing, to both, so that neither takes its pad for silent; then both are quiet.
///
/// The one that is measured next is served last: either finds the processor's caches as its own frame left them.
fn settle(ways: &mut [Way; 2], measured: usize) -> Result<(), Stalled> {
    for _ in 0..SETTLING_FRAMES {
        let next_ns = monotonic_ns() + MS;
        ways[1 - measured].rest_until(0)?;
        ways[measured].rest_until(next_ns)?;
    }
    for way in ways {
        way.reader.read_until(EDGE_LIMIT_MS, |seen| seen.len() >= way.settling_events);
        way.reader.read_available();
        way.check_running()?;
        assert_eq!(way.reader.seen.len(), way.settling_events, "{:?}", way.reader.seen);
        way.reader.seen.clear();
    }
    Ok(())
}

/// No finger on either pad until both ways are as they were at the start.
fn recover(ways: &mut [Way; 2]) {
    for _ in 0..RECOVERY_FRAMES {
        let next_ns = monotonic_ns() + MS;
        for way in &mut *ways {
            way.held = false;
            way.pad.stream_one(NONE, next_ns);
            way.reader.read_available();
        }
    }
    for way in ways {
        way.reader.seen.clear();
    }
}

/// The whole machine stood still for so long that what was measured means nothing.
struct Stalled;

impl Way {
    /// One frame that changes nothing, and a wait.
    fn rest_until(&mut self, next_ns: u64) -> Result<(), Stalled> {
        self.check_running()?;
        self.pad.stream_one(self.touch(), next_ns);
        Ok(())
    }

    fn check_running(&self) -> Result<(), Stalled> {
        let last_ns = self.pad.last_write_ns();
        if last_ns == 0 || stamp_ns() - last_ns < STALL_MS * MS { Ok(()) } else { Err(Stalled) }
    }

    fn touch(&self) -> Touch {
        if self.held { RIGHT } else { NONE }
    }

    /// One frame that changes what is held, timed until the change can be read.
    fn edge(&mut self) -> Result<(), Stalled> {
        self.check_running()?;
        self.held = !self.held;
        let frame = self.pad.next_frame(self.touch());
        let written_ns = monotonic_ns();
        self.pad.write(&frame);
        let arrived = readable_before(written_ns + EDGE_LIMIT_MS * MS, self.reader.device.as_fd());
        let readable_ns = monotonic_ns();
        assert!(arrived, "edge {} never came", self.took_ns.len());
        self.took_ns.push(readable_ns - written_ns);
        self.reader.read_available();
        assert_eq!(self.reader.seen.len(), 1, "one frame, one edge: {:?}", self.reader.seen);
        self.reader.seen.clear();
        Ok(())
    }
}

/// Median, 95th and 99th percentile in microseconds.
fn quantiles_us(mut took_ns: Vec<u64>) -> [f64; 3] {
    took_ns.sort_unstable();
    [50, 95, 99].map(|percent| took_ns[took_ns.len() * percent / 100] as f64 / 1e3)
}
