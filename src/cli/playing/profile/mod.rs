//! `tactpad profile`: list, show, check, begin, edit.

use std::io::Write;

use clap::{Args, Subcommand};

use crate::cli::failure::Failure;
use crate::cli::printing::written::stdout;
use tactpad::pipeline::mapping::read::shipped;

mod chosen;
#[cfg(all(feature = "dashboard", target_os = "linux"))]
mod kept;
mod list;
mod new;
mod own;
mod stored;
mod verdict;

pub(crate) use chosen::{file, read};
#[cfg(target_os = "linux")]
pub(crate) use chosen::{is_known, known, next, read_aside};
#[cfg(all(feature = "dashboard", target_os = "linux"))]
pub(super) use kept::{entries, save, stored};
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
    /// Names of the profiles: those inside the program, and your own.
    #[command(after_help = "Example: tactpad profile list")]
    List {
        /// Print one JSON document.
        #[arg(long)]
        json: bool,
    },
    /// Print a profile's text.
    #[command(after_help = "Example: tactpad profile show contra > my-contra.toml")]
    Show {
        /// A name from `profile list`, or a file.
        profile: String,
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
    /// Print the JSON Schema of profiles, for editors and programs.
    #[command(after_help = "Example: tactpad profile schema > profile.schema.json\n\n\
        Profiles begin with the line `#:schema ./profile.schema.json`. Editors with Taplo or Even Better TOML then \
        complete and check keys where the schema lies beside the profile.")]
    Schema,
}

pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    match &arguments.action {
        Action::List { json } => list::run(*json),
        Action::Show { profile } => Ok(stdout().write_all(chosen::find(profile)?.text.as_bytes())?),
        Action::Check { profile, json } => verdict::run(profile, *json),
        Action::New { name, save } => new::new(name, *save),
        Action::Edit { name } => new::edit(name),
        Action::Schema => Ok(stdout().write_all(shipped::schema().as_bytes())?),
    }
}
