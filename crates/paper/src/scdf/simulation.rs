//! Stage I: what a pad's mechanics say about contacts, learnt from simulated ones.

use super::{BATCH, EPOCHS_MAX, RATE, VALIDATION_PART};
use tactpad_core::network::training::score::{Score, Scores};
use tactpad_core::network::training::{Epoch, Schedule, Trained, split, train};
use tactpad_core::network::{Example, Network, Zero, numbers};
use tactpad_core::pad::device::Device;
use tactpad_core::pad::field::PadField;
use tactpad_core::pad::readout::Readout;
use tactpad_core::pad::twin::bridges;
use tactpad_core::tables::dataset;

/// What the paper reports of its stage I on the test's examples, in standardised units.
pub const PAPER: Score = Score { mse: 0.011, mae: 0.092, r2: 0.981 };

/// A network that knows the simulated pad.
#[derive(Clone, Debug)]
pub struct Pretrained {
    /// The network and its way there.
    pub trained: Trained,
    /// Its errors on the test's examples.
    pub scores: Scores,
    /// Examples that it has never seen.
    pub test: Vec<Example>,
}

/// The paper's 14,400 contacts as the ideal pad of `device` reads them: tared, without noise, hysteresis or creep.
pub fn examples(device: &Device, field: &PadField, seed: u64) -> Vec<Example> {
    let readout = Readout::of(device);
    let reference_c = device.behaviour.thermal.reference_c;
    let contacts = dataset::paper(&device.contact, seed);
    let read = |contact| {
        let strain_uv = readout.strain_uv(&bridges(field, contact));
        let uv = readout.signal_uv(&strain_uv, &readout.conditions(reference_c)).map(|uv| uv as f32);
        Example { uv, contact: numbers(contact) }
    };
    contacts.iter().map(read).collect()
}

/// Trains on 80 % of the examples, keeps the weights that do best on 10 %, and scores them on the last 10 %.
///
/// The scalers are those of the training examples. The seed draws the split, the first weights and the order.
pub fn pretrain(
    hidden: &[usize],
    examples: Vec<Example>,
    seed: u64,
    report: impl FnMut(&Epoch),
) -> Pretrained {
    let tenth = examples.len() / VALIDATION_PART;
    let [mut held, training] = split(examples, VALIDATION_PART / 2, seed);
    let test = held.split_off(tenth.min(held.len()));
    let start = Network::untrained(hidden, Zero::Tared, &training, seed);
    let schedule =
        Schedule { rate: RATE, batch: BATCH, epochs_max: EPOCHS_MAX, patience: EPOCHS_MAX, beta: 0.0, seed };
    let trained = train(&start, &training, &held, &schedule, report);
    Pretrained { scores: Scores::of(&trained.network, &test), trained, test }
}
