//! Where a contact is and how hard it presses, from strain.

pub mod file;
pub mod friction;
pub mod inverse;
pub mod neighbours;
pub mod recording;
pub mod regression;
pub mod statics;
pub mod touch;
pub mod uncertainty;

use crate::contact::friction::{Friction, NO_FRICTION};
use crate::contact::inverse::Inverse;
use crate::contact::neighbours::Neighbours;
use crate::contact::regression::Regression;
use crate::contact::statics::Statics;
use crate::network::Network;
use crate::quantity::{Contact, Strain};

/// A way from strain to a contact.
#[derive(Clone, Debug)]
pub enum Decoder {
    /// The balance of forces and moments, with five numbers.
    Statics(Statics),
    /// The pad's own field, inverted.
    Inverse(Box<Inverse>),
    /// Linear functions of the channels.
    Regression(Box<Regression>),
    /// The nearest contacts that were measured.
    Neighbours(Neighbours),
    /// The paper's network.
    Network(Box<Network>),
}

impl Decoder {
    /// The decoder that is inside the program.
    pub fn shipped() -> Self {
        Self::Statics(Statics::nominal())
    }

    /// What the decoder wants taken off its channels, as they remember earlier loads.
    pub const fn friction(&self) -> &Friction {
        match self {
            Self::Inverse(inverse) => inverse.friction(),
            _ => &NO_FRICTION,
        }
    }

    /// The contact that explains `strain`. Always finite; see the decoder in question for degenerate input.
    pub fn decode(&self, strain: &Strain) -> Contact {
        match self {
            Self::Statics(statics) => statics.decode(strain),
            Self::Inverse(inverse) => inverse.decode(strain),
            Self::Regression(regression) => regression.decode(strain),
            Self::Neighbours(neighbours) => neighbours.decode(strain),
            Self::Network(network) => by_network(network, strain),
        }
    }
}

fn by_network(network: &Network, strain: &Strain) -> Contact {
    let numbers = network.decode(&strain.uv);
    let [x_mm, y_mm, fx_n, fy_n, fz_n] = numbers;
    let is_finite = numbers.iter().all(|number| number.is_finite());
    if is_finite { Contact { x_mm, y_mm, fx_n, fy_n, fz_n } } else { Contact::default() }
}
