//! `tactpad twin`: plans in, measured tables and truths out; and what it refuses.
#![allow(clippy::unwrap_used, reason = "a test that cannot set its scene fails")]

use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};

/// Runs on the pad as drawn with faults that need no field of their own.
fn twin(folder: &Path, line: &str) -> Output {
    fs::write(folder.join("noisy.toml"), "[noise]\nadditive_uv = 10.0\n[finger]\nwander_mm = 0.3\n").unwrap();
    let mut command = Command::new(env!("CARGO_BIN_EXE_tactpad"));
    command.arg("twin").args(line.split_whitespace()).current_dir(folder).stdin(Stdio::null());
    let output = command.env("RUST_BACKTRACE", "1").output().unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(!said.contains("panicked") && !said.contains("stack backtrace"), "{said}");
    output
}

fn made(folder: &Path, line: &str) -> String {
    let output = twin(folder, line);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

fn refused(folder: &Path, line: &str) -> String {
    let output = twin(folder, line);
    assert_eq!(output.status.code(), Some(2), "{line}");
    String::from_utf8(output.stderr).unwrap()
}

#[test]
fn the_same_seed_makes_the_same_bytes() {
    let folder = tempfile::tempdir().unwrap();
    let table = |seed: u32, name: &str| {
        made(
            folder.path(),
            &format!("--plan recommended --imperfections noisy.toml --seed {seed} --out {name}"),
        );
        fs::read(folder.path().join(name)).unwrap()
    };
    let first = table(4, "a.csv");
    assert_eq!(first, table(4, "b.csv"));
    assert_ne!(first, table(5, "c.csv"));
}

#[test]
fn the_papers_plan_has_648_contacts_and_a_truth_for_each_row() {
    let folder = tempfile::tempdir().unwrap();
    let said =
        made(folder.path(), "--plan paper --imperfections noisy.toml --out m.csv --truth t.csv --json");
    let said: serde_json::Value = serde_json::from_str(&said).unwrap();
    assert_eq!(said["twin"], "a numerical twin: no hardware was measured");
    let [measured, truth] =
        ["m.csv", "t.csv"].map(|name| fs::read_to_string(folder.path().join(name)).unwrap());
    assert_eq!(measured.lines().filter(|line| line.starts_with("calibration,")).count(), 648);
    assert_eq!(measured.lines().count(), truth.lines().count());
    assert_eq!(truth.lines().next(), Some("t_s,x_mm,y_mm,fx_n,fy_n,fz_n"));
    assert!(measured.lines().next().unwrap().contains("fz_n,m0x_uv,m0y_uv,"));
    assert_eq!(said["rows"].as_u64().unwrap() as usize + 1, measured.lines().count());
}

#[test]
fn a_plan_of_ones_own_keeps_its_columns() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("plan.csv"), "note,x_mm,y_mm,fx_n,fy_n,fz_n\nmine,1,2,0,0,3\n").unwrap();
    let table = made(folder.path(), "--plan plan.csv --imperfections noisy.toml --out -");
    let lines: Vec<&str> = table.lines().collect();
    assert!(lines[0].starts_with("t_s,x_mm") && lines[0].ends_with(",note"), "{}", lines[0]);
    assert!(lines[1].starts_with("5,1,2,0,0,3,") && lines[1].ends_with(",mine"), "{}", lines[1]);
}

#[test]
fn what_cannot_be_is_refused_with_its_line() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    write("far.csv", "x_mm,y_mm,fx_n,fy_n,fz_n\n0,0,0,0,1\n29.5,0,0,0,1\n");
    write("creep.toml", "[[creep]]\ntime_s = -3\nshare = 0.1\n");
    write("typo.toml", "[nois]\nadditive_uv = 3\n");
    for (line, wanted) in [
        ("--plan far.csv --imperfections noisy.toml --out m.csv", "far.csv:3: the contact is 29.50 mm"),
        ("--plan paper --imperfections creep.toml --out m.csv", "creep.toml:2:10: error: \"time_s\" is -3"),
        ("--plan paper --imperfections typo.toml --out m.csv", "did you mean \"noise\"?"),
        ("--plan none.csv --out m.csv", "none.csv cannot be read"),
        ("--plan paper --out a.csv --truth a.csv", "--out and --truth name one file"),
        ("--plan far.csv --out far.csv", "is the plan"),
        ("--plan paper --out - --json", "both print"),
    ] {
        let said = refused(folder.path(), line);
        assert!(said.contains(wanted), "{line}: {said}");
    }
    assert!(!folder.path().join("m.csv").exists());
}

