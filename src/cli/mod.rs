//! The program's verbs, one file each. Errors are printed and exit codes chosen here and nowhere else.

mod ablation;
mod adapt;
mod decoder_file;
mod device;
mod evaluate;
mod failure;
mod field;
mod layout;
#[cfg(all(feature = "live", target_os = "linux"))]
mod live;
mod metrology;
mod pictures;
mod profile;
mod progress;
mod protocol;
mod replay;
mod simulate;
mod summary;
mod tables;
mod text_file;
mod train;
mod twin;
mod written;

use std::process::ExitCode;

use clap::{Parser, Subcommand};

use self::failure::Failure;
use self::written::say;

/// Turns a tactile disc with nine strain channels into a game controller.
#[derive(Debug, Parser)]
#[command(name = "tactpad", version, arg_required_else_help = true)]
#[command(after_help = "Try it with nothing attached: tactpad demo")]
struct Arguments {
    #[command(subcommand)]
    verb: Verb,
}

#[derive(Debug, Subcommand)]
enum Verb {
    #[cfg(all(feature = "live", target_os = "linux"))]
    #[command(flatten)]
    Live(live::Verb),
    /// Print the events that a capture, or a list of contacts, comes to.
    Replay(replay::Arguments),
    /// Say what the channels read for given contacts, or for the paper's dataset.
    Simulate(simulate::Arguments),
    /// Write a measuring plan: the paper's, or the recommended one.
    Protocol(protocol::Arguments),
    /// Make measured-like data with the imperfect virtual pad.
    Twin(twin::Arguments),
    /// Train the paper's network on simulated contacts.
    Train(train::Arguments),
    /// Fit a decoder to a pad by measured contacts.
    Adapt(adapt::Arguments),
    /// Say how far a decoder's contacts are from measured ones, or from the truth.
    Evaluate(evaluate::Arguments),
    /// Compare all decoders on the twin: the paper's Table 3, and what the noise allows.
    Ablation(ablation::Arguments),
    /// List, show and check profiles.
    Profile(profile::Arguments),
    /// Say where the three modules should stand, by the paper's rule and by the pad's mechanics.
    Layout(layout::Arguments),
    /// Find the paper's figures of merit, of the twin or of a measured file.
    Metrology(metrology::Arguments),
}

/// Runs the program with the process's arguments.
pub(super) fn run() -> ExitCode {
    let outcome = match Arguments::parse().verb {
        #[cfg(all(feature = "live", target_os = "linux"))]
        Verb::Live(verb) => live::run(&verb),
        Verb::Replay(arguments) => replay::run(&arguments),
        Verb::Simulate(arguments) => simulate::run(&arguments),
        Verb::Protocol(arguments) => protocol::run(&arguments),
        Verb::Twin(arguments) => twin::run(&arguments),
        Verb::Train(arguments) => train::run(&arguments),
        Verb::Adapt(arguments) => adapt::run(&arguments),
        Verb::Evaluate(arguments) => evaluate::run(&arguments),
        Verb::Ablation(arguments) => ablation::run(&arguments),
        Verb::Profile(arguments) => profile::run(&arguments),
        Verb::Layout(arguments) => layout::run(&arguments),
        Verb::Metrology(arguments) => metrology::run(&arguments),
    };
    let (code, message) = match outcome {
        Ok(()) | Err(Failure::Unread) => return ExitCode::SUCCESS,
        Err(Failure::Failed(message)) => (1, message),
        Err(Failure::Unusable(message)) => (2, message),
    };
    // Where even the error cannot be written, the exit code still tells.
    say(format_args!("tactpad: {message}"));
    ExitCode::from(code)
}
