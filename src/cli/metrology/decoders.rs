//! The decoders whose contacts are judged: the paper's network in its two stages, or one from a file.

use super::Arguments;
use crate::cli::progress::Progress;
use crate::cli::{Failure, decoder_file};
use crate::contact::Decoder;
use crate::device::Device;
use crate::field::PadField;
use crate::measured::{Table, zero};
use crate::network::training::Epoch;
use crate::network::{Network, Zero};
use crate::quantity::{CHANNELS, Contact, Strain};
use crate::scdf::HIDDEN;
use crate::scdf::adaptation::{self, adapt};
use crate::scdf::simulation::{examples, pretrain};

/// Draws the network of stage I, of which there is one for all pads: that of `train --seed 1`.
const NETWORK_SEED: u64 = 1;

/// What there is to decode with.
pub(super) struct Decoders {
    /// That of `--decoder`, the same for all pads.
    pub(super) given: Option<Decoder>,
    /// The network of stage I.
    simulation: Option<Network>,
}

impl Decoders {
    /// Those that are given as files.
    pub(super) fn given(arguments: &Arguments) -> Result<Self, Failure> {
        let given = arguments.decoder.as_deref().map(decoder_file::read).transpose()?;
        if given.as_ref().is_some_and(|decoder| decoder.zero() == Zero::Raw) {
            return Err(Failure::Unusable(
                "--decoder takes raw channels, and zeros are taken off here: adapt it with a file that has \
                 rows without force"
                    .into(),
            ));
        }
        let simulation = arguments.network.as_deref().map(decoder_file::read_network).transpose()?;
        Ok(Self { given, simulation })
    }

    /// Those that are given; if there are none, stage I is trained on `designed`.
    pub(super) fn given_or_trained(
        arguments: &Arguments,
        designed: &Device,
        nominal: &PadField,
    ) -> Result<Self, Failure> {
        let mut decoders = Self::given(arguments)?;
        if !arguments.no_network && decoders.given.is_none() && decoders.simulation.is_none() {
            let mut progress = Progress::begin();
            let contacts = examples(designed, nominal, NETWORK_SEED);
            let pretrained = pretrain(HIDDEN, contacts, NETWORK_SEED, |Epoch { number, .. }| {
                progress.step(format_args!("training the paper's network on the simulation: epoch {number}"));
            });
            decoders.simulation = Some(pretrained.trained.network);
        }
        Ok(decoders)
    }

    /// The network that never saw a measured contact.
    pub(super) fn simulation(&self) -> Option<Decoder> {
        self.simulation.clone().map(|network| Decoder::Network(Box::new(network)))
    }

    /// The decoder that is judged: the given one, else stage II on a pad's measured contacts.
    pub(super) fn judged(&self, contacts: &Table, seed: u64) -> Option<Decoder> {
        if self.given.is_some() {
            return self.given.clone();
        }
        let mut start = self.simulation.clone()?;
        start.zero = Zero::Tared;
        let tared = zero::tared(contacts)?;
        let known = adaptation::examples(&tared.rows_at(&zero::contacts(&tared)));
        let adapted = adapt(&start, known, seed, |_, _| ()).ok()?;
        Some(Decoder::Network(Box::new(adapted.trained.network)))
    }
}

/// A decoder as the figures take one.
pub(super) fn by(decoder: &Decoder) -> impl Fn(&[f64; CHANNELS]) -> Contact {
    |uv| decoder.decode(&Strain { uv: uv.map(|uv| uv as f32) })
}
