//! The bridge under random bytes, random damage and random unplugging: it stays alive, holds nothing it should not,
//! and does not grow.
//!
//! A slice of 20 s runs with the other tests, in a guest in virtual time. The whole proof is ten minutes, in real time:
//! `cargo test --release --test bridge soak:: -- --ignored --nocapture`. It leaves a dated result file.
#![expect(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use std::collections::BTreeMap;
use std::fs;
use std::os::fd::OwnedFd;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};

use firmware_proto::ENCODED_MAX;
use firmware_proto::frame::Message;
use firmware_proto::link::encode_message;
use firmware_proto::sample::{Sample, Status};
use rustix::event::{PollFd, Timespec, poll};
use rustix::process::{Pid, Signal, kill_process};
use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};
use rustix::time::{ClockId, clock_gettime};
use tactpad::pad::field::PadField;
use tactpad::pad::influence::InfluenceField;
use tactpad::quantity::Contact;

use crate::guest::in_guest;

/// After this long without a sound frame nothing may be held.
const SETTLE_MS: u64 = 100;

/// How late a machine may be that has nothing else to do.
const LATE_MS: u64 = 150;

/// The most that resident memory may grow between a tenth of the time and the end.
const GROWTH_MAX_KB: u64 = 1_024;

struct Soak {
    folder: tempfile::TempDir,
    child: Child,
    line: Option<OwnedFd>,
    field: InfluenceField,
    random: u64,
    sequence: u32,
    time_us: u64,
    contact: Contact,
    unplugged: u32,
    damaged: u32,
    settle_ms: u64,
}

impl Soak {
    fn start(settle_ms: u64) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let (port, log) = (folder.path().join("pad"), folder.path().join("events"));
        let child = Command::new(env!("CARGO_BIN_EXE_tactpad"))
            .args(["run", "--wait", "--profile", "contra", "--pad"])
            .arg(format!("serial:{}", port.display()))
            .arg("--output")
            .arg(format!("log:{}", log.display()))
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        Self {
            folder,
            child,
            line: None,
            field: PadField::nominal().signals,
            random: 0x2545_f491_4f6c_dd1d,
            sequence: 0,
            time_us: 0,
            contact: Contact::default(),
            unplugged: 0,
            damaged: 0,
            settle_ms,
        }
    }

    fn port(&self) -> PathBuf {
        self.folder.path().join("pad")
    }

    fn plug_in(&mut self) {
        let line = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY).unwrap();
        rustix::io::ioctl_fionbio(&line, true).unwrap();
        grantpt(&line).unwrap();
        unlockpt(&line).unwrap();
        let far_end = ptsname(&line, Vec::new()).unwrap().into_string().unwrap();
        let _ = fs::remove_file(self.port());
        std::os::unix::fs::symlink(far_end, self.port()).unwrap();
        (self.line, self.sequence, self.time_us) = (Some(line), 0, 0);
    }

    fn unplug(&mut self) {
        let _ = fs::remove_file(self.port());
        self.line = None;
        self.unplugged += 1;
        wait_ms(self.settle_ms);
        self.assert_neutral();
    }

    /// One step of the pad's life, a millisecond of it.
    fn step(&mut self) {
        wait_ms(1);
        match self.random() % 4_000 {
            0 => {
                self.unplug();
                self.plug_in();
            }
            1 => {
                wait_ms(self.settle_ms);
                self.assert_neutral();
            }
            2..20 => self.move_finger(),
            20..40 => {
                let bytes: Vec<u8> = (0..self.random() % 400).map(|_| self.random() as u8).collect();
                self.write(&bytes);
            }
            40..60 => {
                let mut frame = self.frame();
                let place = self.random() as usize % frame.len();
                frame[place] ^= 1 << (self.random() % 8);
                self.damaged += 1;
                self.write(&frame);
            }
            60..70 => drop(self.frame()),
            _ => {
                let frame = self.frame();
                self.write(&frame);
            }
        }
    }

    fn move_finger(&mut self) {
        let mut amount = |range: f32| (self.random() % 2_001) as f32 / 1_000.0 * range - range;
        let (x_mm, y_mm, fy_n) = (amount(20.0), amount(20.0), amount(2.0));
        let fz_n = (amount(4.0)).max(0.0);
        self.contact = Contact { x_mm, y_mm, fx_n: 0.0, fy_n: if fz_n > 0.0 { fy_n } else { 0.0 }, fz_n };
    }

    fn frame(&mut self) -> Vec<u8> {
        self.time_us += 1_000;
        self.sequence = self.sequence.wrapping_add(1);
        let strain = self.field.strain_uv(&self.contact).uv;
        let counts = strain.map(|uv| (uv * 100.0) as i32 + (self.random() % 1_500) as i32);
        let sample = Sample {
            sequence: self.sequence,
            time_us: self.time_us,
            counts,
            temperature_centi_c: 2_500,
            status: Status::OK,
        };
        let mut frame = [0; ENCODED_MAX];
        let length = encode_message(&Message::Sample(sample), &mut frame);
        frame[..length].to_vec()
    }

    /// Writes as much as the line takes; reads away what the bridge says.
    fn write(&mut self, bytes: &[u8]) {
        if let Some(line) = &self.line {
            let _ = rustix::io::write(line, bytes);
            let _ = rustix::io::read(line, &mut [0; 256]);
        }
    }

    fn random(&mut self) -> u64 {
        self.random ^= self.random << 13;
        self.random ^= self.random >> 7;
        self.random ^= self.random << 17;
        self.random
    }

    fn assert_neutral(&mut self) {
        assert!(self.child.try_wait().unwrap().is_none(), "the bridge has ended");
        let held = held(&self.folder.path().join("events"));
        assert!(held.is_empty(), "held: {held:?}");
    }

    fn resident_kb(&self) -> u64 {
        let status = fs::read_to_string(format!("/proc/{}/status", self.child.id())).unwrap();
        let line = status.lines().find(|line| line.starts_with("VmRSS:")).unwrap();
        line.split_whitespace().nth(1).unwrap().parse().unwrap()
    }
}

