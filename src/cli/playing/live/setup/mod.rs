//! `tactpad setup`: leads who is new here to the first game, in five questions at most.

mod games;
mod offers;
mod questions;

use std::env;
use std::process::{Command, Stdio};

use clap::{Args, ValueEnum};

use self::games::{Choice, Kind};
use self::questions::{Questions, command, list, list_from, say};
use super::last_choice::{self, ChosenPad};
use super::output::{Output, variable, window_of_keys};
use super::profile_selection::{FALLBACK, ProfileSelection, first};
use super::{devices, doctor};
use crate::cli::failure::Failure;
use crate::cli::playing::{profile, source};
use tactpad::bridge::sink::uinput::{self, UinputObstacle};
use tactpad::bridge::sink::x11::X11Sink;
use tactpad::bridge::transport::address::PadAddress;
use tactpad::pipeline::mapping::read::check::OutputChoice;
use tactpad::source::shipped;

/// Arguments of `tactpad setup`.
#[derive(Debug, Args)]
#[command(after_help = "Example: tactpad setup\n\n\
    Enter takes the answer in brackets, and each option answers a question beforehand. What was chosen is kept at the end, and is what \
    `tactpad run` plays from then on.")]
pub(crate) struct Arguments {
    /// The pad, as `run --pad` takes it; virtual is a pad of software.
    #[arg(long, value_name = "PAD")]
    pad: Option<PadAddress>,
    /// The description of a pad of your own, as `run --source` takes it.
    #[arg(long, value_name = "NAME|FILE", requires = "pad")]
    source: Option<String>,
    /// How games get what is pressed: auto is by virtual devices, x11 by keys of the X server, which go to the window in front.
    #[arg(long, value_name = "OUTPUT", value_parser = kept_output)]
    output: Option<Output>,
    /// Whether to try it for ten seconds.
    #[arg(long = "try", value_name = "WHETHER")]
    trial: Option<Trial>,
    /// The profile: a name from `profile list`, a file, or auto.
    #[arg(long, value_name = "PROFILE")]
    profile: Option<String>,
    /// Take the answer in brackets wherever no option gives one.
    #[arg(long)]
    yes: bool,
}

/// Whether to play now.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Trial {
    Yes,
    No,
}

/// How long it is tried, in seconds.
const TRIAL_SECONDS: &str = "10";

pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    arguments.check()?;
    let mut questions = Questions::new(arguments.yes);
    say(
        "A few questions lead to the first game. Enter takes the answer in brackets. Nothing is kept before the last one; Ctrl-C ends it.",
    )?;
    let pad = arguments.asked_pad(&mut questions)?;
    let output = arguments.asked_output(&mut questions)?;
    ask_permission(&mut questions, &pad, &output)?;
    let usual = usual_profile(&pad);
    arguments.try_out(&mut questions, &pad, &usual)?;
    let profile = arguments.asked_profile(&mut questions, &usual)?;
    last_choice::keep_pad(&pad)?;
    last_choice::keep_output(&output)?;
    last_choice::keep_profile(&ProfileSelection::of(&profile).as_argument())?;
    say(&format!("\nThat is kept. {}", what_plays(&output, uinput::available().is_ok())))?;
    command(if output == Output::X11 { "tactpad run --output x11" } else { "tactpad run" })?;
    say("With --dashboard behind it a page in the browser shows the pad, and profiles are changed there.")
}

/// What the command at the end does.
const fn what_plays(output: &Output, has_devices: bool) -> &'static str {
    match (output, has_devices) {
        (Output::X11, _) => {
            "From now on this presses keys, until Ctrl-C ends it. They go to whatever window is in front: start the game first."
        }
        (_, true) => "From now on this plays, until Ctrl-C ends it:",
        (_, false) => {
            "From now on this shows what is pressed, until Ctrl-C ends it; no game gets it while there are no virtual devices (`tactpad doctor`):"
        }
    }
}

/// An output that can be kept.
fn kept_output(text: &str) -> Result<Output, String> {
    let output = text.parse().ok().filter(|output| matches!(output, Output::Auto | Output::X11));
    output.ok_or_else(|| "choose auto or x11".into())
}

impl Arguments {
    /// Refuses options that name nothing, before anybody answers the rest.
    fn check(&self) -> Result<(), Failure> {
        self.given_pad().map_or(Ok(()), |pad| is_described(&pad))?;
        self.profile.as_deref().map_or(Ok(()), is_usable)
    }

    fn given_pad(&self) -> Option<ChosenPad> {
        self.pad.clone().map(|address| ChosenPad { address, source: self.source.clone() })
    }

    /// What is to be played with.
    fn asked_pad(&self, questions: &mut Questions) -> Result<ChosenPad, Failure> {
        if let Some(pad) = self.given_pad() {
            return Ok(pad);
        }
        questions.ask("What do you want to play with?")?;
        loop {
            let offers = offers::of(&devices::found_here());
            list(&offers.iter().map(|offer| offer.words.clone()).collect::<Vec<_>>())?;
            say(
                "Is yours missing, a pad, a tablet, a touchpad, load cells, a Balance Board? Plug it in and type: again",
            )?;
            let answer = questions.answer("1")?;
            match offers::chosen(&answer, &offers) {
                Some(pad) if is_described(&pad).is_ok() => return Ok(pad),
                _ if answer == "again" => {}
                _ => say("That is no number of this list, and no pad as `tactpad devices` lists them.")?,
            }
        }
    }

