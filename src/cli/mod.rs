//! The program's verbs, one file each. Errors are printed and exit codes chosen here and nowhere else.

mod failure;
mod files;
mod laboratory;
mod number;
mod paper;
mod playing;
mod printing;

use std::env;
use std::ffi::OsString;
use std::process::ExitCode;

use clap::{Command, CommandFactory, FromArgMatches, Parser, Subcommand};

use self::failure::Failure;
use self::printing::{wrapped, written::say};

/// Turns a tactile disc with nine strain channels into a game controller.
#[derive(Debug, Parser)]
#[command(name = "tactpad", version, arg_required_else_help = true, max_term_width = wrapped::COLUMNS)]
#[command(after_help = "Begin with: tactpad setup\nTry it with nothing attached: tactpad demo\n\
    On a desktop, tactpad alone plays with the pad that comes, and shows an icon.")]
struct Arguments {
    #[command(subcommand)]
    verb: Verb,
}

#[derive(Debug, Subcommand)]
enum Verb {
    #[command(flatten)]
    Playing(playing::Verb),
    #[command(flatten)]
    Laboratory(laboratory::Verb),
    #[command(flatten)]
    Paper(paper::Verb),
}

/// The whole command line; its help has the verbs in their groups.
pub(super) fn command() -> Command {
    let command = Arguments::command();
    let groups = [
        ("Playing", playing::Verb::augment_subcommands(Command::new("playing"))),
        ("Laboratory", laboratory::Verb::augment_subcommands(Command::new("laboratory"))),
        ("The paper", paper::Verb::augment_subcommands(Command::new("paper"))),
    ];
    let header = command.get_styles().get_header();
    let texts = groups.map(|(name, group)| format!("{header}{name}:{header:#}\n{}", verbs(&group)));
    let template = format!(
        "{{about}}\n\n{{usage-heading}} {{usage}}\n\n{}\n{header}Options:{header:#}\n{{options}}{{after-help}}",
        texts.join("\n")
    );
    command.help_template(template)
}

/// A line for each verb of a group, or as many as its sentence takes.
fn verbs(group: &Command) -> String {
    let verb = |verb: &Command| {
        let about = verb.get_about().map(ToString::to_string).unwrap_or_default();
        wrapped::hanging(&format!("  {:11}  ", verb.get_name()), &about) + "\n"
    };
    group.get_subcommands().map(verb).collect()
}

/// The words of the command line, or those that are meant where there are none; `None` if that is done already.
fn words() -> Result<Option<Vec<OsString>>, Failure> {
    #[cfg(all(feature = "tray", target_os = "linux"))]
    if env::args_os().len() < 2 && playing::live::alone::is_on_desktop() {
        return Ok(playing::live::alone::command_line()?
            .map(|words| words.into_iter().map(OsString::from).collect()));
    }
    Ok(Some(env::args_os().collect()))
}

/// Runs the program with the process's arguments.
pub(super) fn run() -> ExitCode {
    #[cfg(target_os = "linux")]
    let guarded = playing::live::guardian::outcome(env::args_os());
    #[cfg(not(target_os = "linux"))]
    let guarded = None;
    let asked = || words().and_then(|words| words.map_or(Ok(()), |words| obey(&parsed(words).verb)));
    let outcome = guarded.unwrap_or_else(asked);
    let (code, message) = match outcome {
        Ok(()) | Err(Failure::Unread) => return ExitCode::SUCCESS,
        Err(Failure::Failed(message)) => (1, message),
        Err(Failure::Unusable(message)) => (2, message),
    };
    // Where even the error cannot be written, the exit code still tells.
    say(format_args!("tactpad: {message}"));
    ExitCode::from(code)
}

/// Parses the words, or ends the process with the help or the error that they ask for.
fn parsed(words: Vec<OsString>) -> Arguments {
    let matches = command().get_matches_from(words);
    Arguments::from_arg_matches(&matches).unwrap_or_else(|error| error.exit())
}

fn obey(verb: &Verb) -> Result<(), Failure> {
    match verb {
        Verb::Playing(verb) => playing::run(verb, command),
        Verb::Laboratory(verb) => laboratory::run(verb),
        Verb::Paper(verb) => paper::run(verb),
    }
}

#[cfg(test)]
mod tests {
    use std::any::TypeId;

    use clap::{Arg, Command};

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
        let mut whole = command();
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

    /// Whether the values of an argument are numbers, or lists of them.
    fn takes_numbers(argument: &Arg) -> bool {
        const LISTS: [&str; 4] = ["R1,R2,R3", "N,N", "A-B", "X,Y"];
        let kind = argument.get_value_parser().type_id();
        let numbers = [TypeId::of::<f64>(), TypeId::of::<u64>(), TypeId::of::<u32>(), TypeId::of::<usize>()];
        let names = argument.get_value_names().unwrap_or_default();
        numbers.iter().any(|it| kind == *it) || names.iter().any(|name| LISTS.contains(&name.as_str()))
    }

    /// The words of a command line that gives an argument this value.
    fn line(name: &str, argument: &Arg, value: &str) -> Vec<String> {
        let mut words: Vec<String> = name.split(' ').map(str::to_owned).collect();
        match (argument.get_long(), argument.get_index()) {
            (Some(long), _) => words.push(format!("--{long}={value}")),
            (None, index) => {
                words.extend((1..index.unwrap_or(1)).map(|_| "anything".to_owned()));
                words.push(value.to_owned());
            }
        }
        words
    }

    #[test]
    fn a_number_that_is_mistyped_is_told_what_can_be_written() {
        let mut whole = command();
        whole.build();
        let mut commands = Vec::new();
        all(&whole, "", &mut commands);
        let mut count = 0;
        for (name, command) in &commands {
            for argument in command.get_arguments().filter(|it| takes_numbers(it)) {
                count += 1;
                for value in ["", "many", "7q", "1.2.3", "7 apples", "1e999"] {
                    let words = line(name, argument, value);
                    let error = whole.clone().try_get_matches_from(&words).unwrap_err().to_string();
                    let told = error.lines().next().unwrap_or_default();
                    let sentence = told.split(": write ").nth(1);
                    let is_example = |it: &str| it.contains(" as ") || it.contains(" or more");
                    assert!(sentence.is_some_and(is_example), "{words:?}: {error}");
                }
            }
        }
        assert!(count > 20, "{count} numbers");
    }

    #[test]
    fn arguments_are_sound() {
        command().debug_assert();
    }
}
