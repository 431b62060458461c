//! `tactpad diagnose` of pads as they are made and rooms as they are: every channel has its own gain, and a column is missing.
#![allow(clippy::unwrap_used, reason = "a test that cannot set its scene fails")]

use std::fmt::Write as _;
use std::fs;
use std::path::Path;
use std::process::Command;

use serde_json::Value;

/// The gains in `models/imperfections/gains.toml`, channel by channel.
const GAINS: [(&str, f64); 9] = [
    ("m0x", 1.262),
    ("m0y", 1.331),
    ("m0z", 0.834),
    ("m1x", 1.285),
    ("m1y", 1.262),
    ("m1z", 0.994),
    ("m2x", 1.270),
    ("m2y", 1.330),
    ("m2z", 0.840),
];

fn imperfections(name: &str) -> String {
    format!("{}/models/imperfections/{name}", env!("CARGO_MANIFEST_DIR"))
}

fn said(folder: &Path, line: &[&str]) -> String {
    let output = Command::new(env!("CARGO_BIN_EXE_tactpad")).args(line).current_dir(folder).output().unwrap();
    assert!(output.status.success(), "{line:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

fn findings(folder: &Path, table: &str) -> Vec<Value> {
    let document: Value =
        serde_json::from_str(&said(folder, &["diagnose", "--json", "--measured", table])).unwrap();
    document["findings"].as_array().unwrap().clone()
}

/// The plan with a temperature that rises by 8 °C from its first to its last row.
fn warmed(plan: &str) -> String {
    let count = plan.lines().count() as f64;
    let mut warmed = String::new();
    for (at, line) in plan.lines().enumerate() {
        let cell =
            if at == 0 { "temp_c".to_owned() } else { format!("{:.3}", 25.0 + 8.0 * at as f64 / count) };
        writeln!(warmed, "{line},{cell}").unwrap();
    }
    warmed
}

/// A table without one of its columns.
fn without(table: &str, column: &str) -> String {
    let at = table.lines().next().unwrap().split(',').position(|name| name == column).unwrap();
    let row = |line: &str| {
        let cells: Vec<&str> =
            line.split(',').enumerate().filter(|(k, _)| *k != at).map(|(_, cell)| cell).collect();
        cells.join(",") + "\n"
    };
    table.lines().map(row).collect()
}

#[test]
fn nine_gains_are_told_as_nine_gains() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    said(
        folder,
        &[
            "twin",
            "--plan",
            "paper",
            "--seed",
            "1",
            "--imperfections",
            &imperfections("gains.toml"),
            "--out",
            "g.csv",
        ],
    );
    let found = findings(folder, "g.csv");
    for finding in &found {
        assert_eq!(
            (&finding["effect"], &finding["status"]),
            (&"channel_gain".into(), &"NAMED".into()),
            "{finding}"
        );
        let (_, gain) = GAINS.iter().find(|(channel, _)| finding["target"] == *channel).unwrap();
        let [low, high] = ["low95", "high95"].map(|end| finding["parameters"]["gain"][end].as_f64().unwrap());
        assert!((low..=high).contains(gain) && high / low < 1.05, "{finding}");
    }
    // The ninth is 0.994.
    assert_eq!(found.len(), 8);
}

#[test]
fn a_room_whose_temperature_nobody_wrote_down_stays_a_rival_of_drift() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    said(folder, &["protocol", "paper", "--out", "plan.csv"]);
    let plan = fs::read_to_string(folder.join("plan.csv")).unwrap();
    fs::write(folder.join("warmed.csv"), warmed(&plan)).unwrap();
    let warm = imperfections("warm.toml");
    said(
        folder,
        &["twin", "--plan", "warmed.csv", "--seed", "1", "--imperfections", &warm, "--out", "m.csv"],
    );
    let measured = fs::read_to_string(folder.join("m.csv")).unwrap();
    fs::write(folder.join("without.csv"), without(&measured, "temp_c")).unwrap();
    let found = findings(folder, "without.csv");
    let of_drift: Vec<&Value> = found.iter().filter(|it| it["effect"] == "zero_drift").collect();
    assert!(!of_drift.is_empty(), "{found:?}");
    for finding in of_drift {
        let rivals = finding["confounded_with"].as_array().unwrap();
        assert!(rivals.iter().any(|rival| rival["effect"] == "thermal_zero"), "{finding}");
        assert!(finding["separate_by"].as_str().unwrap().contains("under temp_c"), "{finding}");
    }
}
