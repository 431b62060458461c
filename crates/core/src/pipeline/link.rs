//! From bytes to samples in order, on one monotonic clock.
//!
//! Frames are unpacked by `firmware_proto`; here their sequence numbers and timestamps are checked, and the pad's
//! clock becomes stream time. Nothing is repaired: what is missing or doubtful is told as a [`Fault`].

use firmware_proto::frame::{Message, WireError};
use firmware_proto::identity::Identity;
use firmware_proto::link::MessageReceiver;
use firmware_proto::sample::Sample;

use crate::pipeline::health::Health;
use crate::pipeline::line_check::{LineCheck, LineFinding};
use crate::time::{HostInstant, StreamInstant};

/// Without a sample for this long the link counts as lost. Everything is released then, well inside 100 ms.
pub const SILENCE_MAX_US: u64 = 80_000;

/// Frames may be missing between two samples this close: nobody lifts a finger and presses again in so short a time, and what is
/// pressed meanwhile shows in the next sample. With one frame in 40 damaged, 15 presses stay 15; where each gap ended a contact they
/// became 40. It is two periods of the slowest pad: one frame may be missing there, too.
pub const BRIDGED_GAP_US: u64 = 20_000;

/// The longest step of the pad's clock between two samples that is not a jump: 10 periods of the slowest pad.
pub const GAP_MAX_US: u64 = 100_000;

/// The pace of the pad's clock is judged over this time.
const PACE_US: u64 = 1_000_000;

/// Bytes that waited for a host that was busy arrive at once: so much more may be shown than has passed.
const PACE_BURST_US: u64 = 1_000_000;

/// A line that brings sound frames of a newer version and, for so long, nothing that is understood is a newer pad's. A single
/// such frame is not: one damaged frame in 65,536 has a checksum that is right.
pub const NEWER_US: u64 = 2_000_000;

/// No pad samples faster than once in so many microseconds.
const PERIOD_MIN_US: u64 = 50;

/// A frame this little behind the newest is an old one that came again; farther behind, the pad began anew.
const REORDER_MAX: u32 = 64;

/// Pad clocks beyond this are moved to zero, so that no sum of times overflows.
const DEVICE_TIME_MAX_US: u64 = 1 << 62;

