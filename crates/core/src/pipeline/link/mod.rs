//! From bytes to samples in order, on one monotonic clock.
//!
//! Frames are unpacked by `firmware_proto`; here their sequence numbers and timestamps are checked, and the pad's
//! clock becomes stream time. Nothing is repaired: what is missing or doubtful is told as a [`Fault`].

mod clock;
mod order;
pub mod reading;

use firmware_proto::frame::{Message, WireError};
use firmware_proto::identity::Identity;
use firmware_proto::link::MessageReceiver;

use crate::pipeline::health::Health;
use crate::pipeline::line_check::{Arrival, LineCheck, LineFinding};
use crate::time::{HostInstant, StreamInstant};
use clock::StreamClock;
use order::{OtherRun, Run, SequenceStep};
use reading::Reading;
pub use reading::SILENCE_MAX_US;

/// A pad of which nothing at all came for so long is not slow.
const QUIET_US: u64 = 1_000_000;

/// Frames may be missing between two samples this close: nobody lifts a finger and presses again in so short a time, and what is
/// pressed meanwhile shows in the next sample. With one frame in 40 damaged, 15 presses stay 15; where each gap ended a contact they
/// became 40. It is two periods of the slowest pad: one frame may be missing there, too.
pub const BRIDGED_GAP_US: u64 = 20_000;

/// A line that brings sound frames of a newer version and, for so long, nothing that is understood is a newer pad's. A single
/// such frame is not: one damaged frame in 65,536 has a checksum that is right.
pub const NEWER_US: u64 = 2_000_000;

/// Something about the link that makes the present contact untrustworthy.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Fault {
    /// So many frames are missing before this one that a finger could have come or gone.
    Lost,
    /// A frame came again, or is of another time; it was dropped.
    Repeated,
    /// The pad's clock jumped.
    TimeJump,
    /// The pad began anew: its offsets may be different. It says so, or several frames go on from one another and not from the last
    /// sample.
    Restarted,
}

/// What the link has to say after a byte.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LinkEvent {
    /// A sample at its stream time; a fault tells what happened on the way to it.
    Sample {
        /// Stream time of the sample; never earlier than the one before.
        at: StreamInstant,
        /// What the pad sent.
        reading: Reading,
        /// What was wrong between the last sample and this one.
        fault: Option<Fault>,
    },
    /// A frame that brought no sample but ends the contact.
    Fault(Fault),
    /// The pad told who it is.
    Identity(Identity),
    /// Sound frames of a protocol version newer than ours, and nothing else for [`NEWER_US`].
    NewerVersion(u8),
}

/// The receiving end of a pad's byte stream.
#[derive(Clone, Debug)]
pub struct Link {
    receiver: MessageReceiver,
    /// What was heard of the pad that is there; nothing of one that was unplugged.
    run: Option<Run>,
    is_silent: bool,
    /// Frames that came since the last sample and do not go on from it.
    other: Option<OtherRun>,
    clock: StreamClock,
    check: LineCheck,
    /// The first and the last of the frames of a newer version since something was understood.
    newer: Option<[HostInstant; 2]>,
}

impl Default for Link {
    fn default() -> Self {
        Self::new()
    }
}

impl Link {
    /// A link that has heard nothing yet.
    pub fn new() -> Self {
        Self {
            receiver: MessageReceiver::new(),
            run: None,
            is_silent: false,
            other: None,
            clock: StreamClock::new(),
            check: LineCheck::new(),
            newer: None,
        }
    }

    /// Takes one byte that came at `now`; counts what is wrong in `health`.
    pub fn push(&mut self, now: HostInstant, byte: u8, health: &mut Health) -> Option<LinkEvent> {
        let message = self.receiver.push(byte)?;
        if message.is_ok() {
            self.newer = None;
        }
        match message {
            Ok(Message::Sample(sample)) => Some(self.order(now, sample.into(), health)),
            Ok(Message::Channels(sample)) => Some(self.order(now, sample.into(), health)),
            Ok(Message::Contact(sample)) => Some(self.order(now, sample.into(), health)),
            Ok(Message::Identity(identity)) => Some(LinkEvent::Identity(identity)),
            Ok(Message::Acknowledgement { .. }) => None,
            Err(WireError::NewerVersion(version)) => {
                health.frames_newer += 1;
                self.speaks_newer(now).then_some(LinkEvent::NewerVersion(version))
            }
            Err(WireError::UnknownKind(_)) => {
                health.frames_unknown += 1;
                None
            }
            Err(WireError::Damaged | WireError::TooLong) => {
                // What it leaves out shows in the next sample, or in silence.
                health.frames_damaged += 1;
                None
            }
        }
    }

