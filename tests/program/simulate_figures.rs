//! `tactpad simulate --figures` and `--vtk`: the files that are there afterwards, and what they show.
#![allow(clippy::unwrap_used, reason = "a test that cannot set its scene fails")]

use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};

use crate::support::{leave_out, require};
use serde_json::Value;

fn simulate(folder: &Path, line: &str) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_tactpad"));
    command.arg("simulate").args(line.split(' ')).current_dir(folder).stdin(Stdio::null());
    command.env("XDG_CACHE_HOME", folder.join("cache")).output().unwrap()
}

#[test]
fn figures_and_meshes_of_one_press() {
    let folder = tempfile::tempdir().unwrap();
    let output = simulate(folder.path(), "--figures f --vtk v/w --at -5,3.5 --json");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let told: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert!(told.get("rows").is_none(), "no table was wanted: {told}");
    let files: Vec<&str> =
        told["files"].as_array().unwrap().iter().map(|file| file.as_str().unwrap()).collect();
    assert_eq!(files.len(), 20, "{files:?}");
    for file in &files {
        let bytes = fs::read(folder.path().join(file)).unwrap();
        let start: &[u8] = match Path::new(file).extension().unwrap().to_str().unwrap() {
            "svg" => b"<svg",
            "png" => b"\x89PNG",
            _ => b"<?xml",
        };
        assert!(bytes.starts_with(start), "{file}");
    }
    let text = |name: &str| fs::read_to_string(folder.path().join("f").join(name)).unwrap();
    assert!(text("deflection.svg").contains("1 N at (−5, 3.5) mm"));
    assert!(text("strain-x.svg").contains("R7") && text("strain-y.svg").contains("R1"));
    assert!(text("film-stress.svg").contains("R3") && text("plate-stress.svg").contains("underside"));
    assert!(text("module-stress.svg").contains("cut at y = 0"));
    // Nine charts: seven gauges alone and in the pad, and the channels, under each of three forces.
    assert_eq!(text("module-gauges.svg").matches("R7 ").count(), 6);
    let maps = text("influence.svg");
    assert_eq!(maps.matches("<circle").count(), 27, "one rim for each map");
    assert!(maps.len() < 300_000, "{} bytes", maps.len());
    check_meshes(&folder.path().join("v/w"));
}

#[test]
fn the_dataset_is_drawn_beside_its_table() {
    let folder = tempfile::tempdir().unwrap();
    let output = simulate(folder.path(), "--dataset paper --seed 2 --out p.csv --figures f --json");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let told: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!((&told["rows"], told["files"].as_array().unwrap().len()), (&Value::from(14_400), 2), "{told}");
    let drawn = fs::read_to_string(folder.path().join("f/dataset.svg")).unwrap();
    let dots = drawn.matches("<circle").count();
    assert!(dots > 900 && drawn.len() < 300_000, "{dots} dots, {} bytes", drawn.len());
}

/// The modules stand under the plate, move with it, hold on to the base, and VTK sees no brick inside out.
fn check_meshes(folder: &Path) {
    if !require("python3", "apt-get install python3-meshio") {
        return;
    }
    let has_meshio = |python: &&str| {
        let output = Command::new(python).args(["-c", "import meshio"]).output();
        output.is_ok_and(|output| output.status.success())
    };
    let Some(python) = ["python3", "/usr/bin/python3"].into_iter().find(has_meshio) else {
        leave_out("meshio", "apt-get install python3-meshio");
        return;
    };
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/program/vtk/pressed.py");
    let output = Command::new(python).arg(script).arg(folder).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}

#[test]
fn arguments_that_do_not_fit_together_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("file"), "").unwrap();
    for (line, words) in [
        ("--json", "--figures <DIR>"),
        ("--figures f --out o.csv", "--contacts <FILE>|--dataset <NAME>"),
        ("--figures f --dataset paper", "--out <FILE>"),
        ("--dataset paper --out o.csv --at 1,2", "--figures <DIR>"),
        ("--figures f --at 1", "write x and y in millimetres"),
        ("--figures f --at nan,0", "write x and y in millimetres"),
        ("--figures f --at 25,-16", "29.68 mm from the centre"),
        ("--figures file/f", "file/f cannot be made"),
    ] {
        let output = simulate(folder.path(), line);
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{line}: {said}");
        assert!(said.contains(words), "{line} lacks {words:?}: {said}");
        assert!(!folder.path().join("f").exists(), "{line}");
    }
}
