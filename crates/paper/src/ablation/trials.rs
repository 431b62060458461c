//! All decoders, tried on contacts that none has seen.

use super::Subject;
use super::drawing::{self, DecoderContacts};
use super::entries::{ENTRIES, Method};
use super::fitting::{DecoderFitError, decoders};
use super::maps;
use super::regions::Touches;
use super::unseen::{Unseen, UnseenContacts, unseen};
use tactpad_core::network::Network;
use tactpad_core::pipeline::contact::Decoder;
use tactpad_plot::figure::Figure;

/// What is tried on what, and what came of it.
pub struct Trials {
    /// The tables that are tried.
    pub unseen: [Unseen; 2],
    /// The decoders, in the order of [`ENTRIES`].
    pub decoders: Vec<Decoder>,
    /// For each of the unseen tables, for each decoder.
    pub judged: [Vec<UnseenContacts>; 2],
}

impl Trials {
    /// Fits all decoders and tries them. `network` is that of stage I, for tared channels; `report` hears how many
    /// decoders are fitted.
    ///
    /// # Errors
    /// A decoder that cannot be fitted.
    pub fn of(
        subject: &Subject<'_>,
        network: &Network,
        report: impl Fn(usize) + Sync,
    ) -> Result<Self, DecoderFitError> {
        let decoders = decoders(*subject, network, ENTRIES, report)?;
        let unseen = unseen(subject);
        let judged = unseen.each_ref().map(|table| decoders.iter().map(|it| table.judged(it)).collect());
        Ok(Self { unseen, decoders, judged })
    }

    /// The plots, with their names.
    pub fn figures(&self, subject: &Subject<'_>) -> Vec<(String, Figure)> {
        let mut figures = vec![("ablation-regions".to_owned(), self.regions(subject))];
        for (unseen, judged) in self.unseen.iter().zip(&self.judged) {
            let outcomes: Vec<DecoderContacts<'_>> = ENTRIES.iter().zip(judged).collect();
            let learnt: Vec<DecoderContacts<'_>> =
                outcomes.iter().copied().filter(|(entry, _)| entry.has_all()).collect();
            let reach_mm = subject.actual.device.contact.max_centre_radius_mm;
            figures.extend([
                (format!("ablation-samples-{}", unseen.plan), drawing::by_samples(unseen, &outcomes)),
                (format!("ablation-force-{}", unseen.plan), drawing::by_force(unseen, &outcomes)),
                (format!("ablation-map-{}", unseen.plan), maps::over_plate(unseen, &learnt, reach_mm)),
            ]);
        }
        figures
    }

    /// Figure 11 for the paper's decoder and ours.
    fn regions(&self, subject: &Subject<'_>) -> Figure {
        let touches = Touches::of(subject);
        let drawn = [Method::Network, Method::Inverse];
        let decoded = ENTRIES.iter().zip(&self.decoders);
        let decoded = decoded.filter(|(entry, _)| entry.has_all() && drawn.contains(&entry.method));
        let decoded: Vec<_> =
            decoded.map(|(entry, decoder)| (entry.to_string(), touches.decoded(decoder))).collect();
        drawing::by_region(&decoded)
    }
}
