//! What inference asks of a model of channels, and what it is told.

use crate::hypothesis::Hypothesis;
use crate::noise::Noise;
use crate::observations::{Observations, Zeros};

/// A contact's numbers: x, y and the three loads.
pub type Written = [f64; 5];

/// Readings that change together: each channel's, or `None` where nothing changes.
pub type Signature = Vec<Option<Vec<f64>>>;

/// A column of all: its signature, channel by channel.
pub type Column<'c> = &'c [Option<Vec<f64>>];

/// Something that the model gets wrong by a known amount, in all contacts alike.
#[derive(Clone, Debug, PartialEq)]
pub struct CommonError {
    /// Its standard deviation.
    pub deviation: f64,
    /// What one unit of it changes.
    pub signature: Signature,
}

/// Everything about the present point ψ.
#[derive(Clone, Debug, PartialEq)]
pub struct Linearised {
    /// Each channel's readings, row by row.
    pub readings: Vec<Vec<f64>>,
    /// The loads by which the model has come to them, row by row: what it gets wrong goes with these.
    pub loads: Vec<[f64; 3]>,
    /// The same way as the readings, the standard deviation that they have where the model is as far off as it may be and an effect
    /// makes more of that; nothing for channels where none does.
    pub doubts: Vec<Vec<f64>>,
    /// For each hypothesis and each of its parameters, ∂readings/∂ψ.
    pub signatures: Vec<Vec<Signature>>,
}

/// Zero and noise of each channel.
pub struct ChannelBaselines<'t> {
    /// What it reads without load.
    pub zeros: &'t Zeros,
    /// Its noise.
    pub noise: &'t [Noise],
}

/// A model of N channels at the rows of a measurement.
pub trait Model<L>: Sync {
    /// What may be wrong with it.
    fn hypotheses(&self) -> &[Hypothesis<L>];
    /// Each channel's readings, row by row, when hypotheses hold with these coordinates.
    fn readings(&self, applied: &[(usize, Vec<f64>)]) -> Vec<Vec<f64>>;
    /// Each channel's root mean square over the whole measurement, of which these may be some rows.
    fn sizes(&self) -> Vec<f64>;
    /// Each channel's largest reading over the whole measurement; nothing where no effect is a share of it. Studies ask for it.
    fn full_scale(&self) -> Vec<f64> {
        Vec::new()
    }
    /// The readings, and their derivatives by all coordinates.
    fn linearised(&self, applied: &[(usize, Vec<f64>)]) -> Linearised;
    /// The same, by the coordinates of those hypotheses alone: others may be left out, as columns in which nothing changes.
    fn linearised_by_applied(&self, applied: &[(usize, Vec<f64>)]) -> Linearised {
        self.linearised(applied)
    }
    /// What is known of its own errors, when hypotheses hold with these coordinates. Their number and deviations are always the same.
    fn common_errors(&self, applied: &[(usize, Vec<f64>)]) -> Vec<CommonError>;
    /// A channel's further errors, row by row: independent columns of deviation 1 each, which no other channel shares.
    fn stated_errors(&self, _channel: usize) -> &[Vec<f64>] {
        &[]
    }
    /// For each row, the contact that must have been written for these hypotheses to read what was read. None where the model
    /// knows no contacts. Studies ask for it.
    fn contacts(
        &self,
        _applied: &[(usize, Vec<f64>)],
        _told: &ChannelBaselines<'_>,
    ) -> Option<Vec<Option<Written>>> {
        None
    }
    /// The same at other rows, which nobody measured, and what the model gets wrong there. None where it cannot say. Studies ask
    /// for it.
    fn elsewhere(
        &self,
        _rows: &Observations,
        _applied: &[(usize, Vec<f64>)],
    ) -> Option<(Linearised, Vec<CommonError>)> {
        None
    }
}
