//! `--method scdf`.

use std::fmt;

use serde::Serialize;

use super::{Arguments, Contacts};
use crate::cli::progress::Progress;
use crate::cli::{Failure, decoder_file};
use crate::network::training::Epoch;
use crate::scdf::adaptation::{Adapted, adapt as fit, examples};

/// How the network took to the pad.
#[derive(Serialize)]
pub(super) struct Fit {
    beta: f32,
    validation_mse: f64,
    /// For each β the mean squared error on the contacts that were not learnt from.
    sweep: Vec<Tried>,
    curve: Vec<Epoch>,
}

#[derive(Serialize)]
struct Tried {
    beta: f32,
    validation_mse: f64,
}

/// Trains the network of `--from` on, and writes it.
pub(super) fn adapt(arguments: &Arguments, contacts: &Contacts) -> Result<Fit, Failure> {
    let from = arguments.from.as_ref().ok_or_else(|| {
        Failure::Unusable(
            "--method scdf trains a network on: make one with tactpad train --out scdf.onnx, and give it as --from scdf.onnx"
                .into(),
        )
    })?;
    let mut start = decoder_file::read_network(from)?;
    start.zero = contacts.zero();
    let mut progress = Progress::begin();
    let adapted = fit(&start, examples(&contacts.rows), arguments.seed, |beta, Epoch { number, .. }| {
        progress.step(format_args!("β = {beta}: epoch {number}"));
    });
    drop(progress);
    let adapted =
        adapted.map_err(|error| Failure::Unusable(format!("{}: {error}", arguments.measured_names())))?;
    decoder_file::write_network(&arguments.out, &adapted.trained.network)?;
    Ok(Fit::of(adapted))
}

impl Fit {
    fn of(adapted: Adapted) -> Self {
        let tried = |(beta, validation_mse)| Tried { beta, validation_mse };
        Self {
            beta: adapted.beta,
            validation_mse: adapted.trained.validation_mse,
            sweep: adapted.sweep.map(tried).into(),
            curve: adapted.trained.curve,
        }
    }
}

impl fmt::Display for Fit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for Tried { beta, validation_mse } in &self.sweep {
            let chosen = if *beta == self.beta { "  chosen" } else { "" };
            writeln!(f, "β = {beta:<7} mean squared error {validation_mse:.4}, standardised{chosen}")?;
        }
        write!(f, "{} epochs", self.curve.len())
    }
}
