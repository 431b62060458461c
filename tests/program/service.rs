//! The service for systemd, as `systemd-analyze` reads it.
#![expect(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use std::fs;
use std::path::Path;
use std::process::Command;

use crate::support::require;

/// What systemd says of a unit whose exposure may be so many tenths at most: whether it is, and the findings in the text.
fn judged(unit: &str, tenths: u32) -> (bool, String) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("tactpad.service");
    fs::write(&path, unit).unwrap();
    let mut analyze = Command::new("systemd-analyze");
    analyze.args(["security", "--offline=true", &format!("--threshold={tenths}")]).arg(path);
    let output = analyze.output().unwrap();
    (output.status.success(), String::from_utf8(output.stderr).unwrap())
}

#[test]
fn the_service_is_exposed_no_more_than_is_said_and_all_its_words_are_known() {
    if !require("systemd-analyze", "apt-get install systemd") {
        return;
    }
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/linux");
    let [unit, sandbox] = ["tactpad.service", "tactpad-sandbox.conf"]
        .map(|name| fs::read_to_string(folder.join(name)).unwrap());
    assert_eq!(judged(&unit, 60), (true, String::new()));
    // A drop-in is what comes after.
    assert_eq!(judged(&format!("{unit}\n{sandbox}"), 20), (true, String::new()));
    let (_, findings) = judged(&unit.replace("LockPersonality", "LockPersonalty"), 100);
    assert!(findings.contains("LockPersonalty"), "an unknown word is found: {findings}");
}