    /// How games are to get what is pressed. It is asked where there are no virtual devices, and an X server takes keys.
    fn asked_output(&self, questions: &mut Questions) -> Result<Output, Failure> {
        if let Some(given) = &self.output {
            return Ok(given.clone());
        }
        let (Some(window), Err(UinputObstacle { why, mend })) =
            (window_of_keys(variable), uinput::available())
        else {
            return Ok(Output::Auto);
        };
        if X11Sink::open(None, None).is_err() {
            return Ok(Output::Auto);
        }
        questions.ask(&format!("How are games to get what is pressed? {why}."))?;
        let devices = mend.map_or_else(String::new, |_| ", after one command, which comes next".to_owned());
        list(&[
            format!("by a virtual gamepad{devices}"),
            format!("by keys on this X display, which go to {window}"),
        ])?;
        let usual = if last_choice::kept_output() == Output::X11 { "2" } else { "1" };
        loop {
            match questions.answer(usual)?.as_str() {
                "1" => return Ok(Output::Auto),
                "2" => return Ok(Output::X11),
                _ => say("Answer 1 or 2.")?,
            }
        }
    }

    /// Plays for some seconds, if that is wanted.
    fn try_out(&self, questions: &mut Questions, pad: &ChosenPad, profile: &str) -> Result<(), Failure> {
        let is_wanted = match self.trial {
            Some(trial) => trial == Trial::Yes,
            None => questions.is_wanted(&format!("Try it now, for {TRIAL_SECONDS} seconds?"))?,
        };
        if !is_wanted {
            return Ok(());
        }
        say(match pad.address {
            PadAddress::Virtual => "A finger of software presses it. This is what comes of it:",
            _ => "Press it with a finger, here and there, softly and hard. This is what comes of it:",
        })?;
        if !plays(pad, profile)? {
            say(
                "That did not go well; `tactpad doctor` says what may stand in the way. The set-up goes on.",
            )?;
        }
        Ok(())
    }

    /// The profile that is to be played.
    fn asked_profile(&self, questions: &mut Questions, usual: &str) -> Result<String, Failure> {
        if let Some(given) = &self.profile {
            return Ok(given.clone());
        }
        let choices = games::choices();
        questions.ask("Which game? A number or a name; auto goes by the program that is in front.")?;
        let mut number = 1;
        for kind in choices.chunk_by(|one, next| one.kind == next.kind) {
            kind.first().map_or(Ok(()), |choice| say(choice.kind.heading()))?;
            number = list_from(number, &kind.iter().map(Choice::words).collect::<Vec<_>>())?;
        }
        loop {
            let answer = questions.answer(usual)?;
            let number = answer.parse().ok().and_then(|number: usize| choices.get(number.checked_sub(1)?));
            let name = number.map_or(&answer, |choice| &choice.name);
            match is_usable(name) {
                Ok(()) => return Ok(name.clone()),
                Err(failure) => say(&failure.sentence())?,
            }
        }
    }
}

/// Whether a pad that needs a description has one.
fn is_described(pad: &ChosenPad) -> Result<(), Failure> {
    match (&pad.address, &pad.source) {
        (_, Some(source)) => source::usable(&source::find(source)?).map(|_| ()),
        (PadAddress::Described { name, .. }, None) if shipped::text(name).is_none() => {
            Err(source::unknown(name))
        }
        _ => Ok(()),
    }
}

/// Whether a profile can be played.
fn is_usable(profile: &str) -> Result<(), Failure> {
    profile::read_aside(first(profile), OutputChoice::AsWritten).map(|_| ())
}

/// The profile in brackets: the last one, else the pad's own, else that of a game which is installed.
fn usual_profile(pad: &ChosenPad) -> String {
    let kept = last_choice::kept_profile().filter(|name| is_usable(name).is_ok());
    let of_pad = || match &pad.address {
        PadAddress::Described { name, .. } if profile::is_known(name) => Some(name.clone()),
        _ => None,
    };
    let installed = || games::choices().into_iter().find(|it| it.kind == Kind::Installed).map(|it| it.name);
    kept.or_else(of_pad).or_else(installed).unwrap_or_else(|| FALLBACK.to_owned())
}

/// Says what may not be opened, with the command that mends it, and looks again when that is done.
fn ask_permission(questions: &mut Questions, pad: &ChosenPad, output: &Output) -> Result<(), Failure> {
    let denied = doctor::denied(&pad.address, output);
    if denied.is_empty() {
        return say("\nPermission: all that is needed may be opened.");
    }
    questions.ask("Permission is missing. Type this in another terminal, and Enter here when it is done.")?;
    for (message, mend) in denied {
        say(&message)?;
        command(&mend)?;
    }
    questions.answer("look again")?;
    if doctor::denied(&pad.address, output).is_empty() {
        return say("Now all that is needed may be opened.");
    }
    say("It is still missing. The set-up goes on; `tactpad doctor` says later how it stands.")
}

/// Plays on this terminal by a process of this same program; whether that went well.
fn plays(pad: &ChosenPad, profile: &str) -> Result<bool, Failure> {
    let mut program = Command::new(env::current_exe()?);
    if pad.address == PadAddress::Virtual {
        program.arg("demo");
    } else {
        // Keys would go to this terminal.
        program.args(["run", "--keep-play", "no", "--output", "auto", "--pad"]).arg(pad.address.to_string());
        program.args(pad.source.iter().flat_map(|source| ["--source", source]));
    }
    // The answers are not for it.
    program.args(["--seconds", TRIAL_SECONDS, "--profile", profile]).stdin(Stdio::null());
    Ok(program.status()?.success())
}
