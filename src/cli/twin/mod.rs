//! `tactpad twin`: measured-like data from the imperfect virtual pad.

mod arguments;
mod life;
mod table;

use super::failure::Failure;
use super::written::{both_print, is_stdout};

pub(super) use self::arguments::{Arguments, NUMERICAL};

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let prints = is_stdout(&arguments.out);
    if arguments.json && prints {
        return Err(both_print("--out -"));
    }
    arguments.keep_apart()?;
    table::make(arguments, prints)
}