    /// Stream time at host time `now`: the last sample's, advanced by the host's clock since. As long as a pad does not count as
    /// silent its next samples may be waiting on the line, however late it is: stream time does not run away from them.
    pub fn stream_at(&self, now: HostInstant) -> StreamInstant {
        self.clock.at(self.silent_at().map_or(now, |silent_at| now.min(silent_at)))
    }

    /// Host time at which stream time reaches `at` if no sample comes before.
    pub fn host_at(&self, at: StreamInstant) -> HostInstant {
        self.clock.heard.plus_us(at.us_since(self.clock.last))
    }

    /// When the link counts as lost if no sample comes before; `None` while nothing is to be lost.
    pub fn silent_at(&self) -> Option<HostInstant> {
        let is_heard = self.run.is_some() && !self.is_silent;
        is_heard.then(|| self.clock.heard.plus_us(SILENCE_MAX_US))
    }

    /// The pad fell silent. Half a frame is forgotten. What comes next is of the same pad, which may have begun anew.
    pub fn fall_silent(&mut self, now: HostInstant) {
        self.is_silent = true;
        self.clock.advance(now);
        self.receiver = MessageReceiver::new();
    }

    /// The pad was unplugged: whatever comes next begins anew.
    pub fn unplug(&mut self, now: HostInstant) {
        self.fall_silent(now);
        (self.run, self.other) = (None, None);
        self.check.forget();
    }

    /// Takes a frame of a newer version; whether the line has brought nothing but such for long.
    fn speaks_newer(&mut self, now: HostInstant) -> bool {
        // After a pause it may be another pad's line.
        let [first, last] = self.newer.unwrap_or([now; 2]);
        let first = if now.us_since(last) < NEWER_US { first } else { now };
        self.newer = Some([first, now]);
        now.us_since(first) >= NEWER_US
    }

    /// Whether no sample has come for a second, not even one that cannot be used.
    pub fn is_quiet(&self, now: HostInstant) -> bool {
        self.check.heard().is_none_or(|heard| now.us_since(heard) > QUIET_US)
    }

    /// What is wrong with the stream as a whole, if anything is.
    pub const fn finding(&self) -> Option<&LineFinding> {
        self.check.finding()
    }

    fn order(&mut self, now: HostInstant, reading: Reading, health: &mut Health) -> LinkEvent {
        let before = *health;
        let delay_us = self.run.as_ref().map_or(0, |run| run.delay_us(now, &reading));
        let event = self.ordered(now, reading, health);
        let is_next = matches!(event, LinkEvent::Sample { .. });
        let arrival = Arrival {
            lost: u32::try_from(health.frames_lost - before.frames_lost).unwrap_or(u32::MAX),
            // A number that begins again may be all of it, or a pace that is in doubt.
            breaks: is_next
                && self.clock.has_jumped
                && (health.time_jumps, health.restarts) != (before.time_jumps, before.restarts),
            delay_us: is_next.then_some(delay_us),
        };
        self.check.sample(now, &reading, arrival);
        event
    }

