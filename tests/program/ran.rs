//! The program run with a line of arguments.
#![allow(clippy::unwrap_used, reason = "a test that cannot set its scene fails")]

use std::path::Path;
use std::process::{Command, Output, Stdio};

use serde_json::Value;

/// What the program does, in this folder; it never panics.
pub(super) fn tactpad(folder: &Path, line: &str) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_tactpad"));
    command.args(line.split_whitespace()).current_dir(folder).stdin(Stdio::null()).env("RUST_BACKTRACE", "1");
    let output = command.output().unwrap();
    let said = said(&output);
    assert!(!said.contains("panicked") && !said.contains("stack backtrace"), "{said}");
    output
}

/// What it says on standard error.
pub(super) fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// What it prints where it succeeds.
pub(super) fn printed(folder: &Path, line: &str) -> String {
    let output = tactpad(folder, line);
    assert!(output.status.success(), "{line}: {}", said(&output));
    String::from_utf8(output.stdout).unwrap()
}

/// The document that it prints.
pub(super) fn json(folder: &Path, line: &str) -> Value {
    serde_json::from_str(&printed(folder, line)).unwrap()
}

/// What it says where it refuses, and prints nothing.
pub(super) fn refused(folder: &Path, line: &str) -> String {
    let output = tactpad(folder, line);
    assert_eq!((output.status.code(), output.stdout.len()), (Some(2), 0), "{line}");
    said(&output)
}
