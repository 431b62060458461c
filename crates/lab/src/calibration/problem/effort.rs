//! How far the maximum of a posterior is sought: the evidence of many settings is compared, and most of them are far from the best.

/// All further steps together gain less than so many times the present one.
const HOPE: f64 = 5.0;

/// How far a fit is carried.
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

    /// Whether a step that gained so much is the last.
    pub(crate) fn is_enough(self, log_evidence: f64, gain: f64) -> bool {
        gain < self.tolerance || log_evidence + HOPE * gain < self.least
    }
}
