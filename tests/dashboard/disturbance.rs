//! What an open page costs the live path: frame on the terminal → event in the log, with the page and without it.
//!
//! Two bridges play at the same time, each on a pad of its own. One is measured. The browser shows now the one, now the other, so that it loads
//! the machine alike, and only the connection differs.

use std::collections::VecDeque;
use std::io::{BufRead, BufReader};
use std::sync::mpsc::{Receiver, channel};
use std::sync::{Arc, Mutex};
use std::{fs, thread};

use firmware_proto::ENCODED_MAX;
use firmware_proto::frame::Message;
use firmware_proto::link::encode_message;
use firmware_proto::sample::{Sample, Status};
use rustix::fs::{CWD, FileType, Mode, mknodat};
use tactpad::bridge::clock::Clock;
use tactpad::bridge::transport::virtual_pad::{PadFirmware, VirtualPadPort};
use tactpad::pad::field::PadField;
use tactpad::quantity::Contact;
use tactpad::time::HostInstant;

use crate::browser::Browser;
use crate::running::comes_true;
use crate::shown::Shown;

/// Nothing waits: what is left is the way itself.
const PROFILE: &str = "schema = 1\nname = \"way\"\noutput = \"gamepad\"\nfilter_samples = 1\nmin_press_ms = 0\n\
                       [[button]]\nforce = \"fz\"\npress_n = 1.0\nrelease_n = 0.8\n\
                       out = { gamepad = \"BTN_SOUTH\", keyboard = \"KEY_Z\" }\n";

/// Blocks of each kind, interleaved.
const BLOCKS: usize = 5;
/// Frames of a block.
const FRAMES: usize = 20_000;
/// The pad's rate.
const PERIOD_US: u64 = 250;
/// Each so manieth frame presses, or lifts to half of the threshold.
const FRAMES_PER_EDGE: u32 = 4;
/// The page may make the slowest hundredth so much slower.
const RATIO_MAX: f64 = 1.3;

/// A pad that presses and lets go, again and again; it tells when.
struct Pulse {
    uv_per_n: [f64; 9],
    clock: Clock,
    edges: Arc<Mutex<VecDeque<HostInstant>>>,
    sequence: u32,
}

impl Pulse {
    /// It rests for so many frames, in which the bridge measures its zero.
    const REST: u32 = 4_000;

    fn start(clock: Clock) -> (VirtualPadPort, Arc<Mutex<VecDeque<HostInstant>>>) {
        let contact = Contact { fz_n: 1.0, ..Contact::default() };
        let uv = PadField::nominal().signals.strain_uv(&contact).uv.map(f64::from);
        let edges = Arc::default();
        let pulse = Self { uv_per_n: uv, clock, edges: Arc::clone(&edges), sequence: 0 };
        (VirtualPadPort::start(pulse).unwrap(), edges)
    }

    fn force_n(&self) -> f64 {
        match self.sequence {
            0..Self::REST => 0.0,
            sequence if (sequence / FRAMES_PER_EDGE).is_multiple_of(2) => 2.0,
            _ => 0.5,
        }
    }
}

impl PadFirmware for Pulse {
    fn receive(&mut self, _bytes: &[u8]) {}

    fn due_us(&self) -> u64 {
        u64::from(self.sequence + 1) * PERIOD_US
    }

    fn emit(&mut self, now_us: u64, bytes: &mut Vec<u8>) {
        while self.due_us() <= now_us {
            let time_us = self.due_us();
            self.sequence += 1;
            let force_n = self.force_n();
            // A channel that stands still for long is a fault: the last digit moves.
            let jitter = i32::from(self.sequence.is_multiple_of(2));
            let sample = Sample {
                sequence: self.sequence,
                time_us,
                counts: self.uv_per_n.map(|uv| (100.0 * uv * force_n).round() as i32 + jitter),
                temperature_centi_c: 0,
                status: Status::OK.with_temperature_invalid(),
            };
            let mut frame = [0; ENCODED_MAX];
            let length = encode_message(&Message::Sample(sample), &mut frame);
            bytes.extend_from_slice(&frame[..length]);
            if self.sequence > Self::REST && self.sequence.is_multiple_of(FRAMES_PER_EDGE) {
                self.edges.lock().unwrap().push_back(self.clock.now());
            }
        }
    }
}

/// A bridge, and how long its events take.
struct Way {
    shown: Shown,
    _pad: VirtualPadPort,
    took_us: Receiver<f64>,
}

impl Way {
    fn start() -> Self {
        let clock = Clock::start();
        let (pad, edges) = Pulse::start(clock);
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("way.toml"), PROFILE).unwrap();
        mknodat(CWD, folder.path().join("log"), FileType::Fifo, Mode::RWXU, 0).unwrap();
        let path = folder.path().join("log");
        let (tell, took_us) = channel();
        thread::spawn(move || {
            let lines = BufReader::new(fs::File::open(path).unwrap()).lines();
            for _ in lines.map_while(Result::ok) {
                let now = clock.now();
                let sent = edges.lock().unwrap().pop_front();
                if sent.is_some_and(|sent| tell.send((now.as_ns() - sent.as_ns()) as f64 * 1e-3).is_err()) {
                    return;
                }
            }
        });
        let shown = Shown::start_in(folder, &format!("serial:{}", pad.path()), "./way.toml");
        Self { shown, _pad: pad, took_us }
    }

    /// The durations of the next so many events.
    fn block(&self, events: usize) -> Vec<f64> {
        while self.took_us.try_recv().is_ok() {}
        self.took_us.iter().take(events).collect()
    }
}

fn p99(took_us: &[f64]) -> f64 {
    let mut sorted = took_us.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted[sorted.len() * 99 / 100]
}

#[test]
#[ignore = "proof: two minutes that measure what a page costs, which only a quiet machine tells"]
fn an_open_page_makes_the_live_path_hardly_slower() {
    let events = FRAMES / FRAMES_PER_EDGE as usize;
    let (measured, other) = (Way::start(), Way::start());
    let Some(browser) = Browser::open(&other.shown.url) else { return };
    let show = |way: &Way| {
        browser.run(&format!("location.href = '{}'", way.shown.url));
        browser.wait(&format!(
            "location.host === '{}' && Number(document.documentElement.dataset.updates) > 100",
            way.shown.host
        ));
    };
    for way in [&measured, &other] {
        assert!(
            comes_true(|| way.shown.status()["held"].to_string().contains("BTN_SOUTH")),
            "{}",
            way.shown.status()
        );
    }
    let (mut without, mut with) = (Vec::new(), Vec::new());
    for block in 0..BLOCKS {
        show(&other);
        let off = measured.block(events);
        show(&measured);
        let on = measured.block(events);
        eprintln!("block {}: p99 {:.0} µs without, {:.0} µs with the page", block + 1, p99(&off), p99(&on));
        without.extend(off);
        with.extend(on);
    }
    let (off, on) = (p99(&without), p99(&with));
    eprintln!(
        "{} events each: p99 {off:.0} µs without, {on:.0} µs with the page: {:.2} times",
        with.len(),
        on / off
    );
    let lost = measured.shown.status()["health"]["frames_lost"].clone();
    assert_eq!(lost, 0);
    assert!(on <= RATIO_MAX * off, "{on} µs with the page, {off} µs without");
}
