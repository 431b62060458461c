//! `tactpad diagnose --against`: what changed in a sensor since an earlier recording.

use std::path::Path;

use super::any_sensor::{read, tell};
use super::arguments::{Arguments, folder};
use super::files::file_name;
use crate::cli::failure::Failure;
use crate::cli::files::tables;
use crate::cli::printing::progress::Progress;
use tactpad::lab::diagnosis::against::{ColumnSelection, compare};

/// Memory that a comparison takes for each row of both tables, with what it repeats of it.
const ROW_BYTES: usize = 4_000;

pub(super) fn run(arguments: &Arguments, measured: &Path, earlier: &Path) -> Result<(), Failure> {
    let Arguments { save_device, report, labels, channels, without, json, pad, .. } = arguments;
    if save_device.is_some() {
        return Err(Failure::Unusable(
            "--save-device writes the model of a pad with what was found, and --against knows no model; leave one of them out".into(),
        ));
    }
    if pad.is_given() {
        return Err(Failure::Unusable(
            "--device and --imperfections say which model to hold a table against, and --against takes an earlier table instead; \
             leave one of them out"
                .into(),
        ));
    }
    let folder = report.as_deref().map(|path| folder(path, arguments)).transpose()?;
    let [before, after] = [read(earlier)?, read(measured)?];
    let names = format!("{} against {}", measured.display(), earlier.display());
    tables::within_memory(&names, before.rows() + after.rows(), ROW_BYTES, tables::fewer_rows)?;
    let diagnosis = {
        let _progress = Progress::begin("looking for changes");
        let asked = ColumnSelection { labels, channels, without };
        compare(&before, &after, &asked).map_err(|why| Failure::Unusable(format!("{names}: {why}")))?
    };
    let model = format!("the earlier recording {}", file_name(earlier));
    tell(&diagnosis, measured, model, folder.as_ref(), *json)
}
