//! The contacts of a recording over time, and what a profile makes of them.

use tactpad_core::pipeline::call::Call;
use tactpad_core::pipeline::contact::Decoder;
use tactpad_core::pipeline::control::OutputEvent;
use tactpad_core::pipeline::mapping::live::engine::Engine;
use tactpad_core::pipeline::mapping::profile::Profile;
use tactpad_core::pipeline::output::ledger::{Edges, Ledger};
use tactpad_core::pipeline::{NoProbe, Phase, Pipeline};
use tactpad_core::quantity::Contact;
use tactpad_core::time::{HostInstant, StreamInstant};

/// Events of a sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TraceEvents {
    /// A touch.
    Contact(Contact),
    /// Nothing on the pad.
    Nothing,
    /// Nothing that can be believed: what was held is released, what was under way is forgotten.
    Doubt,
}

/// A sample of a recording.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TracePoint {
    /// Since the recording's first sample, by the pad's clock.
    pub at: StreamInstant,
    /// What it showed.
    pub heard: TraceEvents,
}

/// A recording as far as a mapping sees it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Trace {
    moments: Vec<TracePoint>,
}

impl Trace {
    /// Of these samples, which must be in order of time.
    pub const fn new(moments: Vec<TracePoint>) -> Self {
        Self { moments }
    }

    /// The samples, in order of time.
    pub fn moments(&self) -> &[TracePoint] {
        &self.moments
    }

    /// How long it lasts.
    pub fn duration_us(&self) -> u64 {
        self.moments.last().map_or(0, |moment| moment.at.as_us())
    }

    /// From one sample to the next, mostly; 0 without samples.
    pub fn period_us(&self) -> u64 {
        let mut steps: Vec<u64> =
            self.moments.windows(2).map(|pair| pair[1].at.us_since(pair[0].at)).collect();
        let middle = steps.len() / 2;
        steps.sort_unstable();
        steps.get(middle).copied().unwrap_or_default()
    }

    /// The samples from one time to another, without the second.
    #[must_use]
    pub fn between(&self, from_us: u64, to_us: u64) -> Self {
        let index = |us: u64| self.moments.partition_point(|moment| moment.at.as_us() < us);
        let range = index(from_us)..index(to_us).max(index(from_us));
        Self { moments: self.moments.get(range).unwrap_or_default().to_vec() }
    }

    /// The same with fewer samples: none follows another within `period_us`, but where a touch begins or ends.
    #[must_use]
    pub fn thinned(&self, period_us: u64) -> Self {
        let mut moments: Vec<TracePoint> = Vec::new();
        for moment in &self.moments {
            let is_new = moments.last().is_none_or(|last| {
                let turns = std::mem::discriminant(&last.heard) != std::mem::discriminant(&moment.heard);
                turns || moment.at.us_since(last.at) >= period_us
            });
            if is_new {
                moments.push(*moment);
            }
        }
        Self { moments }
    }

    /// Plays it with a profile and hands on the events, in order of time. At the end the touch is lifted.
    pub fn play(&self, profile: &Profile, mut see: impl FnMut(&OutputEvent)) {
        let (mut engine, mut ledger) = (Engine::new(profile.clone()), Ledger::new(profile));
        let mut edges = Edges::new();
        let end = self.moments.last().map(|last| TracePoint { heard: TraceEvents::Nothing, ..*last });
        // A tap is stated once; the step behind the lift tells that it is over.
        for moment in self.moments.iter().chain(&end).chain(&end) {
            settle(&mut ledger, moment.at, &mut see);
            edges.clear();
            match &moment.heard {
                TraceEvents::Contact(contact) => {
                    ledger.update(moment.at, &engine.step(moment.at, Some(contact)), &mut edges);
                }
                TraceEvents::Nothing => ledger.update(moment.at, &engine.step(moment.at, None), &mut edges),
                TraceEvents::Doubt => {
                    engine.cancel();
                    ledger.release_all(moment.at, &mut edges);
                }
            }
            edges.iter().for_each(&mut see);
        }
        settle(&mut ledger, StreamInstant::from_us(u64::MAX), &mut see);
    }
}

/// Hands on what the minimum press held back and is due before `until`.
fn settle(ledger: &mut Ledger, until: StreamInstant, see: &mut impl FnMut(&OutputEvent)) {
    while let Some(due) = ledger.next_due().filter(|&due| due < until) {
        let mut edges = Edges::new();
        ledger.settle(due, &mut edges);
        edges.iter().for_each(&mut *see);
    }
}

/// Makes a recording's calls again and keeps the contacts.
#[derive(Debug)]
pub struct Tracer {
    pipeline: Pipeline,
    /// Of the recording's first sample.
    begin: Option<StreamInstant>,
    samples: u64,
    moments: Vec<TracePoint>,
}

impl Tracer {
    /// One that has heard nothing. Of the profile only the filter matters.
    pub fn new(decoder: Decoder, profile: Profile) -> Self {
        Self { pipeline: Pipeline::new(decoder, profile), begin: None, samples: 0, moments: Vec::new() }
    }

    /// One that goes on from a pipeline that has heard something.
    pub fn going_on(pipeline: Pipeline) -> Self {
        let samples = pipeline.health().samples;
        Self { pipeline, begin: None, samples, moments: Vec::new() }
    }

    /// Makes one call. A change of the profile is left out: the question is what another one makes of the contacts.
    pub fn apply(&mut self, now: HostInstant, call: Call<'_>) {
        match call {
            Call::Profile(_) => {}
            // One by one, so that no sample is passed over.
            Call::Bytes(bytes) => bytes.chunks(1).for_each(|byte| self.make(now, Call::Bytes(byte))),
            other => self.make(now, other),
        }
    }

    /// What was heard.
    pub fn finish(self) -> Trace {
        Trace { moments: self.moments }
    }

    fn make(&mut self, now: HostInstant, call: Call<'_>) {
        let mut left = Some(call);
        while let Some(call) = left {
            left = self.pipeline.apply(now, call, &mut NoProbe);
        }
        let heard = match (self.pipeline.phase(), self.pipeline.contact()) {
            (Phase::Playing, Some(contact)) => TraceEvents::Contact(*contact),
            (Phase::Playing, None) => TraceEvents::Nothing,
            _ => TraceEvents::Doubt,
        };
        let samples = self.pipeline.health().samples;
        if samples > self.samples {
            self.begin.get_or_insert(self.pipeline.at());
        }
        let is_new = match heard {
            // It is told by whatever brings it, and once.
            TraceEvents::Doubt => self.moments.last().is_some_and(|last| last.heard != TraceEvents::Doubt),
            TraceEvents::Contact(_) | TraceEvents::Nothing => samples > self.samples,
        };
        self.samples = samples;
        if let Some(begin) = self.begin.filter(|_| is_new) {
            let at = StreamInstant::from_us(self.pipeline.at().us_since(begin));
            self.moments.push(TracePoint { at, heard });
        }
    }
}
