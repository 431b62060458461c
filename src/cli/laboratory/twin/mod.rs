//! `tactpad twin`: measured-like data from the imperfect virtual pad.

mod arguments;
mod capture;
mod life;
mod table;

use crate::cli::failure::Failure;
use crate::cli::printing::written::{both_print, is_stdout};

pub(crate) use self::arguments::{Arguments, NUMERICAL};
use self::capture::HandMotion;

pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let prints = is_stdout(&arguments.out);
    if arguments.json && prints {
        return Err(both_print("--out -"));
    }
    arguments.keep_apart()?;
    let hands = match arguments.plan.to_str() {
        Some("play") => Some(HandMotion::Play),
        Some("presses") => Some(HandMotion::Presses),
        _ => None,
    };
    arguments.refuse_foreign(hands.is_some())?;
    match hands {
        Some(hands) => capture::make(arguments, hands, prints),
        None => table::make(arguments, prints),
    }
}
