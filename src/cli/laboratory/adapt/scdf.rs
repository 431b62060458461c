//! `--method scdf`.

use std::fmt;
use std::path::Path;

use serde::Serialize;

use super::measured::Measured;
use crate::cli::failure::Failure;
use crate::cli::files::decoder_file;
use crate::cli::printing::progress::Progress;
use tactpad::lab::scdf::adaptation::{self, Adapted, BETAS};
use tactpad::lab::scdf::{EPOCHS_MAX, drawing};
use tactpad::network::Network;
use tactpad::network::training::Epoch;
use tactpad::plot::figure::Figure;

/// How the network took to the pad.
#[derive(Serialize)]
pub(super) struct ScdfFit {
    beta: f32,
    validation_mse: f64,
    /// For each β the mean squared error on the contacts that were not learnt from.
    sweep: Vec<BetaTrial>,
    curve: Vec<Epoch>,
}

#[derive(Serialize)]
struct BetaTrial {
    beta: f32,
    validation_mse: f64,
}

/// Trains the network of `--from` on.
pub(super) fn adapt(
    measured: &Measured,
    from: Option<&Path>,
    seed: u64,
) -> Result<(Network, ScdfFit), Failure> {
    let from = from.ok_or_else(|| {
        Failure::Unusable(
            "--method scdf trains a network on: make one with tactpad train --out scdf.onnx, and give it as --from scdf.onnx"
                .into(),
        )
    })?;
    let start = decoder_file::read_network(from)?;
    let progress = Progress::begin("adapting the network");
    let adapted =
        adaptation::adapt_to_contacts(start, &measured.contacts, seed, |beta, Epoch { number, .. }| {
            let before = BETAS.iter().position(|tried| *tried == beta).unwrap_or_default() * EPOCHS_MAX;
            progress.part(
                before + number,
                BETAS.len() * EPOCHS_MAX,
                format_args!("β = {beta}: epoch {number}"),
            );
        });
    drop(progress);
    let adapted = adapted.map_err(|error| measured.refused(error))?;
    Ok((adapted.trained.network.clone(), ScdfFit::of(adapted)))
}

impl ScdfFit {
    /// How errors fell with the β that was chosen.
    pub(super) fn drawn(&self) -> Figure {
        drawing::training(&format!("Stage II, β = {}", self.beta), &self.curve, None)
    }

    fn of(adapted: Adapted) -> Self {
        let tried = |(beta, validation_mse)| BetaTrial { beta, validation_mse };
        Self {
            beta: adapted.beta,
            validation_mse: adapted.trained.validation_mse,
            sweep: adapted.sweep.map(tried).into(),
            curve: adapted.trained.curve,
        }
    }
}

impl fmt::Display for ScdfFit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for BetaTrial { beta, validation_mse } in &self.sweep {
            let chosen = if *beta == self.beta { "  chosen" } else { "" };
            writeln!(f, "β = {beta:<7} mean squared error {validation_mse:.4}, standardised{chosen}")?;
        }
        write!(f, "{} epochs", self.curve.len())
    }
}
