//! A question to the running bridge, and its answer.

use std::io;
use std::path::Path;

use serde_json::Value;

use crate::cli::failure::Failure;
use crate::cli::printing::written::reason;
use tactpad::bridge::control::ask;

/// The bridge's answer, as a line and as a document. An error in it is one here.
pub(super) fn answered(path: &Path, request: &str) -> Result<(String, Value), Failure> {
    let answer = ask(path, request).map_err(|error| Failure::Failed(no_answer(path, &error)))?;
    let document: Value =
        serde_json::from_str(&answer).map_err(|error| Failure::Failed(error.to_string()))?;
    match document.get("error").and_then(Value::as_str) {
        Some(error) => Err(Failure::Unusable(error.to_owned())),
        None => Ok((answer, document)),
    }
}

const fn is_nobody(kind: io::ErrorKind) -> bool {
    matches!(kind, io::ErrorKind::ConnectionRefused | io::ErrorKind::NotFound)
}

/// Why no bridge answers, and what to do about it.
pub(crate) fn no_answer(path: &Path, error: &io::Error) -> String {
    let path = path.display();
    match error.kind() {
        kind if is_nobody(kind) => format!("no bridge answers at {path}: start one with `tactpad run`"),
        io::ErrorKind::TimedOut => format!(
            "the bridge at {path} does not answer: if it was stopped (Ctrl-Z), continue it with `fg`; else end it and \
             start one with `tactpad run`"
        ),
        _ => format!("the bridge at {path} cannot be asked: {}", reason(error)),
    }
}
