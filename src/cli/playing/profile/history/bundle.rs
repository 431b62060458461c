//! The exported file of a profile, for import on another machine: its name, its text, and a decoder if one is wanted.

use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use super::edits;
use crate::cli::failure::Failure;
use crate::cli::files::destination::Destination;
use crate::cli::files::{config_folder, decoder_file};
use crate::cli::playing::profile::own;
use tactpad::pipeline::mapping::read::ReadProfile;
use tactpad::pipeline::mapping::read::check::OutputChoice;

/// The version of the format.
const FORMAT: u32 = 1;

/// The file's content: JSON.
#[derive(Debug, Serialize, Deserialize)]
struct ProfileBundle {
    /// The version of the format.
    tactpad_profile: u32,
    name: String,
    /// The profile, byte for byte.
    text: String,
    /// A decoder's bytes in hexadecimal digits.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    decoder: Option<String>,
}

/// What an import has made.
#[derive(Debug)]
pub(crate) struct ImportedProfile {
    pub(crate) name: String,
    pub(crate) path: PathBuf,
    /// Where its decoder is, if one was in it.
    pub(crate) decoder: Option<PathBuf>,
}

/// The bundle of a profile of this name, as text.
pub(crate) fn document(name: &str, text: &str, decoder: Option<&[u8]>) -> Result<String, Failure> {
    let decoder = decoder.map(|bytes| bytes.iter().map(|byte| format!("{byte:02x}")).collect());
    let bundle = ProfileBundle { tactpad_profile: FORMAT, name: name.into(), text: text.into(), decoder };
    let json = serde_json::to_string_pretty(&bundle).map_err(|error| Failure::Failed(error.to_string()))?;
    Ok(json + "\n")
}

/// Makes the profile of a bundle one's own, under its name or another one; what is there stays.
pub(crate) fn import(document: &str, name: Option<&str>) -> Result<ImportedProfile, Failure> {
    let bundle: ProfileBundle = serde_json::from_str(document).map_err(|error| {
        Failure::Unusable(format!("this is no profile that `tactpad profile export` wrote: {error}"))
    })?;
    if bundle.tactpad_profile != FORMAT {
        return Err(Failure::Unusable(format!(
            "this profile was written in format {}, and this program reads format {FORMAT}: take a newer program",
            bundle.tactpad_profile
        )));
    }
    let name = name.unwrap_or(&bundle.name);
    own::check_name(name)?;
    if let (None, found) = ReadProfile::read(&bundle.text, OutputChoice::AsWritten) {
        let found: Vec<String> = found.iter().map(|it| it.render("the profile in it")).collect();
        return Err(Failure::Unusable(format!("the profile in it cannot be used\n{}", found.join("\n"))));
    }
    let decoder = bundle.decoder.as_deref().map(bytes_of).transpose()?;
    let place = decoder.as_ref().map(|_| decoder_place(name)).transpose()?;
    // The profile last: with it all is there.
    if own::file(name).is_some() {
        return Err(Failure::Unusable(format!(
            "there is a profile {name:?} already: choose another name (--name)"
        )));
    }
    if let (Some(bytes), Some(place)) = (&decoder, &place) {
        Destination::of(place)?.write(bytes)?;
    }
    let path = edits::create(name, &bundle.text)?;
    Ok(ImportedProfile { name: name.into(), path, decoder: place })
}

/// A decoder's bytes, which must be those of a decoder.
fn bytes_of(digits: &str) -> Result<Vec<u8>, Failure> {
    let wrong = || Failure::Unusable("the decoder in it is damaged: export the profile again".into());
    let pairs = digits.as_bytes().chunks(2);
    let bytes: Option<Vec<u8>> = pairs
        .map(|pair| u8::from_str_radix(str::from_utf8(pair).ok().filter(|it| it.len() == 2)?, 16).ok())
        .collect();
    let bytes = bytes.ok_or_else(wrong)?;
    decoder_file::check(&bytes).map_err(|_| wrong())?;
    Ok(bytes)
}

/// The user's own decoders, in the order of their names.
#[cfg(all(feature = "dashboard", target_os = "linux"))]
pub(crate) fn decoders() -> Vec<(String, PathBuf)> {
    let folder = config_folder::folder("decoders");
    let entries = folder.and_then(|folder| std::fs::read_dir(folder).ok()).into_iter().flatten().flatten();
    let named = entries.filter_map(|entry| {
        let name = entry.file_name().to_str()?.strip_suffix(".decoder")?.to_owned();
        Some((name, entry.path()))
    });
    let mut decoders: Vec<_> = named.collect();
    decoders.sort();
    decoders
}

/// Where the decoder of an imported profile goes: a file that is not there yet.
fn decoder_place(name: &str) -> Result<PathBuf, Failure> {
    let folder = config_folder::folder("decoders").ok_or_else(|| {
        let why = "there is no folder for your own decoders: set HOME or XDG_CONFIG_HOME to a whole path";
        Failure::Unusable(why.into())
    })?;
    std::fs::create_dir_all(&folder)?;
    let mut names = std::iter::once(name.to_owned()).chain((2..).map(|number| format!("{name}-{number}")));
    let free = names.find_map(|name| {
        let place = folder.join(format!("{name}.decoder"));
        (!place.exists()).then_some(place)
    });
    free.ok_or_else(|| Failure::Failed("there is no name for its decoder".into()))
}
