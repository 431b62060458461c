//! What somebody's own simulation can vary: a file of effects, and a table of derivatives for each.

use std::collections::BTreeMap;
use std::fmt;

use serde::Deserialize;

use super::unfit::PredictionError;
use crate::effect::{Effect, EffectFamily, OwnEffect};
use tactpad_core::counted::counted;
use tactpad_core::tables::measured::sheet::Sheet;

/// An effect, and the derivative of every channel by its number.
#[derive(Clone, Debug)]
pub struct Derivative {
    pub(super) effect: OwnEffect,
    pub(super) unit: String,
    pub(super) range: [f64; 2],
    /// Standard deviation of the number in any specimen.
    pub(super) prior_deviation: f64,
    pub(super) table: Sheet,
}

impl Derivative {
    /// Whether its table says something of these channels in each of so many rows.
    pub(super) fn check(&self, channels: &[String], rows: usize) -> Result<(), PredictionError> {
        let fault = |why: String| PredictionError::Derivative { name: self.effect.name().to_owned(), why };
        if self.table.rows() != rows {
            let own = self.table.rows();
            return Err(fault(format!(
                "{}, and {rows} were measured: write one for each, in the same order",
                counted(own, "row")
            )));
        }
        let known: Vec<&String> = channels.iter().filter(|name| self.table.numbers(name).is_some()).collect();
        let row_of = |name: &&String| self.table.numbers(name)?.iter().position(|number| !number.is_finite());
        if let Some((name, row)) = known.iter().find_map(|name| Some((*name, row_of(name)?))) {
            return Err(fault(format!(
                "row {}: {name} is no number; write 0 where nothing changes",
                row + 1
            )));
        }
        if known.is_empty() {
            return Err(fault(format!("no column has the name of a channel ({})", channels.join(", "))));
        }
        Ok(())
    }
}

/// A section of the file of effects.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Section {
    unit: String,
    low: f64,
    high: f64,
    prior_deviation: f64,
    family: EffectFamily,
}

/// Why effects cannot be read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum DerivativeError {
    /// The file is none of effects: where and why.
    File(String),
    /// Of an effect's numbers one makes no sense.
    Effect {
        /// The effect.
        name: String,
        /// What is wrong.
        why: &'static str,
    },
}

impl fmt::Display for DerivativeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::File(why) => f.write_str(why),
            Self::Effect { name, why } => write!(f, "[{name}]: {why}"),
        }
    }
}

impl std::error::Error for DerivativeError {}

/// The effects of a file, with the tables that `table` has of them.
///
/// # Errors
/// The text is no file of effects, or a table cannot be had: `E` is what `table` fails by.
pub fn derivatives<E: From<DerivativeError>>(
    text: &str,
    mut table: impl FnMut(&str) -> Result<Sheet, E>,
) -> Result<Vec<Derivative>, E> {
    let sections: BTreeMap<String, Section> =
        toml::from_str(text).map_err(|error| DerivativeError::File(error.to_string().trim().to_owned()))?;
    let mut derivatives = Vec::new();
    for (name, Section { unit, low, high, prior_deviation, family }) in sections {
        let why = if Effect::from_name(&name).is_some() {
            Some("is an effect that needs no simulation; choose another name")
        } else if !(low.is_finite() && high.is_finite() && low <= 0.0 && high >= 0.0 && low < high) {
            Some(
                "low and high are the least and the greatest deviation from your model: low is 0 or less, high 0 or more",
            )
        } else if !(prior_deviation.is_finite() && prior_deviation > 0.0) {
            Some(
                "prior_deviation is how far it lies from your model in any specimen, as a standard deviation: more than 0",
            )
        } else {
            None
        };
        if let Some(why) = why {
            return Err(DerivativeError::Effect { name, why }.into());
        }
        let (effect, table) = (OwnEffect::new(&name, family), table(&name)?);
        derivatives.push(Derivative { effect, unit, range: [low, high], prior_deviation, table });
    }
    Ok(derivatives)
}
