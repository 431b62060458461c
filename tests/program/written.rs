//! What a verb is to write is tried before the work, and is there whole or not at all.
#![allow(clippy::unwrap_used, reason = "a test that cannot set its scene fails")]

use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};

use tactpad::pad::device::Device;
use tactpad::quantity::CHANNEL_NAMES;

/// Seconds on a processor: far fewer than the work of any of these verbs takes, and far more than a refusal.
const AT_ONCE_S: u32 = 4;

fn tactpad(folder: &Path, line: &str) -> Command {
    let mut command = Command::new("sh");
    command.args(["-c", &format!("ulimit -t {AT_ONCE_S} && exec {} {line}", env!("CARGO_BIN_EXE_tactpad"))]);
    command.current_dir(folder).stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::piped());
    command.env("XDG_CACHE_HOME", folder.join("cache"));
    command
}

/// What the verb says that is refused at once.
fn refused(folder: &Path, line: &str) -> String {
    let output = tactpad(folder, line).output().unwrap();
    let text = String::from_utf8_lossy(&output.stderr).into_owned();
    // The limit's signal ends a verb that works on something that it cannot write, so that it has no code.
    assert_eq!(output.status.code(), Some(2), "{line}: {text}");
    text
}

/// A folder with a pad whose field nobody knows, four contacts, and measured ones.
fn scene() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: String| fs::write(folder.path().join(name), text).unwrap();
    write("pad.toml", Device::nominal().to_toml().replace("thickness_mm = 1.0 ", "thickness_mm = 1.17 "));
    let labels = ["x_mm,y_mm,fx_n,fy_n,fz_n", "0,0,0,0,1", "9,0,0,0,1", "0,9,0,0,1", "-9,0,0,0,1"];
    write("plan.csv", labels.join("\n"));
    let channels = CHANNEL_NAMES.map(|name| format!(",{name}_uv")).concat();
    let measured: Vec<_> = labels[1..].iter().map(|row| format!("{row}{}", ",1".repeat(9))).collect();
    write("m.csv", format!("{}{channels}\n{}\n", labels[0], measured.join("\n")));
    folder
}

#[test]
fn what_cannot_be_written_is_refused_before_the_work() {
    let folder = scene();
    for line in [
        "train --out no/f",
        "train --out net.onnx --figures m.csv/f",
        "twin --plan plan.csv --out no/f",
        "twin --plan plan.csv --out t.csv --truth no/f",
        "simulate --contacts plan.csv --out no/f",
        "adapt --method inverse --measured m.csv --out no/f",
        "metrology --measured m.csv --figures m.csv/f",
        "metrology --no-network --figures m.csv/f",
        "ablation --out m.csv/f",
        "layout --figures m.csv/f",
    ] {
        let told = refused(folder.path(), &format!("{line} --device pad.toml"));
        let place = line.rsplit(' ').next().unwrap();
        assert!(
            told.contains(&format!("{place} cannot be ")) && told.contains("name another"),
            "{line}: {told}"
        );
        assert!(!folder.path().join("cache").exists(), "{line}: the pad was computed before");
    }
    for untouched in ["net.onnx", "t.csv"] {
        assert!(!folder.path().join(untouched).exists(), "{untouched} is made before the work");
    }
}

#[cfg(target_os = "linux")]
#[test]
fn pipes_are_written_one_after_the_other() {
    use rustix::fs::{CWD, FileType, Mode, mknodat};

    let folder = scene();
    for name in ["out", "truth"] {
        mknodat(CWD, folder.path().join(name), FileType::Fifo, Mode::RWXU, 0).unwrap();
    }
    fs::write(folder.path().join("none.toml"), "").unwrap();
    let line = "twin --plan plan.csv --imperfections none.toml --out out --truth truth";
    let mut child = tactpad(folder.path(), line).spawn().unwrap();
    let read = |name: &str| fs::read_to_string(folder.path().join(name)).unwrap();
    let (measured, truth) = (read("out"), read("truth"));
    assert!(child.wait().unwrap().success());
    assert_eq!((measured.lines().count(), truth.lines().count()), (5, 5));
}
