//! `tactpad adapt --play`: a decoder from a capture of play.

use std::path::Path;

use super::at_home;
use super::method::Method;
use super::own;
use crate::cli::failure::Failure;
use crate::cli::files::destination::Destination;
use crate::cli::files::field::field_of;
use crate::cli::files::played;
use crate::cli::files::tables;
use crate::cli::files::text_file;
use tactpad::lab::play::home::HomeError;
use tactpad::lab::play::weights::{self, Placement};
use tactpad::pad::device::Device;

/// The options of `tactpad adapt --play`.
pub(super) struct PlayOptions<'a> {
    pub(super) method: Option<Method>,
    /// The capture, or kept play.
    pub(super) play: &'a Path,
    /// The table of placements, if there is one.
    pub(super) weights: Option<&'a Path>,
    pub(super) from: Option<&'a Path>,
    pub(super) out: &'a Path,
    pub(super) json: bool,
}

pub(super) fn run(options: &PlayOptions<'_>, device: &Device) -> Result<(), Failure> {
    let PlayOptions { method, play, weights, from, out, json } = *options;
    if method.is_some_and(|method| method != Method::Inverse) {
        return Err(Failure::Unusable(
            "from play there is only --method inverse: the others learn from labels".into(),
        ));
    }
    let reach_mm = device.contact.max_centre_radius_mm;
    let placements = weights.map_or(Ok(Vec::new()), |path| read_weights(path, reach_mm))?;
    let to = Destination::of(out)?;
    let earlier = own::earlier(Method::Inverse, from)?;
    let field = field_of(device)?;
    let windows = played::read(play, earlier.as_ref())?.windows;
    let found = at_home::fitted(&windows, &placements, device, &field, earlier.as_ref());
    let found = found.map_err(|error| {
        let name = weights.unwrap_or(play);
        let is_placement = matches!(error, HomeError::Placement(_));
        let name = if is_placement { name } else { play };
        Failure::Unusable(format!("{}: {error}", name.display()))
    })?;
    at_home::write(found, &windows, &to, out, json)
}

/// Reads a table of placements.
pub(crate) fn read_weights(path: &Path, reach_mm: f64) -> Result<Vec<Placement>, Failure> {
    let unusable = |why: String| Failure::Unusable(format!("{}: {why}", path.display()));
    let text = text_file::read(path).map_err(unusable)?;
    let read = weights::read(&text, reach_mm).map_err(|why| unusable(why.to_string()))?;
    tables::warn(path, read.open_end.as_ref());
    Ok(read.all)
}
