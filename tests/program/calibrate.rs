//! `tactpad calibrate` from outside: the sheet, and what it refuses. A whole session lasts minutes: its steps are tried in the library.
#![allow(clippy::unwrap_used, reason = "a test that cannot set its scene fails")]

use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};

fn calibrate(folder: &Path, line: &str) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_tactpad"));
    command.arg("calibrate").args(line.split_whitespace()).current_dir(folder).stdin(Stdio::null());
    command.env("XDG_CONFIG_HOME", folder.join("config")).env("XDG_CACHE_HOME", folder.join("cache"));
    command.output().unwrap()
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

#[test]
fn the_sheet_alone_is_written_and_nothing_else() {
    let folder = tempfile::tempdir().unwrap();
    for (name, begin) in [("marks.svg", "<svg "), ("marks.PDF", "%PDF-1.4\n")] {
        let output = calibrate(folder.path(), &format!("--sheet {name}"));
        assert!(output.status.success(), "{}", said(&output));
        assert!(fs::read_to_string(folder.path().join(name)).unwrap().starts_with(begin));
        assert!(String::from_utf8_lossy(&output.stdout).contains(&format!("{name} is written")));
    }
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 2);
}

#[test]
fn what_cannot_be_done_is_refused_with_a_way_out() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    fs::write(path("mine.decoder.cap"), "my notes").unwrap();
    fs::write(path("lone.decoder.weights.csv"), "t_s,x_mm,y_mm,weight_g\n").unwrap();
    for (line, wanted) in [
        ("", "name the decoder to write, as in --out my.decoder"),
        ("--sheet marks.png", "let its name end in .svg or .pdf"),
        ("--sheet marks.svg --weight-g 200", "--out"),
        ("--pad virtual --out d --weight-g 2", "2 g is no weight for this pad: take one of 30 to 1000 g"),
        ("--pad virtual --out d --weight-g nan", "write grams, such as 200"),
        ("--pad virtual --out d --weight-g 200kg", "write grams, such as 200, 200g or 8.5"),
        ("--pad virtual --out d --weight-g 2,5g", "2.5 g is no weight for this pad"),
        ("--pad virtual --out -", "name a file"),
        ("--pad virtual --out d.svg --sheet d.svg", "is the sheet"),
        ("--pad capture:game.cap --out d", "adapt --play"),
        ("--pad virtual --out nowhere/d", "nowhere/d cannot be written"),
        ("--pad virtual --out mine.decoder", "mine.decoder.cap is there already, and no capture"),
        ("--pad virtual --out mine.decoder --fresh", "mine.decoder.cap is there already, and no capture"),
        ("--pad virtual --out lone.decoder", "give --fresh to begin anew"),
    ] {
        let output = calibrate(folder.path(), line);
        assert_eq!(output.status.code(), Some(2), "{line}: {}", said(&output));
        assert!(said(&output).contains(wanted), "{line}: {}", said(&output));
    }
    assert_eq!(fs::read_to_string(path("mine.decoder.cap")).unwrap(), "my notes");
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 2, "a refusal leaves a file");
}
