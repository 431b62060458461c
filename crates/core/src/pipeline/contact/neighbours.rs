//! The mean of the nearest contacts that were measured (K nearest neighbours, K = 5): a baseline of the paper's Table 3.

use crate::network::Zero;
use crate::quantity::{CHANNELS, Contact, Strain};

/// How many neighbours; the paper's.
pub const NEIGHBOURS: usize = 5;

/// Most contacts that a decoder keeps: its file stays one that is read, 56 bytes for each, and a decode below a millisecond.
pub const KNOWN_MAX: usize = 200_000;

/// A contact that was measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LabelledContact {
    /// Channels, in standard deviations over all contacts.
    pub channels: [f32; CHANNELS],
    /// Label as it was written.
    pub contact: Contact,
}

/// The contacts, and how channels are made comparable.
#[derive(Clone, Debug, PartialEq)]
pub struct Neighbours {
    /// Zero of the channels.
    pub zero: Zero,
    /// µV per standard deviation.
    pub deviation_uv: [f32; CHANNELS],
    /// At least one.
    pub known: Vec<LabelledContact>,
}

impl Neighbours {
    /// The mean of the nearest contacts. Without any, or for strain that is not finite, no contact.
    pub fn decode(&self, strain: &Strain) -> Contact {
        let channels: [f32; CHANNELS] = std::array::from_fn(|k| strain.uv[k] / self.deviation_uv[k]);
        let mut nearest = [(f32::INFINITY, Contact::default()); NEIGHBOURS];
        for known in &self.known {
            let distance =
                known.channels.iter().zip(&channels).map(|(one, other)| (one - other) * (one - other)).sum();
            if distance < nearest[NEIGHBOURS - 1].0 {
                nearest[NEIGHBOURS - 1] = (distance, known.contact);
                nearest.sort_unstable_by(|one, other| one.0.total_cmp(&other.0));
            }
        }
        mean(nearest.iter().filter(|(distance, _)| distance.is_finite()).map(|(_, contact)| contact))
    }
}

fn mean<'c>(contacts: impl Iterator<Item = &'c Contact> + Clone) -> Contact {
    let count = contacts.clone().count().max(1) as f32;
    let of = |number: fn(&Contact) -> f32| contacts.clone().map(number).sum::<f32>() / count;
    Contact {
        x_mm: of(|contact| contact.x_mm),
        y_mm: of(|contact| contact.y_mm),
        fx_n: of(|contact| contact.fx_n),
        fy_n: of(|contact| contact.fy_n),
        fz_n: of(|contact| contact.fz_n),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_five_nearest_count() {
        let known = |index: usize| {
            let mut channels = [0.0; CHANNELS];
            channels[3] = index as f32;
            LabelledContact { channels, contact: Contact { fz_n: index as f32, ..Contact::default() } }
        };
        let mut deviation_uv = [1.0; CHANNELS];
        deviation_uv[3] = 100.0;
        let zero = Zero::Tared;
        let neighbours = Neighbours { zero, deviation_uv, known: (0..20).map(known).collect() };
        let mut strain = Strain::default();
        strain.uv[3] = 1010.0;
        assert_eq!(neighbours.decode(&strain).fz_n, 10.0, "8 to 12");
        strain.uv[4] = f32::NAN;
        assert_eq!(neighbours.decode(&strain), Contact::default());
        assert_eq!(
            Neighbours { zero, deviation_uv, known: vec![] }.decode(&Strain::default()),
            Contact::default()
        );
    }
}
