//! What a diagnosis calls the hypotheses of the inference: an effect, and where it acts.

use crate::diagnosis::data::target::Target;
use crate::effect::Effect;

/// An effect, and where it acts.
pub(crate) type Label = (Effect, Target);

/// A hypothesis that is called so.
pub(crate) type Hypothesis = tactpad_inference::hypothesis::Hypothesis<Label>;

/// A search among such hypotheses.
pub(crate) type Search<'m> = tactpad_inference::search::Search<'m, Label>;
