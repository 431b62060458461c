//! `tactpad protocol`: the same bytes each time, plans that can be read, and refusals that help.
#![allow(clippy::unwrap_used, reason = "a test that cannot set its scene fails")]

use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};

use serde_json::Value;
use tactpad::tables::measured::Table;
use tactpad::tables::measured::columns::TableKind;
use tactpad::tables::measured::read;

fn protocol(folder: &Path, line: &str) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_tactpad"));
    command.arg("protocol").args(line.split(' ')).current_dir(folder).stdin(Stdio::null());
    let output = command.env("RUST_BACKTRACE", "1").output().unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(!said.contains("panicked") && !said.contains("stack backtrace"), "{said}");
    output
}

/// What is written for a line without `--out`.
fn written(folder: &Path, line: &str) -> Vec<u8> {
    let output = protocol(folder, &format!("{line} --out plan.csv"));
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    fs::read(folder.join("plan.csv")).unwrap()
}

fn plan(text: &[u8]) -> Table {
    read::table(text, TableKind::Plan, 30.0).unwrap()
}

#[test]
fn a_seed_gives_the_same_bytes_and_another_seed_others() {
    let folder = tempfile::tempdir().unwrap();
    let first = written(folder.path(), "recommended --seed 1");
    assert!(first == written(folder.path(), "recommended --seed 1"), "two runs differ");
    assert!(
        first == protocol(folder.path(), "recommended --seed 1 --out -").stdout,
        "file and standard output differ"
    );
    assert!(first != written(folder.path(), "recommended --seed 2"));
    assert!(
        written(folder.path(), "paper --seed 1") == written(folder.path(), "paper"),
        "the paper draws nothing"
    );
}

#[test]
fn plans_read_as_they_were_made() {
    let folder = tempfile::tempdir().unwrap();
    let patch = tactpad::pad::device::Device::nominal().contact;
    let with_lines = |mut table: Table| {
        table.rows.iter_mut().enumerate().for_each(|(index, row)| row.line = index + 2);
        table
    };
    // Sessions are numbered as they first appear; both plans begin with a zero or with the rest.
    let paper = tactpad::tables::plans::paper::plan(&patch);
    assert_eq!(plan(&written(folder.path(), "paper")), with_lines(paper));
    let recommended = plan(&written(folder.path(), "recommended --seed 7"));
    let made = tactpad::tables::plans::recommended::plan(&patch, 7);
    assert_eq!((recommended.rows.len(), &recommended.trials), (made.rows.len(), &made.trials));
    for (read, wanted) in recommended.rows.iter().zip(&made.rows) {
        let named =
            |table: &Table, session: Option<usize>| session.map(|index| table.sessions[index].clone());
        assert_eq!(
            (read.label, read.t_s, read.dwell_s, read.approach),
            (wanted.label, wanted.t_s, wanted.dwell_s, wanted.approach)
        );
        assert_eq!(named(&recommended, read.session), named(&made, wanted.session));
    }
}

#[test]
fn the_report_tells_what_the_plan_holds() {
    let folder = tempfile::tempdir().unwrap();
    for (name, presses, places, zeros, trials) in
        [("paper", 648, 72, 25, 0), ("recommended", 528, 128, 29, 10)]
    {
        let output = protocol(folder.path(), &format!("{name} --seed 3 --out plan.csv --json"));
        let report: Value = serde_json::from_slice(&output.stdout).unwrap();
        let table = plan(&fs::read(folder.path().join("plan.csv")).unwrap());
        assert_eq!((report["plan"].as_str(), report["seed"].as_u64()), (Some(name), Some(3)));
        assert_eq!(report["rows"], table.rows.len());
        let counts = ["presses", "places", "zeros", "trials"].map(|key| report[key].as_u64().unwrap());
        assert_eq!(counts, [presses, places, zeros, trials]);
        let people = protocol(folder.path(), &format!("{name} --out plan.csv"));
        let said = String::from_utf8(people.stdout).unwrap();
        assert!(
            said.contains(&format!("{presses} static contacts at {places} places, {zeros} zeros")),
            "{said}"
        );
        assert!(said.contains("minutes") && said.ends_with("plan.csv is written\n"), "{said}");
    }
}

#[test]
fn another_device_gives_another_plan() {
    let folder = tempfile::tempdir().unwrap();
    let text = tactpad::pad::device::Device::nominal().to_toml();
    let text = text.replace("max_centre_radius_mm = 29.0", "max_centre_radius_mm = 20.0");
    fs::write(folder.path().join("d.toml"), text).unwrap();
    for line in ["paper", "recommended"] {
        let table = plan(&written(folder.path(), &format!("{line} --device d.toml")));
        let far_mm = table.rows.iter().map(|row| row.label.x_mm.hypot(row.label.y_mm)).fold(0.0, f64::max);
        assert!(far_mm > 19.0 && far_mm <= 20.0, "{far_mm}");
    }
}

#[test]
fn pictures_are_the_documentations() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["paper", "recommended"] {
        written(folder.path(), &format!("{name} --figures f"));
        let file = format!("protocol-{name}.svg");
        let kept = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs").join(&file);
        let drawn = fs::read(folder.path().join("f").join(&file)).unwrap();
        assert!(drawn == fs::read(kept).unwrap(), "docs/{file} is not what the program draws");
    }
}

#[test]
fn the_example_of_the_help_runs() {
    let folder = tempfile::tempdir().unwrap();
    let help = String::from_utf8(protocol(folder.path(), "--help").stdout).unwrap();
    let example = help.split("Example: tactpad protocol ").nth(1).unwrap().lines().next().unwrap();
    assert!(protocol(folder.path(), example).status.success(), "{example}");
    assert_eq!(plan(&fs::read(folder.path().join("plan.csv")).unwrap()).rows.len(), 1312);
}

#[test]
fn arguments_that_do_not_fit_are_refused_and_files_stay() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("d.toml"), tactpad::pad::device::Device::nominal().to_toml()).unwrap();
    for (line, words) in [
        ("papers --out p.csv", &["papers", "possible values: paper, recommended"][..]),
        ("paper", &["--out <FILE>"]),
        ("recommended --seed -1 --out p.csv", &["-1"]),
        ("recommended --seed 1e3 --out p.csv", &["1e3"]),
        ("paper --out - --json", &["--json and --out -", "name a file"]),
        ("paper --out no/folder.csv", &["no/folder.csv cannot be written", "name another file"]),
        ("paper --out p.csv --device no.toml", &["no.toml cannot be read"]),
        ("paper --device d.toml --out d.toml", &["d.toml is the device", "name another file"]),
    ] {
        let output = protocol(folder.path(), line);
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{line}: {said}");
        assert!(output.stdout.is_empty() && words.iter().all(|word| said.contains(word)), "{line}: {said}");
    }
    assert!(!folder.path().join("p.csv").exists());
    let kept = fs::read_to_string(folder.path().join("d.toml")).unwrap();
    assert_eq!(kept, tactpad::pad::device::Device::nominal().to_toml());
}
