//! The program's verbs, one file each. Errors are printed and exit codes chosen here and nowhere else.

mod ablation;
mod adapt;
#[cfg(all(feature = "live", target_os = "linux"))]
mod chosen;
#[cfg(all(feature = "live", target_os = "linux"))]
mod ctl;
mod decoder_file;
#[cfg(all(feature = "live", target_os = "linux"))]
mod demo;
mod device;
#[cfg(all(feature = "live", target_os = "linux"))]
mod devices;
#[cfg(all(feature = "live", target_os = "linux"))]
mod doctor;
mod evaluate;
mod field_cache;
#[cfg(all(feature = "live", target_os = "linux"))]
mod files;
#[cfg(all(feature = "live", target_os = "linux"))]
mod latency;
mod layout;
#[cfg(all(feature = "live", target_os = "linux"))]
mod live;
mod metrology;
mod pictures;
mod profile;
mod progress;
mod protocol;
#[cfg(all(feature = "live", target_os = "linux"))]
mod record;
mod replay;
#[cfg(all(feature = "live", target_os = "linux"))]
mod run;
#[cfg(all(feature = "live", target_os = "linux"))]
mod screen;
#[cfg(all(feature = "live", target_os = "linux"))]
mod seconds;
mod simulate;
mod summary;
mod tables;
mod text_file;
mod train;
mod twin;
mod written;

use std::io::{self, Write};
use std::process::ExitCode;

use clap::{Parser, Subcommand};

use self::written::stdout;

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
    /// Play with a virtual pad: nothing needs to be attached.
    #[cfg(all(feature = "live", target_os = "linux"))]
    Demo(demo::Arguments),
    /// Play: a pad in, key and gamepad events out.
    #[cfg(all(feature = "live", target_os = "linux"))]
    Run(run::Arguments),
    /// Talk to the running bridge.
    #[cfg(all(feature = "live", target_os = "linux"))]
    Ctl(ctl::Arguments),
    /// List what is attached.
    #[cfg(all(feature = "live", target_os = "linux"))]
    Devices(devices::Arguments),
    /// Say what stands in the way here, and the command that mends it.
    #[cfg(all(feature = "live", target_os = "linux"))]
    Doctor(doctor::Arguments),
    /// Record a pad, so that `replay` gives the same events again.
    #[cfg(all(feature = "live", target_os = "linux"))]
    Record(record::Arguments),
    /// Print the events that a capture, or a list of contacts, comes to.
    Replay(replay::Arguments),
    /// Measure from pad bytes readable to event written, and where the time goes.
    #[cfg(all(feature = "live", target_os = "linux"))]
    Latency(latency::Arguments),
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

/// Why a verb did not do what was asked.
#[derive(Debug)]
enum Failure {
    /// Arguments or input that cannot be used: exit 2.
    Unusable(String),
    /// It failed, or a check says no: exit 1.
    Failed(String),
    /// Nobody reads our output any more; nothing to say.
    Unread,
}

impl From<io::Error> for Failure {
    fn from(error: io::Error) -> Self {
        if error.kind() == io::ErrorKind::BrokenPipe { Self::Unread } else { Self::Failed(error.to_string()) }
    }
}

/// Runs the program with the process's arguments.
pub fn run() -> ExitCode {
    let outcome = match Arguments::parse().verb {
        #[cfg(all(feature = "live", target_os = "linux"))]
        Verb::Demo(arguments) => demo::run(&arguments),
        #[cfg(all(feature = "live", target_os = "linux"))]
        Verb::Run(arguments) => run::run(&arguments),
        #[cfg(all(feature = "live", target_os = "linux"))]
        Verb::Ctl(arguments) => ctl::run(&arguments),
        #[cfg(all(feature = "live", target_os = "linux"))]
        Verb::Devices(arguments) => devices::run(&arguments),
        #[cfg(all(feature = "live", target_os = "linux"))]
        Verb::Doctor(arguments) => doctor::run(&arguments),
        #[cfg(all(feature = "live", target_os = "linux"))]
        Verb::Record(arguments) => record::run(&arguments),
        Verb::Replay(arguments) => replay::run(&arguments),
        #[cfg(all(feature = "live", target_os = "linux"))]
        Verb::Latency(arguments) => latency::run(&arguments),
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

/// Prints one JSON document to stdout.
fn print_json(document: &impl serde::Serialize) -> Result<(), Failure> {
    let text = serde_json::to_string(document).map_err(|error| Failure::Failed(error.to_string()))?;
    Ok(writeln!(stdout(), "{text}")?)
}

/// Says something to people beside the verb's output. What does not get out must not stop the verb.
fn say(line: impl std::fmt::Display) {
    let _ = writeln!(io::stderr(), "{line}");
}

/// What is printed on the way to a verdict: a reader that went away is no reason to skip the verdict.
fn if_read(printed: Result<(), Failure>) -> Result<(), Failure> {
    match printed {
        Err(Failure::Unread) => Ok(()),
        printed => printed,
    }
}