    fn ordered(&mut self, now: HostInstant, reading: Reading, health: &mut Health) -> LinkEvent {
        let fault = match self.step(now, &reading) {
            SequenceStep::Next => None,
            SequenceStep::Again => {
                health.frames_repeated += 1;
                return LinkEvent::Fault(Fault::Repeated);
            }
            SequenceStep::Skipped(frames) => {
                health.frames_lost += u64::from(frames);
                let since = |run: &Run| reading.time_us.wrapping_sub(run.last.time_us);
                let gap_us = self.run.as_ref().map_or(u64::MAX, since);
                (gap_us > BRIDGED_GAP_US || now.us_since(self.clock.heard) > BRIDGED_GAP_US)
                    .then_some(Fault::Lost)
            }
            SequenceStep::Apart => {
                let run = OtherRun::with(self.other, &reading);
                if !run.is_believed() {
                    self.other = Some(run);
                    health.frames_repeated += 1;
                    return LinkEvent::Fault(Fault::Repeated);
                }
                // They were none that came again.
                health.frames_repeated -= u64::from(run.frames - 1);
                health.restarts += 1;
                Some(Fault::Restarted)
            }
            SequenceStep::Anew => {
                health.restarts += 1;
                Some(Fault::Restarted)
            }
        };
        let goes_on = fault != Some(Fault::Restarted);
        let run = self.run.as_ref().filter(|_| goes_on);
        let delay_us = run.map_or(0, |run| run.delay_us(now, &reading));
        let smooth = self.clock.accept(now, reading.time_us, delay_us, run.is_some() && !self.is_silent);
        match &mut self.run {
            Some(run) if goes_on => run.take(now, &reading),
            _ => self.run = Some(Run::beginning(now, &reading)),
        }
        (self.is_silent, self.other) = (false, None);
        let fault = if smooth { fault } else { jumped(fault, health) };
        LinkEvent::Sample { at: self.clock.last, reading, fault }
    }

    /// How this sample follows what was heard last. If it goes on both from that and from frames that came since, it is of these: a pad
    /// that began anew as soon as it had begun.
    fn step(&self, now: HostInstant, reading: &Reading) -> SequenceStep {
        let is_of_other = self.other.is_some_and(|other| other.is_followed_by(reading));
        match &self.run {
            Some(run) if self.is_silent => match run.step_over_silence(now, reading) {
                SequenceStep::Next if self.other.is_some_and(|other| other.is_many()) => SequenceStep::Anew,
                step => step,
            },
            Some(run) => match run.step(now, reading) {
                SequenceStep::Next | SequenceStep::Skipped(_) if is_of_other => SequenceStep::Apart,
                step => step,
            },
            None if self.clock.set && reading.status.restarted() => SequenceStep::Anew,
            None => SequenceStep::Next,
        }
    }
}

/// A jump of the clock is told unless a graver fault explains it.
fn jumped(fault: Option<Fault>, health: &mut Health) -> Option<Fault> {
    health.time_jumps += 1;
    fault.or(Some(Fault::TimeJump))
}

#[cfg(test)]
mod tests {
    use firmware_proto::link::encode_message;
    use firmware_proto::sample::{Sample, Status};
    use firmware_proto::{CHANNELS, ENCODED_MAX};

    use super::clock::DEVICE_TIME_MAX_US;
    use super::*;

    fn sample(sequence: u32, time_us: u64) -> Sample {
        Sample { sequence, time_us, counts: [0; CHANNELS], temperature_centi_c: 2_000, status: Status::OK }
    }

    /// A link under test; frames arrive at the host times that the test gives.
    struct Rig {
        link: Link,
        health: Health,
    }

    impl Rig {
        fn new() -> Self {
            Self { link: Link::new(), health: Health::default() }
        }

        fn bytes(&mut self, host_us: u64, bytes: &[u8]) -> Vec<LinkEvent> {
            let now = HostInstant::default().plus_us(host_us);
            bytes.iter().filter_map(|&byte| self.link.push(now, byte, &mut self.health)).collect()
        }

        /// Stream time and fault of one sample that arrives whole.
        fn hear(&mut self, host_us: u64, sample: Sample) -> (Option<u64>, Option<Fault>) {
            match self.bytes(host_us, &frame(sample))[..] {
                [LinkEvent::Sample { at, fault, .. }] => (Some(at.as_us()), fault),
                [LinkEvent::Fault(fault)] => (None, Some(fault)),
                ref events => panic!("{events:?}"),
            }
        }
    }

    fn frame(sample: Sample) -> Vec<u8> {
        let mut frame = [0; ENCODED_MAX];
        let length = encode_message(&Message::Sample(sample), &mut frame);
        frame[..length].to_vec()
    }

    #[test]
    fn stream_time_is_the_pads_clock() {
        let mut rig = Rig::new();
        assert_eq!(rig.hear(1, sample(7, 5_000_000)), (Some(5_000_000), None));
        assert_eq!(rig.hear(900, sample(8, 5_001_000)), (Some(5_001_000), None));
        assert_eq!(rig.health, Health::default());
    }

