//! Two tables of the same rows: what was measured, and what a model predicts.

use super::unfit::PredictionError;
use crate::diagnosis::against::ColumnSelection;
use crate::diagnosis::against::columns::{Columns, PLANNED, extent, is_known, varies};
use crate::diagnosis::against::recording::Recording;
use tactpad_core::tables::measured::sheet::Sheet;
use tactpad_inference::observations::Observations;
use tactpad_numeric::statistics::correlation;

/// Numbers of two tables that differ by less than this part of their column's range are the same.
const SAME: f64 = 1e-3;
/// So many standard deviations of what chance makes of a correlation.
const FOLLOWS: f64 = 4.0;
/// What stands for places where no label says any: half the extent of what the first two channels should read.
const HALF_SIDE_MM: f64 = 10.0;

/// The rows of both tables.
#[derive(Clone, Debug)]
pub(super) struct PredictedRows {
    pub(super) columns: Columns,
    /// What was measured. Samples have their row's number as block.
    pub(super) recording: Recording,
    /// For each row, what each channel should read.
    predicted: Vec<Vec<f64>>,
}

impl PredictedRows {
    pub(super) fn of(
        measured: &Sheet,
        predicted: &Sheet,
        asked: &ColumnSelection<'_>,
    ) -> Result<Self, PredictionError> {
        if measured.rows() != predicted.rows() {
            let [measured, predicted] = [measured, predicted].map(Sheet::rows);
            return Err(PredictionError::Rows { measured, predicted });
        }
        if let Some(name) = asked.labels.iter().find(|name| measured.numbers(name).is_none()) {
            return Err(PredictionError::NoNumbers { name: name.clone(), which: "the measured table" });
        }
        for name in asked.channels {
            for (sheet, which) in [(measured, "the measured table"), (predicted, "the table of predictions")]
            {
                if sheet.numbers(name).is_none() {
                    return Err(PredictionError::NoNumbers { name: name.clone(), which });
                }
            }
        }
        let both: Vec<String> =
            predicted.numeric().filter(|name| measured.numbers(name).is_some()).map(str::to_owned).collect();
        let is_label =
            |name: &String| is_known(name) || PLANNED.contains(&name.as_str()) || asked.labels.contains(name);
        let channels = if asked.channels.is_empty() {
            let (repeated, channels): (Vec<String>, Vec<String>) = both
                .iter()
                .filter(|name| !is_label(name) && varies(predicted, name))
                .cloned()
                .partition(|name| other_row(measured, predicted, name).is_none());
            // What the predictions repeat of the measured table is a label.
            match channels.is_empty() {
                true if repeated.is_empty() => return Err(PredictionError::Channels),
                true => return Err(PredictionError::Same(repeated.join(", "))),
                false => channels,
            }
        } else {
            asked.channels.to_vec()
        };
        let is_repeated = |name: &&String| other_row(measured, predicted, name).is_none();
        let labels = both.iter().filter(|name| !channels.contains(name));
        let (repeated, others): (Vec<&String>, Vec<&String>) = labels.partition(is_repeated);
        let other = others.into_iter().find(|name| is_label(name));
        if let Some((name, row)) = other.and_then(|name| Some((name, other_row(measured, predicted, name)?)))
        {
            return Err(PredictionError::OtherRow { name: name.clone(), row });
        }
        let labels: Vec<String> = repeated.into_iter().chain(asked.labels).cloned().collect();
        let columns = Columns::beside(channels, measured, &labels);
        let recording = Recording::of(measured, &columns);
        let model = Recording::of(&measured.with_numbers_of(predicted, &columns.channels), &columns);
        let readings = &model.observations.readings;
        if let Some((channel, row)) = (0..readings.len()).find_map(|channel| {
            Some((channel, readings[channel].iter().position(|number| !number.is_finite())?))
        }) {
            let (name, row) = (columns.channels[channel].clone(), model.table_rows[row]);
            return Err(PredictionError::NoPrediction { name, row });
        }
        let of_row = |row: usize| readings.iter().map(|channel| channel[row]).collect();
        let predicted = (0..recording.inputs.len()).map(of_row).collect();
        Ok(Self { columns, recording, predicted }.placed())
    }