impl Drop for Soak {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// Controls that the event log leaves held.
fn held(log: &Path) -> Vec<String> {
    let mut last = BTreeMap::new();
    for line in fs::read_to_string(log).unwrap().lines() {
        let event: serde_json::Value = serde_json::from_str(line).unwrap();
        last.insert(event["code"].to_string(), event["value"].as_i64().unwrap());
    }
    last.retain(|_, value| *value != 0);
    last.into_keys().collect()
}

fn now_ms() -> u64 {
    let now = clock_gettime(ClockId::Monotonic);
    now.tv_sec as u64 * 1_000 + now.tv_nsec as u64 / 1_000_000
}

/// Lets real time pass; the bridge under test lives in it.
fn wait_ms(ms: u64) {
    let limit = Timespec { tv_sec: (ms / 1_000) as i64, tv_nsec: (ms % 1_000) as i64 * 1_000_000 };
    let _ = poll(&mut [] as &mut [PollFd<'_>; 0], Some(&limit));
}

fn write_result(seconds: u64, soaked: &Soaked) {
    let Soaked { soak, early_kb, late_kb } = soaked;
    let result = serde_json::json!({
        "seconds": seconds, "unplugged": soak.unplugged, "damaged": soak.damaged,
        "resident_kb_early": early_kb, "resident_kb_late": late_kb,
    });
    crate::proof::write("soak", &result);
}

#[test]
fn nothing_is_held_and_nothing_grows() {
    in_guest("soak::nothing_is_held_and_nothing_grows", || {
        soak(20, SETTLE_MS);
    });
}

#[test]
#[ignore = "proof: ten minutes of real time, whose bounds ask for a quiet machine"]
fn nothing_is_held_and_nothing_grows_in_ten_minutes() {
    let seconds = std::env::var("TACTPAD_SOAK_SECONDS").ok().and_then(|text| text.parse().ok());
    let seconds = seconds.unwrap_or(600);
    write_result(seconds, &soak(seconds, SETTLE_MS + LATE_MS));
}

/// Resident memory a tenth of the time after the start, and at the end.
struct Soaked {
    soak: Soak,
    early_kb: u64,
    late_kb: u64,
}

/// Does everything to a bridge for so long, and sees that it holds nothing and does not grow.
fn soak(seconds: u64, settle_ms: u64) -> Soaked {
    let mut soak = Soak::start(settle_ms);
    soak.plug_in();
    let start_ms = now_ms();
    let (early_ms, end_ms) = (start_ms + seconds * 100, start_ms + seconds * 1_000);
    let mut early_kb = None;
    while now_ms() < end_ms {
        soak.step();
        if now_ms() >= early_ms && early_kb.is_none() {
            early_kb = Some(soak.resident_kb());
        }
    }
    let late_kb = soak.resident_kb();
    soak.unplug();
    let pid = Pid::from_child(&soak.child);
    kill_process(pid, Signal::TERM).unwrap();
    assert!(soak.child.wait().unwrap().success(), "the bridge ends well when it is asked to");
    let early_kb = early_kb.unwrap();
    assert!(late_kb <= early_kb + GROWTH_MAX_KB, "resident memory grew from {early_kb} kB to {late_kb} kB");
    let events = fs::read_to_string(soak.folder.path().join("events")).unwrap().lines().count();
    assert!(events >= 10, "only {events} events: the finger was not felt");
    Soaked { soak, early_kb, late_kb }
}
