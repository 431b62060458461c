//! Results of proofs: dated files.
#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a test may stop at what it did not expect, and says what it wrote"
)]

use std::fs;
use std::path::Path;
use std::process::Command;

/// Writes a proof's result to `target/proofs/NAME-DATE.json`, and says so.
///
/// # Panics
/// The file cannot be written.
pub(crate) fn write(name: &str, result: &serde_json::Value) {
    let date = Command::new("date").arg("+%Y-%m-%d").output().unwrap();
    let date = String::from_utf8(date.stdout).unwrap();
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).parent().unwrap().join("proofs");
    fs::create_dir_all(&folder).unwrap();
    let file = folder.join(format!("{name}-{}.json", date.trim()));
    fs::write(&file, format!("{result}\n")).unwrap();
    println!("{result} in {}", file.display());
}
