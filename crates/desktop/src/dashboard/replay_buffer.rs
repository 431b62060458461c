//! The last minute of play: a pipeline as it stood then, and the calls since.

use std::collections::VecDeque;

use tactpad_core::pipeline::call::OwnedCall;
use tactpad_core::pipeline::{NoProbe, Pipeline};
use tactpad_core::time::HostInstant;

/// So much is kept, …
const KEPT_US: u64 = 60_000_000;

/// … but no more bytes of the pad than these: a minute at 8 kHz.
const BYTES_MAX: usize = 20 << 20;

/// The calls of the last minute, and the pipeline on which the first of them was made.
#[derive(Clone, Debug)]
pub(super) struct ReplayBuffer {
    pub(super) begin: Pipeline,
    pub(super) calls: VecDeque<(HostInstant, OwnedCall)>,
    bytes: usize,
}

impl ReplayBuffer {
    /// Nothing was called yet.
    pub(super) const fn new(begin: Pipeline) -> Self {
        Self { begin, calls: VecDeque::new(), bytes: 0 }
    }

    /// Adds a call. Those that are too old are made on the pipeline, and forgotten.
    pub(super) fn push(&mut self, at: HostInstant, call: OwnedCall) {
        self.bytes += length(&call);
        self.calls.push_back((at, call));
        while self.is_too_long(at)
            && let Some((at, call)) = self.calls.pop_front()
        {
            self.bytes -= length(&call);
            make(&mut self.begin, at, &call, |_| ());
        }
        self.begin.forget_verdicts();
    }

    fn is_too_long(&self, now: HostInstant) -> bool {
        let is_old = self.calls.front().is_some_and(|(at, _)| now.us_since(*at) > KEPT_US);
        is_old || self.bytes > BYTES_MAX
    }

    /// How long it lasts, in microseconds.
    pub(super) fn duration_us(&self) -> u64 {
        match (self.calls.front(), self.calls.back()) {
            (Some((first, _)), Some((last, _))) => last.us_since(*first),
            _ => 0,
        }
    }
}

/// Makes one call whole; `see` looks at the pipeline after each part.
pub(super) fn make(
    pipeline: &mut Pipeline,
    at: HostInstant,
    call: &OwnedCall,
    mut see: impl FnMut(&mut Pipeline),
) {
    let mut left = Some(call.as_call());
    while let Some(call) = left {
        left = pipeline.apply(at, call, &mut NoProbe);
        see(pipeline);
    }
}

fn length(call: &OwnedCall) -> usize {
    match call {
        OwnedCall::Bytes(bytes) => bytes.len(),
        OwnedCall::Profile(_) | OwnedCall::Plain(_) => 0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use tactpad_core::pipeline::call::Call;
    use tactpad_core::pipeline::mapping::read::check::{OutputChoice, read};
    use tactpad_core::pipeline::mapping::read::shipped as profiles;
    use tactpad_core::pipeline::{Phase, shipped};

    #[test]
    fn what_is_older_than_a_minute_is_made_and_forgotten() {
        let profile = read(profiles::text("contra").unwrap(), OutputChoice::AsWritten).0.unwrap();
        let mut past = ReplayBuffer::new(Pipeline::new(shipped::decoder(), profile));
        let at = |s: u64| HostInstant::default().plus_us(s * 1_000_000);
        past.push(at(0), Call::Pause.into());
        (1..60).for_each(|s| past.push(at(s), Call::Timeout.into()));
        assert_eq!((past.calls.len(), past.begin.phase()), (60, Phase::Waiting));
        past.push(at(61), Call::Bytes(&[0; 100]).into());
        assert_eq!((past.calls.len(), past.begin.phase()), (60, Phase::Paused));
        assert_eq!((past.bytes, past.duration_us()), (100, 60_000_000));
    }
}
