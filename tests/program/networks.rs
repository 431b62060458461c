//! ONNX files as decoders: damage is found, what is no decoder is refused, what may be of another pad is said.
#![allow(clippy::unwrap_used, reason = "a test that cannot set its scene fails")]

use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};

use tactpad::pad::field::PadField;
use tactpad::quantity::Contact;

const SHIPPED: &[u8] = include_bytes!("../../models/scdf.onnx");
const FOREIGN: &[u8] = include_bytes!("../lab/network/gemm.onnx");

/// What `evaluate` makes of presses of the nominal pad with these bytes as its decoder.
fn evaluated(folder: &Path, network: &[u8]) -> Output {
    let signals = PadField::nominal().signals;
    let names = tactpad::quantity::CHANNEL_NAMES.map(|name| format!("{name}_uv")).join(",");
    let row = |fz_n: u8| {
        let contact = Contact { x_mm: 9.0, fz_n: f32::from(fz_n), ..Contact::default() };
        let uv = signals.strain_uv(&contact).uv.map(|uv| uv.to_string()).join(",");
        format!("9,0,0,0,{fz_n},{uv}\n")
    };
    let rows: String = (0..4).map(row).collect();
    fs::write(folder.join("m.csv"), format!("x_mm,y_mm,fx_n,fy_n,fz_n,{names}\n{rows}")).unwrap();
    fs::write(folder.join("network.onnx"), network).unwrap();
    let mut command = Command::new(env!("CARGO_BIN_EXE_tactpad"));
    command.args(["evaluate", "--decoder", "network.onnx", "--measured", "m.csv", "--json"]);
    command.current_dir(folder).stdin(Stdio::null()).output().unwrap()
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// The bytes with the first `from` replaced by `to`, which is as long.
fn replaced(bytes: &[u8], from: &[u8], to: &[u8]) -> Vec<u8> {
    let mut bytes = bytes.to_vec();
    let at = bytes.windows(from.len()).position(|window| window == from).unwrap();
    bytes[at..at + to.len()].copy_from_slice(to);
    bytes
}

#[test]
fn flipped_bits_of_our_own_file_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    assert!(evaluated(folder.path(), SHIPPED).status.success());
    for step in 0..40 {
        let mut bytes = SHIPPED.to_vec();
        // The checksum's own property is at the end.
        let bit = step * (8 * (bytes.len() - 50) / 40) + 3;
        bytes[bit / 8] ^= 1 << (bit % 8);
        let output = evaluated(folder.path(), &bytes);
        assert_eq!(output.status.code(), Some(2), "bit {bit}: {}", said(&output));
        assert!(said(&output).contains("network.onnx cannot be read: "), "{}", said(&output));
        assert!(output.stdout.is_empty());
    }
}

#[test]
fn a_network_without_checksum_is_tried_on_the_nominal_pad() {
    let folder = tempfile::tempdir().unwrap();
    // As an earlier tactpad wrote it.
    let at = SHIPPED.windows(16).rposition(|window| window == b"tactpad.checksum").unwrap();
    let earlier = &SHIPPED[..at - 4];
    let output = evaluated(folder.path(), earlier);
    assert!(output.status.success() && said(&output).is_empty(), "{}", said(&output));
    // Its last scaler says what a newton is; 19 bytes behind the name, four for each number.
    let scaler = earlier.windows(17).rposition(|window| window == b"contact_deviation").unwrap();
    let with_newton = |change: fn(f32) -> f32| {
        let mut bytes = earlier.to_vec();
        let number: &mut [u8; 4] = bytes[scaler + 19 + 16..].first_chunk_mut().unwrap();
        *number = change(f32::from_le_bytes(*number)).to_le_bytes();
        bytes
    };
    let output = evaluated(folder.path(), &with_newton(|newton| 3.0 * newton));
    assert!(output.status.success(), "{}", said(&output));
    let words = ["warning: decoder network.onnx", "no checksum", "misses presses of the nominal pad by"];
    assert!(words.iter().all(|word| said(&output).contains(word)), "{}", said(&output));
    let output = evaluated(folder.path(), &with_newton(|_| 1e30));
    assert_eq!(output.status.code(), Some(2), "{}", said(&output));
    assert!(said(&output).contains("beyond 300 mm or 100 N, or no number"), "{}", said(&output));
}

#[test]
fn what_a_terminal_obeys_does_not_reach_it_from_a_file() {
    let folder = tempfile::tempdir().unwrap();
    let output = evaluated(folder.path(), &replaced(FOREIGN, b"Gemm", b"\x1b[2J"));
    assert_eq!(output.status.code(), Some(2));
    assert!(said(&output).contains("an operator \\u{1b}[2J is no step"), "{:?}", said(&output));
    assert!(!said(&output).contains('\x1b'));
}
