//! Verbs of the laboratory: simulated and measured tables, decoders fitted to them, and causes of what they disagree in.

pub(super) mod adapt;
pub(super) mod diagnose;
mod evaluate;
mod protocol;
mod simulate;
mod train;
pub(super) mod twin;

use clap::Subcommand;

use crate::cli::failure::Failure;

#[derive(Debug, Subcommand)]
pub(super) enum Verb {
    /// Say what the channels read for given contacts, or for the paper's dataset.
    Simulate(simulate::Arguments),
    /// Make measured-like data with the imperfect virtual pad.
    Twin(twin::Arguments),
    /// Write a measuring plan: the paper's, or the recommended one.
    Protocol(protocol::Arguments),
    /// Train the paper's network on simulated contacts.
    Train(train::Arguments),
    /// Fit a decoder to a pad by measured contacts.
    Adapt(adapt::Arguments),
    /// Say how far a decoder's contacts are from measured ones, or from the truth.
    Evaluate(evaluate::Arguments),
    /// Say what a measured file shows that the model of the pad gets wrong, and why.
    Diagnose(diagnose::Arguments),
}

pub(super) fn run(verb: &Verb) -> Result<(), Failure> {
    match verb {
        Verb::Simulate(arguments) => simulate::run(arguments),
        Verb::Twin(arguments) => twin::run(arguments),
        Verb::Protocol(arguments) => protocol::run(arguments),
        Verb::Train(arguments) => train::run(arguments),
        Verb::Adapt(arguments) => adapt::run(arguments),
        Verb::Evaluate(arguments) => evaluate::run(arguments),
        Verb::Diagnose(arguments) => diagnose::run(arguments),
    }
}
