//! The verb `tune`, and `replay` as a difference, on a recording of the virtual pad.
#![allow(clippy::unwrap_used, reason = "a test that cannot set its scene fails")]

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};

use serde_json::Value;

fn tactpad(folder: &Path, line: &str) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_tactpad"));
    command.args(line.split(' ')).current_dir(folder).stdin(Stdio::null());
    command.env("RUST_BACKTRACE", "1").env("XDG_CONFIG_HOME", folder);
    let output = command.output().unwrap();
    assert!(!said(&output).contains("panicked"), "{}", said(&output));
    output
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

fn printed(output: &Output) -> String {
    assert!(output.status.success(), "{}", said(output));
    String::from_utf8(output.stdout.clone()).unwrap()
}

fn json(folder: &Path, line: &str) -> Value {
    serde_json::from_str(&printed(&tactpad(folder, line))).unwrap()
}

/// What the events of a replay meant, as somebody would write it down who saw them: from one rest to the next.
fn table(log: &str) -> String {
    let mut held = BTreeMap::new();
    let (mut begin_us, mut meant) = (0, Vec::new());
    let mut lines = vec!["begin_s,end_s,meant".to_owned()];
    let events: Vec<Value> = log.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    for (index, event) in events.iter().enumerate() {
        let (code, value) = (event["code"].as_str().unwrap().to_owned(), event["value"].as_i64().unwrap());
        match value {
            0 => held.remove(&code),
            value => {
                let side = if value < 0 { "-" } else { "+" };
                meant.push(if code.starts_with("ABS") { format!("{code}{side}") } else { code.clone() });
                held.insert(code, value)
            }
        };
        // A finger that rolls from one direction to the next changes both at once.
        let goes_on = events.get(index + 1).is_some_and(|next| next["t_us"] == event["t_us"]);
        if held.is_empty() && !goes_on {
            // The recording's first sample is the pad's first one: its clock begins there.
            let end_us = event["t_us"].as_u64().unwrap() + 20_000;
            lines.push(format!("{},{},{}", begin_us as f64 * 1e-6, end_us as f64 * 1e-6, meant.join("+")));
            (begin_us, meant) = (end_us, Vec::new());
        }
    }
    lines.join("\n")
}

#[test]
fn a_profile_that_does_not_fit_is_fitted_and_written() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    printed(&tactpad(folder, "record game.cap --seconds 12 --profile super-mario"));
    fs::write(folder.join("game.csv"), table(&printed(&tactpad(folder, "replay game.cap")))).unwrap();
    let shipped = printed(&tactpad(folder, "profile show super-mario"));
    let odd = shipped
        .replace("press_n = 2.0", "press_n = 4.4 # far too hard")
        .replace("release_n = 1.4", "release_n = 3.5");
    let odd = odd.replace("rotation_deg = 0.0 ", "rotation_deg = 50.0 ");
    fs::write(folder.join("odd.toml"), &odd).unwrap();
    let fits = json(folder, "tune --labelled game.csv --profile super-mario --json");
    assert_eq!((&fits["share"]["before"], &fits["changes"]), (&1.0.into(), &Value::Array(vec![])), "{fits}");
    let found = json(folder, "tune game.cap --labelled game.csv --profile odd.toml --write fitted --json");
    let [before, after] = ["before", "after"].map(|when| found["share"][when].as_f64().unwrap());
    assert!(before <= 0.2 && after >= 0.9, "{found}");
    assert!(found["delay_ms"]["after"].as_f64().unwrap() <= 200.0, "{found}");
    let written = fs::read_to_string(found["written"].as_str().unwrap()).unwrap();
    assert!(written.contains("# far too hard") && !written.contains("4.4"), "{written}");
    let lines = |text: &str| text.lines().filter(|line| line.starts_with('#')).count();
    assert_eq!(lines(&written), lines(&odd));
    printed(&tactpad(folder, "profile check fitted"));
    let again = json(folder, "tune --labelled game.csv --profile fitted --json");
    assert_eq!(again["share"]["before"], found["share"]["after"]);
    let told = printed(&tactpad(folder, "tune --labelled game.csv --profile odd.toml --write mine.toml"));
    assert!(
        told.contains("button 1: a press begins at ") && told.ends_with("mine.toml is written\n"),
        "{told}"
    );
    assert_eq!(fs::read_to_string(folder.join("mine.toml")).unwrap(), written);
    refuses(folder, "tune --labelled game.csv --profile odd.toml --write fitted", "is there already");
    refuses(folder, "tune --labelled game.csv --profile odd.toml --write game.cap", "is the recording");
    refuses(folder, "tune --labelled game.csv --profile odd.toml --write - --json", "both print");
    compares(folder);
    fs::write(folder.join("late.csv"), "begin_s,end_s,meant\n99,100,up\n").unwrap();
    refuses(folder, "tune game.cap --labelled late.csv --profile odd.toml", "late.csv has a label at 99.0 s");
}

/// The difference between the profile that fits and one that does not.
fn compares(folder: &Path) {
    let same = printed(&tactpad(folder, "replay game.cap --profile super-mario --compare super-mario"));
    assert!(same.ends_with("; 0 only with the old profile (-), 0 only with the new one (+)\n"), "{same}");
    let told = printed(&tactpad(folder, "replay game.cap --profile super-mario --compare odd.toml"));
    let taps =
        told.lines().filter(|line| line.starts_with("+ ") && line.contains(" s  BTN_SOUTH  for 0.040 s"));
    assert!(taps.count() >= 2, "{told}");
    let found = json(folder, "replay game.cap --profile super-mario --compare odd.toml --json");
    let only = found["only"].as_array().unwrap();
    let is_tap = |it: &&Value| it["with"] == "new" && it["code"] == "BTN_SOUTH" && it["device"] == "gamepad";
    assert!(only.iter().filter(is_tap).count() >= 2, "{found}");
    assert_eq!(only.len(), told.lines().count() - 1);
    refuses(folder, "replay game.cap --compare super-mario", "--profile");
}

fn refuses(folder: &Path, line: &str, words: &str) {
    let output = tactpad(folder, line);
    assert_eq!(output.status.code(), Some(2), "{line}: {}", said(&output));
    assert!(said(&output).contains(words), "{line}: {}", said(&output));
}

#[test]
fn what_cannot_be_used_is_said() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    fs::write(folder.join("a.csv"), "begin_s,end_s,meant\n1,2,rigth\n").unwrap();
    fs::write(folder.join("b.csv"), "begin_s,end_s,meant\n1,2,right\n").unwrap();
    for (line, words) in [
        ("tune --labelled none.csv --profile super-mario", "none.csv cannot be read"),
        (
            "tune --labelled a.csv --profile super-mario",
            "a.csv:2: the profile has nothing that is called \"rigth\": did you mean \"right\"?",
        ),
        ("tune --labelled b.csv --profile super-mario", "there is no b.cap beside the table"),
        ("tune b.csv --labelled b.csv --profile super-mario", "b.csv "),
        ("tune --labelled b.csv --profile nothing", "there is no profile \"nothing\""),
        ("tune --labelled b.csv --profile super-mario --delay-ms 9999", "delay-ms"),
    ] {
        refuses(folder, line, words);
    }
}
