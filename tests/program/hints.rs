//! Slips of a person at the keyboard: what the program makes of them, and what it says.
#![allow(clippy::unwrap_used, reason = "a test that cannot set its scene fails")]

use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};

use crate::undisturbed::undisturbed;

fn tactpad(folder: &Path, line: &str) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_tactpad"));
    command.args(line.split(' ')).current_dir(folder).stdin(Stdio::null());
    command.env("XDG_RUNTIME_DIR", folder).env("XDG_CONFIG_HOME", folder.join("config"));
    command.env("XDG_CACHE_HOME", folder.join("cache")).output().unwrap()
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

fn utf16(text: &str) -> Vec<u8> {
    "\u{feff}".encode_utf16().chain(text.encode_utf16()).flat_map(u16::to_le_bytes).collect()
}

#[test]
fn a_dash_is_standard_output() {
    let folder = tempfile::tempdir().unwrap();
    let run = tactpad(folder.path(), "run --pad virtual --seconds 2 --output log:-");
    let log = String::from_utf8(run.stdout.clone()).unwrap();
    assert!(run.status.success() && log.contains("\"code\":\"ABS_HAT0X\""), "{log}{}", said(&run));
    let is_event = |line: &str| serde_json::from_str::<serde_json::Value>(line).is_ok();
    assert!(log.lines().all(is_event), "{log}");
    let demo = undisturbed(|| tactpad(folder.path(), "demo --seconds 2 --output log:-"));
    assert!(demo.status.success() && String::from_utf8(demo.stdout).unwrap().lines().all(is_event));
    let record = tactpad(folder.path(), "record - --seconds 1");
    assert!(record.status.success() && record.stdout.starts_with(b"tactpad capture 1\n"));
    for line in [
        "demo --seconds 2 --json --output log:-",
        "latency --seconds 1 --json --output log:-",
        "record - --seconds 1 --output log:-",
    ] {
        let both = tactpad(folder.path(), line);
        assert_eq!(both.status.code(), Some(2), "{line}");
        assert!(said(&both).contains("both print"), "{line}: {}", said(&both));
    }
    let left = fs::read_dir(folder.path()).unwrap().count();
    assert_eq!(left, 0, "a file is named -");
}

#[test]
fn a_capture_is_not_written_over_unless_that_is_asked_for() {
    let folder = tempfile::tempdir().unwrap();
    assert!(tactpad(folder.path(), "record game.cap --seconds 1").status.success());
    let first = fs::read(folder.path().join("game.cap")).unwrap();
    let again = tactpad(folder.path(), "record game.cap --seconds 1");
    assert_eq!(again.status.code(), Some(2));
    assert!(
        said(&again).contains("game.cap is a capture: name another file, or give --force"),
        "{}",
        said(&again)
    );
    for verb in ["run --pad virtual", "demo", "latency", "record other.cap"] {
        let log = tactpad(folder.path(), &format!("{verb} --seconds 2 --output log:game.cap"));
        assert_eq!(log.status.code(), Some(2), "{verb}");
        assert!(said(&log).contains("game.cap is a capture: name another file"), "{verb}: {}", said(&log));
    }
    assert_eq!(fs::read(folder.path().join("game.cap")).unwrap(), first);
    assert!(!folder.path().join("other.cap").exists());
    fs::write(folder.path().join("mine.toml"), "schema = 1").unwrap();
    let over_a_profile = tactpad(folder.path(), "record mine.toml --seconds 1");
    assert_eq!(over_a_profile.status.code(), Some(2));
    assert!(said(&over_a_profile).contains("mine.toml is there already"), "{}", said(&over_a_profile));
    assert_eq!(fs::read_to_string(folder.path().join("mine.toml")).unwrap(), "schema = 1");
    assert!(tactpad(folder.path(), "record game.cap --seconds 1 --force").status.success());
    assert!(tactpad(folder.path(), "replay game.cap").status.success());
    // What holds no play is no loss.
    fs::write(folder.path().join("empty.cap"), &first[..18]).unwrap();
    assert!(tactpad(folder.path(), "record empty.cap --seconds 1").status.success());
    // An older log is no capture.
    fs::write(folder.path().join("log"), "{}\n").unwrap();
    assert!(tactpad(folder.path(), "run --pad virtual --seconds 1 --output log:log").status.success());
}