/// Something about the link that makes the present contact untrustworthy.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Fault {
    /// So many frames are missing before this one that a finger could have come or gone.
    Lost,
    /// A frame came again; it was dropped.
    Repeated,
    /// The pad's clock jumped.
    TimeJump,
    /// The pad began anew: its offsets may be different.
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
        sample: Sample,
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
    last: Option<Sample>,
    /// The last sample before the silence that lasts, and when it was heard.
    before_silence: Option<(Sample, HostInstant)>,
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
            last: None,
            before_silence: None,
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
            Ok(Message::Sample(sample)) => Some(self.order(now, sample, health)),
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

    /// Stream time at host time `now`: the last sample's, advanced by the host's clock since.
    pub fn stream_at(&self, now: HostInstant) -> StreamInstant {
        self.clock.at(now)
    }

    /// Host time at which stream time reaches `at` if no sample comes before.
    pub fn host_at(&self, at: StreamInstant) -> HostInstant {
        self.clock.heard.plus_us(at.us_since(self.clock.last))
    }

    /// When the link counts as lost if no sample comes before; `None` while nothing is to be lost.
    pub fn silent_at(&self) -> Option<HostInstant> {
        self.last.map(|_| self.clock.heard.plus_us(SILENCE_MAX_US))
    }

    /// The pad fell silent. Half a frame is forgotten. What comes next is of the same pad, which may have begun anew.
    pub fn fall_silent(&mut self, now: HostInstant) {
        let heard = self.clock.heard;
        self.before_silence = self.last.take().map(|last| (last, heard)).or(self.before_silence);
        self.clock.advance(now);
        self.receiver = MessageReceiver::new();
    }

    /// The pad was unplugged: whatever comes next begins anew.
    pub fn unplug(&mut self, now: HostInstant) {
        self.fall_silent(now);
        self.before_silence = None;
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

    /// Whether the pad whose first sample this is, after a silence, was switched off meanwhile.
    fn has_begun_anew(&mut self, now: HostInstant, sample: &Sample) -> bool {
        let goes_on = self.before_silence.take().is_none_or(|(last, heard)| {
            sample.sequence != last.sequence && goes_on_after_gap(&last, sample, now.us_since(heard))
        });
        self.clock.set && (!goes_on || sample.status.restarted())
    }

    /// What is wrong with the stream as a whole, if anything is.
    pub const fn finding(&self) -> Option<&LineFinding> {
        self.check.finding()
    }

    fn order(&mut self, now: HostInstant, sample: Sample, health: &mut Health) -> LinkEvent {
        let lost_before = health.frames_lost;
        let event = self.ordered(now, sample, health);
        let lost = u32::try_from(health.frames_lost - lost_before).unwrap_or(u32::MAX);
        let breaks =
            matches!(event, LinkEvent::Sample { fault: Some(Fault::TimeJump | Fault::Restarted), .. });
        self.check.sample(now, &sample, lost, breaks);
        event
    }

    fn ordered(&mut self, now: HostInstant, sample: Sample, health: &mut Health) -> LinkEvent {
        let fault = match self.last {
            None => self.has_begun_anew(now, &sample).then(|| {
                health.restarts += 1;
                Fault::Restarted
            }),
            Some(last) => match step_between(&last, &sample, now.us_since(self.clock.heard)) {
                SequenceStep::Next => None,
                SequenceStep::Again => {
                    health.frames_repeated += 1;
                    return LinkEvent::Fault(Fault::Repeated);
                }
                SequenceStep::Skipped(frames) => {
                    health.frames_lost += u64::from(frames);
                    let gap_us = sample.time_us.wrapping_sub(last.time_us);
                    (gap_us > BRIDGED_GAP_US || now.us_since(self.clock.heard) > BRIDGED_GAP_US)
                        .then_some(Fault::Lost)
                }
                SequenceStep::Anew => {
                    health.restarts += 1;
                    Some(Fault::Restarted)
                }
            },
        };
        let smooth =
            self.clock.accept(now, sample.time_us, self.last.is_some() && fault != Some(Fault::Restarted));
        self.last = Some(sample);
        let fault = if smooth { fault } else { jumped(fault, health) };
        LinkEvent::Sample { at: self.clock.last, sample, fault }
    }
}

/// How one sample follows another by sequence number.
enum SequenceStep {
    Next,
    Again,
    Skipped(u32),
    Anew,
}

/// The step from `last` to `next`, which came `passed_us` of host time later.
fn step_between(last: &Sample, next: &Sample, passed_us: u64) -> SequenceStep {
    if next.status.restarted() {
        return if next == last { SequenceStep::Again } else { SequenceStep::Anew };
    }
    match next.sequence.wrapping_sub(last.sequence) {
        0 => SequenceStep::Again,
        1 => SequenceStep::Next,
        behind if behind.wrapping_neg() <= REORDER_MAX && next.time_us <= last.time_us => SequenceStep::Again,
        ahead if ahead <= REORDER_MAX => SequenceStep::Skipped(ahead - 1),
        ahead if goes_on_after_gap(last, next, passed_us) => SequenceStep::Skipped(ahead - 1),
        _ => SequenceStep::Anew,
    }
}

/// Whether `next` can be of the run of `last` after a gap of `passed_us` of host time. A run that began anew shows another time
/// than has passed, or a number that is behind, or farther ahead than samples fit into that time. So does a pad that ran while
/// the host slept, whose zero is as old as that.
fn goes_on_after_gap(last: &Sample, next: &Sample, passed_us: u64) -> bool {
    let ahead = next.sequence.wrapping_sub(last.sequence);
    next.time_us.checked_sub(last.time_us).is_some_and(|shown_us| {
        (passed_us / 2..=2 * passed_us + GAP_MAX_US).contains(&shown_us)
            && u64::from(ahead) <= (shown_us / PERIOD_MIN_US).max(REORDER_MAX.into())
    })
}

/// A jump of the clock is told unless a graver fault explains it.
fn jumped(fault: Option<Fault>, health: &mut Health) -> Option<Fault> {
    health.time_jumps += 1;
    fault.or(Some(Fault::TimeJump))
}

