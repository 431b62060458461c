//! Where a contact is and how hard it presses, from strain.

pub mod inverse;
pub mod statics;
pub mod touch;

use crate::contact::statics::Statics;
use crate::quantity::{Contact, Strain};

/// A way from strain to a contact.
#[derive(Clone, Debug)]
pub enum Decoder {
    /// The balance of forces and moments, with five numbers.
    Statics(Statics),
}

impl Decoder {
    /// The decoder that is inside the program.
    pub fn shipped() -> Self {
        Self::Statics(Statics::nominal())
    }

    /// The contact that explains `strain`. Always finite; see the decoder in question for degenerate input.
    pub fn decode(&self, strain: &Strain) -> Contact {
        match self {
            Self::Statics(statics) => statics.decode(strain),
        }
    }
}
