//! What was recorded replays, byte for byte.
#![expect(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use std::fs::{self, File};
use std::path::Path;
use std::process::{Command, Output};
use std::thread;

use tactpad::pipeline::capture::reader::CaptureReader;

use crate::guest::in_guest;

fn tactpad(arguments: &[&str], folder: &Path) -> Output {
    Command::new(env!("CARGO_BIN_EXE_tactpad")).args(arguments).current_dir(folder).output().unwrap()
}

fn lines(text: &[u8]) -> usize {
    text.split(|&byte| byte == b'\n').count() - 1
}

#[test]
fn a_recording_replays_byte_for_byte_and_plays_as_a_pad() {
    in_guest("replay::a_recording_replays_byte_for_byte_and_plays_as_a_pad", replays_and_plays);
}

fn replays_and_plays() {
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

/// Plays with a decoder, and sees that the capture holds it and replays to the same events.
fn plays_and_replays(folder: &Path, name: &str, file: Option<&[u8]>) {
    let path = format!("{name}.decoder");
    let chosen = if file.is_some() { path.as_str() } else { name };
    file.into_iter().for_each(|bytes| fs::write(folder.join(&path), bytes).unwrap());
    let [capture, log] = ["cap", "log"].map(|kind| format!("{name}.{kind}"));
    let output = format!("log:{log}");
    let arguments = ["record", &capture, "--seconds", "3", "--decoder", chosen, "--output", &output];
    let recorded = tactpad(&arguments, folder);
    assert!(recorded.status.success(), "{name}: {}", String::from_utf8_lossy(&recorded.stderr));
    // Only the capture is needed.
    let _ = fs::remove_file(folder.join(&path));
    let live = fs::read_to_string(folder.join(&log)).unwrap();
    let again = String::from_utf8(tactpad(&["replay", &capture], folder).stdout).unwrap();
    assert!(lines(live.as_bytes()) >= 2, "{name}: {live}");
    assert_eq!(again, live, "{name}");
    let capture = CaptureReader::new(File::open(folder.join(&capture)).unwrap()).unwrap();
    let held = capture.head().decoder.clone();
    assert_eq!(held.is_some(), name != "statics", "{name}");
    assert!(file.is_none() || held.as_deref() == file, "{name}");
}

#[test]
fn a_recording_with_any_decoder_holds_it_and_replays_byte_for_byte() {
    in_guest("replay::a_recording_with_any_decoder_holds_it_and_replays_byte_for_byte", any_decoder_replays);
}

fn any_decoder_replays() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    thread::scope(|scope| {
        for (name, decoder) in crate::decoders::each() {
            let file = decoder.to_bytes("nominal pad");
            // Those that cannot play are no less for a replay.
            if decoder.cannot_play().is_some() {
                fs::write(folder.join(name), file.unwrap()).unwrap();
                continue;
            }
            let name = if name == "network" { "scdf" } else { name };
            scope.spawn(move || plays_and_replays(folder, name, file.as_deref()));
        }
    });
    let own = tactpad(&["replay", "wrench.cap"], folder).stdout;
    let otherwise = tactpad(&["replay", "wrench.cap", "--decoder", "linear"], folder).stdout;
    assert_eq!(otherwise, tactpad(&["replay", "wrench.cap", "--decoder", "linear"], folder).stdout);
    assert!(own != otherwise && lines(&otherwise) >= 2, "another decoder gives other events");
}

#[test]
fn another_profile_gives_other_events() {
    in_guest("replay::another_profile_gives_other_events", another_profile);
}

fn another_profile() {
    let folder = tempfile::tempdir().unwrap();
    assert!(tactpad(&["record", "game.cap", "--seconds", "4"], folder.path()).status.success());
    let own = tactpad(&["replay", "game.cap"], folder.path()).stdout;
    let contra = tactpad(&["replay", "game.cap", "--profile", "contra"], folder.path()).stdout;
    assert!(lines(&own) > 0 && lines(&contra) > 0);
    assert_ne!(own, contra);
}

#[test]
fn a_cut_off_recording_replays_as_far_as_it_reaches() {
    in_guest("replay::a_cut_off_recording_replays_as_far_as_it_reaches", cut_off);
}

fn cut_off() {
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
fn a_recording_for_the_force_range_says_when_to_press_how() {
    in_guest("replay::a_recording_for_the_force_range_says_when_to_press_how", cues_for_the_force_range);
}

fn cues_for_the_force_range() {
    let folder = tempfile::tempdir().unwrap();
    let output = tactpad(&["record", "range.cap", "--force-range", "--seconds", "2"], folder.path());
    let said = String::from_utf8(output.stderr).unwrap();
    let [light, hard] = ["as lightly as feels sure", "as hard as is comfortable"].map(|cue| said.find(cue));
    assert!(output.status.success() && light.is_some() && light < hard, "{said}");
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
