//! Where a verb keeps a profile that it has changed.

use std::path::{Path, PathBuf};

use super::history::edits;
use super::{chosen, own};
use crate::cli::failure::Failure;
use crate::cli::files::destination::Destination;
use crate::cli::printing::written::is_stdout;

/// A place that can be written; it is looked at before the work.
#[derive(Debug)]
pub(crate) enum ProfileDestination {
    /// A new profile of the user's own.
    Own(String),
    /// A file, new or there already.
    File(Destination, PathBuf),
}

impl ProfileDestination {
    /// The place that a name or a file stands for. A profile of one's own that is there is only written over if it is `changed`, the
    /// one that the verb began with.
    pub(crate) fn of(name: &str, changed: &str) -> Result<Self, Failure> {
        if !own::is_name(name) || is_stdout(Path::new(name)) {
            let path = PathBuf::from(name);
            return Ok(Self::File(Destination::of(&path)?, path));
        }
        own::check_name(name)?;
        match own::file(name) {
            Some(path) if chosen::file(changed).as_deref() == Some(&path) => {
                Ok(Self::File(Destination::of(&path)?, path))
            }
            Some(path) => Err(Failure::Unusable(format!(
                "{} is there already: choose another name, or begin with it as --profile {name}",
                path.display()
            ))),
            None => Ok(Self::Own(name.to_owned())),
        }
    }

    /// The file that is written over, if it is one.
    pub(crate) fn path(&self) -> Option<&Path> {
        match self {
            Self::Own(_) => None,
            Self::File(_, path) => Some(path),
        }
    }

    /// Writes the profile and says where it is.
    pub(crate) fn write(&self, text: &str) -> Result<PathBuf, Failure> {
        match self {
            Self::Own(name) => edits::create(name, text),
            Self::File(_, path) if own::name_in_folder(path).is_some() => {
                edits::write_over(path, text).map(|()| path.clone())
            }
            Self::File(to, path) => to.write(text.as_bytes()).map(|()| path.clone()),
        }
    }
}
