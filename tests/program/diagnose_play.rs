//! `tactpad diagnose --play`: two captures of a virtual pad, and what is refused.
#![allow(clippy::unwrap_used, reason = "a test that cannot set its scene fails")]

use std::fs;

use serde_json::Value;
use tactpad::pipeline::shipped;

use crate::ran::{printed, refused};

/// Gains of module 1, and noise that lasts, but no simulator.
fn pad(gain: f64) -> String {
    format!(
        "[noise]\nadditive_uv = 10.0\nshare = 0.01\nshare_time_s = 3.0\n[[module]]\nindex = 1\ngain = [{gain}, {gain}, {gain}]\n"
    )
}

#[test]
fn a_module_that_lost_gain_is_found_in_play() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    fs::write(folder.join("new.toml"), pad(1.0)).unwrap();
    fs::write(folder.join("worn.toml"), pad(0.9)).unwrap();
    let twin = "twin --plan play --seconds 90";
    printed(folder, &format!("{twin} --imperfections new.toml --out january.cap"));
    printed(folder, &format!("{twin} --imperfections worn.toml --seed 2 --out today.cap"));
    let found = printed(folder, "diagnose --play today.cap --against january.cap --json");
    let found: Value = serde_json::from_str(&found).unwrap();
    let first = &found["findings"][0];
    let names = [&first["effect"], &first["target"]];
    assert_eq!(
        (names, &found["verdict"]),
        ([&"module_gain".into(), &"module1".into()], &"changed".into()),
        "{found}"
    );
    let gain = &first["parameters"]["gain"];
    let [low, high] = ["low95", "high95"].map(|key| gain[key].as_f64().unwrap());
    assert!(low - 0.01 < 0.9 && 0.9 < high + 0.01 && high < 0.95, "{gain}");
    let words = printed(folder, "diagnose --play today.cap --against january.cap");
    assert!(words.contains("module_gain of module1: gain 0."), "{words}");
    assert!(words.contains("no press tells them"), "{words}");
}

#[test]
fn what_is_no_play_is_refused_in_one_sentence() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    fs::write(folder.join("my.decoder"), shipped::bytes(shipped::INVERSE).unwrap()).unwrap();
    fs::write(folder.join("text.cap"), "nothing\n").unwrap();
    printed(folder, "twin --plan play --seconds 10 --out short.cap");
    for (line, wanted) in [
        ("diagnose --play short.cap --against my.decoder", "my.decoder is a decoder"),
        ("diagnose --play short.cap --against text.cap", "text.cap "),
        ("diagnose --play text.cap --against short.cap", "text.cap "),
        ("diagnose --play short.cap --against short.cap", "tenths of a second with a press"),
        ("diagnose --play none.cap --against short.cap", "none.cap "),
    ] {
        let said = refused(folder, line);
        assert!(said.contains(wanted) && said.lines().count() == 1, "{line}: {said}");
    }
    assert!(refused(folder, "diagnose --play short.cap").contains("--against"));
}
