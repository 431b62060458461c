//! Where a contact is and how hard it presses, from strain.

pub mod balance;
pub mod field_error;
pub mod file;
pub mod inverse;
pub mod neighbours;
pub mod nominal;
pub mod read;
pub mod regression;
pub mod stage;
pub mod standing;
pub mod statics;
pub mod told;
pub mod touch;
pub mod uncertainty;
pub mod watch;

#[cfg(feature = "foreign-onnx")]
use crate::network::foreign::Foreign;
use crate::network::{Network, OUTPUTS, Zero};
use crate::pipeline::compensation::Compensation;
use crate::pipeline::contact::balance::Balance;
use crate::pipeline::contact::inverse::{ContactFit, Inverse};
use crate::pipeline::contact::neighbours::Neighbours;
use crate::pipeline::contact::regression::{Regression, Target};
use crate::pipeline::contact::statics::Statics;
use crate::pipeline::signal::Scale;
use crate::quantity::{CHANNELS, Contact, Strain};

/// A way from strain to a contact, and what is known of the pad beside it.
#[derive(Clone, Debug)]
pub struct Decoder {
    /// How strain becomes a contact.
    pub method: Method,
    /// Compensation to subtract from the channels first. It is no work of [`Decoder::decode`]: strains come without it. A decoder
    /// that takes raw channels learnt them with all of this in them, and has none.
    pub compensation: Compensation,
}

/// How strain becomes a contact.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub enum Method {
    /// The balance of forces and moments, with five numbers.
    Statics(Statics),
    /// The balance of forces on load cells, or on a sensor of six axes.
    Balance(Box<Balance>),
    /// None: the pad sends contacts, and nothing else is decoded.
    Told,
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

impl From<Method> for Decoder {
    /// For a pad of which nothing else is known.
    fn from(method: Method) -> Self {
        Self { method, compensation: Compensation::NONE }
    }
}

impl From<Statics> for Decoder {
    fn from(statics: Statics) -> Self {
        Method::Statics(statics).into()
    }
}

impl From<Balance> for Decoder {
    fn from(balance: Balance) -> Self {
        Method::Balance(Box::new(balance)).into()
    }
}

impl From<Inverse> for Decoder {
    fn from(inverse: Inverse) -> Self {
        Method::Inverse(Box::new(inverse)).into()
    }
}

impl From<Regression> for Decoder {
    fn from(regression: Regression) -> Self {
        Method::Regression(Box::new(regression)).into()
    }
}

impl From<Neighbours> for Decoder {
    fn from(neighbours: Neighbours) -> Self {
        Method::Neighbours(neighbours).into()
    }
}

impl From<Network> for Decoder {
    fn from(network: Network) -> Self {
        Method::Network(Box::new(network)).into()
    }
}

#[cfg(feature = "foreign-onnx")]
impl From<Foreign> for Decoder {
    fn from(network: Foreign) -> Self {
        Method::Foreign(network).into()
    }
}

impl Decoder {
    /// The same for a pad of which this is known.
    #[must_use]
    pub fn compensated_by(self, compensation: Compensation) -> Self {
        Self { compensation, ..self }
    }

