//! The inference in the words of a diagnosis: a hypothesis is called by an effect and where it acts.

use crate::diagnosis::data::target::Target;
use crate::effect::Effect;
use tactpad_inference::error::InferenceError;
use tactpad_inference::model::Model;
use tactpad_inference::observations::Observations;

/// An effect, and where it acts.
pub(crate) type Label = (Effect, Target);

/// A hypothesis that is called so.
pub(crate) type Hypothesis = tactpad_inference::hypothesis::Hypothesis<Label>;

/// A search among such hypotheses.
pub(crate) type Search<'m> = tactpad_inference::search::Search<'m, Label>;

/// A model that can be had at other rows.
pub(crate) trait ModelOfRows: Model<Label> {
    /// At some of the same measurement's rows.
    fn at<'o>(&'o self, rows: &'o Observations) -> Box<dyn Model<Label> + 'o>;
    /// At `rows` of `all`, which are the measurement before its faults were mended.
    fn at_measured<'o>(&'o self, all: &'o Observations, rows: &'o Observations)
    -> Box<dyn Model<Label> + 'o>;
}

/// Why nothing can be told by readings, where channels have these names.
pub(super) fn no_solution<S: AsRef<str>>(error: &InferenceError, channels: &[S]) -> String {
    let why = if error.is_finite { "have no noise at all" } else { "hold numbers too large to be readings" };
    format!("these readings {why}: {}", error.told(channels))
}
