//! Figures as files.

use std::fs;
use std::path::Path;

use super::failure::Failure;
use super::written::reason;
use tactpad::plot::figure::Figure;
use tactpad::plot::{png, svg};

/// Picture elements per CSS pixel: sharp on any screen.
const SCALE: f64 = 2.0;

/// Writes a figure as `name`.svg and `name`.png into a folder, which is made if there is none.
pub(super) fn write(folder: &Path, name: &str, figure: &Figure) -> Result<(), Failure> {
    let picture = png::bytes(figure, SCALE).map_err(|error| Failure::Failed(error.to_string()))?;
    let text = svg::text(figure);
    fs::create_dir_all(folder).map_err(|error| refused(folder, &error))?;
    for (ending, bytes) in [("svg", text.as_bytes()), ("png", &picture)] {
        let path = folder.join(name).with_extension(ending);
        fs::write(&path, bytes).map_err(|error| refused(&path, &error))?;
    }
    Ok(())
}

fn refused(path: &Path, error: &std::io::Error) -> Failure {
    let why = reason(error);
    Failure::Unusable(format!("{} cannot be written: {why}; name another folder", path.display()))
}
