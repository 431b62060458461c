//! The `tactpad` program: parse, dispatch, print the error, set the exit code.

use std::process::ExitCode;

fn main() -> ExitCode {
    tactpad::cli::run()
}
