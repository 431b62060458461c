//! `tactpad completions`: what a shell needs to complete verbs and options.

use std::io::Write;

use clap::{Args, Command};
use clap_complete::{Shell, generate};

use crate::cli::failure::Failure;
use crate::cli::printing::written::stdout;

/// Arguments of `tactpad completions`.
#[derive(Debug, Args)]
#[command(after_help = "Example: tactpad completions bash > tactpad.bash\n\n\
    bash: write it as ~/.local/share/bash-completion/completions/tactpad.\n\
    zsh: write it as _tactpad into a folder of $fpath.\n\
    fish: write it as ~/.config/fish/completions/tactpad.fish.")]
pub(crate) struct Arguments {
    /// The shell.
    shell: Shell,
}

pub(super) fn run(arguments: &Arguments, command: &mut Command) -> Result<(), Failure> {
    // What writes them takes no error.
    let mut text = Vec::new();
    generate(arguments.shell, command, "tactpad", &mut text);
    Ok(stdout().write_all(&text)?)
}
