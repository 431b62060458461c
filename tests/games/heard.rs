//! What a recording of a segment came to: labels by the pad's clock, and mis-presses.

use std::fs::File;
use std::io::BufReader;
use std::path::Path;

use firmware_proto::frame::Message;
use firmware_proto::link::MessageReceiver;
use tactpad::lab::tuning::labels::Labels;
use tactpad::lab::tuning::scoring::{AFTER_US, Score};
use tactpad::lab::tuning::trace::Tracer;
use tactpad::pipeline::call::Call;
use tactpad::pipeline::capture::reader::CaptureReader;
use tactpad::pipeline::mapping::profile::Profile;

use crate::segment::Segment;

fn open(capture: &Path) -> CaptureReader<BufReader<File>> {
    CaptureReader::new(BufReader::new(File::open(capture).unwrap())).unwrap()
}

/// The table for `tune` of a segment that began at `begun_us` by the pad's clock.
pub(crate) fn labels(capture: &Path, segment: &Segment, begun_us: u64) -> String {
    segment.labels(begun_us - first_sample_us(capture))
}

/// What a recording came to with a profile.
pub(crate) struct Heard {
    /// Things meant that did not come down as they were meant, and things that came down unasked; none where nothing was meant.
    pub(crate) mispresses: usize,
    /// What went down and up when, in ms since the segment's begin.
    pub(crate) events: Vec<String>,
}

impl Heard {
    /// In a recording of a segment that began at `begun_us` by the pad's clock.
    pub(crate) fn of(capture: &Path, segment: &Segment, begun_us: u64, profile: &Profile) -> Self {
        let mut reader = open(capture);
        let mut tracer = Tracer::new(reader.head().read_decoder().unwrap(), profile.clone());
        while let Some(call) = reader.next_call() {
            let (now, call) = call.unwrap();
            tracer.apply(now, call);
        }
        let trace = tracer.finish();
        let mut events = Vec::new();
        let begin_us = begun_us - first_sample_us(capture);
        trace.play(profile, |event| {
            let at_ms = (event.at.as_us() as f64 - begin_us as f64) * 1e-3;
            events.push(format!("{at_ms:.0} {} {}", event.code, event.value));
        });
        let mut mispresses = 0;
        if segment.means_something() {
            let labels = Labels::read(&labels(capture, segment, begun_us), profile).unwrap();
            let score = Score::of(profile, &trace, &labels, AFTER_US);
            mispresses = labels.labels().len() - score.correct() + score.strays();
        }
        Self { mispresses, events }
    }
}

/// The pad's time of the first sample that was heard.
fn first_sample_us(capture: &Path) -> u64 {
    let mut reader = open(capture);
    let mut receiver = MessageReceiver::new();
    while let Some(call) = reader.next_call() {
        let Call::Bytes(bytes) = call.unwrap().1 else { continue };
        for byte in bytes {
            match receiver.push(*byte) {
                Some(Ok(Message::Sample(sample))) => return sample.time_us,
                Some(Ok(Message::Channels(sample))) => return sample.time_us,
                Some(Ok(Message::Contact(sample))) => return sample.time_us,
                _ => {}
            }
        }
    }
    panic!("nothing was heard")
}
