//! A pad that presses on its right side for long, again and again, as a capture: `--pad capture:FILE`.
#![expect(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use std::path::{Path, PathBuf};

use firmware_proto::ENCODED_MAX;
use firmware_proto::frame::Message;
use firmware_proto::link::encode_message;
use firmware_proto::sample::{Sample, Status};
use tactpad::pad::field::PadField;
use tactpad::pipeline::call::Call;
use tactpad::pipeline::capture::head::Head;
use tactpad::pipeline::capture::writer::CaptureWriter;
use tactpad::quantity::Contact;
use tactpad::time::HostInstant;

/// How long the finger stays, and how long it is away.
const PRESS_MS: u32 = 2_500;
const REST_MS: u32 = 500;

/// Writes a minute of it into `folder`, at 1 kHz.
pub(crate) fn write_capture(folder: &Path) -> PathBuf {
    write_presses(folder, PRESS_MS)
}

/// Writes a minute of one press into `folder`, at 1 kHz.
pub(crate) fn write_long_press(folder: &Path) -> PathBuf {
    write_presses(folder, 60_000)
}

fn write_presses(folder: &Path, press_ms: u32) -> PathBuf {
    let field = PadField::nominal().signals;
    let pressed = field.strain_uv(&Contact { x_mm: 15.0, fz_n: 2.0, ..Contact::default() }).uv;
    let mut writer = CaptureWriter::begin(Vec::new(), HostInstant::default(), &Head::default()).unwrap();
    for sequence in 0..60_000 {
        let is_down = sequence > 1_000 && (sequence - 1_000) % (press_ms + REST_MS) < press_ms;
        let counts = pressed.map(|uv| if is_down { (uv * 100.0) as i32 } else { 0 });
        let time_us = u64::from(sequence) * 1_000;
        let sample = Sample { sequence, time_us, counts, temperature_centi_c: 2_500, status: Status::OK };
        let mut frame = [0; ENCODED_MAX];
        let length = encode_message(&Message::Sample(sample), &mut frame);
        let now = HostInstant::default().plus_us(time_us);
        writer.write(now, Call::Bytes(&frame[..length])).unwrap();
    }
    let path = folder.join("presses.cap");
    std::fs::write(&path, writer.get_mut()).unwrap();
    path
}
