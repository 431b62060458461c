//! Makes recorded calls on a pipeline. The live bridge makes its own calls through the same function.

use crate::capture::CallRef;
use crate::control::OutputEvent;
use crate::mapping::check::{self, OutputChoice};
use crate::pipeline::{Pipeline, Probe};
use crate::time::HostInstant;

/// Makes one call and hands each group of events to `deliver` as it appears.
///
/// A profile text that cannot be used changes nothing: a capture holds only texts that were in use when it was
/// recorded.
///
/// # Errors
/// What `deliver` returns ends the call.
pub fn make_call<P: Probe, E>(
    pipeline: &mut Pipeline,
    now: HostInstant,
    call: CallRef<'_>,
    probe: &mut P,
    mut deliver: impl FnMut(&[OutputEvent]) -> Result<(), E>,
) -> Result<(), E> {
    match call {
        CallRef::Bytes(bytes) => {
            let mut rest = bytes;
            while !rest.is_empty() {
                let taken = pipeline.handle_bytes(now, rest, probe);
                rest = rest.get(taken..).unwrap_or_default();
                deliver_events(pipeline, &mut deliver)?;
            }
            return Ok(());
        }
        CallRef::Timeout => pipeline.handle_timeout(now),
        CallRef::Unplugged => pipeline.handle_unplugged(now),
        CallRef::Pause => pipeline.pause(now),
        CallRef::Resume => pipeline.resume(),
        CallRef::ReleaseAll => pipeline.release_all(now),
        CallRef::Retare => pipeline.retare(now),
        CallRef::Profile(text) => set_profile(pipeline, now, text, OutputChoice::AsWritten),
        CallRef::KeyboardProfile(text) => set_profile(pipeline, now, text, OutputChoice::Keyboard),
        // A capture begins with it: whoever made the pipeline has read it.
        CallRef::Decoder(_) => return Ok(()),
    }
    deliver_events(pipeline, &mut deliver)
}

fn set_profile(pipeline: &mut Pipeline, now: HostInstant, text: &str, output: OutputChoice) {
    if let (Some(profile), _) = check::read(text, output) {
        pipeline.set_profile(now, profile);
    }
}

fn deliver_events<E>(
    pipeline: &Pipeline,
    deliver: &mut impl FnMut(&[OutputEvent]) -> Result<(), E>,
) -> Result<(), E> {
    if pipeline.events().is_empty() { Ok(()) } else { deliver(pipeline.events()) }
}
