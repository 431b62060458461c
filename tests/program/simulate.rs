//! `tactpad simulate`: the same bytes each time, the physics of the reference solution, and refusals that help.
#![allow(clippy::unwrap_used, reason = "a test that cannot set its scene fails")]

use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};

use serde_json::Value;
use tempfile::TempDir;

const HEADER: &str = "x_mm,y_mm,fx_n,fy_n,fz_n";
const CHANNELS: &str = "m0x_uv,m0y_uv,m0z_uv,m1x_uv,m1y_uv,m1z_uv,m2x_uv,m2y_uv,m2z_uv";

/// Runs a shell line of plain words in `folder`.
fn simulate(folder: &Path, line: &str) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_tactpad"));
    command.arg("simulate").args(line.split(' ')).current_dir(folder).stdin(Stdio::null());
    let output = command.env("RUST_BACKTRACE", "1").output().unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(!said.contains("panicked") && !said.contains("stack backtrace"), "{said}");
    output
}

/// A folder with a table of contacts, `c.csv`.
fn with_contacts(text: &str) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("c.csv"), text).unwrap();
    folder
}

/// The rows of a measured table, all of whose columns are numbers.
fn rows(table: &str) -> Vec<Vec<f64>> {
    let row = |line: &str| line.split(',').map(|cell| cell.parse().unwrap()).collect();
    table.lines().skip(1).map(row).collect()
}

/// What the channels read for these contacts.
fn channels_uv(contacts: &[[f64; 5]]) -> Vec<[f64; 9]> {
    let lines = contacts.iter().map(|contact| contact.map(|number| number.to_string()).join(",") + "\n");
    let folder = with_contacts(&format!("{HEADER}\n{}", lines.collect::<String>()));
    let output = simulate(folder.path(), "--contacts c.csv --out -");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let table = String::from_utf8(output.stdout).unwrap();
    let channels = |row: Vec<f64>| row.get(5..).unwrap().try_into().unwrap();
    rows(&table).into_iter().map(channels).collect()
}

fn dataset(folder: &Path, seed: u64) -> String {
    let output = simulate(folder, &format!("--dataset paper --seed {seed} --out {seed}.csv"));
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    fs::read_to_string(folder.join(format!("{seed}.csv"))).unwrap()
}

#[test]
fn a_seed_gives_the_same_bytes_and_another_seed_others() {
    let folder = tempfile::tempdir().unwrap();
    let first = dataset(folder.path(), 1);
    assert!(first == dataset(folder.path(), 1), "two runs differ");
    let printed = simulate(folder.path(), "--dataset paper --seed 1 --out -");
    assert!(printed.stdout == first.as_bytes(), "the file and standard output differ");
    let second = dataset(folder.path(), 2);
    assert!(first.lines().skip(1).zip(second.lines().skip(1)).all(|(first, second)| first != second));
}

#[test]
fn the_dataset_is_the_papers() {
    let folder = tempfile::tempdir().unwrap();
    let table = dataset(folder.path(), 0);
    assert_eq!(table.lines().next().unwrap(), format!("{HEADER},{CHANNELS}"));
    let rows = rows(&table);
    assert_eq!(rows.len(), 14_400);
    for (index, row) in rows.iter().enumerate() {
        let [x_mm, y_mm, fx_n, fy_n, fz_n, ..] = row[..] else { panic!("{row:?}") };
        assert!(x_mm.hypot(y_mm) <= 29.000_01 && (0.0..5.0).contains(&fz_n), "{row:?}");
        let is_normal = fx_n == 0.0 && fy_n == 0.0;
        assert!(fx_n.abs() <= 5.0 && fy_n.abs() <= 5.0 && is_normal == (index >= 7_200), "{index}: {row:?}");
    }
    // The largest of 14,400 evenly drawn forces is this near the full scale but once in 10⁶ seeds.
    let largest = |column: usize| rows.iter().map(|row| row[column].abs()).fold(0.0, f64::max);
    assert!(largest(4) > 4.99 && largest(2) > 4.98 && largest(3) > 4.98);
}

#[test]
fn a_measured_table_is_a_table_of_contacts() {
    let folder = tempfile::tempdir().unwrap();
    let table = dataset(folder.path(), 5);
    assert!(simulate(folder.path(), "--contacts 5.csv --out again.csv").status.success());
    assert!(table == fs::read_to_string(folder.path().join("again.csv")).unwrap(), "a number changed");
}

