//! The report of `tactpad metrology`.

use serde::Serialize;

use tactpad::lab::metrology::dynamics::PadDynamics;
use tactpad::lab::metrology::figures::Figures;
use tactpad::lab::metrology::report::ReportEntry;

/// Everything that the verb finds out.
#[derive(Serialize)]
pub(super) struct MetrologyReport {
    /// Whose figures these are.
    pub(super) statement: String,
    /// None for a measured file.
    pub(super) seeds: Vec<u64>,
    pub(super) rows: Vec<ReportEntry>,
    /// All that was found, by seed.
    pub(super) figures: Vec<Figures>,
    /// The simulated pad's own dynamics; nothing for a measured table or without the simulator.
    pub(super) dynamics: Option<PadDynamics>,
    /// Files of the plots.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub(super) plots: Vec<String>,
}
