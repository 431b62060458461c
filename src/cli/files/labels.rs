//! How the labels of measured tables are meant: arguments, and the question where nobody says.

use std::path::Path;

use clap::Args;

use super::tables;
use crate::cli::failure::Failure;
use tactpad::lab::diagnosis::conventions::refusal;
use tactpad::lab::tangent::SimulatedPad;
use tactpad::pad::device::Device;
use tactpad::tables::convention::{Frame, LabelConvention, Sign};
use tactpad::tables::measured::Table;
use tactpad::tables::measured::columns::TableKind;
use tactpad::tables::units::Units;

/// The way out where a number is too large.
const OTHER_UNITS: &str = "; where the table has other units, say so, as with --units \"mm,g,uV\"";

/// How labels are meant; without any of these they are asked about.
#[derive(Clone, Copy, Debug, Default, Args)]
#[command(next_help_heading = "How the labels are meant")]
pub(crate) struct LabelOptions {
    /// What the columns x and y hold of the pad's axes, as "x,-y" or "y,x", or by how many degrees their frame is turned
    /// counter-clockwise, as "turn=120". Forces turn with it.
    #[arg(long, value_name = "FRAME", allow_hyphen_values = true)]
    frame: Option<Frame>,
    /// What the columns fx, fy, fz hold, as "fx,fy,-fz". Forces are the finger's on the plate, and pressing in is +fz.
    #[arg(long, value_name = "SIGN", allow_hyphen_values = true)]
    sign: Option<Sign>,
    /// Units of places, forces and channels, as "in,lbf,mV"; without it mm,N,uV.
    #[arg(long, value_name = "UNITS")]
    units: Option<Units>,
}

impl LabelOptions {
    /// Whether somebody said how they are meant.
    pub(crate) const fn are_said(&self) -> bool {
        self.frame.is_some() || self.sign.is_some() || self.units.is_some()
    }

    /// Reads a measured table, in the pad's frame, mm, N and µV.
    pub(crate) fn read(&self, path: &Path, device: &Device) -> Result<Table, Failure> {
        let Self { frame, sign, units } = *self;
        let convention = LabelConvention {
            frame: frame.unwrap_or_default(),
            sign: sign.unwrap_or_default(),
            units: units.unwrap_or_default(),
        };
        let plate_mm = device.plate.radius_mm();
        let table = tables::written_in(path, TableKind::Measured, plate_mm, &convention.units, OTHER_UNITS)?;
        Ok(if convention.is_default() { table } else { convention.applied(table) })
    }

    /// Refuses a table whose labels are meant otherwise than somebody said, or than they are without a word.
    pub(crate) fn ask(&self, path: &str, table: &Table, pad: &SimulatedPad<'_>) -> Result<(), Failure> {
        match refusal(table, pad).filter(|_| !self.are_said()) {
            Some(why) => Err(Failure::Unusable(format!("{path}: {why}"))),
            None => Ok(()),
        }
    }
}
