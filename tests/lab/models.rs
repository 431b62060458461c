//! The shipped network is what its card says, and can be made again.
#![allow(clippy::unwrap_used, reason = "a test that cannot set its scene fails")]

use std::fs;
use std::process::Command;

use crate::support::require;
use serde_json::Value;

const CARD: &str = include_str!("../../models/scdf.md");
const NETWORK: &str = "models/scdf.onnx";

/// The cell beside `name` in the card's table.
fn card(name: &str) -> &'static str {
    let row = CARD.lines().find_map(|line| line.strip_prefix(&format!("| {name} | "))).unwrap();
    row.trim_end_matches(" |").trim_matches('`')
}

#[test]
fn the_card_has_the_networks_hash_and_size() {
    assert_eq!(card("bytes").replace(',', ""), fs::metadata(NETWORK).unwrap().len().to_string());
    if !require("sha256sum", "apt-get install coreutils") {
        return;
    }
    let output = Command::new("sha256sum").arg(NETWORK).output().unwrap();
    let hash = String::from_utf8(output.stdout).unwrap();
    assert_eq!(hash.split(' ').next(), Some(card("SHA-256")));
}

#[test]
#[ignore = "proof: 40 s: the shipped network is trained anew"]
fn the_cards_command_makes_the_network_again_bit_by_bit_with_the_cards_figures() {
    let folder = tempfile::tempdir().unwrap();
    let command = card("command").strip_prefix("tactpad ").unwrap();
    let mut train = Command::new(env!("CARGO_BIN_EXE_tactpad"));
    let trained = train.args(command.split(' ')).arg("--json").current_dir(folder.path()).output().unwrap();
    assert!(trained.status.success(), "{}", String::from_utf8_lossy(&trained.stderr));
    assert!(fs::read(folder.path().join("scdf.onnx")).unwrap() == fs::read(NETWORK).unwrap());
    let report: Value = serde_json::from_slice(&trained.stdout).unwrap();
    for (figure, digits) in [("mse", 4), ("mae", 3), ("r2", 3)] {
        let found = report["test"]["all"][figure].as_f64().unwrap();
        assert_eq!(card(figure), format!("{found:.digits$}"));
    }
}
