//! `tactpad setup`: leads who is new here to the first game, in four questions.

mod offers;
mod questions;

use std::env;
use std::process::{Command, Stdio};

use clap::{Args, ValueEnum};

use self::questions::{Questions, command, list, say};
use super::last_choice::{self, ChosenPad};
use super::profile_selection::{FALLBACK, ProfileSelection, first};
use super::{devices, doctor};
use crate::cli::failure::Failure;
use crate::cli::playing::{profile, source};
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
    ask_permission(&mut questions, &pad)?;
    let usual = usual_profile(&pad);
    arguments.try_out(&mut questions, &pad, &usual)?;
    let profile = arguments.asked_profile(&mut questions, &usual)?;
    let is_software = pad.address == PadAddress::Virtual;
    // A pad of software is for now: one that is plugged in later is to play.
    last_choice::keep_pad(Some(&pad).filter(|_| !is_software))?;
    last_choice::keep_profile(&ProfileSelection::of(&profile).as_argument())?;
    say("\nThat is kept. From now on this plays, until Ctrl-C ends it:")?;
    command(if is_software { "tactpad run --pad virtual" } else { "tactpad run" })?;
    say("With --dashboard behind it a page in the browser shows the pad, and profiles are changed there.")
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
        let known = profile::known();
        questions.ask("Which game? A number or a name; auto goes by the program that is in front.")?;
        list(&known.iter().map(|name| titled(name)).collect::<Vec<_>>())?;
        loop {
            let answer = questions.answer(usual)?;
            let number = answer.parse().ok().and_then(|number: usize| known.get(number.checked_sub(1)?));
            let name = number.unwrap_or(&answer);
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

/// A profile's name and title.
fn titled(name: &str) -> String {
    let read = profile::read_aside(name, OutputChoice::AsWritten);
    let title = read.map_or_else(|_| "has errors".to_owned(), |(read, _)| read.profile().name.clone());
    format!("{name} ({title})")
}

/// The profile in brackets: the last one, else the pad's own.
fn usual_profile(pad: &ChosenPad) -> String {
    let kept = last_choice::kept_profile().filter(|name| is_usable(name).is_ok());
    let of_pad = || match &pad.address {
        PadAddress::Described { name, .. } if profile::is_known(name) => Some(name.clone()),
        _ => None,
    };
    kept.or_else(of_pad).unwrap_or_else(|| FALLBACK.to_owned())
}

/// Says what may not be opened, with the command that mends it, and looks again when that is done.
fn ask_permission(questions: &mut Questions, pad: &ChosenPad) -> Result<(), Failure> {
    let denied = doctor::denied(&pad.address);
    if denied.is_empty() {
        return say("\nPermission: all that is needed may be opened.");
    }
    questions.ask("Permission is missing. Type this in another terminal, and Enter here when it is done.")?;
    for (message, mend) in denied {
        say(&message)?;
        command(&mend)?;
    }
    questions.answer("look again")?;
    if doctor::denied(&pad.address).is_empty() {
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
        program.args(["run", "--keep-play", "no", "--pad"]).arg(pad.address.to_string());
        program.args(pad.source.iter().flat_map(|source| ["--source", source]));
    }
    // The answers are not for it.
    program.args(["--seconds", TRIAL_SECONDS, "--profile", profile]).stdin(Stdio::null());
    Ok(program.status()?.success())
}
