//! `tactpad bench` from outside: a session on the virtual pad, and what it refuses.
#![expect(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use std::process::{Command, Output, Stdio};

use serde_json::Value;

use crate::guest::in_guest;

fn bench(line: &str) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_tactpad"));
    command.arg("bench").args(line.split_whitespace()).stdin(Stdio::null());
    command.output().unwrap()
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

#[test]
fn a_session_on_a_pad_that_is_wired_wrong_prints_what_mends_it() {
    in_guest("bench::a_session_on_a_pad_that_is_wired_wrong_prints_what_mends_it", session);
}

fn session() {
    // What stands for a pad that sends m0x as m1y, m1y as -m0x, and m2z reversed.
    let output = bench("virtual --json --weight-g 20 --wiring m0x=m1y,m1y=-m0x,m2z=-m2z");
    assert_eq!(output.status.code(), Some(1), "{}", said(&output));
    assert!(said(&output).contains("press firmly above module 2 (lower left)"), "{}", said(&output));
    let report: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(report["wiring"], "m0x=-m1y,m1y=m0x,m2z=-m2z", "{report:#}");
    assert_eq!(report["open"], serde_json::json!([]), "{report:#}");
    assert_eq!(report["inputs"][0]["name"], "m0x");
    let noise_uv = report["inputs"][0]["noise_uv"].as_f64().unwrap();
    assert!(noise_uv > 4.0 && noise_uv < 8.0, "{report:#}");
}

#[test]
fn what_cannot_be_measured_is_refused_with_a_way_out() {
    for (line, wanted) in [
        ("virtual --weight-g 1", "take a weight of 2 to 1000 g"),
        ("virtual --weight-g nan", "write grams, such as 200"),
        ("load-cells:/dev/null", "`tactpad run` and its description"),
        ("serial:/nowhere", "/nowhere"),
        ("virtual --wiring m0x=m1y", "m0x=m1y,m1y=m0x"),
        ("virtual --wiring m0q=m1y", "m0z=-m0z"),
    ] {
        let output = bench(line);
        assert_eq!(output.status.code(), Some(2), "{line}: {}", said(&output));
        assert!(said(&output).contains(wanted), "{line}: {}", said(&output));
    }
}
