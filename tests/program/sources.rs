//! Descriptions of pads: listed, shown, checked, begun.
#![allow(clippy::unwrap_used, reason = "a test that cannot set its scene fails")]

use std::fs;
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Command, Output, Stdio};

use serde_json::Value;
use tactpad::pipeline::mapping::read::shipped;

fn tactpad(folder: &Path, line: &str) -> Output {
    Command::new(env!("CARGO_BIN_EXE_tactpad")).args(line.split(' ')).current_dir(folder).output().unwrap()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap()
}

#[test]
fn what_is_listed_can_be_shown_and_is_in_order() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let list = tactpad(folder, "source list --json");
    let list: Value = serde_json::from_slice(&list.stdout).unwrap();
    let names: Vec<&str> =
        list["sources"].as_array().unwrap().iter().map(|source| source["name"].as_str().unwrap()).collect();
    assert_eq!(
        names,
        [
            "load-cells",
            "balance-board",
            "balance-board-standing",
            "tablet",
            "touchpad",
            "magic-trackpad",
            "spacemouse"
        ]
    );
    for name in names {
        let shown = tactpad(folder, &format!("source show {name}"));
        fs::write(folder.join("mine.toml"), &shown.stdout).unwrap();
        for named in [name, "mine.toml"] {
            let checked = tactpad(folder, &format!("source check {named} --json"));
            assert_eq!(checked.status.code(), Some(0), "{name}");
            assert_eq!(text(&checked.stdout).trim(), r#"{"ok":true,"diagnostics":[]}"#, "{name}");
        }
    }
}

#[test]
fn mistakes_are_told_all_at_once_with_their_places() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let begun = text(&tactpad(folder, "source new my-board").stdout);
    assert!(begun.contains("\nname = \"my-board\"\n"), "{begun}");
    fs::write(
        folder.join("bad.toml"),
        begun.replace("\"g\"", "\"stone\"").replace("full_n = 50.0", "full_n = 0"),
    )
    .unwrap();
    let checked = tactpad(folder, "source check bad.toml --json");
    assert_eq!(checked.status.code(), Some(1));
    let report: Value = serde_json::from_slice(&checked.stdout).unwrap();
    let lines: Vec<u64> = report["diagnostics"]
        .as_array()
        .unwrap()
        .iter()
        .map(|found| found["line"].as_u64().unwrap())
        .collect();
    let line = |key: &str| 1 + begun.lines().position(|line| line.starts_with(key)).unwrap() as u64;
    assert_eq!((&report["ok"], lines), (&Value::Bool(false), vec![line("unit"), line("full_n")]));
    let run = tactpad(folder, "run --pad my-board:/dev/null --source bad.toml --output none");
    assert_eq!(run.status.code(), Some(2));
    let told = text(&run.stderr);
    assert!(told.contains("cannot be used") && told.contains("\"unit\" cannot be \"stone\""), "{told}");
}

#[test]
fn what_cannot_be_is_refused_with_the_way_out() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    fs::write(folder.join("mine.toml"), tactpad(folder, "source new mine").stdout).unwrap();
    for (line, words) in [
        ("source show nope", "choose one of load-cells"),
        ("source check ./nope.toml", "cannot be read"),
        ("source new Mine", "small letters"),
        ("run --pad load-cells --output none", "name its port, as in --pad load-cells:/dev/ttyUSB0"),
        (
            "run --pad serial:/dev/ttyUSB0 --source load-cells --output none",
            "name its port, as in --pad load-cells:/dev/ttyUSB0",
        ),
        ("run --pad nope:/dev/null --output none", "`nope` names no pad"),
        ("run --pad load-cells:/dev/null --output none", "not a serial port"),
        ("run --pad load-cells:/no-such-port --output none", "does not exist"),
        ("run --pad other:/dev/null --source mine.toml --output none", "--source describes mine"),
        ("run --pad auto --source mine.toml --output none", "name its port"),
        ("run --pad virtual --source mine.toml --output none", "leave it out"),
        ("run --pad virtual --no-grab --output none", "--no-grab is for tablets"),
        ("run --pad load-cells:/dev/null --decoder statics --output none", "leave it out"),
        ("run --pad tablet:/dev/null --output none", "cannot be opened as an input device"),
        ("run --pad tablet:/no-such-node --output none", "is gone"),
    ] {
        let output = tactpad(folder, line);
        let told = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{line}: {told}");
        assert!(told.contains(words), "{line}: {told}");
    }
}

#[test]
fn a_profile_that_asks_for_shear_is_warned_of_with_its_line() {
    let folder = tempfile::tempdir().unwrap();
    let output = tactpad(folder.path(), "run --pad load-cells:/no-such-port --profile contra --output none");
    let told = text(&output.stderr);
    assert!(
        told.contains("contra:31:9: warning: \"force\" is \"fy\"") && told.contains("no force along"),
        "{told}"
    );
}

#[test]
fn a_profile_that_is_asked_for_or_changed_later_is_warned_of_as_well() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let (contra, mario) = (shipped::text("contra").unwrap(), shipped::text("super-mario").unwrap());
    let mine = folder.join("mine.toml");
    fs::write(&mine, mario).unwrap();
    let program = |line: &str| {
        let mut program = Command::new(env!("CARGO_BIN_EXE_tactpad"));
        program.args(line.split(' ')).current_dir(folder).env("XDG_RUNTIME_DIR", folder);
        program
    };
    let line = "run --pad load-cells:no-such-port --wait --profile mine.toml --output none --seconds 30";
    let mut bridge = program(line).stderr(Stdio::piped()).spawn().unwrap();
    let mut said = BufReader::new(bridge.stderr.take().unwrap()).lines().map_while(Result::ok);
    let mut until = |words: &str| {
        let before: Vec<String> = said.by_ref().take_while(|line| !line.contains(words)).collect();
        assert!(before.iter().all(|line| !line.contains("no force along")), "{words}: {before:?}");
    };
    until("load-cells:no-such-port");
    fs::write(&mine, contra).unwrap();
    until("mine.toml:31:9: warning: \"force\" is \"fy\", and this pad measures no force along");
    until("its file was changed");
    assert!(program("ctl profile contra").status().unwrap().success());
    until("contra:31:9: warning: \"force\" is \"fy\", and this pad measures no force along");
    bridge.kill().unwrap();
    bridge.wait().unwrap();
}
