//! `--figures` and `--vtk`: the files of a pressed pad.

use super::{module, pictures};
use crate::cli::failure::Failure;
use crate::cli::files::destination::Folder;
use crate::cli::files::field::field_of;
use crate::cli::printing::pictures::write;
use crate::cli::printing::progress::Progress;
use tactpad::lab::field_cache::FieldError;
use tactpad::mechanics::mesh::Fineness;
use tactpad::mechanics::meshes;
use tactpad::mechanics::pressed::PressedPad;
use tactpad::mechanics::simulator::Simulator;
use tactpad::pad::device::Device;
use tactpad::quantity::MODULES;

/// Presses the device's pad at a place, writes figures and meshes into these folders, and says which files these are.
pub(super) fn fill(
    device: &Device,
    at_mm: [f64; 2],
    figures: Option<&Folder>,
    vtk: Option<&Folder>,
) -> Result<Vec<String>, Failure> {
    let pressed = pressed(device, at_mm)?;
    let mut written = Vec::new();
    if let Some(folder) = figures {
        let field = field_of(&pressed.pad.device)?;
        let gauges = module::gauges(&pressed).map_err(FieldError::Unsolved)?;
        let figures = pictures::of(&pressed, &field).into_iter().chain([("module-gauges", gauges)]);
        for (name, figure) in figures {
            written.extend(write(folder, name, &figure)?);
        }
    }
    if let Some(folder) = vtk {
        write_meshes(&pressed, folder, &mut written)?;
    }
    Ok(written)
}

fn pressed(device: &Device, at_mm: [f64; 2]) -> Result<PressedPad, Failure> {
    let _progress = Progress::begin("solving the pressed pad");
    Simulator::new(Fineness::STANDARD)
        .pressed(device, at_mm)
        .map_err(|error| FieldError::Unsolved(error).into())
}

fn write_meshes(pressed: &PressedPad, folder: &Folder, written: &mut Vec<String>) -> Result<(), Failure> {
    let modules = (0..MODULES).map(|index| (format!("module{index}.vtu"), meshes::module(pressed, index)));
    for (name, grid) in [("plate.vtu".to_owned(), meshes::plate(pressed))].into_iter().chain(modules) {
        let bytes = grid.vtu().map_err(|error| Failure::Failed(error.to_string()))?;
        written.push(folder.write(&name, &bytes)?);
    }
    Ok(())
}
