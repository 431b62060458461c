//! The report of `tactpad layout`.

use serde::Serialize;

use tactpad::lab::layout::published::{AreaRow, PARTS, PublishedPart};
use tactpad::lab::layout::study::{Simulated, SpacingAnswers};

/// Everything that the verb finds out.
#[derive(Serialize)]
pub(super) struct LayoutReport {
    pub(super) seed: u64,
    pub(super) spacing: SpacingAnswers,
    /// Nothing if the radii were given.
    #[serde(flatten)]
    pub(super) simulated: Option<Simulated>,
    pub(super) area_per_channel: Vec<AreaRow>,
    pub(super) parts: [PublishedPart; PARTS.len()],
    pub(super) parts_usd: f64,
}
