//! `--figures` and `--vtk`: the files of a pressed pad.

use std::fs;
use std::path::{Path, PathBuf};

use super::pictures;
use crate::cli::failure::Failure;
use crate::cli::field::field_of;
use crate::cli::progress::Progress;
use crate::cli::written::reason;
use tactpad::lab::field_cache::FieldError;
use tactpad::mechanics::mesh::Fineness;
use tactpad::mechanics::meshes;
use tactpad::mechanics::pressed::PressedPad;
use tactpad::mechanics::simulator::Simulator;
use tactpad::pad::device::Device;
use tactpad::plot::{png, svg};
use tactpad::quantity::MODULES;

/// Pixels of a PNG per pixel of the figure: sharp on paper and on dense screens.
const PNG_SCALE: f64 = 2.0;

/// Presses the device's pad at a place, writes figures and meshes into these folders, and says which files these are.
pub(super) fn write(
    device: &Device,
    at_mm: [f64; 2],
    figures: Option<&Path>,
    vtk: Option<&Path>,
) -> Result<Vec<String>, Failure> {
    [figures, vtk].into_iter().flatten().try_for_each(make)?;
    let pressed = pressed(device, at_mm)?;
    let mut written = Vec::new();
    if let Some(folder) = figures {
        write_figures(&pressed, folder, &mut written)?;
    }
    if let Some(folder) = vtk {
        write_meshes(&pressed, folder, &mut written)?;
    }
    Ok(written.iter().map(|path| path.display().to_string()).collect())
}

fn pressed(device: &Device, at_mm: [f64; 2]) -> Result<PressedPad, Failure> {
    let mut progress = Progress::begin();
    progress.step("solving the pressed pad");
    Simulator::new(Fineness::STANDARD)
        .pressed(device, at_mm)
        .map_err(|error| FieldError::Unsolved(error).into())
}

fn write_figures(pressed: &PressedPad, folder: &Path, written: &mut Vec<PathBuf>) -> Result<(), Failure> {
    let field = field_of(&pressed.pad.device)?;
    for (name, figure) in pictures::of(pressed, &field) {
        put(folder.join(name).with_extension("svg"), svg::text(&figure).as_bytes(), written)?;
        let bytes = png::bytes(&figure, PNG_SCALE).map_err(|error| Failure::Failed(error.to_string()))?;
        put(folder.join(name).with_extension("png"), &bytes, written)?;
    }
    Ok(())
}

fn write_meshes(pressed: &PressedPad, folder: &Path, written: &mut Vec<PathBuf>) -> Result<(), Failure> {
    let modules = (0..MODULES).map(|index| (format!("module{index}.vtu"), meshes::module(pressed, index)));
    for (name, grid) in [("plate.vtu".to_owned(), meshes::plate(pressed))].into_iter().chain(modules) {
        let bytes = grid.vtu().map_err(|error| Failure::Failed(error.to_string()))?;
        put(folder.join(name), &bytes, written)?;
    }
    Ok(())
}

fn make(folder: &Path) -> Result<(), Failure> {
    fs::create_dir_all(folder).map_err(|error| {
        let why = reason(&error);
        Failure::Unusable(format!("{} cannot be made: {why}; name another folder", folder.display()))
    })
}

fn put(path: PathBuf, bytes: &[u8], written: &mut Vec<PathBuf>) -> Result<(), Failure> {
    fs::write(&path, bytes)
        .map_err(|error| Failure::Failed(format!("cannot write {}: {}", path.display(), reason(&error))))?;
    written.push(path);
    Ok(())
}
