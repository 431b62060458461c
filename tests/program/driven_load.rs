//! `tactpad diagnose --against` on load tests: a load that is driven up and down again, seconds between rows, gauges that lag behind it.
#![allow(clippy::unwrap_used, reason = "a test that cannot set its scene fails")]

use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};

use serde_json::Value;
use tactpad::numeric::random::SplitMix64;

const NAMES: [&str; 5] = ["laser1_mm", "laser3_mm", "laser4_mm", "laser5_mm", "strain_ue"];
/// What a gauge reads by a kilonewton.
const SLOPES: [f64; 5] = [-0.018, 0.069, 0.121, 0.0068, -0.35];
const ROWS: usize = 1500;
const STEP_S: f64 = 4.0;
/// Half the width of the loop of load and gauge.
const PLAY_KN: f64 = 40.0;
const CREEP_S: f64 = 900.0;

/// The load of a cycle at a part of it: up in two steps, held, down, and nothing.
fn load(top_kn: f64, part: f64) -> f64 {
    let points = [(0.0, 0.0), (0.06, 0.85), (0.2, 0.85), (0.22, 1.0), (0.55, 0.97), (0.6, 0.0), (1.0, 0.0)];
    let at = points.partition_point(|(begin, _)| *begin <= part).clamp(1, points.len() - 1);
    let ((begin, from), (end, to)) = (points[at - 1], points[at]);
    top_kn * (from + (to - from) * (part - begin) / (end - begin))
}

/// A test of a structure with these compliances: 85 % of a gauge follows the load at once, 15 % by play, and 5 % creep after it; each cycle
/// has its own 1 % of each gain.
fn tested(seed: u64, growth: [f64; 5], cycles: usize) -> String {
    let mut random = SplitMix64::new(seed);
    let mut normal = move || f64::from(random.normal());
    let mut text = format!("t_s,fz_n,{}\n", NAMES.join(","));
    let ([mut play, mut creep], mut gains, mut top_kn) = ([0.0; 2], [1.0; 5], 0.0);
    for row in 0..ROWS {
        let (number, length) = (row % (ROWS / cycles), ROWS / cycles);
        if number == 0 {
            top_kn = 312.0 + 7.0 * normal();
            gains = growth.map(|it| it * (1.0 + 0.01 * normal()));
        }
        let kn = load(top_kn, number as f64 / length as f64) + 0.3 * normal();
        play = f64::clamp(play, kn - PLAY_KN, kn + PLAY_KN);
        creep += (kn - creep) * STEP_S / CREEP_S;
        let followed = 0.85 * kn + 0.15 * play + 0.05 * creep;
        let gauges: Vec<String> = SLOPES
            .iter()
            .zip(gains)
            .map(|(slope, gain)| format!("{:.5}", slope * (gain * followed + 0.6 * normal())))
            .collect();
        text += &format!("{:.1},{kn:.4},{}\n", row as f64 * STEP_S, gauges.join(","));
    }
    text
}

fn diagnosed(folder: &Path, later: &str) -> Value {
    let earlier = folder.join("earlier.csv");
    let measured = folder.join("later.csv");
    fs::write(&measured, later).unwrap();
    let mut command = Command::new(env!("CARGO_BIN_EXE_tactpad"));
    command.args(["diagnose", "--json", "--measured"]).arg(&measured).arg("--against").arg(&earlier);
    let output = command.env("XDG_STATE_HOME", folder).stdin(Stdio::null()).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

#[test]
fn a_compliance_that_grew_is_found_where_the_load_came_six_times_and_untestable_where_once() {
    let folder = tempfile::tempdir().unwrap();
    let grown = [1.14, 1.10, 1.07, 1.0, 1.0];
    fs::write(folder.path().join("earlier.csv"), tested(1, [1.0; 5], 6)).unwrap();
    assert_eq!(diagnosed(folder.path(), &tested(2, [1.0; 5], 6))["verdict"], "no_discrepancy");
    let found = diagnosed(folder.path(), &tested(3, grown, 6));
    let gain_of = |channel: &str| {
        let is_it = |it: &&Value| it["effect"] == "channel_gain" && it["target"] == channel;
        let finding = found["findings"].as_array().unwrap().iter().find(is_it)?;
        Some(["low95", "high95"].map(|end| finding["parameters"]["gain"][end].as_f64().unwrap()))
    };
    for (channel, gain) in NAMES.iter().zip(grown).take(3) {
        let [low, high] = gain_of(channel).unwrap_or_else(|| panic!("{channel}: {found:#}"));
        assert!((low..=high).contains(&gain) && high - low < 0.1, "{channel}: {low} to {high}");
    }
    fs::write(folder.path().join("earlier.csv"), tested(4, [1.0; 5], 1)).unwrap();
    for growth in [[1.0; 5], grown] {
        let once = diagnosed(folder.path(), &tested(5, growth, 1));
        assert_eq!(
            (&once["verdict"], once["findings"].as_array().unwrap().len()),
            (&"no_discrepancy".into(), 0)
        );
        let untested = once["not_testable"].as_array().unwrap();
        assert!(untested.iter().any(|it| it["effect"] == "channel_gain"), "{untested:?}");
    }
}
