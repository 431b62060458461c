//! Captures in memory: read, written, replayed.

use std::convert::Infallible;

use firmware_proto::crc::crc32;
use tactpad::capture::{Call, CaptureReader, CaptureWriter};
use tactpad::control::OutputEvent;
use tactpad::pipeline::{NoProbe, Pipeline};
use tactpad::replay::make_call;

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

/// The calls of a file up to the first error; none where it is no capture.
pub fn calls(file: &[u8]) -> Vec<Call> {
    let reader = CaptureReader::new(file).inspect_err(|error| assert!(!error.to_string().is_empty()));
    reader.into_iter().flatten().map_while(Result::ok).collect()
}

/// The file of `calls`.
pub fn written(calls: &[Call]) -> Vec<u8> {
    let mut file = Vec::new();
    let mut writer = CaptureWriter::new(&mut file).unwrap();
    for call in calls {
        writer.write(call.now, call.kind.as_ref()).unwrap();
    }
    file
}

/// The events of `calls`. Their times may even run back, as no recorder's do.
pub fn replayed(calls: &[Call]) -> Vec<OutputEvent> {
    let mut pipeline = Pipeline::new(tactpad::shipped::decoder(), first_profile());
    let mut all = Vec::new();
    for call in calls {
        let made = make_call(&mut pipeline, call.now, call.kind.as_ref(), &mut NoProbe, |events| {
            all.extend_from_slice(events);
            Ok::<_, Infallible>(())
        });
        assert!(made.is_ok());
    }
    all
}
