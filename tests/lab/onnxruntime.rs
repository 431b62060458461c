//! Networks beside onnxruntime: the shipped one, and those that others could have written.
#![allow(clippy::unwrap_used, reason = "a test that cannot set its scene fails")]

use std::io::Write;
use std::process::{Command, Stdio};
use std::{env, thread};

use crate::support::{leave_out, require};
use tactpad::network::onnx;
use tactpad::pad::field::PadField;
use tactpad::quantity::{CHANNELS, Contact};

type Channels = [f32; CHANNELS];

/// An interpreter that has onnxruntime, if there is one.
fn python() -> Option<String> {
    let python = env::var("TACTPAD_PYTHON").unwrap_or_else(|_| "python3".into());
    if !require(&python, "apt-get install python3") {
        return None;
    }
    let mut imported = Command::new(&python);
    let imported = imported.args(["-c", "import onnxruntime"]).stderr(Stdio::null()).status();
    if imported.is_ok_and(|imported| imported.success()) {
        return Some(python);
    }
    leave_out("onnxruntime", "pip install onnxruntime, and TACTPAD_PYTHON where that is another python3");
    None
}

/// Numbers that fill −1 to 1 evenly in each place: multiples of a root, modulo 2.
fn spread<const N: usize>(index: u16) -> [f32; N] {
    const PRIMES: [f64; CHANNELS] = [2.0, 3.0, 5.0, 7.0, 11.0, 13.0, 17.0, 19.0, 23.0];
    std::array::from_fn(|k| ((f64::from(index) * PRIMES[k].sqrt()).fract() * 2.0 - 1.0) as f32)
}

/// What the nominal pad reads for presses all over it.
fn presses() -> Vec<Channels> {
    let field = PadField::nominal().signals;
    let press = |index| {
        let [x, y, fx, fy, fz] = spread(index);
        let contact =
            Contact { x_mm: 20.0 * x, y_mm: 20.0 * y, fx_n: 2.0 * fx, fy_n: 2.0 * fy, fz_n: 2.5 * fz + 2.5 };
        field.strain_uv(&contact).uv
    };
    (1..2_000).map(press).collect()
}

/// Numbers as large as the small networks' weights.
fn numbers() -> Vec<Channels> {
    (1..500).map(spread).collect()
}

fn by_onnxruntime(python: &str, file: &str, rows: &[Channels]) -> Vec<[f32; 5]> {
    let mut child = Command::new(python)
        .args(["tests/lab/network/run.py", file])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let mut to = child.stdin.take().unwrap();
    let bytes: Vec<u8> = rows.as_flattened().iter().flat_map(|number| number.to_le_bytes()).collect();
    let writer = thread::spawn(move || to.write_all(&bytes).unwrap());
    let output = child.wait_with_output().unwrap();
    writer.join().unwrap();
    assert!(output.status.success(), "{file}");
    let numbers = output.stdout.as_chunks::<4>().0.iter().map(|bytes| f32::from_le_bytes(*bytes));
    numbers.collect::<Vec<_>>().as_chunks().0.to_vec()
}

/// Sees that both give the same within 1e-5 of each output's full scale.
fn agree(what: &str, found: &[[f32; 5]], wanted: &[[f32; 5]]) {
    assert_eq!(found.len(), wanted.len(), "{what}");
    for output in 0..5 {
        let full_scale = wanted.iter().map(|row| row[output].abs()).fold(0.0, f32::max);
        let off = found.iter().zip(wanted).map(|(found, wanted)| (found[output] - wanted[output]).abs());
        let off = off.fold(0.0, f32::max);
        assert!(off.is_finite() && off <= 1e-5 * full_scale, "{what}: {off} of {full_scale}");
    }
}

fn decoded(file: &str, rows: &[Channels]) -> Vec<[f32; 5]> {
    let network = onnx::read(&std::fs::read(file).unwrap()).unwrap();
    rows.iter().map(|row| network.decode(row)).collect()
}

#[test]
fn onnxruntime_gives_what_the_program_gives() {
    let Some(python) = python() else { return };
    let shipped = "models/scdf.onnx";
    agree(shipped, &decoded(shipped, &presses()), &by_onnxruntime(&python, shipped, &presses()));
    for name in ["gemm", "matmul", "traced", "translated"] {
        let file = format!("tests/lab/network/{name}.onnx");
        agree(&file, &decoded(&file, &numbers()), &by_onnxruntime(&python, &file, &numbers()));
    }
}

#[cfg(feature = "foreign-onnx")]
#[test]
fn onnxruntime_gives_what_tract_gives() {
    use tactpad::network::foreign::Foreign;
    let Some(python) = python() else { return };
    for (file, rows) in [("models/scdf.onnx", presses()), ("tests/lab/network/residual.onnx", numbers())] {
        let network = Foreign::read(&std::fs::read(file).unwrap()).unwrap();
        let found: Vec<_> = rows.iter().map(|row| network.decode(row)).collect();
        agree(file, &found, &by_onnxruntime(&python, file, &rows));
    }
}
