//! `tactpad diagnose --model`: what measured channels show that anybody's own model gets wrong.

use std::fs;
use std::path::Path;

use super::any_sensor::{read, tell};
use super::arguments::{Arguments, folder};
use super::files::file_name;
use crate::cli::failure::Failure;
use crate::cli::files::tables;
use crate::cli::printing::progress::Progress;
use crate::cli::printing::written::reason;
use tactpad::lab::diagnosis::against::ColumnSelection;
use tactpad::lab::diagnosis::prediction::{Derivative, DerivativeError, derivatives, diagnose};

/// Memory that the search for causes takes for each row, with what it repeats of it.
const ROW_BYTES: usize = 32_000;
/// The file of effects in its folder.
const EFFECTS: &str = "effects.toml";

pub(super) fn run(arguments: &Arguments, measured: &Path, predicted: &Path) -> Result<(), Failure> {
    let Arguments { save_device, report, labels, channels, without, json, pad, effects, model_error, .. } =
        arguments;
    if save_device.is_some() || pad.is_given() {
        return Err(Failure::Unusable(
            "--save-device, --device and --imperfections are of the pad's own model, and --model takes another one instead; leave one of \
             them out"
                .into(),
        ));
    }
    let folder = report.as_deref().map(|path| folder(path, arguments)).transpose()?;
    let [measurement, prediction] = [read(measured)?, read(predicted)?];
    let names = format!("{} with {}", measured.display(), predicted.display());
    tables::within_memory(&names, measurement.rows(), ROW_BYTES, tables::fewer_rows)?;
    let own = effects.as_deref().map(own_effects).transpose()?.unwrap_or_default();
    let diagnosis = {
        let _progress = Progress::begin("looking for causes");
        let asked = ColumnSelection { labels, channels, without };
        diagnose(&measurement, &prediction, &own, &asked, 0.01 * model_error)
            .map_err(|why| Failure::Unusable(format!("{names}: {why}")))?
    };
    let model = format!("the predictions {}", file_name(predicted));
    tell(&diagnosis, measured, model, folder.as_ref(), *json)
}

/// Why effects cannot be read.
enum Unreadable {
    Effects(DerivativeError),
    Table(Failure),
}

fn own_effects(folder: &Path) -> Result<Vec<Derivative>, Failure> {
    let path = folder.join(EFFECTS);
    let text = fs::read_to_string(&path).map_err(|error| {
        Failure::Unusable(format!(
            "{} cannot be read: {}; write a section [EFFECT] with unit, low, high, prior_deviation and family for each EFFECT.csv beside it",
            path.display(),
            reason(&error)
        ))
    })?;
    let table = |name: &str| read(&folder.join(format!("{name}.csv"))).map_err(Unreadable::Table);
    derivatives(&text, table).map_err(|why| match why {
        Unreadable::Effects(why) => Failure::Unusable(format!("{}: {why}", path.display())),
        Unreadable::Table(failure) => failure,
    })
}

impl From<DerivativeError> for Unreadable {
    fn from(error: DerivativeError) -> Self {
        Self::Effects(error)
    }
}
