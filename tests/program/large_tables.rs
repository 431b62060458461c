//! Tables of a million rows: in how much memory, and in which time, they are read and judged.
#![allow(clippy::unwrap_used, reason = "a test that cannot set its scene fails")]

use std::fmt::Write as _;
use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::time::Instant;

use tactpad::pad::field::PadField;
use tactpad::pipeline::compensation::creep::Creep;
use tactpad::pipeline::compensation::hysteresis::PlayOperators;
use tactpad::pipeline::shipped;
use tactpad::quantity::{CHANNEL_NAMES, CHANNELS, Contact};

/// Writes a table of presses on a spiral, one row in ten without load and a session of its own, that warms by ten degrees.
fn write(path: &Path, rows: u32) {
    let signals = PadField::nominal().signals;
    let mut text = format!("session,t_s,temp_c,x_mm,y_mm,fx_n,fy_n,fz_n,{}_uv\n", CHANNEL_NAMES.join("_uv,"));
    for row in 0..rows {
        let turn = row as f32 * 2.4;
        let radius_mm = 29.0 * (f64::from(row) / f64::from(rows)).sqrt() as f32;
        let load = if row % 10 == 0 { 0.0 } else { 1.0 };
        let contact = Contact {
            x_mm: radius_mm * libm::cosf(turn),
            y_mm: radius_mm * libm::sinf(turn),
            fx_n: load * libm::cosf(0.7 * turn),
            fy_n: load * libm::sinf(1.3 * turn),
            fz_n: load * (1.0 + (row % 7) as f32 / 2.0),
        };
        let Contact { x_mm, y_mm, fx_n, fy_n, fz_n } = contact;
        let session = if load > 0.0 { "play" } else { "zero" };
        let temp_c = 20.0 + 10.0 * f64::from(row) / f64::from(rows);
        let _ = write!(text, "{session},{row},{temp_c:.2},{x_mm:.3},{y_mm:.3},{fx_n:.4},{fy_n:.4},{fz_n:.4}");
        signals.strain_uv(&contact).uv.iter().for_each(|uv| write!(text, ",{uv:.2}").unwrap());
        text.push('\n');
    }
    fs::write(path, text).unwrap();
}

/// Runs the program with as much memory for its data as this, in kB.
fn within(data_kb: u32, folder: &Path, line: &str) -> Output {
    let program = env!("CARGO_BIN_EXE_tactpad");
    let mut shell = Command::new("sh");
    shell.args(["-c", &format!("ulimit -d {data_kb} && exec {program} {line}")]);
    shell.current_dir(folder).stdin(Stdio::null()).output().unwrap()
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// Writes the decoder of a pad that creeps and has hysteresis; its file's name.
fn pad_with_memory(folder: &Path) -> &'static str {
    let mut decoder = shipped::decoder();
    let play = PlayOperators { threshold_uv: [500.0; CHANNELS], share: [0.05; CHANNELS] };
    decoder.compensation.hysteresis = [play, PlayOperators::NONE];
    decoder.compensation.creep = Creep { time_s: 8.0, share: 0.01 };
    fs::write(folder.join("memory.decoder"), decoder.to_bytes("of a test").unwrap()).unwrap();
    "memory.decoder"
}

#[test]
fn a_million_rows_are_judged_within_300_mb_and_are_too_many_neighbours() {
    let folder = tempfile::tempdir().unwrap();
    write(&folder.path().join("m.csv"), 1_000_000);
    let output = within(300_000, folder.path(), "evaluate --measured m.csv --json");
    assert!(output.status.success(), "{}", said(&output));
    let told: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(told["rows"], 900_000);
    assert!(told["position_mae_mm"].as_f64().unwrap() < 0.1, "{told}");
    let output = within(300_000, folder.path(), "metrology --measured m.csv --no-network --json");
    assert!(output.status.success(), "{}", said(&output));
    let told: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert!(told["figures"][0]["sensitivity"]["places"].as_u64().unwrap() > 1_000, "{told}");
    let with_memory = pad_with_memory(folder.path());
    let output =
        within(300_000, folder.path(), &format!("evaluate --decoder {with_memory} --measured m.csv --json"));
    assert!(output.status.success(), "{}", said(&output));
    let told: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(told["rows"], 900_000);
    let line = "adapt --method knn --measured m.csv --out pad.decoder";
    let output = within(2_000_000, folder.path(), line);
    assert_eq!(output.status.code(), Some(2), "{}", said(&output));
    assert!(said(&output).contains("take some of them with --rows 200000"), "{}", said(&output));
    let output = within(2_000_000, folder.path(), &format!("{line} --rows 200000"));
    assert!(output.status.success(), "{}", said(&output));
    write(&folder.path().join("few.csv"), 30);
    let output = within(2_000_000, folder.path(), "evaluate --decoder pad.decoder --measured few.csv");
    assert!(output.status.success(), "what adapt writes is read: {}", said(&output));
}

#[expect(clippy::disallowed_methods, reason = "what is tested is the time that it takes")]
#[test]
fn figures_of_merit_take_time_in_proportion_to_the_rows() {
    let folder = tempfile::tempdir().unwrap();
    let seconds = |rows: u32| {
        write(&folder.path().join("m.csv"), rows);
        // The least of three: the machine does other things.
        let runs = (0..3).map(|_| {
            let begun = Instant::now();
            let output = within(2_000_000, folder.path(), "metrology --measured m.csv --no-network --json");
            assert!(output.status.success(), "{}", said(&output));
            begun.elapsed().as_secs_f64()
        });
        runs.fold(f64::INFINITY, f64::min)
    };
    let (short, long) = (seconds(10_000), seconds(80_000));
    // Eight times the rows: eight times the time, or sixty-four.
    assert!(long < 20.0 * short.max(0.02), "{short} s and {long} s");
}
