//! Figures as files.

use crate::cli::failure::Failure;
use crate::cli::files::destination::Folder;
use tactpad::plot::figure::Figure;
use tactpad::plot::{png, svg};

/// Picture elements per CSS pixel: sharp on any screen.
const SCALE: f64 = 2.0;

/// Writes a figure as `name`.svg and `name`.png, and says the paths of both.
pub(crate) fn write(folder: &Folder, name: &str, figure: &Figure) -> Result<[String; 2], Failure> {
    let picture = png::bytes(figure, SCALE).map_err(|error| Failure::Failed(error.to_string()))?;
    let text = svg::text(figure);
    Ok([
        folder.write(&format!("{name}.svg"), text.as_bytes())?,
        folder.write(&format!("{name}.png"), &picture)?,
    ])
}
