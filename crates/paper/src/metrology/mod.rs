//! The paper's figures of merit, found in a table of measured contacts.
//!
//! Each figure looks for the rows that it can be made from by what they hold, never by the name of a session
//! or trial, so it is found in any file that has such rows. Where they are missing it says what it needs.
//! `docs/metrology.md` defines every figure.
//!
//! Source: Wu et al., *Sensors* 2026, 26(4), 1378, sections 2.4 and 3.1, Tables 3 and 4, Figures 4 and 8–10.

pub mod ageing;
pub mod bench;
pub mod conflicts;
pub mod decoded;
pub mod decoders;
pub mod drawing;
pub mod dynamics;
pub mod fem;
pub mod figures;
pub mod holding;
pub mod hysteresis;
pub mod lines;
pub mod location;
pub mod procedures;
pub mod repeatability;
pub mod report;
pub mod resolution;
pub mod response;
pub mod sensitivity;
pub mod table3;
pub mod thermal;

mod filter;
mod fixture;
mod output;
mod rows;
mod same;
mod series;

use std::fmt;

use serde::{Serialize, Serializer};

use tactpad_core::quantity::{CHANNELS, Contact};

/// The paper's full-scale output (FSO).
pub const FULL_SCALE_N: f64 = 5.0;

/// A decoder: contact from the nine channels in µV, of which the unloaded channels' readings were taken off.
pub type Decode<'d> = &'d dyn Fn(&[f64; CHANNELS]) -> Contact;

/// Why a figure is not found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Needs {
    /// The rows lack something: what, as the object of "needs".
    Rows(&'static str),
    /// Only a decoder gives it.
    Decoder,
    /// Only the paper's network, trained on the simulation alone, gives it.
    SimulationNetwork,
}

impl fmt::Display for Needs {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Rows(what) => write!(f, "needs {what}"),
            Self::Decoder => f.write_str("needs a decoder"),
            Self::SimulationNetwork => f.write_str("needs the network trained on the simulation alone"),
        }
    }
}

impl std::error::Error for Needs {}

impl Serialize for Needs {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}
