//! Measured contacts as the ways to fit a decoder take them.

use std::fmt;

use crate::calibration::data::earlier::EarlierCalibration;
use crate::calibration::fit::search::Report;
use crate::calibration::fit::{Calibration, FitError, fit_reported};
use crate::calibration::regression::{neighbours, regression};
use crate::calibration::screening::{Fault, TableMismatch, screened};
use crate::tangent::SimulatedPad;
use tactpad_core::network::Zero;
use tactpad_core::pad::device::Device;
use tactpad_core::pad::field::PadField;
use tactpad_core::pipeline::contact::Decoder;
use tactpad_core::pipeline::contact::regression::Target;
use tactpad_core::tables::measured::Row;
use tactpad_core::tables::recording::Recording;
use tactpad_numeric::random::SplitMix64;

/// The contacts of tables that were measured one after the other.
#[derive(Clone, Debug)]
pub struct Contacts {
    /// The whole tables.
    recording: Recording,
    /// Places of the contacts that are fitted to.
    places: Vec<usize>,
    /// These contacts, relative to what the channels are taken relative to.
    rows: Vec<Row>,
}

/// Why tables give no contacts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum ContactsError {
    /// There is no table.
    NoTable,
    /// Only some of them read the untouched pad.
    PartlyTared {
        /// So many do.
        tared: usize,
        /// Of so many.
        tables: usize,
    },
}

impl fmt::Display for ContactsError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoTable => f.write_str("there is no table"),
            Self::PartlyTared { tared, tables } => write!(
                f,
                "{tared} of these {tables} tables read the untouched pad; give those that do, or those that do not"
            ),
        }
    }
}

impl std::error::Error for ContactsError {}

impl Contacts {
    /// Joins the tables. With `count` only so many of their contacts are taken, drawn by the seed.
    ///
    /// # Errors
    /// There is no table, or only some of them read the untouched pad.
    pub fn of(recordings: Vec<Recording>, count: Option<usize>, seed: u64) -> Result<Self, ContactsError> {
        let (tared, tables) = (recordings.iter().filter(|it| it.is_tared()).count(), recordings.len());
        if tared != 0 && tared != tables {
            return Err(ContactsError::PartlyTared { tared, tables });
        }
        let recording = recordings.into_iter().reduce(Recording::then).ok_or(ContactsError::NoTable)?;
        let mut places = recording.contacts();
        if let Some(count) = count {
            SplitMix64::named(seed, "rows").shuffle(&mut places);
            places.truncate(count);
        }
        let rows = recording.tared().rows_at(&places);
        Ok(Self { recording, places, rows })
    }

    /// How many there are.
    pub fn count(&self) -> usize {
        self.rows.len()
    }

    /// Their places in the tables, counted through all of them.
    pub fn places(&self) -> &[usize] {
        &self.places
    }

    /// The contacts that are fitted to, relative to [`Contacts::zero`].
    pub fn rows(&self) -> &[Row] {
        &self.rows
    }

    /// Whether channels are relative to the untouched pad.
    pub fn is_tared(&self) -> bool {
        self.recording.is_tared()
    }

    /// What the channels are relative to.
    pub fn zero(&self) -> Zero {
        if self.is_tared() { Zero::Tared } else { Zero::Raw }
    }

    /// Holds them against the device: `None` for contacts without a fault that shows.
    ///
    /// # Errors
    /// No pad of this kind explains the channels, not even one with one fault.
    pub fn screened(&self, device: &Device, field: &PadField) -> Result<Option<Fault>, TableMismatch> {
        screened(&self.rows, device, field)
    }

    /// The pad's own field, calibrated. `earlier` what another pad's decoder tells of it; `report`
    /// hears how far it is.
    ///
    /// # Errors
    /// The contacts give no calibration.
    pub fn calibration(
        &self,
        pad: &SimulatedPad<'_>,
        earlier: Option<EarlierCalibration<'_>>,
        report: Report<'_>,
    ) -> Result<Calibration, FitError> {
        fit_reported(&self.recording, &self.places, pad, earlier, report)
    }

    /// The mean of the nearest contacts.
    ///
    /// # Errors
    /// Too few contacts.
    pub fn neighbours(&self) -> Result<Decoder, FitError> {
        neighbours(&self.rows, self.zero()).map(Decoder::from)
    }

    /// Least squares from the channels to `target`; places are found up to `reach_mm` from the centre.
    ///
    /// # Errors
    /// Too few contacts, or all alike.
    pub fn regression(&self, target: Target, reach_mm: f64) -> Result<Decoder, FitError> {
        regression(&self.rows, self.zero(), target, reach_mm).map(Decoder::from)
    }
}