#[test]
fn run_without_virtual_devices_plays_into_a_log_here_unless_they_are_asked_for() {
    if Path::new("/dev/uinput").exists() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let run = tactpad(folder.path(), "run --pad virtual --seconds 2");
    assert_eq!(run.status.code(), Some(0), "{}", said(&run));
    assert!(String::from_utf8_lossy(&run.stdout).contains("\"code\":\"ABS_HAT0X\""));
    let told = said(&run);
    assert!(
        told.contains("Output: an event log, here. For a virtual gamepad: `sudo modprobe uinput`\n"),
        "{told}"
    );
    assert!(told.contains(" downs, ") && told.contains(" held at the end\n"), "{told}");
    let doctor = tactpad(folder.path(), "doctor --json").stdout;
    assert!(
        String::from_utf8_lossy(&doctor).contains("\"mend\":\"sudo modprobe uinput\""),
        "the same command"
    );
    let asked = tactpad(folder.path(), "run --pad virtual --seconds 2 --output uinput");
    assert_eq!(asked.status.code(), Some(2));
    assert!(said(&asked).contains("/dev/uinput"), "{}", said(&asked));
}

#[test]
fn slips_in_files_are_named_for_what_they_are() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, bytes: &[u8]| fs::write(folder.path().join(name), bytes).unwrap();
    write("far.toml", b"[[module]]\nindex = 0\nradial_mm = 15\n");
    let far = said(&tactpad(folder.path(), "twin --plan paper --out m.csv --imperfections far.toml"));
    assert!(far.contains("\"radial_mm\" is 15; it must be -10 to 10 mm") && !far.contains("0.015"), "{far}");
    let contra = tactpad(folder.path(), "profile show contra").stdout;
    let text = String::from_utf8(contra).unwrap();
    let force = text.lines().find(|line| line.starts_with("press_n")).unwrap();
    let name = text.lines().find(|line| line.starts_with("name")).unwrap();
    for (profile, wanted) in [
        (text.replacen(force, "press_n = 2,0", 1).into_bytes(), "write a decimal point: 2.0"),
        (text.replacen(name, &format!("{name}\n{name}"), 1).into_bytes(), "duplicate key \"name\""),
        (utf16(&text), "it is UTF-16: save it as UTF-8"),
    ] {
        write("mine.toml", &profile);
        let checked = tactpad(folder.path(), "profile check mine.toml");
        let told = said(&checked) + &String::from_utf8_lossy(&checked.stdout);
        assert!(told.contains(wanted), "{wanted}: {told}");
    }
    write("c.csv", &utf16("x_mm,y_mm,fx_n,fy_n,fz_n\n0,0,0,0,1\n"));
    let table = said(&tactpad(folder.path(), "simulate --contacts c.csv --out s.csv"));
    assert!(table.contains("c.csv:1: the table is UTF-16; save it as UTF-8"), "{table}");
    for rows in ["0", "-1", "many"] {
        let line = format!("adapt --method knn --measured c.csv --out d --rows {rows}");
        assert!(said(&tactpad(folder.path(), &line)).contains("1 or more"), "{rows}");
    }
}

#[test]
fn shells_complete_verbs_and_options() {
    let folder = tempfile::tempdir().unwrap();
    for shell in ["bash", "zsh", "fish"] {
        let printed = tactpad(folder.path(), &format!("completions {shell}"));
        let text = String::from_utf8(printed.stdout).unwrap();
        assert!(printed.status.success());
        for word in ["demo", "imperfections", "metrology", "completions"] {
            assert!(text.contains(word), "{shell} lacks {word}");
        }
    }
    // What the shell itself makes of it.
    fs::write(folder.path().join("tactpad.bash"), tactpad(folder.path(), "completions bash").stdout).unwrap();
    let script = "source ./tactpad.bash; COMP_WORDS=(tactpad met); COMP_CWORD=1; _tactpad tactpad met tactpad; echo ${COMPREPLY[@]}";
    let bash = Command::new("bash").args(["-c", script]).current_dir(folder.path()).output().unwrap();
    assert_eq!(String::from_utf8_lossy(&bash.stdout).trim(), "metrology", "{}", said(&bash));
}

#[test]
fn the_help_of_record_and_latency_names_all_pads() {
    let folder = tempfile::tempdir().unwrap();
    for verb in ["run", "record", "latency"] {
        let help = tactpad(folder.path(), &format!("{verb} --help")).stdout;
        let help = String::from_utf8(help).unwrap();
        for pad in [
            "auto[:SERIAL]",
            "hid:VID:PID[:SERIAL]",
            "serial:PATH[@BAUD]",
            "usb:PORT[@BAUD]",
            "virtual",
            "capture:FILE",
        ] {
            assert!(help.contains(pad), "{verb}: {pad}");
        }
    }
}
