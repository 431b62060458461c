//! Head of a capture.

use crate::pipeline::contact::Decoder;
use crate::pipeline::contact::read::{self, Unreadable};
use crate::pipeline::mapping::read::ReadProfile;
use crate::pipeline::shipped;

/// The decoder and the profile that played when the capture began, so that it replays without another word.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Head {
    /// The decoder's file; `None` for statics as it is inside the program.
    pub decoder: Option<Vec<u8>>,
    /// The profile; `None` if there is none, or none that can be used.
    pub profile: Option<ReadProfile>,
}

impl Head {
    /// Reads the decoder that played.
    ///
    /// # Errors
    /// This program cannot read it.
    pub fn read_decoder(&self) -> Result<Decoder, Unreadable> {
        self.decoder.as_deref().map_or_else(|| Ok(shipped::statics()), read::tared)
    }
}
