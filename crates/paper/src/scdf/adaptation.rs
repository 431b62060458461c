//! Stage II: a pad's own ways, learnt from few measured contacts without forgetting stage I.

use super::{BATCH, EPOCHS_MAX, VALIDATION_PART};
use tactpad_core::network::training::{Epoch, Schedule, Trained, split, train};
use tactpad_core::network::{Example, Network, numbers};
use tactpad_core::quantity::Contact;
use tactpad_core::tables::measured::Row;
use tactpad_lab::contacts::Contacts;

/// The paper's sweep.
pub const BETAS: [f32; 5] = [1e-5, 1e-4, 1e-3, 1e-2, 1e-1];

/// "A smaller learning rate."
pub(super) const RATE: f32 = 3e-4;

/// Epochs without a better one: a tenth of all.
pub(super) const PATIENCE: usize = EPOCHS_MAX / 10;

/// Fewer rows leave none to judge by.
pub const ROWS_MIN: usize = VALIDATION_PART;

/// A network that has been adapted.
#[derive(Clone, Debug)]
pub struct Adapted {
    /// The network and its way there.
    pub trained: Trained,
    /// The β that drew it to stage I.
    pub beta: f32,
    /// Mean squared error on the validation's examples for each β of [`BETAS`].
    pub sweep: [(f32, f64); BETAS.len()],
}

/// There are too few rows: how many.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TooFew(pub usize);

impl std::fmt::Display for TooFew {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(
            f,
            "the network needs at least {} contacts, of which one in {VALIDATION_PART} judges the others, and the table \
             has {}: measure more",
            ROWS_MIN, self.0
        )
    }
}

impl std::error::Error for TooFew {}

/// Measured rows as examples; rows without channels are left out.
pub fn examples(rows: &[Row]) -> Vec<Example> {
    let example = |row: &Row| {
        let uv = row.uv?.map(|uv| uv as f32);
        Some(Example { uv, contact: numbers(&Contact::from(row.label)) })
    };
    rows.iter().filter_map(example).collect()
}

/// Trains on 90 % of the examples from the weights of `start`, once for each β, and keeps what does best on 10 %.
///
/// The loss is that of the paper with λp = λf = 1: the squared errors of the five standardised numbers, summed, and
/// β‖θ − θ₀‖². The scalers stay those of stage I: only with them do its weights mean what they meant.
///
/// # Errors
/// Fewer than [`ROWS_MIN`] examples.
pub fn adapt(
    start: &Network,
    examples: Vec<Example>,
    seed: u64,
    mut report: impl FnMut(f32, &Epoch),
) -> Result<Adapted, TooFew> {
    if examples.len() < ROWS_MIN {
        return Err(TooFew(examples.len()));
    }
    let [held, training] = split(examples, VALIDATION_PART, seed);
    let tried = BETAS.map(|beta| {
        let schedule =
            Schedule { rate: RATE, batch: BATCH, epochs_max: EPOCHS_MAX, patience: PATIENCE, beta, seed };
        (beta, train(start, &training, &held, &schedule, |epoch| report(beta, epoch)))
    });
    let sweep = tried.each_ref().map(|(beta, trained)| (*beta, trained.validation_mse));
    let [first, others @ ..] = tried;
    let better = |best: (f32, Trained), other: (f32, Trained)| {
        if other.1.validation_mse < best.1.validation_mse { other } else { best }
    };
    let (beta, trained) = others.into_iter().fold(first, better);
    Ok(Adapted { trained, beta, sweep })
}

/// [`adapt`] to measured contacts: the network is told what their channels are relative to.
///
/// # Errors
/// Too few contacts.
pub fn adapt_to_contacts(
    mut start: Network,
    contacts: &Contacts,
    seed: u64,
    report: impl FnMut(f32, &Epoch),
) -> Result<Adapted, TooFew> {
    start.zero = contacts.zero();
    adapt(&start, examples(contacts.rows()), seed, report)
}