/// The pad's clock made monotonic and carried on by the host's clock while the pad is silent.
#[derive(Clone, Copy, Debug)]
struct StreamClock {
    /// Added to device time, modulo 2^64, to give stream time.
    offset_us: u64,
    /// Stream time of the newest sample.
    last: StreamInstant,
    /// Host time at which it was heard.
    heard: HostInstant,
    /// False until the first sample, which sets the clock.
    set: bool,
    /// Where the present look at the pace began: host time and the pad's.
    pace_from: (HostInstant, u64),
    /// Whether the last look found that the pad's clock counts microseconds.
    is_on_pace: bool,
}

impl StreamClock {
    const fn new() -> Self {
        Self {
            offset_us: 0,
            last: StreamInstant::from_us(0),
            heard: HostInstant::from_ns(0),
            set: false,
            pace_from: (HostInstant::from_ns(0), 0),
            is_on_pace: true,
        }
    }

    /// Stream time at `now`. It begins with the first sample: what happens before it happens at the origin, so that stream time
    /// never has to go back to where the pad's clock begins.
    fn at(&self, now: HostInstant) -> StreamInstant {
        if self.set { self.last.plus_us(now.us_since(self.heard)) } else { self.last }
    }

    /// Lets stream time pass to `now` without a sample.
    fn advance(&mut self, now: HostInstant) {
        self.last = self.at(now);
        self.heard = now;
    }

    /// Whether the pad's clock goes half to twice as fast as the host's, by the last look that is over. Times in a profile mean
    /// nothing on a clock that counts milliseconds for microseconds, say.
    fn keeps_pace(&mut self, now: HostInstant, device_us: u64) -> bool {
        let (host, from_us) = self.pace_from;
        let passed_us = now.us_since(host);
        if passed_us >= PACE_US {
            let shown_us = device_us.wrapping_sub(from_us);
            self.is_on_pace = (passed_us / 2..=2 * passed_us + PACE_BURST_US).contains(&shown_us);
            self.pace_from = (now, device_us);
        }
        self.is_on_pace
    }

    /// Takes a sample's device time. Returns false if the clock jumped and was joined anew; `continues` says whether
    /// a running sequence gives something to jump from.
    fn accept(&mut self, now: HostInstant, device_us: u64, continues: bool) -> bool {
        let stream_us = device_us.wrapping_add(self.offset_us);
        let smooth = stream_us > self.last.as_us() && stream_us - self.last.as_us() <= GAP_MAX_US;
        if !continues || !smooth {
            self.pace_from = (now, device_us);
            self.is_on_pace |= !continues;
        } else if self.keeps_pace(now, device_us) {
            self.last = StreamInstant::from_us(stream_us);
            self.heard = now;
            return true;
        }
        let joined_us = if self.set { self.at(now).as_us() } else { device_us.min(DEVICE_TIME_MAX_US) };
        self.offset_us = joined_us.wrapping_sub(device_us);
        self.last = StreamInstant::from_us(joined_us);
        (self.heard, self.set) = (now, true);
        !continues
    }
}

#[cfg(test)]
mod tests {
    use firmware_proto::link::encode_message;
    use firmware_proto::sample::Status;
    use firmware_proto::{CHANNELS, ENCODED_MAX};

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
        assert_eq!(rig.hear(30_000, sample(0, 12)), (Some(9_030_000), Some(Fault::Restarted)));
        assert_eq!(rig.hear(31_000, sample(1, 1_012)), (Some(9_031_000), None));
        assert_eq!((rig.health.restarts, rig.health.time_jumps), (1, 0));
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
    fn a_restart_that_is_not_flagged_shows_after_silence_by_number_or_clock() {
        // The pad's number and clock (ms) after a silence of ten seconds.
        for (sequence, time_ms, fault) in [
            (10_600, 10_600, None),
            (501, 10_600, None),
            (40_000, 40_000, Some(Fault::Restarted)),
            (0, 10_600, Some(Fault::Restarted)),
            (9_000, 400, Some(Fault::Restarted)),
            (3_000, 3_000, Some(Fault::Restarted)),
        ] {
            let mut rig = Rig::new();
            rig.hear(0, sample(500, 500_000));
            rig.link.fall_silent(HostInstant::default().plus_us(90_000));
            let (_, told) = rig.hear(10_000_000, sample(sequence, 1_000 * time_ms));
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
