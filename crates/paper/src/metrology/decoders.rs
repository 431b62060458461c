//! The decoders whose contacts are judged: the paper's network in its two stages, or a given one.

use crate::scdf::HIDDEN;
use crate::scdf::adaptation::{self, adapt};
use crate::scdf::simulation::{examples, pretrain};
use tactpad_core::network::training::Epoch;
use tactpad_core::network::{Network, Zero};
use tactpad_core::pad::device::Device;
use tactpad_core::pad::field::PadField;
use tactpad_core::pipeline::contact::Decoder;
use tactpad_core::quantity::{CHANNELS, Contact, Strain};
use tactpad_core::tables::measured::{Table, zero};

/// Draws the network of stage I, of which there is one for all pads: that of `train --seed 1`.
const NETWORK_SEED: u64 = 1;

/// What there is to decode with.
#[derive(Clone, Debug, Default)]
pub struct Decoders {
    /// One that is the same for all pads. It takes channels relative to the untouched pad.
    pub given: Option<Decoder>,
    /// The network of stage I.
    pub network: Option<Network>,
}

impl Decoders {
    /// Trains stage I on the pad as it is designed: half a minute. `report` hears each epoch.
    pub fn trained(designed: &Device, field: &PadField, report: impl FnMut(&Epoch)) -> Self {
        let contacts = examples(designed, field, NETWORK_SEED);
        let pretrained = pretrain(HIDDEN, contacts, NETWORK_SEED, report);
        Self { given: None, network: Some(pretrained.trained.network) }
    }

    /// The network that never saw a measured contact.
    pub fn simulation(&self) -> Option<Decoder> {
        self.network.clone().map(Decoder::from)
    }

    /// The decoder that is judged: the given one, else stage II on a pad's measured contacts.
    pub fn judged(&self, contacts: &Table, seed: u64) -> Option<Decoder> {
        if self.given.is_some() {
            return self.given.clone();
        }
        let mut start = self.network.clone()?;
        start.zero = Zero::Tared;
        let tared = zero::tared(contacts)?;
        let known = adaptation::examples(&tared.rows_at(&zero::contacts(&tared)));
        let adapted = adapt(&start, known, seed, |_, _| ()).ok()?;
        Some(adapted.trained.network.into())
    }
}

/// A decoder as the figures take one.
pub fn by(decoder: &Decoder) -> impl Fn(&[f64; CHANNELS]) -> Contact {
    |uv| decoder.decode(&Strain { uv: uv.map(|uv| uv as f32) })
}
