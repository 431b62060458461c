//! `tactpad profile history`, `restore`, `delete`, `rename`, `export` and `import`.

use std::fs;
use std::io::{self, Read, Write};
use std::path::Path;

use serde::Serialize;

use super::changes::changes;
use super::saves::{self, Save};
use super::{bundle, edits};
use crate::cli::failure::Failure;
use crate::cli::files::decoder_file;
use crate::cli::files::destination::Destination;
use crate::cli::playing::profile::{chosen, own};
use crate::cli::printing::date::date;
use crate::cli::printing::written::{is_stdout, print_json, reason, say, stdout};
use tactpad::pipeline::mapping::read::shipped;

/// No bundle is longer.
const BUNDLE_BYTES_MAX: u64 = 64_000_000;

/// A save as it is listed.
#[derive(Debug, Serialize)]
pub(crate) struct ListedSave {
    /// 1 is the newest.
    pub(crate) number: usize,
    /// By which it is found, whatever is saved meanwhile.
    pub(crate) id: u64,
    /// When it was saved, in milliseconds since 1970.
    pub(crate) at_ms: u64,
    /// What changed from the one before, in words, or from the shipped one; nothing of the oldest that is kept where there is neither.
    pub(crate) changes: Vec<String>,
}

/// The saves of a profile, the newest first.
pub(crate) fn listed(name: &str) -> Vec<ListedSave> {
    let saves = saves::of(name);
    let shipped = shipped::text(name).filter(|_| saves.len() < saves::SAVES_MAX);
    let entry = |(index, save): (usize, &Save)| {
        let before = saves.get(index + 1).map(|before| before.text.as_str()).or(shipped);
        let changes = before.map_or_else(Vec::new, |before| changes(before, &save.text));
        ListedSave { number: index + 1, id: save.id, at_ms: save.at_ms, changes }
    };
    saves.iter().enumerate().map(entry).collect()
}

/// The text of a save.
#[cfg(all(feature = "dashboard", target_os = "linux"))]
pub(crate) fn saved(name: &str, id: u64) -> Option<String> {
    saves::of(name).into_iter().find(|save| save.id == id).map(|save| save.text)
}

/// Prints the history.
pub(crate) fn print(name: &str, json: bool) -> Result<(), Failure> {
    let saves = listed(name);
    if json {
        return print_json(&saves);
    }
    if saves.is_empty() {
        return Err(no_history(name));
    }
    let mut text = String::new();
    for ListedSave { number, at_ms, changes, .. } in &saves {
        let told = if changes.is_empty() { "the oldest that is kept".into() } else { changes.join("; ") };
        text += &format!("{number:>2}  {}  {told}\n", date(*at_ms));
    }
    Ok(stdout().write_all(text.as_bytes())?)
}

fn no_history(name: &str) -> Failure {
    let way_out = match shipped::text(name) {
        Some(_) => "it plays as it was shipped",
        None => "`tactpad profile list` names the profiles that there are",
    };
    Failure::Unusable(format!("no profile of your own was saved as {name:?}: {way_out}"))
}

/// Puts an earlier save in the place of the present one; without a number the last one that differs from it.
pub(crate) fn restore(name: &str, number: Option<usize>) -> Result<(), Failure> {
    let saves = saves::of(name);
    let is_there = own::file(name).is_some();
    let number = number.unwrap_or(if is_there { 2 } else { 1 });
    let Some(save) = number.checked_sub(1).and_then(|index| saves.get(index)) else {
        if saves.is_empty() {
            return Err(no_history(name));
        }
        return Err(Failure::Unusable(format!(
            "there is no save {number} of {name:?}: choose 1 to {}, see `tactpad profile history {name:?}`",
            saves.len()
        )));
    };
    let path = edits::put(name, &save.text)?;
    say(format_args!("{name} is as it was saved {}; what stood there is in its history", date(save.at_ms)));
    Ok(writeln!(stdout(), "{}", path.display())?)
}

/// Makes a profile that stands before a shipped one as it was shipped.
pub(crate) fn restore_shipped(name: &str) -> Result<(), Failure> {
    if shipped::text(name).is_none() {
        return Err(Failure::Unusable(format!("there is no {name:?} inside the program")));
    }
    delete(name)
}

/// Removes a profile of the user's own; its history stays.
pub(crate) fn delete(name: &str) -> Result<(), Failure> {
    edits::remove(name)?;
    let rest = if shipped::text(name).is_some() { ", and the shipped one plays" } else { "" };
    say(format_args!("{name} is removed{rest}: `tactpad profile restore {name:?}` brings it back"));
    Ok(())
}

/// Gives a profile of the user's own another name.
pub(crate) fn rename(name: &str, to: &str) -> Result<(), Failure> {
    let path = edits::rename(name, to)?;
    Ok(writeln!(stdout(), "{}", path.display())?)
}

/// Writes a profile as a bundle.
pub(crate) fn export(name: &str, decoder: Option<&Path>, out: &Path) -> Result<(), Failure> {
    if !own::is_name(name) {
        return Err(Failure::Unusable(format!(
            "{name:?} is a file: copy the file itself, or name a profile"
        )));
    }
    let to = Destination::of(out)?;
    let text = chosen::find(name)?.text;
    let decoder = decoder.map(decoder_file::whole).transpose()?;
    to.write(bundle::document(name, &text, decoder.as_deref())?.as_bytes())
}

/// Makes the profile of a bundle one's own.
pub(crate) fn import(file: &Path, name: Option<&str>) -> Result<(), Failure> {
    let unread = |error: &io::Error| {
        Failure::Unusable(format!("{} cannot be read: {}; name another file", file.display(), reason(error)))
    };
    let mut text = String::new();
    let source: Box<dyn Read> = match is_stdout(file) {
        true => Box::new(io::stdin()),
        false => Box::new(fs::File::open(file).map_err(|error| unread(&error))?),
    };
    source.take(BUNDLE_BYTES_MAX).read_to_string(&mut text).map_err(|error| unread(&error))?;
    let imported = bundle::import(&text, name).map_err(|failure| match failure {
        Failure::Unusable(why) => Failure::Unusable(format!("{}: {why}", file.display())),
        failed => failed,
    })?;
    if let Some(decoder) = &imported.decoder {
        say(format_args!(
            "its decoder is {0}: play with `tactpad run --profile {1:?} --decoder {0:?}`",
            decoder.display(),
            imported.name
        ));
    }
    Ok(writeln!(stdout(), "{}", imported.path.display())?)
}
