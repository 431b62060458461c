//! Builds the snapshot of a running bridge.

use crate::changes::ChangesSlot;
use crate::driver::Driver;
use crate::pad_connection::PadConnection;
use crate::profile_update::ProfileStatus;
use crate::snapshot::{BridgeHealth, LineStatus, Snapshot, Status, Uncertainty};
use crate::state::State;
use crate::weighing::WeighingStatus;
use tactpad_core::pipeline::mapping::plain::named;
use tactpad_core::time::HostInstant;

/// The state of the bridge.
pub(super) fn state(driver: &Driver, connection: &PadConnection) -> State {
    State::of(&driver.pipeline, connection.no_pad_reason())
}

/// The decoder in use, as the status shows it.
pub(super) struct DecoderInfo {
    /// Display name.
    pub(super) name: String,
    /// Path of its file, if it was read from one.
    pub(super) place: Option<String>,
    /// Changes in the pad that play shows since the decoder was made.
    pub(super) changes: ChangesSlot,
}

/// The snapshot at host time `now`.
pub(super) fn snapshot(
    now: HostInstant,
    driver: &Driver,
    connection: &PadConnection,
    decoder: &DecoderInfo,
    profile_status: &ProfileStatus,
) -> Snapshot {
    let Driver { pipeline, sink, .. } = driver;
    let labels = named::labels(pipeline.profile());
    let pad = pipeline.identity().map(|identity| identity.serial_number);
    let status = Status {
        state: state(driver, connection),
        pad,
        profile: pipeline.profile().name.clone(),
        layer: pipeline.layer().map(str::to_owned),
        profile_reason: profile_status.reason.clone(),
        profile_error: profile_status.error.clone(),
        preview: profile_status.is_preview,
        decoder: decoder.name.clone(),
        output: sink.describe(),
        contact: pipeline.contact().copied(),
        held: pipeline.held().collect(),
        held_names: pipeline.held().map(|it| named::control(&labels, it.device, it.code, it.value)).collect(),
        warning: pipeline.warning(),
        line: connection.finding().as_ref().or(pipeline.line_finding()).map(LineStatus::of),
        presses: pipeline.presses(),
        health: BridgeHealth { pipeline: *pipeline.health(), drops: driver.drops() },
        latency_us: driver.latency().percentiles(),
        decoder_file: decoder.place.clone(),
        gain: pipeline.gain(),
        weighing: pipeline.weighing().map(WeighingStatus::of),
        changes: decoder.changes.of(pad),
        labels,
    };
    let uncertainty = pipeline.estimate().as_ref().map(Uncertainty::of);
    Snapshot { at: now, status, channels_uv: pipeline.strain().map(|strain| strain.uv), uncertainty }
}
