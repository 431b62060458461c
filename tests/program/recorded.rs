//! What `record` writes of the virtual pad, made in the pad's own time: nothing waits, and no busy machine loses a sample.
#![allow(clippy::unwrap_used, reason = "a test that cannot set its scene fails")]

use std::fs;
use std::path::Path;

use tactpad::pipeline::capture::head::Head;
use tactpad::pipeline::capture::writer::CaptureWriter;
use tactpad::pipeline::mapping::read::ReadProfile;
use tactpad::pipeline::mapping::read::check::OutputChoice;
use tactpad::pipeline::{mapping, shipped};
use tactpad::time::HostInstant;
use tactpad::virtual_pad::firmware::VirtualPad;
use tactpad::virtual_pad::recording::record;
use tactpad::virtual_pad::script::Script;

/// As the verb's own virtual pad has it.
const SEED: u64 = 1;

/// Writes a capture of so many seconds, in which `super-mario` is played until shortly before the end, with a shipped decoder.
pub(crate) fn write(path: &Path, decoder: &str, seconds: u64) {
    let text = mapping::read::shipped::text("super-mario").unwrap();
    let profile = ReadProfile::read(text, OutputChoice::AsWritten).0.unwrap();
    let end_us = 1_000_000 * seconds;
    let script = Script::for_profile(profile.profile(), end_us);
    // What every tactpad has is in no capture.
    let kept = Some(decoder).filter(|name| *name != shipped::STATICS).and_then(shipped::bytes);
    let head = Head { decoder: kept.map(Into::into), profile: Some(profile) };
    let mut capture = CaptureWriter::begin(Vec::new(), HostInstant::default(), &head).unwrap();
    let mut pad = VirtualPad::new(script, SEED);
    pad.introduce();
    record(&mut pad, end_us, &mut capture, |_, _| Ok(())).unwrap();
    fs::write(path, capture.get_mut()).unwrap();
}
