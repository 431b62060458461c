//! The measured tables that a decoder is fitted to.

use std::path::PathBuf;

use crate::cli::failure::Failure;
use crate::cli::tables;
use tactpad::lab::calibration::screening::Fault;
use tactpad::lab::contacts::Contacts;
use tactpad::pad::device::Device;
use tactpad::tables::measured::columns::Kind;
use tactpad::tables::recording::Recording;

/// The contacts of the tables, and what people call these.
pub(super) struct Measured {
    pub(super) contacts: Contacts,
    pub(super) names: String,
}

impl Measured {
    /// Reads the tables of this pad; see [`Contacts::of`] for the others.
    pub(super) fn read(
        paths: &[PathBuf],
        device: &Device,
        rows: Option<usize>,
        seed: u64,
    ) -> Result<Self, Failure> {
        let names: Vec<String> = paths.iter().map(|path| path.display().to_string()).collect();
        let names = names.join(", ");
        let read = |path: &PathBuf| tables::read(path, Kind::Measured, device.plate.radius_mm());
        let tables = paths.iter().map(read).collect::<Result<Vec<_>, Failure>>()?;
        let full_scale_n = device.contact.full_scale_n;
        let recordings = tables.into_iter().map(|table| Recording::tared_or_raw(table, full_scale_n));
        let contacts = Contacts::of(recordings.collect(), rows, seed);
        let contacts = contacts.map_err(|error| Failure::Unusable(format!("{names}: {error}")))?;
        Ok(Self { contacts, names })
    }

    /// A decoder can be fitted to them, but a part of the pad is at fault.
    pub(super) fn warning(&self, fault: Fault) -> String {
        format!("{}: {fault}; mend it and measure again", self.names)
    }

    /// Nothing can be fitted to them.
    pub(super) fn refused(&self, why: impl std::fmt::Display) -> Failure {
        Failure::Unusable(format!("{}: {why}", self.names))
    }
}