#[test]
fn channels_are_those_of_the_reference_solution() {
    // From a separately written finite-element program, its finest mesh: place, unit force, nine channels.
    let reference: [([f64; 5], [f64; 9]); 4] = [
        (
            [0.0, 0.0, 1.0, 0.0, 0.0],
            [0.0, -472.677, 138.945, -209.319, 236.338, -69.473, 209.319, 236.339, -69.473],
        ),
        ([0.0, 0.0, 0.0, 0.0, 1.0], [0.0, 68.484, 630.108, 0.0, 68.485, 630.108, 0.0, 68.484, 630.108]),
        (
            [12.3, -7.1, 0.0, 1.0, 0.0],
            [375.334, 3.02, 0.067, 13.024, -411.753, 120.198, 13.502, 410.835, -120.277],
        ),
        (
            [-25.1, -14.5, 0.0, 0.0, 1.0],
            [-50.677, 673.316, -932.361, -20.439, -104.976, 624.087, 60.264, -661.419, 2198.812],
        ),
    ];
    let found = channels_uv(&reference.map(|(contact, _)| contact));
    for ((contact, wanted), found) in reference.into_iter().zip(found) {
        let rms = (wanted.iter().map(|uv| uv * uv).sum::<f64>() / 9.0).sqrt();
        for (wanted, found) in wanted.into_iter().zip(found) {
            assert!((wanted - found).abs() < 0.015 * rms, "{contact:?}: {found} for {wanted}");
        }
    }
}

#[test]
fn forces_add_up() {
    for [x, y] in [[0.0, 0.0], [13.7, -11.9], [-20.5, 20.5], [0.0, 29.0]] {
        let [one, other, both, thrice] = channels_uv(&[
            [x, y, 1.5, -0.25, 2.0],
            [x, y, -0.5, 3.75, 1.0],
            [x, y, 1.0, 3.5, 3.0],
            [x, y, 4.5, -0.75, 6.0],
        ])[..] else {
            panic!("four rows give four")
        };
        for channel in 0..9 {
            // Three roundings to 0.001 µV, and those of numbers with 24 bits.
            let off_uv =
                [one[channel] + other[channel] - both[channel], 3.0 * one[channel] - thrice[channel]];
            assert!(off_uv.iter().all(|uv| uv.abs() < 0.01), "{x} {y}, channel {channel}: {off_uv:?}");
        }
    }
}

#[test]
fn times_and_numbers_stay_as_they_were_written() {
    let table =
        "note,fz_n,t_s,y_mm,x_mm,fx_n,fy_n\n\"a, b\",2.5,0.1,-7.1,12.3,0,-0.5\n,0,0.100001,0,1e1,0,0\n";
    let folder = with_contacts(table);
    let printed = simulate(folder.path(), "--contacts c.csv --out -").stdout;
    let lines: Vec<_> = std::str::from_utf8(&printed).unwrap().lines().collect();
    assert_eq!(lines[0], format!("t_s,{HEADER},{CHANNELS}"));
    assert!(lines[1].starts_with("0.1,12.3,-7.1,0,-0.5,2.5,"), "{}", lines[1]);
    assert_eq!(lines[2], format!("0.100001,10,0,0,0,0{}", ",0.000".repeat(9)));
    assert_eq!(lines.len(), 3);
}

#[test]
fn the_report_tells_what_the_table_holds() {
    let folder = tempfile::tempdir().unwrap();
    let output = simulate(folder.path(), "--dataset paper --seed 8 --out f.csv --json");
    let report: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(report["rows"], 14_400);
    let rows = rows(&fs::read_to_string(folder.path().join("f.csv")).unwrap());
    for (channel, name) in CHANNELS.split(',').enumerate() {
        let told = &report["channels"][channel];
        assert_eq!(format!("{}_uv", told["channel"].as_str().unwrap()), name);
        let column = || rows.iter().map(|row| row[5 + channel]);
        let max_uv = column().map(f64::abs).fold(0.0, f64::max);
        let rms_uv = (column().map(|uv| uv * uv).sum::<f64>() / 14_400.0).sqrt();
        assert!((told["max_uv"].as_f64().unwrap() - max_uv).abs() < 0.001, "{told}");
        assert!((told["rms_uv"].as_f64().unwrap() - rms_uv).abs() < 0.001, "{told}");
    }
    let people = simulate(folder.path(), "--dataset paper --seed 8 --out f.csv");
    assert!(String::from_utf8(people.stdout).unwrap().starts_with("14400 contacts\n"));
    let piped = simulate(folder.path(), "--dataset paper --seed 8 --out -");
    assert!(piped.stdout.starts_with(HEADER.as_bytes()));
    assert!(String::from_utf8(piped.stderr).unwrap().starts_with("14400 contacts\n"));
}

