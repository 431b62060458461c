//! The `tactpad` program: parse, dispatch, print the error, set the exit code.

use std::process::ExitCode;

mod cli;

fn main() -> ExitCode {
    cli::run()
}
