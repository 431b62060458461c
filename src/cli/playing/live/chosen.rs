//! The decoder of a live verb: what plays, what people are told, what captures keep.

use std::path::Path;

use crate::cli::failure::Failure;
use crate::cli::files::decoder_file::DecoderChoice;
use tactpad::bridge::bridge_parts::PlayingDecoder;
use tactpad::pipeline::contact::read;
use tactpad::pipeline::shipped;

/// Reads the decoder that is to play.
pub(super) fn read(choice: &DecoderChoice) -> Result<PlayingDecoder, Failure> {
    let (decoder, bytes) = choice.read_by(read::playing)?;
    let (name, kind) = (choice.name(), decoder.name());
    let told = if name == kind { name.into() } else { format!("{kind} ({name})") };
    let whole = |path: &Path| std::path::absolute(path).ok()?.into_os_string().into_string().ok();
    let place = file(choice).map_or_else(|| Some(name.to_owned()), whole);
    Ok(PlayingDecoder { decoder, name: told, place, file: Some(bytes).filter(|_| name != shipped::STATICS) })
}

/// The file that is read, if it is one.
pub(super) fn file(choice: &DecoderChoice) -> Option<&Path> {
    Some(choice.name()).filter(|name| !shipped::is_known(name)).map(Path::new)
}
