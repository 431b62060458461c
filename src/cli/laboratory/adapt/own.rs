//! The methods whose decoders are files of the program's own: `inverse`, `wrench`, `linear`, `knn`.

use std::path::Path;

use super::measured::Measured;
use super::method::Method;
use crate::cli::failure::Failure;
use crate::cli::files::decoder_file;
use crate::cli::printing::progress::Progress;
use tactpad::lab::calibration::data::earlier::EarlierCalibration;
use tactpad::lab::calibration::fit::Calibration;
use tactpad::lab::tangent::SimulatedPad;
use tactpad::pipeline::contact::Decoder;
use tactpad::pipeline::contact::regression::Target;

/// The decoder of `--from`; none for a method that begins with none, or with a network.
pub(super) fn earlier(method: Method, from: Option<&Path>) -> Result<Option<Decoder>, Failure> {
    match (method, from) {
        (Method::Inverse, Some(path)) => another_pads(path).map(Some),
        (Method::Wrench | Method::Linear | Method::Knn, Some(_)) => Err(Failure::Unusable(
            "--from is for inverse and scdf; wrench, linear and knn are made of the measured contacts alone"
                .into(),
        )),
        (_, None) | (Method::Scdf, Some(_)) => Ok(None),
    }
}

/// Fits the decoder; the inverse one is calibrated.
pub(super) fn adapt(
    method: Method,
    measured: &Measured,
    earlier: Option<&Decoder>,
    pad: &SimulatedPad<'_>,
) -> Result<(Decoder, Option<Calibration>), Failure> {
    let (contacts, reach_mm) = (&measured.contacts, pad.device.contact.max_centre_radius_mm);
    let fitted = match method {
        Method::Inverse => return calibrated(measured, earlier, pad),
        Method::Knn => contacts.neighbours(),
        Method::Wrench => contacts.regression(Target::Wrench, reach_mm),
        Method::Linear | Method::Scdf => contacts.regression(Target::Contact, reach_mm),
    };
    Ok((fitted.map_err(|error| measured.refused(error))?, None))
}

fn calibrated(
    measured: &Measured,
    earlier: Option<&Decoder>,
    pad: &SimulatedPad<'_>,
) -> Result<(Decoder, Option<Calibration>), Failure> {
    let progress = Progress::begin("fitting the pad's field");
    let report = |done: usize, of: usize| progress.part(done, of, "fitting the pad's field");
    let earlier = earlier.and_then(EarlierCalibration::of);
    let calibration = measured.contacts.calibration(pad, earlier, &report);
    drop(progress);
    let calibration = calibration.map_err(|error| measured.refused(error))?;
    Ok((calibration.decoder(), Some(calibration)))
}

/// The other pad's decoder to begin with.
fn another_pads(path: &Path) -> Result<Decoder, Failure> {
    let decoder = decoder_file::read(path)?;
    if EarlierCalibration::of(&decoder).is_none() {
        return Err(Failure::Unusable(format!(
            "--from {} is a {} decoder; inverse begins with one that adapt --method inverse wrote",
            path.display(),
            decoder.name()
        )));
    }
    Ok(decoder)
}
