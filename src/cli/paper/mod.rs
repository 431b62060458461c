//! Verbs for who reads the paper: its figures and tables, of the program's own pad.

mod ablation;
mod layout;
mod metrology;
mod wiring;

use clap::Subcommand;

use crate::cli::failure::Failure;

#[derive(Debug, Subcommand)]
pub(super) enum Verb {
    /// Say where the three modules should stand, by the paper's rule and by the pad's mechanics.
    Layout(layout::Arguments),
    /// Say how the gauges are wired into half-bridges and where they lie on the film, and draw it.
    Wiring(wiring::Arguments),
    /// Find the paper's figures of merit, of the twin or of a measured file.
    Metrology(metrology::Arguments),
    /// Compare all decoders on the twin: the paper's Table 3, and what the noise allows.
    Ablation(ablation::Arguments),
}

pub(super) fn run(verb: &Verb) -> Result<(), Failure> {
    match verb {
        Verb::Layout(arguments) => layout::run(arguments),
        Verb::Wiring(arguments) => wiring::run(arguments),
        Verb::Metrology(arguments) => metrology::run(arguments),
        Verb::Ablation(arguments) => ablation::run(arguments),
    }
}
