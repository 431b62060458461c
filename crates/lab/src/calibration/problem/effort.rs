//! Stopping rule of the search for a posterior's maximum: the evidence of many settings is compared, and most of them are far from the best.

/// Upper bound of the gain in log evidence by all further Gauss-Newton steps together, in multiples of the present step's gain.
const REMAINING_STEPS_MAX: f64 = 5.0;

/// Tolerances at which a fit stops, in natural log units of evidence.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Effort {
    /// A step that changes the log evidence by less is the last.
    pub(crate) tolerance: f64,
    /// A fit that will not come to this log evidence breaks off: its maximum is asked by nobody.
    pub(crate) least: f64,
}

impl Effort {
    /// To the maximum.
    pub(crate) const FULL: Self = Self { tolerance: 0.3, least: f64::NEG_INFINITY };
    /// Near enough to choose among settings that differ by more.
    pub(crate) const COARSE: Self = Self { tolerance: 3.0, ..Self::FULL };

    /// Whether the step with this `gain` is the last: gain < tolerance, or log evidence + [`REMAINING_STEPS_MAX`] · gain < least.
    pub(crate) fn is_enough(self, log_evidence: f64, gain: f64) -> bool {
        gain < self.tolerance || log_evidence + REMAINING_STEPS_MAX * gain < self.least
    }
}
