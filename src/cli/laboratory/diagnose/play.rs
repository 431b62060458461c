//! `tactpad diagnose --play`: what changed in a pad since an earlier play, or since it was calibrated.

use std::io::Write as _;
use std::path::Path;

use super::arguments::Arguments;
use super::changes::{ChangesDocument, ChangesText, Comparison, Reference};
use crate::cli::failure::Failure;
use crate::cli::files::decoder_file;
use crate::cli::files::field::{field_of, flaws};
use crate::cli::files::played::{self, Played};
use crate::cli::printing::progress::Progress;
use crate::cli::printing::written::{print_json, stdout};
use tactpad::lab::play::change::{Before, ChangeError, Which, changed};
use tactpad::pipeline::contact::Decoder;

/// The reference with which play is compared.
enum Earlier {
    Play(Played),
    Decoder(Box<Decoder>),
}

pub(super) fn run(arguments: &Arguments, paths: [&Path; 2]) -> Result<(), Failure> {
    let device = arguments.pad.read()?;
    let [before, play] = paths;
    let earlier = Earlier::read(before)?;
    let later = played::read(play, earlier.decoder())?;
    earlier.is_of_pad(&later, paths)?;
    let field = field_of(&device)?;
    let flaws = flaws(&device);
    let found = {
        let progress = Progress::begin("looking for changes");
        let report = |done: usize, of: usize| progress.part(done, of, "looking for changes");
        changed(earlier.before(), &later.windows, &device, &field, &flaws, &report)
    };
    let found = found.map_err(|error| refused(&error, paths))?;
    if arguments.json {
        return print_json(&ChangesDocument::of(&found));
    }
    let since = earlier.since(before);
    Ok(write!(stdout(), "{}", ChangesText(&Comparison { found: &found, since, play }))?)
}

impl Earlier {
    /// A decoder, or play. What is neither is told as no play.
    fn read(path: &Path) -> Result<Self, Failure> {
        let decoder = || decoder_file::read(path).map(|it| Self::Decoder(Box::new(it)));
        if decoder_file::is_meant(path) {
            return decoder();
        }
        played::read(path, None).map(Self::Play).or_else(|failure| decoder().map_err(|_| failure))
    }

    fn decoder(&self) -> Option<&Decoder> {
        match self {
            Self::Decoder(decoder) => Some(decoder),
            Self::Play(_) => None,
        }
    }

    fn before(&self) -> Before<'_> {
        match self {
            Self::Decoder(decoder) => Before::Decoder(decoder),
            Self::Play(played) => Before::Play(&played.windows),
        }
    }

    const fn since<'p>(&self, path: &'p Path) -> Reference<'p> {
        match self {
            Self::Decoder(_) => Reference::Calibrated(path),
            Self::Play(_) => Reference::Played,
        }
    }

    /// Refuses two plays of two pads. A decoder does not say whose it is.
    fn is_of_pad(&self, later: &Played, [before, play]: [&Path; 2]) -> Result<(), Failure> {
        let Self::Play(earlier) = self else { return Ok(()) };
        match earlier.pad.zip(later.pad) {
            Some((was, is)) if was != is => Err(Failure::Unusable(format!(
                "{} is of the pad {is} and {} of the pad {was}: take two captures of one pad",
                play.display(),
                before.display()
            ))),
            _ => Ok(()),
        }
    }
}

fn refused(error: &ChangeError, [before, play]: [&Path; 2]) -> Failure {
    let name = match error.which() {
        Some(Which::Earlier) => before.display().to_string(),
        Some(Which::Later) => play.display().to_string(),
        None => format!("{} against {}", play.display(), before.display()),
    };
    Failure::Unusable(format!("{name}: {error}"))
}