#[test]
fn a_state_makes_many_runs_one_life_of_one_pad() {
    let folder = tempfile::tempdir().unwrap();
    let plan = "x_mm,y_mm,fx_n,fy_n,fz_n\n0,0,0,0,2\n9,0,0,0,2\n";
    fs::write(folder.path().join("plan.csv"), plan).unwrap();
    let run = |seed: u32, more: &str| {
        let line = format!(
            "--plan plan.csv --seed {seed} --state pad.life --count-cycles --json --out m.csv {more}"
        );
        let said: serde_json::Value = serde_json::from_str(&made(folder.path(), &line)).unwrap();
        let table = fs::read_to_string(folder.path().join("m.csv")).unwrap();
        let counted: Vec<String> =
            table.lines().skip(1).map(|line| line.split(',').nth(1).unwrap().to_owned()).collect();
        assert!(table.starts_with("t_s,cycle,x_mm"), "{table}");
        assert!(table.lines().nth(1).unwrap().starts_with("5,"), "each table has its own time: {table}");
        (said["pad_cycles"].as_f64().unwrap(), said["pad_seconds"].as_f64().unwrap(), counted)
    };
    let (cycles, first_s, counted) = run(1, "");
    assert_eq!((cycles, counted), (2.0, vec!["1".to_owned(), "2".to_owned()]));
    let (cycles, second_s, counted) = run(2, "--cycles 5000");
    assert_eq!((cycles, counted), (5004.0, vec!["5003".to_owned(), "5004".to_owned()]));
    assert!((second_s - 2.0 * first_s - 5000.0).abs() < 1e-6, "{first_s} {second_s}");
    let said = made(folder.path(), "--plan plan.csv --state pad.life --out m.csv");
    assert!(said.contains("the pad is 50") && said.contains(" old and has 5006 cycles behind it"), "{said}");
    let left: Vec<_> = fs::read_dir(folder.path()).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    assert_eq!(left.len(), 4, "plan, imperfections, table and state; nothing unfinished: {left:?}");
}

#[test]
fn a_state_that_does_not_fit_is_refused_and_kept() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    write("plan.csv", "x_mm,y_mm,fx_n,fy_n,fz_n\n0,0,0,0,2\n");
    write("young.csv", "cycle,x_mm,y_mm,fx_n,fy_n,fz_n\n20,0,0,0,0,2\n");
    write("crept.toml", "[[creep]]\ntime_s = 8.0\nshare = 0.01\n");
    made(
        folder.path(),
        "--plan plan.csv --imperfections noisy.toml --state pad.life --cycles 30 --out m.csv",
    );
    let kept = fs::read(folder.path().join("pad.life")).unwrap();
    fs::write(folder.path().join("cut.life"), &kept[..kept.len() - 9]).unwrap();
    fs::remove_file(folder.path().join("m.csv")).unwrap();
    let other = "name another file, one that is not there yet for a new pad";
    for (line, wanted) in [
        (
            "--plan plan.csv --imperfections crept.toml --state pad.life",
            "it is of another pad than --device and",
        ),
        (
            "--plan plan.csv --imperfections noisy.toml --state cut.life",
            "cut.life cannot be taken up: it is damaged; ",
        ),
        ("--plan plan.csv --imperfections noisy.toml --state noisy.toml", "is the file of imperfections"),
        (
            "--plan plan.csv --imperfections noisy.toml --state crept.toml",
            "it is no state of a twin's pad, or one of",
        ),
        ("--plan plan.csv --state plan.csv", "is the plan"),
        ("--plan plan.csv --state m.csv", "--out and --state name one file"),
        ("--plan plan.csv --state -", "--state is read and written"),
        ("--plan plan.csv --state .", ". cannot be written"),
        ("--plan plan.csv --state /dev/null", "/dev/null cannot be taken up: it is a device or a pipe"),
        (
            "--plan young.csv --imperfections noisy.toml --state pad.life",
            "young.csv:2: cycle is 20, and the pad has 31 cycles of load behind it already; plan more",
        ),
    ] {
        let said = refused(folder.path(), &format!("{line} --out m.csv"));
        assert!(said.contains(wanted), "{line}: {said}");
        assert!(!said.contains("cannot be taken up") || said.contains(other), "{said}");
    }
    assert_eq!(fs::read(folder.path().join("pad.life")).unwrap(), kept);
    assert!(!folder.path().join("m.csv").exists());
}