    /// What each channel should read, channel by channel.
    pub(super) fn predictions(&self) -> Vec<Vec<f64>> {
        let channels = self.columns.channels.len();
        (0..channels).map(|channel| self.predicted.iter().map(|row| row[channel]).collect()).collect()
    }

    /// Whether any channel goes with its prediction by more than chance.
    pub(super) fn any_follows(&self, observations: &Observations) -> bool {
        let follows = |(channel, predicted): (usize, &Vec<f64>)| {
            let rows =
                observations.readings[channel].iter().zip(predicted).zip(&observations.is_told[channel]);
            let told =
                rows.filter(|(_, is_told)| **is_told).map(|((read, predicted), _)| (*read, *predicted));
            let (read, predicted): (Vec<f64>, Vec<f64>) = told.unzip();
            correlation(&read, &predicted).abs() * (read.len() as f64).sqrt() > FOLLOWS
        };
        self.predictions().iter().enumerate().any(follows)
    }

    /// For each row, what each channel should read beside what it reads at rest.
    pub(super) fn strains(&self) -> Vec<Vec<f64>> {
        let rest = self.rest();
        let beside = |row: &Vec<f64>| row.iter().zip(&rest).map(|(value, rest)| value - rest).collect();
        self.predicted.iter().map(beside).collect()
    }

    /// What checks have mended, which may have put rows in another order.
    pub(super) fn mended(&self, observations: &Observations) -> Self {
        let order = observations.samples.iter().filter_map(|sample| sample.block);
        Self {
            columns: self.columns.clone(),
            recording: self.recording.mended(observations),
            predicted: order.map(|row| self.predicted[row].clone()).collect(),
        }
    }

    /// What each channel should read at rest: that of the row of least load, or of the first one where no load is written.
    pub(super) fn rest(&self) -> Vec<f64> {
        let load =
            |row: &usize| self.recording.observations.samples[*row].load.iter().map(|n| n * n).sum::<f64>();
        let rows = 0..self.recording.inputs.len();
        let least = rows.min_by(|one, other| load(one).total_cmp(&load(other)));
        least.map_or_else(Vec::new, |row| self.predicted[row].clone())
    }

    /// Each label's least and greatest value.
    pub(super) fn extents(&self) -> Vec<[f64; 2]> {
        let inputs = &self.recording.inputs;
        (0..self.columns.inputs.len()).map(|at| extent(inputs.iter().map(|row| row[at]))).collect()
    }

    /// With places and loads as the inference takes them.
    fn placed(mut self) -> Self {
        let extents = self.extents();
        self.recording.placed(&self.columns, &extents);
        if self.columns.inputs.is_empty() {
            let channels = self.predictions();
            for (axis, channel) in channels.iter().take(2).enumerate() {
                let [low, high] = extent(channel.iter().copied());
                let width = (high - low).max(f64::MIN_POSITIVE);
                for (sample, value) in self.recording.observations.samples.iter_mut().zip(channel) {
                    sample.place_mm[axis] = HALF_SIDE_MM * (2.0 * value - low - high) / width;
                }
            }
        }
        self
    }
}

/// The first row in which a column of both tables differs.
fn other_row(measured: &Sheet, predicted: &Sheet, name: &str) -> Option<usize> {
    let [one, other] = [measured, predicted].map(|sheet| sheet.numbers(name).unwrap_or_default());
    let [low, high] = extent(one.iter().copied().filter(|it| it.is_finite()));
    let differs = |(one, other): (&f64, &f64)| (one - other).abs() > SAME * (high - low);
    one.iter().zip(other).position(differs)
}
