//! `tactpad diagnose`: which tables and arguments it refuses, before any long work.
#![allow(clippy::unwrap_used, reason = "a test that cannot set its scene fails")]

use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};

use tactpad::quantity::{CHANNEL_NAMES, CHANNELS};

const LABEL: &str = "x_mm,y_mm,fx_n,fy_n,fz_n";

fn diagnose(folder: &Path, line: &str) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_tactpad"));
    command.arg("diagnose").args(line.split_whitespace()).current_dir(folder).stdin(Stdio::null());
    let output = command.env("RUST_BACKTRACE", "1").output().unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(!said.contains("panicked") && !said.contains("stack backtrace"), "{said}");
    output
}

fn refused(folder: &Path, line: &str) -> String {
    let output = diagnose(folder, line);
    let said = String::from_utf8(output.stderr).unwrap();
    assert_eq!((output.status.code(), output.stdout.len()), (Some(2), 0), "{line}: {said}");
    said
}

/// A measured table with these labels; its channels read a little of everything.
fn table(labels: impl Iterator<Item = [f64; 5]>) -> String {
    let names = CHANNEL_NAMES.map(|name| format!(",{name}_uv")).concat();
    let row = |label: [f64; 5]| {
        let uv: [String; CHANNELS] =
            std::array::from_fn(|k| (10.0 * label.iter().sum::<f64>() + k as f64).to_string());
        format!("{},{}\n", label.map(|number| number.to_string()).join(","), uv.join(","))
    };
    format!("{LABEL}{names}\n{}", labels.map(row).collect::<String>())
}

/// Places on a grid, all pressed alike.
fn grid(fz_n: f64) -> impl Iterator<Item = [f64; 5]> {
    (0..400).map(move |at| [f64::from(at % 20) - 10.0, f64::from(at / 20) - 10.0, 0.0, 0.0, fz_n])
}

#[test]
fn a_table_that_shows_nothing_is_refused_by_its_name() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("untouched.csv"), table(grid(0.0))).unwrap();
    fs::write(folder.path().join("short.csv"), table(grid(2.0).take(3))).unwrap();
    for file in ["untouched.csv", "short.csv"] {
        for more in ["", "--json", "--save-device e.toml"] {
            let said = refused(folder.path(), &format!("--measured {file} {more}"));
            let why = said.strip_prefix(&format!("tactpad: {file}: ")).unwrap_or_else(|| panic!("{said}"));
            assert!(why.contains(' ') && why.lines().count() == 1, "{said}");
        }
    }
    assert!(!folder.path().join("e.toml").exists());
}

#[test]
fn tables_and_arguments_that_cannot_be_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    write("plan.csv", &format!("{LABEL}\n0,0,0,0,1\n"));
    write("partly.csv", &format!("{LABEL},m0x_uv\n0,0,0,0,1,5\n"));
    write("placeless.csv", "fx_n,fy_n,fz_n\n0,0,1\n");
    write("m.csv", &table(grid(2.0)));
    write("far.csv", &table([[59.0, 0.0, 0.0, 0.0, 1.0]].into_iter()));
    write("typo.toml", "[nois]\nadditive_uv = 3\n");
    for (line, wanted) in [
        ("--measured plan.csv", "plan.csv:1: no column is a channel"),
        ("--measured partly.csv", "partly.csv:1: no column is named m0y_uv"),
        ("--measured placeless.csv", "placeless.csv:1: no column is named x_mm, y_mm"),
        ("--measured far.csv", "far.csv:2: x_mm is 59"),
        ("--measured none.csv", "none.csv cannot be read"),
        ("--measured m.csv --imperfections typo.toml", "did you mean \"noise\"?"),
        ("--measured m.csv --device none.toml", "device none.toml cannot be read"),
        ("--measured m.csv --save-device m.csv", "m.csv is the measured table"),
        ("--measured m.csv --device typo.toml --save-device typo.toml", "typo.toml is the device"),
        ("--measured m.csv --save-device no/e.toml", "cannot be written"),
        ("--measured m.csv --save-device - --json", "both print"),
        ("", "--measured <M.csv>"),
    ] {
        let said = refused(folder.path(), line);
        assert!(said.contains(wanted), "{line}: {said}");
    }
}

#[test]
fn help_has_all_options_and_an_example() {
    let output = diagnose(Path::new("."), "--help");
    let help = String::from_utf8(output.stdout).unwrap();
    assert_eq!(output.status.code(), Some(0));
    for word in [
        "--measured",
        "--device",
        "--imperfections",
        "--save-device",
        "--report",
        "--json",
        "Example: tactpad diagnose --measured",
    ] {
        assert!(help.contains(word), "{word}: {help}");
    }
}
