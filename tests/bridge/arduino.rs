//! The Arduino sketch of four load cells, compiled for this machine with chips by their data sheet at its pins: the lines that it prints are
//! those that the description `load-cells` reads.
#![expect(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use std::fmt::Write as _;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use tactpad::bridge::transport::lines::frames::LineFrames;
use tactpad::firmware_proto::channels::ChannelSample;
use tactpad::firmware_proto::frame::Message;
use tactpad::firmware_proto::link::MessageReceiver;
use tactpad::numeric::random::SplitMix64;
use tactpad::source::{Origin, read::read, shipped};

use crate::support::require;

/// What the sketch takes for a gram.
const COUNTS_PER_G: f64 = 420.0;
/// The ends of the converter's range.
const ENDS: [i64; 2] = [0x7f_ffff, -0x80_0000];
const LINE_US: u64 = 12_500;

fn compiled() -> Option<PathBuf> {
    if !require("g++", "apt-get install g++") {
        return None;
    }
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let program = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("load_cells.{}", std::process::id()));
    let compiled = Command::new("g++")
        .args(["-std=c++11", "-Wall", "-Wextra", "-Werror", "-x", "c++", "-include"])
        .arg(root.join("tests/bridge/arduino/Arduino.h"))
        .arg(root.join("firmware-proto/arduino/load_cells/load_cells.ino"))
        .arg("-o")
        .arg(&program)
        .status();
    assert!(compiled.unwrap().success());
    Some(program)
}

/// What the sketch prints of these counts; `None` for a chip that is not there.
fn printed(program: &Path, measured: &[[Option<i64>; 4]]) -> String {
    let mut counts = String::new();
    for cells in measured {
        let words = cells.map(|count| count.map_or("-".into(), |count| count.to_string()));
        writeln!(counts, "{}", words.join(" ")).unwrap();
    }
    let mut sketch = Command::new(program).stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().unwrap();
    let mut stdin = sketch.stdin.take().unwrap();
    let written = std::thread::spawn(move || stdin.write_all(counts.as_bytes()));
    let output = sketch.wait_with_output().unwrap();
    written.join().unwrap().unwrap();
    assert!(output.status.success());
    String::from_utf8(output.stdout).unwrap()
}

/// The samples that the reader makes of a text, each line at its time.
fn read_samples(text: &str) -> Vec<ChannelSample> {
    let source = read(shipped::text("load-cells").unwrap()).0.unwrap();
    let Origin::Lines(lines) = source.origin else { panic!("load cells print lines") };
    let (mut frames, mut receiver) = (LineFrames::new(&lines), MessageReceiver::new());
    let mut samples = Vec::new();
    // The reader takes what comes first for the end of a line that it has not seen begin, and believes a number of fields that it has
    // seen twice.
    for (at, line) in ["\r\n", "0,0,0,0\r\n"].into_iter().chain(text.split_inclusive('\n')).enumerate() {
        let mut bytes = Vec::new();
        frames.take(1_000_000 + LINE_US * at as u64, line.as_bytes(), &mut bytes);
        for message in bytes.iter().filter_map(|byte| receiver.push(*byte)) {
            let Ok(Message::Channels(sample)) = message else { panic!("{message:?}") };
            samples.push(sample);
        }
    }
    samples
}

#[test]
fn what_the_sketch_prints_is_what_the_chips_measure() {
    let Some(program) = compiled() else { return };
    for seed in 0..20 {
        let mut random = SplitMix64::named(seed, "cells");
        let mut draw = |below: u64| random.next_bits() % below;
        let measured: Vec<[Option<i64>; 4]> = (0..200)
            .map(|_| {
                std::array::from_fn(|_| match draw(20) {
                    0 => Some(ENDS[draw(2) as usize]),
                    1 => None,
                    // No two alike, so that no cell counts as one that stands still.
                    _ => Some(draw(0xff_fff0) as i64 - 0x7f_fff0),
                })
            })
            .collect();
        let text = printed(&program, &measured);
        assert_eq!(text.lines().count(), measured.len(), "seed {seed}");
        let samples = read_samples(&text);
        // A line without any number says nothing.
        let is_sound = |count: &Option<i64>| count.is_some_and(|count| !ENDS.contains(&count));
        let told = || measured.iter().filter(|cells| cells.iter().any(is_sound));
        assert_eq!(samples.len(), told().count(), "seed {seed}: {text}");
        for (sample, cells) in samples.iter().zip(told()) {
            for (cell, count) in cells.iter().enumerate() {
                assert_eq!(sample.status().is_out_of_range(cell), !is_sound(count), "seed {seed}: {cells:?}");
                let Some(count) = count.filter(|it| is_sound(&Some(*it))) else { continue };
                let grams = f64::from(sample.counts()[cell]) / 100.0;
                assert!(
                    (grams - count as f64 / COUNTS_PER_G).abs() < 0.02,
                    "seed {seed}: {grams} of {count}"
                );
            }
        }
    }
}
