//! The program's verbs, one file each. Errors are printed and exit codes chosen here and nowhere else.

mod ablation;
mod adapt;
mod completions;
mod config_folder;
mod decoder_file;
mod destination;
mod device;
mod diagnose;
mod evaluate;
mod failure;
mod field;
mod layout;
#[cfg(target_os = "linux")]
mod live;
mod metrology;
mod pictures;
mod played;
mod profile;
mod progress;
mod protocol;
mod recording;
mod replay;
mod reports;
mod seconds;
mod simulate;
mod state_file;
mod summary;
mod tables;
mod terminal;
mod text_file;
mod train;
mod tune;
mod twin;
mod weigh;
mod wiring;
mod wrapped;
mod written;

use std::env;
use std::ffi::OsString;
use std::process::ExitCode;

use clap::{CommandFactory, Parser, Subcommand};

use self::failure::Failure;
use self::written::say;

/// Turns a tactile disc with nine strain channels into a game controller.
#[derive(Debug, Parser)]
#[command(name = "tactpad", version, arg_required_else_help = true, max_term_width = wrapped::COLUMNS)]
#[command(after_help = "Try it with nothing attached: tactpad demo\n\
    On a desktop, tactpad alone plays with the pad that comes, and shows an icon.")]
struct Arguments {
    #[command(subcommand)]
    verb: Verb,
}

#[derive(Debug, Subcommand)]
enum Verb {
    #[cfg(target_os = "linux")]
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
    /// Find by one known weight what gain a pad has lost, and keep it in its decoder.
    Weigh(weigh::Arguments),
    /// Say how far a decoder's contacts are from measured ones, or from the truth.
    Evaluate(evaluate::Arguments),
    /// Compare all decoders on the twin: the paper's Table 3, and what the noise allows.
    Ablation(ablation::Arguments),
    /// Fit a profile to a hand, by a recording and a table of what was meant when.
    Tune(tune::Arguments),
    /// List, show and check profiles.
    Profile(profile::Arguments),
    /// Say where the three modules should stand, by the paper's rule and by the pad's mechanics.
    Layout(layout::Arguments),
    /// Say how the gauges are wired into half-bridges and where they lie on the film, and draw it.
    Wiring(wiring::Arguments),
    /// Find the paper's figures of merit, of the twin or of a measured file.
    Metrology(metrology::Arguments),
    /// Say what a measured file shows that the model of the pad gets wrong, and why.
    Diagnose(diagnose::Arguments),
    /// Print a shell's completions of verbs and options.
    Completions(completions::Arguments),
}

/// The words of the command line, or those that are meant where there are none; `None` if that is done already.
fn words() -> Result<Option<Vec<OsString>>, Failure> {
    #[cfg(all(feature = "tray", target_os = "linux"))]
    if env::args_os().len() < 2 && live::alone::is_on_desktop() {
        return Ok(live::alone::command_line()?.map(|words| words.into_iter().map(OsString::from).collect()));
    }
    Ok(Some(env::args_os().collect()))
}

/// Runs the program with the process's arguments.
pub(super) fn run() -> ExitCode {
    let outcome =
        words().and_then(|words| words.map_or(Ok(()), |words| obey(Arguments::parse_from(words).verb)));
    let (code, message) = match outcome {
        Ok(()) | Err(Failure::Unread) => return ExitCode::SUCCESS,
        Err(Failure::Failed(message)) => (1, message),
        Err(Failure::Unusable(message)) => (2, message),
    };
    // Where even the error cannot be written, the exit code still tells.
    say(format_args!("tactpad: {message}"));
    ExitCode::from(code)
}

fn obey(verb: Verb) -> Result<(), Failure> {
    match verb {
        #[cfg(target_os = "linux")]
        Verb::Live(verb) => live::run(&verb),
        Verb::Replay(arguments) => replay::run(&arguments),
        Verb::Simulate(arguments) => simulate::run(&arguments),
        Verb::Protocol(arguments) => protocol::run(&arguments),
        Verb::Twin(arguments) => twin::run(&arguments),
        Verb::Train(arguments) => train::run(&arguments),
        Verb::Adapt(arguments) => adapt::run(&arguments),
        Verb::Weigh(arguments) => weigh::run(&arguments),
        Verb::Evaluate(arguments) => evaluate::run(&arguments),
        Verb::Ablation(arguments) => ablation::run(&arguments),
        Verb::Tune(arguments) => tune::run(&arguments),
        Verb::Profile(arguments) => profile::run(&arguments),
        Verb::Layout(arguments) => layout::run(&arguments),
        Verb::Wiring(arguments) => wiring::run(&arguments),
        Verb::Metrology(arguments) => metrology::run(&arguments),
        Verb::Diagnose(arguments) => diagnose::run(&arguments),
        Verb::Completions(arguments) => completions::run(&arguments, &mut Arguments::command()),
    }
}

#[cfg(test)]
mod tests {
    use clap::Command;

    use super::*;

    /// The command and all below it, each under its whole name.
    fn all(command: &Command, before: &str, into: &mut Vec<(String, Command)>) {
        let name = format!("{before}{}", command.get_name());
        for below in command.get_subcommands().filter(|below| below.get_name() != "help") {
            all(below, &format!("{name} "), into);
        }
        into.push((name, command.clone()));
    }

    #[test]
    fn each_help_has_an_example_and_no_line_that_is_too_long() {
        let mut whole = Arguments::command();
        whole.build();
        let mut commands = Vec::new();
        all(&whole, "", &mut commands);
        assert!(commands.len() > 25, "{} commands", commands.len());
        for (name, mut command) in commands {
            for help in [command.render_help(), command.render_long_help()].map(|help| help.to_string()) {
                let after = if name == "tactpad" { "Try it" } else { "Example: " };
                let example = help.split(after).nth(1).unwrap_or_default();
                assert!(example.contains(&name), "{name}: {help}");
                let long = help.lines().find(|line| line.chars().count() > wrapped::COLUMNS);
                assert_eq!(long, None, "{name}");
            }
        }
    }

    #[test]
    fn arguments_are_sound() {
        Arguments::command().debug_assert();
    }
}
