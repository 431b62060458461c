//! `tactpad profile list`.

use std::io::Write;

use serde::Serialize;

use super::{chosen, own};
use crate::cli::failure::Failure;
use crate::cli::printing::written::{print_json, stdout};
use tactpad::pipeline::mapping::read::shipped;

/// The profiles that have names.
#[derive(Serialize)]
struct ProfileList {
    /// The folder of one's own, which need not be there; none where the user has no home.
    folder: Option<String>,
    profiles: Vec<ListedProfile>,
}

#[derive(Serialize)]
struct ListedProfile {
    name: String,
    /// Whether it is the user's own.
    own: bool,
    /// Whether there is one of this name inside the program.
    shipped: bool,
    /// The file of the user's own.
    file: Option<String>,
}

/// Prints them: those inside the program, then the user's own.
pub(super) fn run(json: bool) -> Result<(), Failure> {
    let profiles: Vec<_> = chosen::known().into_iter().map(entry).collect();
    if json {
        let folder = own::folder().map(|folder| folder.display().to_string());
        return print_json(&ProfileList { folder, profiles });
    }
    let mut text = String::new();
    for ListedProfile { name, own, shipped, .. } in profiles {
        text += &match (own, shipped) {
            (false, _) => format!("{name}\n"),
            (true, false) => format!("{name:<18} your own\n"),
            (true, true) => format!("{name:<18} your own, before the shipped one\n"),
        };
    }
    Ok(stdout().write_all(text.as_bytes())?)
}

fn entry(name: String) -> ListedProfile {
    let file = own::file(&name).map(|path| path.display().to_string());
    ListedProfile { own: file.is_some(), shipped: shipped::text(&name).is_some(), file, name }
}
