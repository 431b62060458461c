//! What there is to see of a bridge at one moment.

use crate::changes::ChangesSlot;
use crate::driver::Driver;
use crate::keeper::Keeper;
use crate::offer::Standing;
use crate::snapshot::{BridgeHealth, Snapshot, Status, Uncertainty};
use crate::state::State;
use crate::weighing::WeighingStatus;
use tactpad_core::time::HostInstant;

/// What it is doing.
pub(super) fn state(driver: &Driver, keeper: &Keeper) -> State {
    State::of(&driver.pipeline, keeper.absence())
}

/// The decoder, as people know it.
pub(super) struct Known {
    /// What they call it.
    pub(super) name: String,
    /// Where it was read.
    pub(super) place: Option<String>,
    /// What play shows of changes in the pad since it was made.
    pub(super) changes: ChangesSlot,
}

/// All that there is to see at `now`.
pub(super) fn look(
    now: HostInstant,
    driver: &Driver,
    keeper: &Keeper,
    (decoder, standing): (&Known, &Standing),
) -> Snapshot {
    let Driver { pipeline, sink, .. } = driver;
    let pad = pipeline.identity().map(|identity| identity.serial_number);
    let status = Status {
        state: state(driver, keeper),
        pad,
        profile: pipeline.profile().name.clone(),
        layer: pipeline.layer().map(str::to_owned),
        profile_reason: standing.reason.clone(),
        profile_error: standing.error.clone(),
        preview: standing.is_preview,
        decoder: decoder.name.clone(),
        output: sink.describe(),
        contact: pipeline.contact().copied(),
        held: pipeline.held().collect(),
        warning: pipeline.warning(),
        presses: pipeline.presses(),
        health: BridgeHealth { pipeline: *pipeline.health(), drops: driver.drops() },
        latency_us: driver.latency().percentiles(),
        decoder_file: decoder.place.clone(),
        gain: pipeline.gain(),
        weighing: pipeline.weighing().map(WeighingStatus::of),
        changes: decoder.changes.of(pad),
    };
    let uncertainty = pipeline.estimate().as_ref().map(Uncertainty::of);
    Snapshot { at: now, status, channels_uv: pipeline.strain().map(|strain| strain.uv), uncertainty }
}