    #[test]
    fn missing_frames_are_counted_and_told() {
        let mut rig = Rig::new();
        rig.hear(0, sample(u32::MAX - 1, 0));
        assert_eq!(rig.hear(5_000, sample(3, 5_000)), (Some(5_000), None), "too short for a finger");
        assert_eq!(rig.hear(26_000, sample(24, 26_000)), (Some(26_000), Some(Fault::Lost)));
        assert_eq!(rig.health.frames_lost, 4 + 20);
    }

    #[test]
    fn old_frames_are_dropped() {
        let mut rig = Rig::new();
        rig.hear(0, sample(100, 100_000));
        assert_eq!(rig.hear(1, sample(100, 100_000)), (None, Some(Fault::Repeated)));
        assert_eq!(rig.hear(2, sample(36, 36_000)), (None, Some(Fault::Repeated)));
        assert_eq!(rig.hear(1_000, sample(101, 101_000)), (Some(101_000), None));
        assert_eq!(rig.health.frames_repeated, 2);
    }

    #[test]
    fn a_pad_that_begins_anew_goes_on_in_stream_time() {
        let mut rig = Rig::new();
        rig.hear(0, sample(50_000, 9_000_000));
        for (host_us, sequence) in [(28_000, 0), (29_000, 1)] {
            let begun = sample(sequence, 12 + 1_000 * u64::from(sequence));
            assert_eq!(rig.hear(host_us, begun), (None, Some(Fault::Repeated)), "it may be an old one");
        }
        assert_eq!(rig.hear(30_000, sample(2, 2_012)), (Some(9_030_000), Some(Fault::Restarted)));
        assert_eq!(rig.hear(31_000, sample(3, 3_012)), (Some(9_031_000), None));
        let Health { restarts, time_jumps, frames_repeated, .. } = rig.health;
        assert_eq!((restarts, time_jumps, frames_repeated), (1, 0, 0));
    }

    #[test]
    fn a_pad_that_begins_anew_after_a_moment_shows_by_what_it_reads() {
        for life in [3, 10, 64, 200] {
            let mut rig = Rig::new();
            let run = |offset: i32, ms: u32| Sample {
                counts: [offset + (ms % 3) as i32; CHANNELS],
                ..sample(ms, 1_000 * u64::from(ms))
            };
            for ms in 0..life {
                rig.hear(1_000 * u64::from(ms), run(0, ms));
            }
            let faults = (0..3).map(|ms| rig.hear(1_000 * u64::from(life + ms), run(6_000, ms)).1);
            let fault = faults.last().unwrap();
            assert_eq!((fault, rig.health.restarts), (Some(Fault::Restarted), 1), "{life}");
        }
    }

    #[test]
    fn frames_that_come_late_are_no_restart() {
        let mut rig = Rig::new();
        let at = |number: u32| sample(number, 1_000 * u64::from(number));
        for number in (0..100).chain(110..140) {
            rig.hear(1_000 * u64::from(number), at(number));
        }
        for number in 100..110 {
            assert_eq!(rig.hear(140_000, at(number)), (None, Some(Fault::Repeated)), "{number}");
        }
        rig.link.fall_silent(HostInstant::default().plus_us(300_000));
        for number in 130..140 {
            assert_eq!(rig.hear(300_000, at(number)), (None, Some(Fault::Repeated)), "{number}");
        }
        assert_eq!((rig.hear(300_000, at(140)).1, rig.health.restarts), (None, 0));
    }

    #[test]
    fn a_stretch_of_frames_that_comes_again_is_no_restart() {
        let mut rig = Rig::new();
        let at = |number: u32| sample(number, 1_000 * u64::from(number));
        for ms in 0..300 {
            rig.hear(1_000 * u64::from(ms), at(ms));
        }
        for number in 240..300 {
            assert_eq!(rig.hear(300_000, at(number)), (None, Some(Fault::Repeated)), "{number}");
        }
        assert_eq!(rig.hear(300_000, at(300)), (Some(300_000), None));
        assert_eq!(rig.health.restarts, 0);
    }

