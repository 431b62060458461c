//! Tables of a million rows: in how much memory, and in which time, they are read and judged.
#![allow(clippy::unwrap_used, reason = "a test that cannot set its scene fails")]

use std::fmt::Write as _;
use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};

use tactpad::numeric::memory::{PlayOperator, Relaxation};
use tactpad::pad::field::PadField;
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
    let plays = [PlayOperator { threshold: 500.0, share: 0.05 }; CHANNELS];
    decoder.compensation.hysteresis = [plays, [PlayOperator::NONE; CHANNELS]];
    decoder.compensation.creep = Relaxation { time_s: 8.0, share: 0.01 };
    fs::write(folder.join("memory.decoder"), decoder.to_bytes("of a test").unwrap()).unwrap();
    "memory.decoder"
}

/// What the verb says of a table of a million rows, within 300 MB.
fn judged(folder: &Path, line: &str) -> serde_json::Value {
    let output = within(300_000, folder, line);
    assert!(output.status.success(), "{}", said(&output));
    serde_json::from_slice(&output.stdout).unwrap()
}

#[test]
fn a_million_rows_are_judged_within_300_mb() {
    let folder = tempfile::tempdir().unwrap();
    write(&folder.path().join("m.csv"), 1_000_000);
    let told = judged(folder.path(), "evaluate --measured m.csv --json");
    assert_eq!(told["rows"], 900_000);
    assert!(told["position_mae_mm"].as_f64().unwrap() < 0.1, "{told}");
}

#[test]
fn a_table_for_which_a_verb_would_take_gigabytes_is_refused_with_rows_memory_and_the_way_out() {
    let folder = tempfile::tempdir().unwrap();
    let header = format!("x_mm,y_mm,fx_n,fy_n,fz_n,{}_uv\n", CHANNEL_NAMES.join("_uv,"));
    let rows = ["0,0,0,0,0,0,0,0,0,0,0,0,0,0\n", "0,0,0,0,1,1,2,3,4,5,6,7,8,9\n"].concat();
    fs::write(folder.path().join("m.csv"), header + &rows.repeat(260_000)).unwrap();
    for (line, words) in [
        ("diagnose --measured m.csv", ["m.csv: 520000 rows would take", "leave rows out"]),
        ("diagnose --measured m.csv --against m.csv", ["1040000 rows would take", "leave rows out"]),
        (
            "adapt --method inverse --measured m.csv --out pad.decoder",
            ["m.csv: 260000 rows would take", "with --rows"],
        ),
    ] {
        let output = within(800_000, folder.path(), line);
        assert_eq!(output.status.code(), Some(2), "{line}: {}", said(&output));
        assert!(words.iter().all(|word| said(&output).contains(word)), "{line}: {}", said(&output));
        assert!(said(&output).contains("GB of memory"), "{}", said(&output));
    }
}

#[test]
#[ignore = "proof: 20 s: figures of merit, a decoder with memory and neighbours, too"]
fn a_million_rows_are_judged_within_300_mb_and_are_too_many_neighbours() {
    let folder = tempfile::tempdir().unwrap();
    write(&folder.path().join("m.csv"), 1_000_000);
    let told = judged(folder.path(), "metrology --measured m.csv --no-network --json");
    assert!(told["figures"][0]["sensitivity"]["places"].as_u64().unwrap() > 1_000, "{told}");
    let with_memory = pad_with_memory(folder.path());
    let line = format!("evaluate --decoder {with_memory} --measured m.csv --json");
    assert_eq!(judged(folder.path(), &line)["rows"], 900_000);
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

/// Seconds that the children of a shell have worked, by its `times`: what others do on the machine does not count.
fn worked_s(folder: &Path, line: &str) -> f64 {
    let mut shell = Command::new("sh");
    shell.args(["-c", &format!("{} {line} >out.json && times", env!("CARGO_BIN_EXE_tactpad"))]);
    let output = shell.current_dir(folder).stdin(Stdio::null()).output().unwrap();
    assert!(output.status.success(), "{}", said(&output));
    // Of the shell, then of its children, each for user and system: `0m0.120s`.
    let text = String::from_utf8(output.stdout).unwrap();
    let children = text.lines().nth(1).unwrap().split(' ');
    let seconds = |time: &str| {
        let (minutes, seconds) = time.trim_end_matches('s').split_once('m').unwrap();
        60.0 * minutes.parse::<f64>().unwrap() + seconds.parse::<f64>().unwrap()
    };
    children.map(seconds).sum()
}

#[test]
fn figures_of_merit_take_time_in_proportion_to_the_rows() {
    let folder = tempfile::tempdir().unwrap();
    let seconds = |rows: u32| {
        write(&folder.path().join("m.csv"), rows);
        worked_s(folder.path(), "metrology --measured m.csv --no-network --json")
    };
    let (short, long) = (seconds(10_000), seconds(80_000));
    // Eight times the rows: eight times the time, or sixty-four.
    assert!(long < 20.0 * short.max(0.02), "{short} s and {long} s");
}
