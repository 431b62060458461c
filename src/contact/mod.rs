//! Where a contact is and how hard it presses, from strain.

pub mod creep;
pub mod file;
pub mod friction;
pub mod inverse;
pub mod neighbours;
pub mod read;
pub mod recording;
pub mod regression;
pub mod relief;
pub mod statics;
pub mod thermal;
pub mod thermometer;
pub mod touch;
pub mod uncertainty;
pub mod watch;

use crate::contact::creep::{Creep, NO_CREEP};
use crate::contact::friction::{Friction, NO_FRICTION};
use crate::contact::inverse::{Explained, Inverse};
use crate::contact::neighbours::Neighbours;
use crate::contact::regression::{Regression, Target};
use crate::contact::statics::Statics;
use crate::contact::thermal::Thermal;
#[cfg(feature = "foreign-onnx")]
use crate::network::foreign::Foreign;
use crate::network::{Network, OUTPUTS, Zero};
use crate::quantity::{CHANNELS, Contact, Strain};

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
    /// A network that tract runs.
    #[cfg(feature = "foreign-onnx")]
    Foreign(Foreign),
}

impl Decoder {
    /// What people call it.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Statics(_) => "statics",
            Self::Inverse(_) => "inverse",
            Self::Regression(regression) if regression.target == Target::Wrench => "wrench",
            Self::Regression(_) => "linear",
            Self::Neighbours(_) => "knn",
            Self::Network(_) => "network",
            #[cfg(feature = "foreign-onnx")]
            Self::Foreign(_) => "foreign network",
        }
    }

    /// The decoder that knows what each channel should read, if it is that.
    pub const fn inverse(&self) -> Option<&Inverse> {
        match self {
            Self::Inverse(inverse) => Some(inverse),
            _ => None,
        }
    }

    /// What it takes: channels relative to the untouched pad, but for one that was made by a table that never reads it. The
    /// inverse decoder takes them relative even then, as it knows what to take off.
    pub fn zero(&self) -> Zero {
        match self {
            Self::Network(network) => network.zero,
            #[cfg(feature = "foreign-onnx")]
            Self::Foreign(network) => network.zero,
            Self::Regression(regression) => regression.zero,
            Self::Neighbours(neighbours) => neighbours.zero,
            Self::Statics(_) | Self::Inverse(_) => Zero::Tared,
        }
    }

    /// What the decoder wants taken off its channels, as they remember earlier loads.
    pub const fn friction(&self) -> &Friction {
        match self {
            Self::Inverse(inverse) => inverse.friction(),
            _ => &NO_FRICTION,
        }
    }

    /// How much the decoder's pad creeps, which is to be taken off its channels, too.
    pub const fn creep(&self) -> &Creep {
        match self {
            Self::Inverse(inverse) => inverse.creep(),
            _ => &NO_CREEP,
        }
    }

    /// What the untouched pad reads, if the decoder knows.
    pub const fn zero_uv(&self) -> Option<&[f64; CHANNELS]> {
        match self {
            Self::Inverse(inverse) => inverse.zero_uv(),
            _ => None,
        }
    }

    /// How the decoder's pad follows the temperature, if it knows.
    pub const fn thermal(&self) -> Option<&Thermal> {
        match self {
            Self::Inverse(inverse) => inverse.thermal(),
            _ => None,
        }
    }

    /// The contact that explains `strain`, and what it leaves over, if the decoder knows what each channel should read.
    pub fn explain(&self, strain: &Strain) -> (Contact, Option<Explained>) {
        match self {
            Self::Inverse(inverse) => {
                let explained = inverse.explain(strain);
                (explained.map(|explained| explained.contact).unwrap_or_default(), explained)
            }
            _ => (self.decode(strain), None),
        }
    }

    /// The contact that explains `strain`. Always finite; see the decoder in question for degenerate input.
    pub fn decode(&self, strain: &Strain) -> Contact {
        match self {
            Self::Statics(statics) => statics.decode(strain),
            Self::Inverse(inverse) => inverse.decode(strain),
            Self::Regression(regression) => regression.decode(strain),
            Self::Neighbours(neighbours) => neighbours.decode(strain),
            Self::Network(network) => contact(network.decode(&strain.uv)),
            #[cfg(feature = "foreign-onnx")]
            Self::Foreign(network) => contact(network.decode(&strain.uv)),
        }
    }
}

/// A network's numbers; where one is none, no contact.
fn contact(numbers: [f32; OUTPUTS]) -> Contact {
    let [x_mm, y_mm, fx_n, fy_n, fz_n] = numbers;
    let is_finite = numbers.iter().all(|number| number.is_finite());
    if is_finite { Contact { x_mm, y_mm, fx_n, fy_n, fz_n } } else { Contact::default() }
}
