//! Writes the manual page of each verb into a folder, for packages.

use std::env;
use std::io;

#[path = "../src/cli/mod.rs"]
#[expect(dead_code, reason = "the verbs are described, not run")]
mod cli;

fn main() -> io::Result<()> {
    let folder = env::args_os().nth(1).ok_or_else(|| io::Error::other("name the folder"))?;
    clap_mangen::generate_to(cli::command(), folder)
}
