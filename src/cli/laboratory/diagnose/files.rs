//! The report's files.

use std::path::Path;

use super::document::DiagnosisDocument;
use crate::cli::failure::Failure;
use crate::cli::files::destination::Folder;
use crate::cli::printing::reports;
use crate::cli::printing::written::{json_text, say};
use tactpad::lab::diagnosis::report::Diagnosis;

/// The last part of a path.
pub(super) fn file_name(path: &Path) -> String {
    path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned()
}

/// Writes the page and its document.
pub(super) fn write_report(folder: &Folder, page: &str, diagnosis: &Diagnosis) -> Result<(), Failure> {
    let page = folder.write(reports::PAGE, page.as_bytes())?;
    let document = folder.write(
        reports::DOCUMENT,
        format!("{}\n", json_text(&DiagnosisDocument::of(diagnosis))?).as_bytes(),
    )?;
    reports::remember(Path::new(&page).parent().unwrap_or(Path::new(".")));
    say(format_args!("the report is {page}, its numbers are {document}"));
    Ok(())
}
