//! Captures in memory: read, written, replayed.

use firmware_proto::crc::crc32;
use tactpad::pipeline::call::Call;
use tactpad::pipeline::capture::reader::CaptureReader;
use tactpad::pipeline::capture::writer::CaptureWriter;
use tactpad::pipeline::control::OutputEvent;
use tactpad::pipeline::{NoProbe, Pipeline};

use crate::rig::first_profile;

/// How a capture begins.
pub const MAGIC: &[u8] = b"tactpad capture 1\n";

/// A file of entries that were written without their checksums, as far as they are whole: no fuzzer guesses those.
pub fn sealed(mut bare: &[u8]) -> Vec<u8> {
    const FIELDS_BYTES: usize = 13;
    let (mut file, mut chain) = (MAGIC.to_vec(), 0_u32);
    let mut seal = |file: &mut Vec<u8>, bytes: &[u8]| {
        file.extend_from_slice(bytes);
        chain = crc32(&[&chain.to_le_bytes(), bytes].concat());
        file.extend_from_slice(&chain.to_le_bytes());
    };
    while let Some((fields, rest)) = bare.split_at_checked(FIELDS_BYTES) {
        let length = fields.last_chunk().map_or(0, |length| u32::from_le_bytes(*length));
        let (payload, rest) = rest.split_at(rest.len().min(length as usize));
        seal(&mut file, fields);
        seal(&mut file, payload);
        bare = rest;
    }
    file
}

/// The capture in `file`, if it begins like one.
fn opened(file: &[u8]) -> Option<CaptureReader<&[u8]>> {
    CaptureReader::new(file).inspect_err(|error| assert!(!error.to_string().is_empty())).ok()
}

/// What stands in a file up to the first error; none where it is no capture. Profiles stand there without their times,
/// as a head has none.
pub fn read(file: &[u8]) -> Vec<String> {
    let Some(mut capture) = opened(file) else { return Vec::new() };
    let head = capture.head();
    let mut all: Vec<String> = head.decoder.iter().map(|decoder| format!("{decoder:?}")).collect();
    all.extend(head.profile.iter().map(|profile| format!("{:?}", Call::Profile(profile))));
    while let Some(Ok((now, call))) = capture.next_call() {
        match call {
            Call::Profile(_) => all.push(format!("{call:?}")),
            _ => all.push(format!("{now:?} {call:?}")),
        }
    }
    all
}

/// The file of what is read in `file` up to the first error.
pub fn written(file: &[u8]) -> Vec<u8> {
    let mut again = Vec::new();
    let Some(mut capture) = opened(file) else { return again };
    let mut writer = CaptureWriter::begin(&mut again, Default::default(), capture.head()).unwrap();
    while let Some(Ok((now, call))) = capture.next_call() {
        writer.write(now, call).unwrap();
    }
    drop(writer);
    again
}

/// The events of a file up to the first error. Its times may even run back, as no recorder's do.
pub fn replayed(file: &[u8]) -> Vec<OutputEvent> {
    let mut pipeline = Pipeline::new(tactpad::pipeline::shipped::decoder(), first_profile());
    let mut all = Vec::new();
    let Some(mut capture) = opened(file) else { return all };
    while let Some(Ok((now, call))) = capture.next_call() {
        let mut left = Some(call);
        while let Some(call) = left {
            left = pipeline.apply(now, call, &mut NoProbe);
            all.extend_from_slice(pipeline.events());
        }
    }
    all
}
