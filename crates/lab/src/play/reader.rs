//! From the calls of a recording to windows of its samples.

use firmware_proto::identity::SerialNumber;

use crate::play::windows::{SampleContext, Window, WindowCollector};
use tactpad_core::pipeline::call::Call;
use tactpad_core::pipeline::contact::Decoder;
use tactpad_core::pipeline::mapping::profile::Profile;
use tactpad_core::pipeline::{NoProbe, Phase, Pipeline};
use tactpad_core::time::{HostInstant, StreamInstant};

/// Makes a recording's calls again and gathers its samples.
#[derive(Debug)]
pub struct Reader {
    pipeline: Pipeline,
    /// Of the recording's first sample.
    begin: Option<StreamInstant>,
    samples: u64,
    gatherer: WindowCollector,
}

impl Reader {
    /// One that has heard nothing. By the decoder touches are known, and about where they are: any that fits the pad roughly
    /// will do. Of the profile only the filter matters.
    pub fn new(decoder: Decoder, profile: Profile) -> Self {
        Self::going_on(Pipeline::new(decoder, profile))
    }

    /// One that goes on with a pipeline as it stands.
    pub fn going_on(pipeline: Pipeline) -> Self {
        let samples = pipeline.health().samples;
        Self { pipeline, begin: None, samples, gatherer: WindowCollector::default() }
    }

    /// Makes one call. What the player chose for the game is left out: a paused pad is pressed all the same.
    pub fn apply(&mut self, now: HostInstant, call: Call<'_>) {
        match call {
            Call::Profile(_) | Call::Pause | Call::Resume | Call::Weigh(_) => {}
            // One by one, so that no sample is passed over.
            Call::Bytes(bytes) => bytes.chunks(1).for_each(|byte| self.make(now, Call::Bytes(byte))),
            other => self.make(now, other),
        }
    }

    /// Seconds since the first sample, on the pad's clock.
    pub fn now_s(&self) -> f64 {
        self.begin.map_or(0.0, |begin| 1e-6 * self.pipeline.at().us_since(begin) as f64)
    }

    /// The windows so far that nothing is added to any more.
    pub fn windows(&self) -> &[Window] {
        self.gatherer.windows()
    }

    /// What stands in the way of windows, if anything does.
    pub fn phase(&self) -> Phase {
        self.pipeline.phase()
    }

    /// Takes out the windows that nothing is added to any more.
    pub fn take(&mut self) -> Vec<Window> {
        self.gatherer.take()
    }

    /// The pad that was played on, once it has told who it is.
    pub fn serial_number(&self) -> Option<SerialNumber> {
        self.pipeline.identity().map(|identity| identity.serial_number)
    }

    /// The windows, in order of time since the first sample.
    pub fn finish(self) -> Vec<Window> {
        self.gatherer.finish()
    }

    fn make(&mut self, now: HostInstant, call: Call<'_>) {
        let mut left = Some(call);
        while let Some(call) = left {
            left = self.pipeline.apply(now, call, &mut NoProbe);
        }
        let samples = self.pipeline.health().samples;
        if samples == self.samples {
            return;
        }
        self.samples = samples;
        self.begin.get_or_insert(self.pipeline.at());
        let seen = match (self.pipeline.phase(), self.pipeline.contact()) {
            (Phase::Playing, Some(contact)) => SampleContext::Contact(*contact),
            (Phase::Playing, None) => SampleContext::Nothing,
            _ => SampleContext::Doubt,
        };
        self.gatherer.push(self.now_s(), self.pipeline.raw_uv(), None, seen);
    }
}
