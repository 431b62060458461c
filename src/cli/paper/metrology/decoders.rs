//! The verb's decoders: from files, or trained.

use std::path::Path;

use crate::cli::failure::Failure;
use crate::cli::files::decoder_file;
use crate::cli::printing::progress::Progress;
use tactpad::lab::metrology::decoders::Decoders;
use tactpad::lab::scdf::EPOCHS_MAX;
use tactpad::network::Zero;
use tactpad::network::training::Epoch;
use tactpad::pad::device::Device;
use tactpad::pad::field::PadField;

/// Those that are given as files.
pub(super) fn given(decoder: Option<&Path>, network: Option<&Path>) -> Result<Decoders, Failure> {
    let given = decoder.map(decoder_file::read).transpose()?;
    if given.as_ref().is_some_and(|decoder| decoder.zero() == Zero::Raw) {
        return Err(Failure::Unusable(
            "--decoder takes raw channels, and zeros are taken off here: adapt it with a file that has \
             rows without force"
                .into(),
        ));
    }
    let network = network.map(decoder_file::read_network).transpose()?;
    Ok(Decoders { given, network })
}

/// Stage I, trained on `designed`.
pub(super) fn trained(designed: &Device, nominal: &PadField) -> Decoders {
    let progress = Progress::begin("training the paper's network on the simulation");
    Decoders::trained(designed, nominal, |Epoch { number, .. }| {
        let what = format_args!("training the paper's network on the simulation: epoch {number}");
        progress.part(*number, EPOCHS_MAX, what);
    })
}