#[test]
fn the_example_of_the_help_runs() {
    let folder = tempfile::tempdir().unwrap();
    let help = String::from_utf8(simulate(folder.path(), "--help").stdout).unwrap();
    let example = help.split("Example: tactpad simulate ").nth(1).unwrap().lines().next().unwrap();
    assert!(simulate(folder.path(), example).status.success(), "{example}");
    assert_eq!(fs::read_to_string(folder.path().join("paper.csv")).unwrap().lines().count(), 14_401);
}

/// Sees that the line is refused with a sentence that holds the words, and that `old.csv` stays.
fn refuses(folder: &Path, line: &str, words: &[&str]) {
    fs::write(folder.join("old.csv"), "precious").unwrap();
    let output = simulate(folder, line);
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{line}: {said}");
    assert!(output.stdout.is_empty(), "{line}: something on standard output");
    for word in words {
        assert!(said.contains(word), "{line} lacks {word:?}: {said}");
    }
    assert_eq!(fs::read_to_string(folder.join("old.csv")).unwrap(), "precious", "{line}");
}

#[test]
fn contacts_that_the_pad_cannot_have_are_refused_with_their_line() {
    for (rows, words) in [
        ("", &["c.csv:1: ", "no contact follows"][..]),
        ("0,0,0,0,1\n\n29.02,0,0,0,1\n", &["c.csv:4: ", "29.02 mm from the centre", "up to 29 mm"]),
        ("21,21,0,0,1\n", &["c.csv:2: ", "29.70 mm"]),
        ("30.5,0,0,0,1\n", &["c.csv:2: x_mm is 30.5", "-30 to 30 mm"]),
        ("0,0,0,0,101\n", &["c.csv:2: fz_n is 101"]),
        ("0,0,0,0,nan\n", &["c.csv:2: fz_n is \"nan\""]),
        ("0,0,0,0\n", &["c.csv:2: 4 values"]),
    ] {
        let folder = with_contacts(&format!("{HEADER}\n{rows}"));
        refuses(folder.path(), "--contacts c.csv --out old.csv", words);
    }
    let folder = with_contacts("x_mm,y_mm,fx_n,fy_n\n0,0,0,0\n");
    refuses(folder.path(), "--contacts c.csv --out old.csv", &["c.csv:1: no column is named fz_n"]);
    refuses(folder.path(), "--contacts no.csv --out old.csv", &["no.csv cannot be read"]);
}

#[test]
fn arguments_that_do_not_fit_together_are_refused() {
    let folder = with_contacts(&format!("{HEADER}\n0,0,0,0,1\n"));
    for (line, words) in [
        ("--out old.csv", &["--contacts <FILE>|--dataset <NAME>"][..]),
        ("--contacts c.csv", &["--out <FILE>"]),
        ("--contacts c.csv --dataset paper --out old.csv", &["cannot be used with"]),
        ("--contacts c.csv --seed 1 --out old.csv", &["--seed <SEED>", "cannot be used with"]),
        ("--dataset papers --out old.csv", &["papers", "possible values: paper"]),
        ("--dataset paper --seed -1 --out old.csv", &["-1"]),
        ("--dataset paper --seed 1.5 --out old.csv", &["1.5"]),
        ("--dataset paper --seed 18446744073709551616 --out old.csv", &["18446744073709551616"]),
        ("--dataset paper --out - --json", &["--json and --out -", "name a file"]),
        ("--dataset paper --out no/folder.csv", &["no/folder.csv cannot be written", "name another file"]),
        ("--dataset paper --out .", &[". cannot be written", "name another file"]),
        ("--contacts c.csv --out ./c.csv", &["./c.csv is the table of contacts", "name another file"]),
    ] {
        refuses(folder.path(), line, words);
    }
    let kept = fs::read_to_string(folder.path().join("c.csv")).unwrap();
    assert!(kept.ends_with("0,0,0,0,1\n"), "{kept}");
}

#[cfg(target_os = "linux")]
#[test]
fn output_that_goes_nowhere_is_told_and_a_reader_that_goes_away_is_not() {
    let folder = tempfile::tempdir().unwrap();
    let full = simulate(folder.path(), "--dataset paper --out /dev/full");
    assert_eq!(full.status.code(), Some(1));
    let said = String::from_utf8_lossy(&full.stderr);
    assert!(said.contains("cannot write /dev/full: No space left on device"), "{said}");
    let (reader, writer) = std::io::pipe().unwrap();
    drop(reader);
    let mut unread = Command::new(env!("CARGO_BIN_EXE_tactpad"));
    unread.args(["simulate", "--dataset", "paper", "--out", "-"]).stdout(writer);
    let output = unread.stderr(Stdio::piped()).spawn().unwrap().wait_with_output().unwrap();
    assert_eq!((output.status.code(), &output.stderr[..]), (Some(0), &b""[..]));
}
