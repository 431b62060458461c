//! `tactpad twin --plan play` and `--plan presses`: captures that replay, their truths, weights, and what is refused.
#![allow(clippy::unwrap_used, reason = "a test that cannot set its scene fails")]

use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};

use serde_json::Value;

/// Runs where the pad has faults that need no field of their own.
fn tactpad(folder: &Path, line: &str) -> Output {
    let text =
        "[noise]\nadditive_uv = 10.0\n[finger]\nwander_mm = 0.3\n[[creep]]\ntime_s = 8.0\nshare = 0.01\n";
    fs::write(folder.join("pad.toml"), text).unwrap();
    let mut command = Command::new(env!("CARGO_BIN_EXE_tactpad"));
    command.args(line.split(' ')).current_dir(folder).stdin(Stdio::null()).env("RUST_BACKTRACE", "1");
    let output = command.output().unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(!said.contains("panicked") && !said.contains("stack backtrace"), "{said}");
    output
}

fn done(folder: &Path, line: &str) -> String {
    let output = tactpad(folder, line);
    assert!(output.status.success(), "{line}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

fn made(folder: &Path, line: &str) -> Value {
    serde_json::from_str(&done(folder, &format!("twin --imperfections pad.toml --json {line}"))).unwrap()
}

/// The rows of a table of numbers.
fn rows(path: &Path, header: &str) -> Vec<Vec<f64>> {
    let text = fs::read_to_string(path).unwrap();
    assert_eq!(text.lines().next(), Some(header));
    text.lines().skip(1).map(|line| line.split(',').map(|cell| cell.parse().unwrap()).collect()).collect()
}

#[test]
fn play_replays_and_its_seed_decides() {
    let folder = tempfile::tempdir().unwrap();
    let said = made(folder.path(), "--plan play --seconds 20 --seed 3 --out a.cap");
    assert_eq!(said["samples"], 20_000);
    let touches = said["touches"].as_u64().unwrap();
    assert!((8..40).contains(&touches), "{said}");
    let events = done(folder.path(), "replay a.cap");
    let presses = events.lines().filter(|line| !line.ends_with("\"value\":0}")).count() as u64;
    assert!(presses >= touches / 2 && presses < 8 * touches, "{presses} of {touches}");
    made(folder.path(), "--plan play --seconds 20 --seed 3 --out b.cap");
    made(folder.path(), "--plan play --seconds 20 --seed 4 --out c.cap");
    let [a, b, c] = ["a.cap", "b.cap", "c.cap"].map(|name| fs::read(folder.path().join(name)).unwrap());
    assert!(a == b && a != c);
}

#[test]
fn play_and_measurement_are_one_life() {
    let folder = tempfile::tempdir().unwrap();
    let first = made(folder.path(), "--plan presses --seconds 10 --state pad.life --out a.cap");
    assert_eq!(first["pad_cycles"].as_f64(), first["touches"].as_f64(), "each touch is a cycle of load");
    fs::write(folder.path().join("plan.csv"), "x_mm,y_mm,fx_n,fy_n,fz_n\n0,0,0,0,2\n").unwrap();
    let line = "--plan plan.csv --state pad.life --cycles 100 --count-cycles --out m.csv";
    let then = made(folder.path(), line);
    let cycles = first["touches"].as_f64().unwrap() + 101.0;
    assert_eq!(then["pad_cycles"].as_f64(), Some(cycles));
    let last = made(folder.path(), "--plan play --seconds 10 --state pad.life --out b.cap");
    assert_eq!(last["pad_cycles"].as_f64(), Some(cycles + last["touches"].as_f64().unwrap()));
    let age_s = last["pad_seconds"].as_f64().unwrap();
    assert!((age_s - (10.0 + 100.0 + 5.0 + 10.0)).abs() < 0.1, "{age_s}");
}

#[test]
fn weights_are_written_with_the_middle_of_their_rests() {
    let folder = tempfile::tempdir().unwrap();
    let line =
        "--plan presses --seconds 6 --within-mm 10 --out a.cap --truth t.csv --weight-g 250 --weights w.csv";
    assert_eq!(made(folder.path(), line)["weights"], 5);
    let weights = rows(&folder.path().join("w.csv"), "t_s,x_mm,y_mm,weight_g");
    let truth = rows(&folder.path().join("t.csv"), "t_s,x_mm,y_mm,fx_n,fy_n,fz_n");
    let marks: Vec<[f64; 2]> = weights.iter().map(|row| [row[1], row[2]]).collect();
    assert_eq!(marks, [[0.0, 0.0], [15.0, 0.0], [-15.0, 0.0], [0.0, 15.0], [0.0, -15.0]]);
    for weight in &weights {
        let resting: Vec<_> = truth.iter().filter(|row| (row[0] - weight[0]).abs() < 0.96).collect();
        assert!((190..193).contains(&resting.len()), "{} rows, 10 ms apart", resting.len());
        for row in resting {
            assert!((row[1] - weight[1]).hypot(row[2] - weight[2]) <= 0.701, "{row:?}");
            assert!((row[5] - 0.25 * 9.806_65).abs() < 1e-4 && row[3] == 0.0 && row[4] == 0.0, "{row:?}");
        }
    }
    let before = truth.iter().filter(|row| row[0] < 6.0);
    // The finger wanders by 0.3 mm.
    assert!(before.clone().count() > 50 && before.into_iter().all(|row| row[1].hypot(row[2]) < 12.0));
    assert!(truth[0][0] >= 1.0);
}

#[test]
fn what_does_not_belong_together_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("mine.toml"), "schema = 1\n").unwrap();
    for (line, wanted) in [
        (
            "--plan presses --count-cycles",
            "--count-cycles belongs to measuring plans, not to presses: leave it out",
        ),
        ("--plan paper --seconds 9", "--seconds belongs to --plan play and --plan presses, not to paper"),
        ("--plan paper --profile tetris", "--profile belongs to"),
        ("--plan paper --within-mm 9", "--within-mm belongs to"),
        ("--plan paper --weight-g 9 --weights w.csv", "--weight-g belongs to"),
        ("--plan play --weight-g 9", "--weights"),
        ("--plan play --weights w.csv", "--weight-g"),
        (
            "--plan play --weight-g 900 --weights w.csv",
            "--weight-g is 900, which presses with 8.83 N: take a weight",
        ),
        ("--plan play --weight-g nan --weights w.csv", "write grams, such as 200"),
        ("--plan play --weight-g 90 --weights o.cap", "--out and --weights name one file"),
        ("--plan play --within-mm 30", "--within-mm is 30, and a finger stays on this plate up to 29 mm"),
        ("--plan play --within-mm -1", "--within-mm is -1"),
        ("--plan play --seconds 2", "--seconds is too short"),
        ("--plan play --seconds x", "write a number of seconds"),
        ("--plan play --profile nobodys", "there is no profile \"nobodys\""),
        ("--plan play --profile mine.toml --truth mine.toml", "is the profile"),
        ("--plan play --truth no/t.csv", "no/t.csv cannot be written"),
    ] {
        let output = tactpad(folder.path(), &format!("twin {line} --imperfections pad.toml --out o.cap"));
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{line}: {said}");
        assert!(said.contains(wanted), "{line}: {said}");
    }
    assert!(!folder.path().join("o.cap").exists());
}
