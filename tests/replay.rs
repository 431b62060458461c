//! What was recorded replays, byte for byte.
#![cfg(all(feature = "live", target_os = "linux"))]
#![expect(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

fn tactpad(arguments: &[&str], folder: &Path) -> Output {
    Command::new(env!("CARGO_BIN_EXE_tactpad")).args(arguments).current_dir(folder).output().unwrap()
}

fn lines(text: &[u8]) -> usize {
    text.split(|&byte| byte == b'\n').count() - 1
}

#[test]
fn a_recording_replays_byte_for_byte_and_plays_as_a_pad() {
    let folder = tempfile::tempdir().unwrap();
    let arguments = ["record", "game.cap", "--seconds", "4", "--profile", "contra", "--output", "log:live"];
    assert!(tactpad(&arguments, folder.path()).status.success());
    let live = fs::read(folder.path().join("live")).unwrap();
    assert!(lines(&live) >= 8, "{}", String::from_utf8_lossy(&live));

    let replayed = tactpad(&["replay", "game.cap"], folder.path());
    assert!(replayed.status.success());
    assert_eq!(String::from_utf8(replayed.stdout).unwrap(), String::from_utf8(live.clone()).unwrap());

    let arguments = ["run", "--pad", "capture:game.cap", "--profile", "contra", "--output", "log:again"];
    assert!(tactpad(&arguments, folder.path()).status.success());
    let again = fs::read(folder.path().join("again")).unwrap();
    let codes = |log: &[u8]| -> Vec<String> {
        let text = String::from_utf8(log.to_vec()).unwrap();
        text.lines().map(|line| line.split("\"device\"").nth(1).unwrap().to_owned()).collect()
    };
    assert_eq!(codes(&again), codes(&live));
}

#[test]
fn another_profile_gives_other_events() {
    let folder = tempfile::tempdir().unwrap();
    assert!(tactpad(&["record", "game.cap", "--seconds", "4"], folder.path()).status.success());
    let own = tactpad(&["replay", "game.cap"], folder.path()).stdout;
    let contra = tactpad(&["replay", "game.cap", "--profile", "contra"], folder.path()).stdout;
    assert!(lines(&own) > 0 && lines(&contra) > 0);
    assert_ne!(own, contra);
}

#[test]
fn a_cut_off_recording_replays_as_far_as_it_reaches() {
    let folder = tempfile::tempdir().unwrap();
    assert!(tactpad(&["record", "game.cap", "--seconds", "4"], folder.path()).status.success());
    let whole = tactpad(&["replay", "game.cap"], folder.path()).stdout;
    let capture = fs::read(folder.path().join("game.cap")).unwrap();
    fs::write(folder.path().join("cut.cap"), &capture[..capture.len() - 40_001]).unwrap();
    let cut = tactpad(&["replay", "cut.cap"], folder.path());
    assert!(cut.status.success() && whole.starts_with(&cut.stdout) && lines(&cut.stdout) > 0);
    assert!(String::from_utf8_lossy(&cut.stderr).contains("cut off at byte"));
}

#[test]
fn contacts_are_mapped_as_they_stand() {
    let folder = tempfile::tempdir().unwrap();
    let rows = "t_s,x_mm,y_mm,fx_n,fy_n,fz_n\n0,20,0,0,0,1\n0.5,20,0,0,0,0\n1,0,0,0,0,3\n1.1,0,0,0,0,0\n1.2,0,0,0,0,0\n";
    fs::write(folder.path().join("contacts.csv"), rows).unwrap();
    let arguments = ["replay", "--contacts", "contacts.csv", "--profile", "super-mario"];
    let log = String::from_utf8(tactpad(&arguments, folder.path()).stdout).unwrap();
    let expected = [
        r#"{"t_us":0,"device":"gamepad","code":"ABS_HAT0X","value":1}"#,
        r#"{"t_us":500000,"device":"gamepad","code":"ABS_HAT0X","value":0}"#,
        r#"{"t_us":1100000,"device":"gamepad","code":"BTN_SOUTH","value":1}"#,
        r#"{"t_us":1140000,"device":"gamepad","code":"BTN_SOUTH","value":0}"#,
    ];
    assert_eq!(log.lines().collect::<Vec<_>>(), expected);
}

#[test]
fn contacts_without_times_are_a_millisecond_apart() {
    let folder = tempfile::tempdir().unwrap();
    let rows = "x_mm,y_mm,fx_n,fy_n,fz_n,trial\n20,0,0,0,1,7\n20,0,0,0,0,7\n0,20,0,0,1,7\n";
    fs::write(folder.path().join("contacts.csv"), rows).unwrap();
    let arguments = ["replay", "--contacts", "contacts.csv", "--profile", "super-mario"];
    let log = String::from_utf8(tactpad(&arguments, folder.path()).stdout).unwrap();
    let expected = [
        r#"{"t_us":0,"device":"gamepad","code":"ABS_HAT0X","value":1}"#,
        r#"{"t_us":2000,"device":"gamepad","code":"ABS_HAT0Y","value":-1}"#,
        r#"{"t_us":40000,"device":"gamepad","code":"ABS_HAT0X","value":0}"#,
        r#"{"t_us":42000,"device":"gamepad","code":"ABS_HAT0Y","value":0}"#,
    ];
    assert_eq!(log.lines().collect::<Vec<_>>(), expected);
}