    /// What a run of frames makes of others among it: how many restarts, and how many frames of the run are at fault.
    fn among(run: impl Iterator<Item = Sample>, after: usize, others: &[Sample]) -> (u64, usize) {
        let mut rig = Rig::new();
        let mut faults = 0;
        for (number, next) in run.enumerate() {
            let host_us = 1_000 * number as u64;
            faults += usize::from(rig.hear(host_us, next).1.is_some());
            // Two at a time, so that they are among the frames, too.
            if let Some(others) = number.checked_sub(after).and_then(|at| others.chunks(2).nth(at)) {
                others.iter().for_each(|other| assert_eq!(rig.hear(host_us, *other).0, None, "{other:?}"));
            }
        }
        (rig.health.restarts, faults)
    }

    #[test]
    fn frames_of_another_time_are_no_restart() {
        let at = |number: u32| sample(number, 1_000_000 + 1_000 * u64::from(number));
        for behind in [1, 2, 63, 64, 65, 66, 1_000, 49_000] {
            let (one, two) = ([at(50_000 - behind)], [at(50_000 - behind), at(50_001 - behind)]);
            assert_eq!(among((50_000..50_100).map(at), 0, &one), (0, 0), "{behind}");
            assert_eq!(
                among((50_000..50_100).map(at), 0, &two[..behind.min(2) as usize]),
                (0, 0),
                "{behind}"
            );
            let many: Vec<Sample> = (0..20).map(|k| at(50_000 - behind - 30 * k)).collect();
            let many = if behind < 49_000 { &many[..] } else { &one };
            assert_eq!(among((50_000..50_100).map(at), 0, many), (0, 0), "{behind}");
        }
        // The number begins at zero again in between.
        let wrapped = |number: u32| sample(number.wrapping_sub(70), 1_000_000 + 1_000 * u64::from(number));
        assert_eq!(among((80..180).map(wrapped), 0, &[wrapped(5), wrapped(14)]), (0, 0));
        // Of the run before the pad began anew, which was ahead; and the first one of the run itself.
        let first = Sample { status: Status::OK.with_restarted(), ..at(0) };
        let run = || (0..100).map(|number| if number == 0 { first } else { at(number) });
        assert_eq!(among(run(), 40, &[at(7_000), first, sample(9, 77)]), (0, 0));
    }

    #[test]
    fn an_old_frame_after_silence_is_no_restart() {
        let mut rig = Rig::new();
        rig.hear(0, sample(500, 500_000));
        rig.link.fall_silent(HostInstant::default().plus_us(90_000));
        assert_eq!(rig.hear(200_000, sample(400, 400_000)), (None, Some(Fault::Repeated)));
        assert_eq!(rig.hear(201_000, sample(701, 701_000)).1, None);
        assert_eq!(rig.health.restarts, 0);
    }

    #[test]
    fn jumps_of_the_pads_clock_are_bridged_by_the_hosts() {
        for jump_us in [0, 1_999_999, 2_000_000, 2_101_001, u64::MAX] {
            let mut rig = Rig::new();
            rig.hear(0, sample(0, 2_000_000));
            assert_eq!(
                rig.hear(1_000, sample(1, jump_us)),
                (Some(2_001_000), Some(Fault::TimeJump)),
                "{jump_us}"
            );
            assert_eq!(rig.health.time_jumps, 1);
        }
    }

    #[test]
    fn the_longest_step_is_no_jump() {
        let mut rig = Rig::new();
        rig.hear(0, sample(0, 2_000_000));
        assert_eq!(rig.hear(1, sample(1, 2_100_000)), (Some(2_100_000), None));
    }

    #[test]
    fn a_clock_that_crawls_or_runs_is_a_jump_as_long_as_it_does() {
        for us_per_ms in [1, 450, 3_100, 10_000] {
            let mut rig = Rig::new();
            let mut is_sound =
                |ms: u64, us_per_ms: u64| rig.hear(ms * 1_000, sample(ms as u32, ms * us_per_ms)).1.is_none();
            let first = (0..3_000).find(|ms| !is_sound(*ms, us_per_ms));
            assert!(first.is_some_and(|ms| ms <= 1_000), "{us_per_ms}: {first:?}");
            assert!((1_001..3_000).all(|ms| !is_sound(ms, us_per_ms)), "{us_per_ms}");
            // The firmware is mended; its clock jumps, and is looked at for a second.
            let last = (4_200..7_000).filter(|ms| !is_sound(*ms, 1_000)).last();
            assert!(last.is_some_and(|ms| ms <= 5_300), "{us_per_ms}: {last:?}");
        }
    }

