//! `tactpad profile`: list, show, sheet, check, new, edit; history, restore, delete, rename; export, import.

use std::io::Write;
use std::path::PathBuf;

use clap::{Args, Subcommand};

use crate::cli::failure::Failure;
use crate::cli::number;
use crate::cli::printing::written::stdout;
use tactpad::pipeline::mapping::read::shipped;

mod chosen;
mod history;
#[cfg(all(feature = "dashboard", target_os = "linux"))]
mod kept;
mod list;
mod new;
mod own;
mod plain;
mod stored;
mod verdict;

use history::verbs;

pub(crate) use chosen::{file, read};
#[cfg(target_os = "linux")]
pub(crate) use chosen::{is_known, known, next, read_aside};
#[cfg(all(feature = "dashboard", target_os = "linux"))]
pub(super) use kept::{decoders, delete, entries, exported, import, listed, rename, save, saved, stored};
pub(super) use stored::ProfileDestination;

/// Arguments of `tactpad profile`.
#[derive(Debug, Args)]
#[command(after_help = "Example: tactpad profile check my-contra.toml\n\n\
    Your own profiles are in tactpad/profiles below $XDG_CONFIG_HOME, else below ~/.config. One that is there stands \
    before the one of the same name inside the program.")]
pub(crate) struct Arguments {
    #[command(subcommand)]
    action: Action,
}

#[derive(Debug, Subcommand)]
enum Action {
    /// List the profiles: those inside the program, and your own.
    #[command(after_help = "Example: tactpad profile list")]
    List {
        /// Print one JSON document.
        #[arg(long)]
        json: bool,
    },
    /// Print a profile's text, or what it does in plain words.
    #[command(
        after_help = "Example: tactpad profile show contra > my-contra.toml\n\n  tactpad profile show contra --plain"
    )]
    Show {
        /// A name from `profile list`, or a file.
        profile: String,
        /// Say in plain words what each press does, with which forces and times.
        #[arg(long)]
        plain: bool,
    },
    /// Make a sheet of one page: the plate with its zones, what each press does, how it fits the hand, the date. It prints on A4 and Letter.
    #[command(after_help = "Example: tactpad profile sheet contra --out contra.pdf")]
    Sheet {
        /// A name from `profile list`, or a file.
        profile: String,
        /// The file, by its end .html, .svg or .pdf; without it the page is printed as HTML.
        #[arg(long, value_name = "FILE")]
        out: Option<PathBuf>,
    },
    /// Say everything that is wrong with a profile.
    #[command(after_help = "Example: tactpad profile check my-contra.toml")]
    Check {
        /// A name from `profile list`, or a file.
        profile: String,
        /// Print one JSON document.
        #[arg(long)]
        json: bool,
    },
    /// Print a new profile to begin with, in which each key is explained.
    #[command(after_help = "Example: tactpad profile new my-game --save")]
    New {
        /// The new profile's name: letters, digits, - and _.
        name: String,
        /// Write it into the folder of your own profiles instead, and print its path.
        #[arg(long)]
        save: bool,
    },
    /// Make a profile your own: copy it into the folder of your own profiles, unless it is there, and print its path.
    ///
    /// On a terminal it is then opened with $VISUAL or $EDITOR, and checked. The one inside the program stays.
    #[command(after_help = "Example: tactpad profile edit contra")]
    Edit {
        /// A name from `profile list`.
        name: String,
    },
    /// List the last 20 saves of a profile of your own, the newest first, with what changed.
    #[command(after_help = "Example: tactpad profile history contra")]
    History {
        /// A profile of your own, also one that was deleted.
        name: String,
        /// Print one JSON document.
        #[arg(long)]
        json: bool,
    },
    /// Put an earlier save of a profile of your own in its place, and print its path. What stands there is kept.
    #[command(after_help = "Example: tactpad profile restore contra 3")]
    Restore {
        /// A profile of your own, also one that was deleted.
        name: String,
        /// The save's number in `profile history`; without it the one before the present, or the last of a deleted profile.
        #[arg(conflicts_with = "shipped", value_parser = parse_save, allow_negative_numbers = true)]
        number: Option<usize>,
        /// Bring back the profile of this name inside the program instead.
        #[arg(long)]
        shipped: bool,
    },
    /// Remove a profile of your own; `profile restore` brings it back.
    #[command(after_help = "Example: tactpad profile delete my-game")]
    Delete {
        /// A profile of your own.
        name: String,
    },
    /// Give a profile of your own another name, and its history with it, and print its path.
    #[command(after_help = "Example: tactpad profile rename my-game my-old-game")]
    Rename {
        /// A profile of your own.
        name: String,
        /// Its new name, which no profile of your own has yet.
        to: String,
    },
    /// Write a profile with its name into one file, for another machine.
    #[command(after_help = "Example: tactpad profile export contra --out contra.tactpad")]
    Export {
        /// A name from `profile list`.
        name: String,
        /// A decoder that goes along: a file that calibrate, adapt or train wrote.
        #[arg(long, value_name = "FILE")]
        decoder: Option<PathBuf>,
        /// The file; - is stdout.
        #[arg(long, value_name = "FILE")]
        out: PathBuf,
    },
    /// Make the profile in such a file your own, and print its path.
    #[command(after_help = "Example: tactpad profile import contra.tactpad --name contra-of-ann")]
    Import {
        /// A file that `profile export` wrote; - is stdin.
        file: PathBuf,
        /// Another name for it.
        #[arg(long)]
        name: Option<String>,
    },
    /// Print the JSON Schema of profiles, for editors and programs.
    #[command(after_help = "Example: tactpad profile schema > profile.schema.json\n\n\
        Profiles begin with the line `#:schema ./profile.schema.json`. Editors with Taplo or Even Better TOML then \
        complete and check keys where the schema lies beside the profile.")]
    Schema,
}

/// The number of a save.
fn parse_save(text: &str) -> Result<usize, String> {
    number::whole(
        text,
        &[],
        1..=usize::MAX,
        "the number of a save as `tactpad profile history` shows it, 1 or more",
    )
}

pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    match &arguments.action {
        Action::List { json } => list::run(*json),
        Action::Show { profile, plain: true } => plain::print(profile),
        Action::Show { profile, plain: false } => {
            Ok(stdout().write_all(chosen::find(profile)?.text.as_bytes())?)
        }
        Action::Sheet { profile, out } => plain::sheet(profile, out.as_deref()),
        Action::Check { profile, json } => verdict::run(profile, *json),
        Action::New { name, save } => new::new(name, *save),
        Action::Edit { name } => new::edit(name),
        Action::History { name, json } => verbs::print(name, *json),
        Action::Restore { name, shipped: true, .. } => verbs::restore_shipped(name),
        Action::Restore { name, number, .. } => verbs::restore(name, *number),
        Action::Delete { name } => verbs::delete(name),
        Action::Rename { name, to } => verbs::rename(name, to),
        Action::Export { name, decoder, out } => verbs::export(name, decoder.as_deref(), out),
        Action::Import { file, name } => verbs::import(file, name.as_deref()),
        Action::Schema => Ok(stdout().write_all(shipped::schema().as_bytes())?),
    }
}
