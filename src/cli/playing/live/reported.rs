//! Reports of diagnoses, for the dashboard: those that `diagnose` remembers and that are still there.

use std::fs;
use std::path::{Path, PathBuf};
use std::time::UNIX_EPOCH;

use serde_json::Value;

use crate::cli::printing::reports::{DOCUMENT, PAGE, folders};
use tactpad::dashboard::host::ReportEntry;

/// Reports that are still there, the newest first.
pub(super) fn all() -> Vec<ReportEntry> {
    folders().iter().enumerate().filter_map(|(number, folder)| report(number, folder)).rev().collect()
}

/// The page of the report that is called so.
pub(super) fn page(id: &str) -> Option<PathBuf> {
    let folder = folders().into_iter().nth(id.parse().ok()?)?;
    Some(folder.join(PAGE)).filter(|page| page.is_file())
}

fn report(number: usize, folder: &Path) -> Option<ReportEntry> {
    let written = fs::metadata(folder.join(PAGE)).ok()?.modified().ok()?;
    let document: Value = serde_json::from_slice(&fs::read(folder.join(DOCUMENT)).ok()?).ok()?;
    Some(ReportEntry {
        id: number.to_string(),
        name: folder.file_name()?.to_string_lossy().into_owned(),
        folder: folder.display().to_string(),
        modified_s: written.duration_since(UNIX_EPOCH).map_or(0, |it| it.as_secs()),
        verdict: document.get("verdict").and_then(Value::as_str).unwrap_or_default().to_owned(),
        summary: summary(&document),
    })
}

/// The findings, in one line.
fn summary(document: &Value) -> String {
    let findings = document.get("findings").and_then(Value::as_array).into_iter().flatten();
    let text =
        |finding: &Value, key: &str| finding.get(key).and_then(Value::as_str).unwrap_or_default().to_owned();
    let found: Vec<_> = findings
        .map(|finding| format!("{} of {}", text(finding, "effect"), text(finding, "target")))
        .collect();
    if found.is_empty() { "nothing was found".into() } else { found.join(", ") }
}