    #[test]
    fn a_restart_after_silence_is_told() {
        let mut rig = Rig::new();
        rig.hear(0, sample(500, 500_000));
        rig.link.fall_silent(HostInstant::default().plus_us(90_000));
        let mut first = sample(0, 10);
        first.status = Status::OK.with_restarted();
        assert_eq!(rig.hear(150_000, first), (Some(650_000), Some(Fault::Restarted)));
    }

    #[test]
    fn a_restart_after_silence_is_told_among_numbers_that_were_never_heard() {
        let mut rig = Rig::new();
        rig.hear(0, sample(22, 22_000));
        rig.link.fall_silent(HostInstant::default().plus_us(90_000));
        let first = Sample { status: Status::OK.with_restarted(), ..sample(0, 0) };
        assert_eq!(rig.hear(150_000, first).1, Some(Fault::Restarted));
    }

    #[test]
    fn a_restart_that_is_not_flagged_shows_after_silence_by_number_or_clock() {
        // The pad's number and clock (ms) after a silence of ten seconds.
        for (sequence, time_ms, fault) in [
            (10_600, 10_600, None),
            (501, 10_600, None),
            (40_000, 40_000, Some(Fault::Restarted)),
            (0, 10_600, Some(Fault::Restarted)),
            (9_000, 400, Some(Fault::Restarted)),
            (3_000, 3_000, Some(Fault::Restarted)),
            // It kept its samples meanwhile, or all but the first 59.
            (501, 501, None),
            (560, 560, None),
        ] {
            let mut rig = Rig::new();
            rig.hear(0, sample(500, 500_000));
            rig.link.fall_silent(HostInstant::default().plus_us(90_000));
            let mut told = None;
            for number in 0..3 {
                let next = sample(sequence + number, 1_000 * (time_ms + u64::from(number)));
                let (at, said) = rig.hear(10_000_000 + 1_000 * u64::from(number), next);
                told = told.or(at.and(said));
            }
            assert_eq!(
                (told, rig.health.restarts),
                (fault, u64::from(fault.is_some())),
                "{sequence} {time_ms}"
            );
        }
    }

    #[test]
    fn damage_is_counted_and_the_next_frame_is_whole() {
        let mut rig = Rig::new();
        let mut damaged = frame(sample(1, 1_000));
        damaged[20] ^= 4;
        assert_eq!(rig.bytes(0, &damaged), []);
        assert_eq!(rig.hear(1, sample(2, 2_000)), (Some(2_000), None));
        assert_eq!(rig.health.frames_damaged, 1);
    }

    #[test]
    fn silence_is_due_only_after_a_sample() {
        let mut rig = Rig::new();
        assert_eq!(rig.link.silent_at(), None);
        rig.hear(10_000, sample(0, 0));
        assert_eq!(rig.link.silent_at(), Some(HostInstant::default().plus_us(10_000 + SILENCE_MAX_US)));
        rig.link.fall_silent(HostInstant::default().plus_us(90_000));
        assert_eq!(rig.link.silent_at(), None);
    }

    #[test]
    fn host_time_carries_stream_time_on() {
        let mut rig = Rig::new();
        rig.hear(1_000, sample(0, 500));
        let later = HostInstant::default().plus_us(4_000);
        assert_eq!(rig.link.stream_at(later), StreamInstant::from_us(3_500));
        assert_eq!(rig.link.host_at(StreamInstant::from_us(3_500)), later);
    }

    #[test]
    fn times_at_the_end_of_the_world_do_not_overflow() {
        let mut rig = Rig::new();
        rig.hear(0, sample(0, u64::MAX));
        rig.hear(1, sample(1, u64::MAX - 5));
        let (at, _) = rig.hear(2, sample(2, 0));
        assert!(at.is_some_and(|at| at <= DEVICE_TIME_MAX_US + 2_000));
    }
}
