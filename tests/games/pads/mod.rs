//! Pads that people own, of software: input devices and a pseudo-terminal, on which somebody plays.
//!
//! What a person and their pad are, is drawn from the seed, and so are the errors of each touch. The people are made up.

mod board;
mod cells;
mod hand;
mod input;
mod tablet;

use std::fmt;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::thread::{self, JoinHandle};

use tactpad::numeric::random::SplitMix64;
use tactpad::quantity::Contact;

use self::hand::OnPad;
use crate::clock::{monotonic_ns, wait_until};
use crate::player::{Begun, Cue};
use crate::segment::Segment;

/// A kind of pad.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    /// A Balance Board below the hands of who sits.
    Board,
    /// A pen on a tablet.
    Tablet,
    /// Four load cells below a plate of 200 mm, under hands, which print so many lines a second.
    Cells { lines_per_s: u64 },
}

impl fmt::Display for Kind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Board => f.write_str("balance board"),
            Self::Tablet => f.write_str("tablet"),
            Self::Cells { lines_per_s } => write!(f, "load cells, {lines_per_s} lines a second"),
        }
    }
}

/// A pad of software.
trait Device: Send {
    /// As `--pad` takes it.
    fn address(&self) -> String;

    /// From the middle of its area to the right edge and to the upper edge, mm.
    fn half_mm(&self) -> [f64; 2];

    /// Until it looks again at what lies on it, µs.
    fn wait_us(&mut self) -> u64;

    /// Takes what lies on it: a contact on a profile's plate.
    fn feel(&mut self, contact: &Contact);
}

/// A plate of a profile, from the middle to the edge.
const PLATE_MM: f64 = 30.0;

/// Evenly between two numbers.
fn between(random: &mut SplitMix64, [low, high]: [f64; 2]) -> f64 {
    low + (high - low) * f64::from(random.fraction())
}

/// Somebody at a pad of software; both end with it.
pub(crate) struct Owned {
    pub(crate) address: String,
    pub(crate) cue: Arc<Mutex<Cue<Segment>>>,
    stop: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl Owned {
    /// Makes the pad. Nobody plays before they are told to.
    pub(crate) fn start(kind: Kind, seed: u64) -> Self {
        let random = SplitMix64::named(seed, "pad");
        let device: Box<dyn Device> = match kind {
            Kind::Board => Box::new(board::Board::new(random)),
            Kind::Tablet => Box::new(tablet::Tablet::new(random)),
            Kind::Cells { lines_per_s } => Box::new(cells::Cells::new(random, lines_per_s)),
        };
        let habits = if kind == Kind::Tablet { &hand::PEN } else { &hand::HANDS };
        let body = OnPad::new(habits, device.half_mm(), seed);
        let (address, cue) = (device.address(), Cue::shared());
        let stop = Arc::new(AtomicBool::new(false));
        let playing = Playing { device, body, cue: Arc::clone(&cue), stop: Arc::clone(&stop) };
        let thread = Some(thread::spawn(|| playing.run()));
        Self { address, cue, stop, thread }
    }
}

impl Drop for Owned {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
        let ended = self.thread.take().map(JoinHandle::join);
        assert!(thread::panicking() || matches!(ended, Some(Ok(()))), "the pad's thread failed");
    }
}

struct Playing {
    device: Box<dyn Device>,
    body: OnPad,
    cue: Arc<Mutex<Cue<Segment>>>,
    stop: Arc<AtomicBool>,
}

impl Playing {
    fn run(mut self) {
        let origin_ns = monotonic_ns();
        let (mut now_ns, mut begun_ns) = (origin_ns, None);
        while !self.stop.load(Ordering::Relaxed) {
            now_ns += 1_000 * self.device.wait_us();
            wait_until(now_ns);
            let mut cue = self.cue.lock().unwrap();
            if let Some(segment) = cue.asked.take() {
                self.body.begin(&segment);
                begun_ns = Some(now_ns);
                cue.begun = Some(Begun { host_ns: now_ns, pad_us: now_ns / 1_000 });
            }
            drop(cue);
            let since_us = |from_ns: u64| (now_ns - from_ns) / 1_000;
            let contact = self.body.contact(since_us(origin_ns), begun_ns.map(since_us));
            self.device.feel(&contact);
        }
    }
}
