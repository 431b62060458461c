//! Why an inference ends without an answer.

use std::fmt;

use tactpad_numeric::dense::Matrix;
use tactpad_numeric::linear::LargeFactor;

/// What was being computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// Weights of the rows, beside the errors that the model states.
    StatedErrors,
    /// Each channel's noise.
    Noise,
    /// The process of the smooth background.
    Process,
    /// The smooth background of a channel.
    Background,
    /// The causes that are fitted, with the zeros.
    Causes,
    /// Readings as a function of labels.
    Regression,
}

impl fmt::Display for Stage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::StatedErrors => "the weights of the rows",
            Self::Noise => "the noise",
            Self::Process => "the process of the background",
            Self::Background => "the background",
            Self::Causes => "the fit of the causes",
            Self::Regression => "the regression on the labels",
        })
    }
}

/// A matrix that must be positive definite is not.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct InferenceError {
    /// What was being computed.
    pub stage: Stage,
    /// In which channel; none where it is all of them.
    pub channel: Option<usize>,
    /// Whether all numbers in it are finite.
    pub is_finite: bool,
}

impl InferenceError {
    /// The same, as of a channel.
    #[must_use]
    pub fn in_channel(self, channel: usize) -> Self {
        Self { channel: self.channel.or(Some(channel)), ..self }
    }

    /// What could not be computed, and why, where channels have these names.
    pub fn told<S: AsRef<str>>(&self, channels: &[S]) -> String {
        let of = self.channel.and_then(|at| channels.get(at));
        let of = of.map(|name| format!(" of channel {}", name.as_ref())).unwrap_or_default();
        let why = if self.is_finite { "the equations are not independent" } else { "numbers are not finite" };
        format!("{}{of} cannot be computed, as {why}", self.stage)
    }
}

/// Cholesky's factor of a symmetric matrix.
///
/// # Errors
/// It is not positive definite.
pub(crate) fn factorised(matrix: &Matrix, stage: Stage) -> Result<LargeFactor, InferenceError> {
    matrix.factorised().ok_or_else(|| InferenceError { stage, channel: None, is_finite: matrix.is_finite() })
}
