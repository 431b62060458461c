//! What measured channels show that anybody's own model gets wrong: the model says what each row should read, and nothing else.
//!
//! The way of the data: a table of predictions goes with the measured one (`rows`); the chain from predictions to readings, with the causes that
//! need no simulation and what somebody's own simulation can vary, is a model of the channels (`sensor`). Everything else is the inference's.

mod derivative;
mod rows;
mod sensor;
mod unfit;

pub use self::derivative::{Derivative, DerivativeError, derivatives};
use self::rows::PredictedRows;
use self::sensor::{Sensor, SensorAt};
pub use self::unfit::PredictionError;
use self::unfit::{BLOCKS_MIN, ROWS_MIN};
use crate::diagnosis::against::{ColumnSelection, unplaced};
use crate::diagnosis::gatekeepers::guarded;
use crate::diagnosis::label::Search;
use crate::diagnosis::report::{Diagnosis, Notice};
use crate::diagnosis::simulation::atlas::chosen;
use crate::diagnosis::{Question, Scope, concluded};
use crate::effect::Effect;
use tactpad_core::counted::counted;
use tactpad_core::tables::measured::sheet::Sheet;
use tactpad_inference::observations::Observations;

/// Holds a measured table against predictions of the same rows: what differs, why, and what the findings gain on locked rows. `model_error` is
/// what the model itself gets wrong, as a share of a channel's root mean square: what is no larger is no finding.
///
/// # Errors
/// The tables are not of the same rows, or have too little in them.
pub fn diagnose(
    measured: &Sheet,
    predicted: &Sheet,
    derivatives: &[Derivative],
    asked: &ColumnSelection<'_>,
    model_error: f64,
) -> Result<Diagnosis, PredictionError> {
    let rows = PredictedRows::of(measured, predicted, asked)?;
    if rows.recording.inputs.len() < ROWS_MIN {
        return Err(PredictionError::Few(rows.recording.inputs.len()));
    }
    for derivative in derivatives {
        derivative.check(&rows.columns.channels, measured.rows())?;
    }
    let no_solution = |error| PredictionError::of(&error, &rows.columns.channels);
    let expected = rows.predictions();
    let rest = rows.rest();
    let mut gate = guarded(&rows.recording.observations, Some(&expected), |effect| asked.asks_for(effect));
    let (rows, unlabelled) = (rows.mended(&gate.observations), rows.recording.unlabelled);
    // Readings are beside rest, and rows of one location or press share their errors.
    let as_modelled = |of: &mut Observations| {
        for (channel, rest) in of.readings.iter_mut().zip(&rest) {
            channel.iter_mut().for_each(|value| *value -= rest);
        }
        of.samples
            .iter_mut()
            .zip(&rows.recording.blocks)
            .for_each(|(sample, block)| sample.block = Some(*block));
    };
    as_modelled(&mut gate.observations);
    gate.unrepaired.iter_mut().for_each(as_modelled);
    let mut blocks = rows.recording.blocks.clone();
    blocks.sort_unstable();
    blocks.dedup();
    if blocks.len() < BLOCKS_MIN {
        return Err(PredictionError::Blocks(blocks.len()));
    }
    if !rows.any_follows(&gate.observations) {
        return Err(PredictionError::Silent);
    }
    let sensor = Sensor::of(&rows, derivatives, asked, model_error).map_err(no_solution)?;
    let all = gate.observations.clone();
    let [open, locked] = all.split().map(|rows| all.picked(&rows));
    let model = SensorAt::new(&sensor, &open);
    let found = chosen(&Search::new(&model, &all, &open)).map_err(no_solution)?;
    let question = Question {
        individual: &[Effect::ChannelOffset],
        missing: sensor.missing(),
        without: asked.without,
        scope: Scope::Full,
    };
    let mut diagnosis = concluded(gate, [&open, &locked], &model, &found, question).map_err(no_solution)?;
    unplaced(&mut diagnosis, &rows.columns);
    if unlabelled > 0 {
        let detail = format!(
            "{} with a label that is no number; left out; write down all labels of every row",
            counted(unlabelled, "row")
        );
        diagnosis.gatekeepers.insert(0, Notice { check: "missing", channel: None, detail });
    }
    Ok(diagnosis)
}
