//! The decoder of a live verb: what plays, what people are told, what captures keep.

use std::path::Path;

use super::Failure;
use super::decoder_file::Choice;
use crate::contact::Decoder;
use crate::shipped;

/// A decoder that is to play.
#[derive(Clone, Debug)]
pub(super) struct Chosen {
    pub(super) decoder: Decoder,
    /// As people are told of it.
    pub(super) name: String,
    /// What captures keep of it; nothing for the statics that are inside the program.
    pub(super) bytes: Option<Vec<u8>>,
}

impl Chosen {
    /// Reads it.
    pub(super) fn read(choice: &Choice) -> Result<Self, Failure> {
        let (decoder, bytes) = choice.read()?;
        let (name, kind) = (choice.name(), decoder.name());
        let told = if name == kind { name.into() } else { format!("{kind} ({name})") };
        Ok(Self { decoder, name: told, bytes: Some(bytes).filter(|_| name != shipped::STATICS) })
    }
}

/// The file that is read, if it is one.
pub(super) fn file(choice: &Choice) -> Option<&Path> {
    Some(choice.name()).filter(|name| !shipped::is_known(name)).map(Path::new)
}
