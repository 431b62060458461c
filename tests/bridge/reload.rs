//! A running bridge and the file of its profile, which is changed meanwhile.
#![expect(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use std::fs;
use std::path::Path;

use serde_json::{Value, json};

use crate::control::await_status;
use crate::guest::in_guest;
use crate::presses;
use crate::running::Running;

/// A direction, and two buttons that the press of the capture holds.
fn profile(second: &str) -> String {
    format!(
        "schema = 1\nname = \"Mine\"\noutput = \"gamepad\"\n[dpad]\n\
         [[button]]\nforce = \"fz\"\npress_n = 1.0\nout = {{ gamepad = \"BTN_SOUTH\", keyboard = \"KEY_Z\" }}\n\
         [[button]]\nforce = \"fz\"\npress_n = 1.2\nout = {{ gamepad = \"{second}\", keyboard = \"KEY_X\" }}\n"
    )
}

/// Writes a file as most editors do: beside the old one, and in its place once it is whole.
fn replace(path: &Path, text: &str) {
    let aside = path.with_extension("new");
    fs::write(&aside, text).unwrap();
    fs::rename(&aside, path).unwrap();
}

/// What the log says so far, as `CODE=VALUE`.
fn events(bridge: &Running) -> Vec<String> {
    let text = fs::read_to_string(bridge.folder.path().join("events")).unwrap();
    let event = |line: &str| {
        let event: Value = serde_json::from_str(line).unwrap();
        format!("{}={}", event["code"].as_str().unwrap(), event["value"])
    };
    text.lines().map(event).collect()
}

#[test]
fn a_changed_profile_is_taken_a_broken_one_is_told_once_and_what_both_hold_stays() {
    in_guest(
        "reload::a_changed_profile_is_taken_a_broken_one_is_told_once_and_what_both_hold_stays",
        the_file_is_changed,
    );
}

fn the_file_is_changed() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("mine.toml");
    fs::write(&path, profile("BTN_EAST")).unwrap();
    let mut program = Running::program(env!("CARGO_BIN_EXE_tactpad"), folder.path());
    program.args(["run", "--profile", "mine.toml", "--output", "log:events", "--pad"]);
    program.arg(format!("capture:{}", presses::write_long_press(folder.path()).display()));
    let bridge = Running::start(folder, program);
    let held = json!(["ABS_HAT0X", "BTN_SOUTH", "BTN_EAST"]);
    let status = await_status(&bridge, "holds", |status| status["held"] == held);
    assert_eq!(status["profile_reason"], "chosen at the start");
    assert_eq!(status["profile_error"], Value::Null);

    replace(&path, &profile("BTN_NORTH"));
    await_status(&bridge, "takes it", |status| status["held"] == json!(["ABS_HAT0X", "BTN_SOUTH"]));
    assert_eq!(events(&bridge), ["ABS_HAT0X=1", "BTN_SOUTH=1", "BTN_EAST=1", "BTN_EAST=0"]);
    assert!(bridge.told().contains("profile Mine: its file was changed"), "{}", bridge.told());

    fs::write(&path, profile("BTN_NORHT")).unwrap();
    let status = await_status(&bridge, "refuses it", |status| status["profile_error"] != Value::Null);
    let error = status["profile_error"].as_str().unwrap();
    assert!(error.contains("mine.toml:12:") && error.contains("did you mean \"BTN_NORTH\"?"), "{error}");
    let listed = String::from_utf8(bridge.ctl("status").stdout).unwrap();
    assert!(
        listed.contains("profile  Mine: chosen at the start\n         profile mine.toml cannot"),
        "{listed}"
    );

    let renamed = profile("BTN_NORTH").replace("\"Mine\"", "\"Mended\"");
    replace(&path, &renamed);
    await_status(&bridge, "takes it", |status| {
        status["profile"] == "Mended" && status["profile_error"] == Value::Null
    });
    assert_eq!(bridge.told().matches("the profile in use stays").count(), 1, "{}", bridge.told());
    assert_eq!(events(&bridge)[4..], ["BTN_SOUTH=0"], "another profile's presses are forgotten");
}
