//! `--figures` and `--vtk`: the files of a pressed pad.

use std::fs;
use std::path::{Path, PathBuf};

use super::{Folders, meshes, pictures};
use crate::cli::Failure;
use crate::cli::field_cache::{field_of, unsolved};
use crate::cli::progress::Progress;
use crate::cli::written::reason;
use crate::device::Device;
use crate::mechanics::mesh::Fineness;
use crate::mechanics::pressed::PressedPad;
use crate::mechanics::simulator::Simulator;
use crate::plot::{png, svg};
use crate::quantity::MODULES;

/// Pixels of a PNG per pixel of the figure: sharp on paper and on dense screens.
const PNG_SCALE: f64 = 2.0;

/// Writes everything that is wanted, and says which files these are.
pub(super) fn write(device: &Device, Folders { figures, vtk, at }: &Folders) -> Result<Vec<String>, Failure> {
    [figures, vtk].into_iter().flatten().try_for_each(|folder| make(folder))?;
    let pressed = pressed(device, *at)?;
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
    Simulator::new(Fineness::STANDARD).pressed(device, at_mm).map_err(|error| unsolved(&error))
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