    /// Name for people.
    pub fn name(&self) -> &'static str {
        match &self.method {
            Method::Statics(_) => "statics",
            Method::Balance(_) => "balance",
            Method::Told => "contacts",
            Method::Inverse(_) => "inverse",
            Method::Regression(regression) if regression.target == Target::Wrench => "wrench",
            Method::Regression(_) => "linear",
            Method::Neighbours(_) => "knn",
            Method::Network(_) => "network",
            #[cfg(feature = "foreign-onnx")]
            Method::Foreign(_) => "foreign network",
        }
    }

    /// Zero that it takes: channels relative to the untouched pad, but for one that was made by a table that never reads it. The
    /// inverse decoder takes them relative even then, as it knows what to take off.
    pub const fn zero(&self) -> Zero {
        match &self.method {
            Method::Network(network) => network.zero,
            #[cfg(feature = "foreign-onnx")]
            Method::Foreign(network) => network.zero,
            Method::Regression(regression) => regression.zero,
            Method::Neighbours(neighbours) => neighbours.zero,
            Method::Statics(_) | Method::Balance(_) | Method::Told | Method::Inverse(_) => Zero::Tared,
        }
    }

    /// How many channels it takes: nine but for pads that have fewer, and none where the pad decodes on its own.
    pub const fn channels(&self) -> usize {
        match &self.method {
            Method::Balance(balance) => balance.channels(),
            Method::Told => 0,
            _ => CHANNELS,
        }
    }

    /// What a count is worth, where it is the decoder that knows it and not the pad.
    pub const fn scale(&self) -> Option<Scale> {
        match &self.method {
            Method::Balance(balance) => Some(balance.scale()),
            _ => None,
        }
    }

    /// Whether 0 is the least that a channel tells, whatever it would read below.
    pub const fn is_clamped(&self) -> bool {
        matches!(&self.method, Method::Balance(balance) if balance.is_clamped())
    }

    /// What the weight of who stands on the pad is for a profile, N, where forces are relative to it.
    pub const fn standing_n(&self) -> Option<f32> {
        match &self.method {
            Method::Balance(balance) => balance.standing_n(),
            _ => None,
        }
    }

    /// The method that knows what each channel should read, if it is that.
    pub const fn inverse(&self) -> Option<&Inverse> {
        match &self.method {
            Method::Inverse(inverse) => Some(inverse),
            _ => None,
        }
    }

    /// Why no game can be played with it, if so: the methods that are there to be compared with.
    pub fn cannot_play(&self) -> Option<&'static str> {
        match &self.method {
            Method::Neighbours(_) => Some(
                "a mean of measured contacts has a force even where nothing presses, and keys would stay down",
            ),
            Method::Regression(regression) if regression.target == Target::Contact => Some(
                "its places grow with the force, so that a firm press would be another direction than a light one",
            ),
            _ => None,
        }
    }

    /// The contact that explains `strain`, and what it leaves over, if the decoder knows what each channel should read.
    pub fn explain(&self, strain: &Strain) -> (Contact, Option<ContactFit>) {
        match &self.method {
            Method::Inverse(inverse) => {
                let explained = inverse.explain(strain);
                (explained.map(|explained| explained.contact).unwrap_or_default(), explained)
            }
            _ => (self.decode(strain), None),
        }
    }

    /// The contact that explains `strain`. Always finite; see the method in question for degenerate input.
    pub fn decode(&self, strain: &Strain) -> Contact {
        match &self.method {
            Method::Statics(statics) => statics.decode(strain),
            Method::Balance(balance) => balance.decode(strain),
            Method::Told => Contact::default(),
            Method::Inverse(inverse) => inverse.decode(strain),
            Method::Regression(regression) => regression.decode(strain),
            Method::Neighbours(neighbours) => neighbours.decode(strain),
            Method::Network(network) => contact(network.decode(&strain.uv)),
            #[cfg(feature = "foreign-onnx")]
            Method::Foreign(network) => contact(network.decode(&strain.uv)),
        }
    }

    /// The normal force of a difference of strains, which may be a pull, or a press here less one there.
    pub fn load_n(&self, strain: &Strain) -> f32 {
        match &self.method {
            Method::Inverse(inverse) => return inverse.load_n(strain),
            Method::Balance(balance) => return balance.load_n(strain),
            _ => {}
        }
        // A network has learnt presses only, but a pull is a press the other way round.
        let pulled = Strain { uv: strain.uv.map(|uv| -uv) };
        let (push_n, pull_n) = (self.decode(strain).fz_n, self.decode(&pulled).fz_n);
        if push_n >= pull_n { push_n } else { -pull_n }
    }
}

/// A network's numbers; where one is none, no contact.
fn contact(numbers: [f32; OUTPUTS]) -> Contact {
    let [x_mm, y_mm, fx_n, fy_n, fz_n] = numbers;
    let is_finite = numbers.iter().all(|number| number.is_finite());
    if is_finite { Contact { x_mm, y_mm, fx_n, fy_n, fz_n } } else { Contact::default() }
}
