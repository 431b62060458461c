//! What was chosen last, which is played where a command line says nothing: the pad and output of `tactpad setup`, and the profile of that
//! or of the tray.

use std::path::{self, Path};

use super::output::{Output, variable, window_of_keys};
use super::profile_selection::{FALLBACK, first};
use crate::cli::failure::Failure;
use crate::cli::files::state_file;
use crate::cli::playing::profile;
use crate::cli::printing::written::{printable, say};
use tactpad::bridge::transport::address::PadAddress;
use tactpad::pipeline::mapping::read::check::OutputChoice;

/// The file that remembers the profile, as `run --profile` takes it.
const PROFILE: &str = "last-profile";

/// The file that remembers the pad: a line as `run --pad` takes it, and one with the path or name of its description if it needs one.
const PAD: &str = "last-pad";

/// The file that remembers the output, as `run --output` takes it.
const OUTPUT: &str = "last-output";

/// A pad, and its description where the address does not name one inside the program.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct ChosenPad {
    pub(super) address: PadAddress,
    pub(super) source: Option<String>,
}

/// The profile that was chosen last, whether it can still be used or not.
pub(super) fn kept_profile() -> Option<String> {
    let text = state_file::read(PROFILE);
    Some(text.trim_end().to_owned()).filter(|name| !name.is_empty() && !name.contains('\n'))
}

/// The profile that is played: the last one if it can still be used.
pub(super) fn profile() -> String {
    let Some(kept) = kept_profile() else { return FALLBACK.to_owned() };
    if profile::read_aside(first(&kept), OutputChoice::AsWritten).is_ok() {
        return kept;
    }
    say(format_args!(
        "the profile that was played last, {}, cannot be used any more: playing {FALLBACK}",
        printable(&kept)
    ));
    FALLBACK.to_owned()
}

/// Keeps a profile.
pub(super) fn keep_profile(profile: &str) -> Result<(), Failure> {
    state_file::write(PROFILE, &format!("{profile}\n"))
}

/// The pad that was chosen; `None` where none was, or what is kept names none.
pub(super) fn pad() -> Option<ChosenPad> {
    pad_in(&state_file::read(PAD))
}

fn pad_in(text: &str) -> Option<ChosenPad> {
    let mut lines = text.lines();
    let address = lines.next()?.parse().ok()?;
    Some(ChosenPad { address, source: lines.next().map(str::to_owned) })
}

/// Keeps a pad.
pub(super) fn keep_pad(pad: &ChosenPad) -> Result<(), Failure> {
    state_file::write(PAD, &text_of(pad))
}

/// The output that was chosen, whether it can be used or not.
pub(super) fn kept_output() -> Output {
    state_file::read(OUTPUT).trim_end().parse().unwrap_or(Output::Auto)
}

/// The output that is played into: the chosen one, and not keys where no X server takes them.
pub(super) fn output() -> Output {
    match kept_output() {
        Output::X11 if window_of_keys(variable).is_none() => {
            say(
                "`tactpad setup` chose keys of the X server, and there is none here: playing with --output auto",
            );
            Output::Auto
        }
        kept => kept,
    }
}

/// Keeps an output.
pub(super) fn keep_output(output: &Output) -> Result<(), Failure> {
    state_file::write(OUTPUT, &format!("{output}\n"))
}

fn text_of(pad: &ChosenPad) -> String {
    let whole = |source: &String| {
        let file = Path::new(source);
        path::absolute(file)
            .ok()
            .filter(|_| file.exists())
            .map_or_else(|| source.clone(), |it| it.display().to_string())
    };
    let source = pad.source.as_ref().map(|source| format!("{}\n", whole(source))).unwrap_or_default();
    format!("{}\n{source}", pad.address)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pad_is_read_as_it_was_kept() {
        for (address, source) in
            [("auto:7A", None), ("my-board:/dev/ttyUSB0@9600", Some("/home/ann/my-board.toml"))]
        {
            let pad = ChosenPad { address: address.parse().unwrap(), source: source.map(str::to_owned) };
            assert_eq!(pad_in(&text_of(&pad)), Some(pad));
        }
        for text in ["", "\n", "serial:\n", "nonsense\n"] {
            assert_eq!(pad_in(text), None, "{text:?}");
        }
    }
}
