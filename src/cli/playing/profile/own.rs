//! The user's own folder of profiles: `$XDG_CONFIG_HOME/tactpad/profiles`, else `~/.config/tactpad/profiles`.

use std::fs::{self, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use crate::cli::failure::Failure;
use crate::cli::files::config_folder;
use crate::cli::files::destination::Destination;
use crate::cli::printing::written::{reason, say};
use tactpad::pipeline::mapping::read::shipped;

/// The longest name of a new profile, which is its name for people, too.
const NAME_CHARS_MAX: usize = 64;

/// `run --profile` takes this for the profile whose program is in front.
const AUTO: &str = "auto";

/// File name of the schema, as the first line of profiles gives it.
const SCHEMA_FILE: &str = "profile.schema.json";

/// The folder, which need not be there; `None` where the user has no home.
pub(super) fn folder() -> Option<PathBuf> {
    config_folder::folder("profiles")
}

/// Whether it names a profile. What has a dot or a slash names a file instead, so that no name leaves the folder.
pub(super) fn is_name(name: &str) -> bool {
    !name.is_empty() && !name.contains(['.', '/', '\\', ':']) && !name.contains(char::is_control)
}

/// The file of the user's own profile `name`, if there is one.
pub(super) fn file(name: &str) -> Option<PathBuf> {
    Some(place(name)?).filter(|path| path.symlink_metadata().is_ok())
}

/// Where the user's own profile `name` is, or would be.
fn place(name: &str) -> Option<PathBuf> {
    is_name(name).then(folder).flatten().map(|folder| folder.join(format!("{name}.toml")))
}

/// The names of the user's own profiles, in order.
pub(super) fn names() -> Vec<String> {
    let entries = folder().and_then(|folder| fs::read_dir(folder).ok()).into_iter().flatten().flatten();
    let mut names: Vec<String> = entries.filter_map(|entry| name_of(&entry.path())).collect();
    names.sort();
    names
}

/// The name under which a file of the folder is found.
fn name_of(path: &Path) -> Option<String> {
    let name = path.file_name()?.to_str()?.strip_suffix(".toml")?;
    is_name(name).then(|| name.to_owned())
}

/// The name of the user's own profile that this file is, if it is one.
pub(super) fn name_in_folder(path: &Path) -> Option<String> {
    (path.parent()? == folder()?).then(|| name_of(path)).flatten()
}

/// The file of the user's own profile `name`, which must be there.
pub(super) fn existing(name: &str) -> Result<PathBuf, Failure> {
    file(name).ok_or_else(|| {
        let own = names().join(", ");
        let way_out = if own.is_empty() { "there are none yet".into() } else { format!("they are {own}") };
        Failure::Unusable(format!("{name:?} is no profile of your own: {way_out}"))
    })
}

/// Refuses a name that a new profile cannot have.
pub(super) fn check_name(name: &str) -> Result<(), Failure> {
    let is_plain = |letter: char| letter.is_alphanumeric() || matches!(letter, '-' | '_' | ' ');
    let is_short = name.chars().count() <= NAME_CHARS_MAX && name != AUTO;
    if is_name(name) && is_short && name.chars().all(is_plain) && name.trim() == name {
        return Ok(());
    }
    Err(Failure::Unusable(format!(
        "{name:?} cannot be the name of a new profile: take up to {NAME_CHARS_MAX} letters, digits, - and _, but not {AUTO}"
    )))
}

/// Writes a new profile into the folder, which is made if there is none, and the schema beside it for editors. It
/// says where; what is there stays.
pub(super) fn write(name: &str, text: &str) -> Result<PathBuf, Failure> {
    let Some(path) = place(name) else {
        return Err(Failure::Unusable(
            "there is no folder for your own profiles: set HOME or XDG_CONFIG_HOME to a whole path".into(),
        ));
    };
    match write_new(&path, text) {
        Ok(()) => {}
        Err(error) if error.kind() == io::ErrorKind::AlreadyExists && path.symlink_metadata().is_ok() => {
            return Err(Failure::Unusable(format!(
                "{} is there already: choose another name, or change it with `tactpad profile edit {name:?}`",
                path.display()
            )));
        }
        Err(error) => {
            return Err(Failure::Failed(format!("{} cannot be written: {}", path.display(), reason(&error))));
        }
    }
    provide_schema(&path.with_file_name(SCHEMA_FILE));
    Ok(path)
}

fn write_new(path: &Path, text: &str) -> io::Result<()> {
    if let Some(folder) = path.parent() {
        fs::create_dir_all(folder)?;
    }
    let mut file = OpenOptions::new().write(true).create_new(true).open(path)?;
    file.write_all(text.as_bytes()).inspect_err(|_| {
        // Half a profile would stand before a shipped one.
        let _ = fs::remove_file(path);
    })
}

/// Keeps the schema as this program has it. A profile plays without, so nothing fails here.
fn provide_schema(path: &Path) {
    if fs::read(path).is_ok_and(|there| there == shipped::schema().as_bytes()) {
        return;
    }
    let written = Destination::of(path).and_then(|to| to.write(shipped::schema().as_bytes()));
    if let Err(Failure::Unusable(why) | Failure::Failed(why)) = written {
        say(why);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_name_leaves_the_folder() {
        for name in ["", ".", "..", "../x", "/etc/passwd", "a/b", "a\\b", "c:x", "mine.toml", "a\0b", "a\nb"]
        {
            assert!(!is_name(name) && place(name).is_none() && check_name(name).is_err(), "{name:?}");
        }
        for name in ["mine", "My game", "größe", "x_1-y"] {
            assert!(is_name(name) && check_name(name).is_ok(), "{name:?}");
        }
        for name in [" x", "x ", "a\"b", "a$b", &"x".repeat(65), "auto"] {
            assert!(check_name(name).is_err(), "{name:?}");
        }
    }

    #[test]
    fn files_have_the_names_that_find_them() {
        for (file, name) in [
            ("mine.toml", Some("mine")),
            ("my.game.toml", None),
            (".toml", None),
            ("mine.TOML", None),
            ("profile.schema.json", None),
        ] {
            assert_eq!(name_of(&Path::new("/x").join(file)).as_deref(), name, "{file}");
        }
    }
}
