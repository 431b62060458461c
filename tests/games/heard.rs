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

/// Things meant that did not come down as they were meant, and things that came down unasked; none where nothing was meant.
pub(crate) fn mispresses(capture: &Path, segment: &Segment, begun_us: u64, profile: &Profile) -> usize {
    if !segment.means_something() {
        return 0;
    }
    let labels = Labels::read(&labels(capture, segment, begun_us), profile).unwrap();
    let mut reader = open(capture);
    let mut tracer = Tracer::new(reader.head().read_decoder().unwrap(), profile.clone());
    while let Some(call) = reader.next_call() {
        let (now, call) = call.unwrap();
        tracer.apply(now, call);
    }
    let score = Score::of(profile, &tracer.finish(), &labels, AFTER_US);
    labels.labels().len() - score.correct() + score.strays()
}

/// The pad's time of the first sample that was heard.
fn first_sample_us(capture: &Path) -> u64 {
    let mut reader = open(capture);
    let mut receiver = MessageReceiver::new();
    while let Some(call) = reader.next_call() {
        let Call::Bytes(bytes) = call.unwrap().1 else { continue };
        for byte in bytes {
            if let Some(Ok(Message::Sample(sample))) = receiver.push(*byte) {
                return sample.time_us;
            }
        }
    }
    panic!("nothing was heard")
}
