//! What is wrong with a pad's stream as a whole, with numbers: a maker's first firmware, or a bad line.
//!
//! Counts tell that something was wrong; this tells what. It looks at one stretch of the host's time after the other.

use std::fmt;
use std::mem::discriminant;

use serde::Serialize;

use crate::pipeline::link::reading::{Reading, SILENCE_MAX_US};
use crate::quantity::{CHANNEL_NAMES, CHANNELS};
use crate::time::HostInstant;

/// Each look takes so long: a little less than what people are told only if it lasts for a second.
const LOOK_US: u64 = 900_000;

/// What was found is taken back after so many looks without it.
const CLEAN_LOOKS: u8 = 5;

/// A slower pad is none: firmware-proto/README.md asks for 100 samples a second.
const SAMPLES_PER_S_MIN: f32 = 90.0;

/// Fewer samples in a look say nothing of how a pad counts.
const SAMPLES_MIN: u32 = 5;

/// Samples that come evenly are no farther apart than so many times their mean distance.
const EVEN: f32 = 3.0;

/// A clock counts microseconds if it shows between half and twice the time that has passed.
const CLOCK_OFF: u64 = 2;

/// In less time without silences a few samples say nothing of the clock.
const STEADY_MIN_US: u64 = 300_000;

/// A clock that is set anew more often in a look is none.
const SET_ANEW_MAX: u32 = 8;

/// Samples that waited come at once, within so long; what they show has not passed meanwhile.
const BURST_US: u64 = 100_000;
const PARTS: usize = LOOK_US.div_ceil(BURST_US) as usize;

/// A smaller share of frames that do not arrive, in percent, is not worth a word; nor are fewer frames in a look.
const LOSS_PERCENT_MIN: f32 = 1.0;
const LOSS_FRAMES_MIN: u32 = 3;

/// Most channels must change before one that does not means anything.
const LIVELY_MIN: usize = 5;

/// What is wrong with the stream. As text: one sentence.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
#[non_exhaustive]
pub enum LineFinding {
    /// Most samples say that they are the first after a restart.
    RestartFlagStays,
    /// The sequence number stands.
    SequenceStands {
        /// Its value.
        sequence: u32,
    },
    /// The sequence number begins again and again: it has too few bits.
    SequenceWraps {
        /// Its largest value.
        largest: u32,
    },
    /// The pad's clock does not count microseconds.
    Clock {
        /// What it shows, µs by its own account.
        shown_us: u64,
        /// The host's time meanwhile, µs.
        passed_us: u64,
    },
    /// Samples come evenly, and too seldom.
    Rate {
        /// So many a second.
        samples_per_s: f32,
    },
    /// A channel reads the same all the time while others do not.
    ChannelStands {
        /// Its index.
        channel: usize,
        /// What it reads.
        counts: i32,
    },
    /// Lines of text come, and are not the numbers that were described.
    NotNumbers,
    /// Lines of text are longer than any line of numbers.
    LineTooLong,
    /// Lines of text have the same number for one channel all the time, and others for the others.
    CellStands {
        /// Its index.
        channel: usize,
    },
    /// Lines of text have no number for one channel.
    NoNumber {
        /// Its index.
        channel: usize,
    },
    /// Frames do not arrive.
    Loss {
        /// The share that is lost or damaged.
        percent: f32,
    },
}

impl fmt::Display for LineFinding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::RestartFlagStays => write!(
                f,
                "each sample says that the pad has just restarted (status bit 10): set it in the first one only"
            )?,
            Self::SequenceStands { sequence } => {
                write!(f, "the sequence number stays {sequence}: it has to count the samples")?;
            }
            Self::SequenceWraps { largest } => {
                write!(
                    f,
                    "after sequence number {largest} comes a smaller one: it has to count on in 32 bits"
                )?;
            }
            Self::Clock { shown_us, passed_us } => write!(
                f,
                "the pad's clock went on by {shown_us} in {passed_us} µs: it has to count microseconds"
            )?,
            Self::Rate { samples_per_s } => {
                write!(f, "the pad sends {samples_per_s:.0} samples a second: it needs 100 at least")?;
            }
            Self::ChannelStands { channel, counts } => {
                let name = CHANNEL_NAMES.get(*channel).copied().unwrap_or("unknown");
                write!(
                    f,
                    "channel {name} reads {counts} all the time while others change: is it connected?"
                )?;
            }
            Self::NotNumbers => {
                return f.write_str(
                    "lines come that are not the numbers of the description: check the baud rate, and `columns` in it \
                     (`tactpad source show`)",
                );
            }
            Self::LineTooLong => {
                return f.write_str(
                    "lines come that are longer than 256 bytes: check the baud rate and the sketch",
                );
            }
            Self::CellStands { channel } => {
                return write!(
                    f,
                    "channel {} reads the same all the time while others change, nothing is pressed: check that cell and its wires",
                    channel + 1
                );
            }
            Self::NoNumber { channel } => {
                return write!(
                    f,
                    "channel {} has no number that can be, nothing is pressed: check that cell and its wires",
                    channel + 1
                );
            }
            Self::Loss { percent } => {
                return write!(
                    f,
                    "{percent:.1} % of the pad's frames are lost or damaged: check the cable and the baud rate, and \
                     that no other program reads this port"
                );
            }
        }
        write!(f, " (firmware-proto/README.md)")
    }
}

impl LineFinding {
    /// The channel that it is about, if it is about one.
    pub const fn channel(&self) -> Option<usize> {
        match self {
            Self::ChannelStands { channel, .. }
            | Self::CellStands { channel }
            | Self::NoNumber { channel } => Some(*channel),
            _ => None,
        }
    }

    fn is_like(&self, other: &Self) -> bool {
        discriminant(self) == discriminant(other)
    }

    /// Whether `next`, which the look after this one's found, is the same thing. A number of few bits begins again at the same one; a pad
    /// that began anew twice does not.
    fn is_seen_again_as(&self, next: &Self) -> bool {
        match (self, next) {
            (Self::SequenceWraps { largest: before }, Self::SequenceWraps { largest }) => {
                before.abs_diff(*largest) <= largest / 8
            }
            _ => self.is_like(next),
        }
    }

    /// Whether one look is enough: most samples show it.
    const fn is_certain(&self) -> bool {
        matches!(
            self,
            Self::RestartFlagStays | Self::SequenceStands { .. } | Self::Clock { .. } | Self::Rate { .. }
        )
    }
}

/// How a sample came.
#[derive(Clone, Copy, Debug, Default)]
pub struct Arrival {
    /// So many frames are missing before it.
    pub lost: u32,
    /// Whether the pad's clock does not go on from the sample before.
    pub breaks: bool,
    /// By how much it came late, µs; `None` of one that came again, or is of another time.
    pub delay_us: Option<u64>,
}

/// What the pad's clock showed. Where it falls, it shows nothing: it has few bits, or was set anew.
#[derive(Clone, Copy, Debug)]
struct ShownTime {
    heard: HostInstant,
    last_us: u64,
    us: u64,
    /// The same without silences, and what passed then: in a silence, or while samples wait, its clock may stand.
    steady_us: u64,
    steady_passed_us: u64,
    /// By how much the first of it came late: that may be made up for.
    delay_us: u64,
    samples: u32,
}

impl ShownTime {
    const fn beginning(heard: HostInstant, last_us: u64, delay_us: u64) -> Self {
        Self { heard, last_us, us: 0, steady_us: 0, steady_passed_us: 0, delay_us, samples: 0 }
    }

    /// Takes the next sample, heard at `now`, which shows that so much has passed.
    fn take(&mut self, now: HostInstant, last_us: u64, step_us: u64) {
        let passed_us = now.us_since(self.heard);
        if passed_us <= SILENCE_MAX_US {
            self.steady_us = self.steady_us.saturating_add(step_us);
            self.steady_passed_us += passed_us;
        }
        self.us = self.us.saturating_add(step_us);
        self.samples += 1;
        (self.heard, self.last_us) = (now, last_us);
    }
}

/// Looks at the samples of one stretch of time after the other.
#[derive(Clone, Debug)]
pub struct LineCheck {
    look: Option<Look>,
    /// What a look found, and where chance may have a part in it the next one, too; it stays for a while.
    finding: Option<LineFinding>,
    candidate: Option<LineFinding>,
    /// What the look before found that gave the candidate, where both found something.
    earlier: Option<LineFinding>,
    clean: u8,
}

/// One stretch of time.
#[derive(Clone, Debug)]
struct Look {
    begun: HostInstant,
    heard: HostInstant,
    first: Reading,
    last: Reading,
    samples: u32,
    widest_us: u64,
    restart_flags: u32,
    sequence_stands: u32,
    sequence_falls: u32,
    sequence_largest: u32,
    /// Samples at which the pad's clock did not go on.
    clock_breaks: u32,
    /// What the pad's clock showed at them, µs.
    broken_us: u64,
    /// The last of the samples that go on from one another, and what they show.
    taken: Option<Reading>,
    clock: Option<ShownTime>,
    /// What all samples show, those of another time, too.
    all: ShownTime,
    /// What the pad's clock showed in each [`BURST_US`], µs.
    shown_us: [u64; PARTS],
    lost: u32,
    has_changed: [bool; CHANNELS],
}

impl Default for LineCheck {
    fn default() -> Self {
        Self::new()
    }
}

impl LineCheck {
    /// Has seen nothing.
    pub const fn new() -> Self {
        Self { look: None, finding: None, candidate: None, earlier: None, clean: 0 }
    }

    /// What is wrong, if anything is.
    pub const fn finding(&self) -> Option<&LineFinding> {
        self.finding.as_ref()
    }

    /// When a sample came last.
    pub fn heard(&self) -> Option<HostInstant> {
        self.look.as_ref().map(|look| look.heard)
    }

    /// Takes a sample, as it came. Of a frame that was damaged the number is missing.
    pub fn sample(&mut self, now: HostInstant, reading: &Reading, arrival: Arrival) {
        let wrapped = self.look.as_ref().and_then(|look| look.wrapped(reading));
        if self.look.as_ref().is_some_and(|look| now.us_since(look.begun) >= LOOK_US) {
            self.close();
        }
        let look = self.look.get_or_insert_with(|| Look::begin(now, reading));
        if let Some(largest) = wrapped {
            // At once: what comes of it must not be told first.
            self.finding = Some(LineFinding::SequenceWraps { largest });
        }
        look.lost = look.lost.saturating_add(arrival.lost);
        look.show(now, reading, arrival);
        look.sample(now, reading);
    }

    /// Another pad may come.
    pub fn forget(&mut self) {
        *self = Self::new();
    }

    fn close(&mut self) {
        let look = self.look.take();
        let found = look.as_ref().and_then(|look| look.found(0));
        let is_certain = found.as_ref().is_some_and(LineFinding::is_certain)
            && look.as_ref().and_then(|look| look.found(look.burst_us())) == found;
        // Of two things that are wrong the graver one may hide the other in every other look.
        let before = [self.candidate, self.earlier];
        let is_again = found.is_some_and(|now| {
            is_certain || before.iter().flatten().any(|before| before.is_seen_again_as(&now))
        });
        // Another thing that is seen once does not keep the one that was found.
        let is_seen = matches!((&self.finding, &found), (Some(before), Some(now)) if before.is_like(now));
        self.clean = if is_seen { 0 } else { self.clean.saturating_add(1) };
        let largest = look.map_or(0, |look| look.sequence_largest);
        // A number of 16 bits begins again once a minute.
        let may_wrap_again =
            matches!(self.finding, Some(LineFinding::SequenceWraps { largest: last }) if largest <= last);
        if is_again {
            self.finding = found;
        } else if self.clean >= CLEAN_LOOKS && !may_wrap_again {
            self.finding = None;
        }
        self.earlier = self.candidate.filter(|_| found.is_some());
        self.candidate = found;
    }
}

impl Look {
    const fn begin(now: HostInstant, reading: &Reading) -> Self {
        Self {
            begun: now,
            heard: now,
            first: *reading,
            last: *reading,
            samples: 0,
            widest_us: 0,
            restart_flags: 0,
            sequence_stands: 0,
            sequence_falls: 0,
            sequence_largest: 0,
            clock_breaks: 0,
            broken_us: 0,
            taken: None,
            clock: None,
            all: ShownTime::beginning(now, reading.time_us, 0),
            shown_us: [0; PARTS],
            lost: 0,
            has_changed: [false; CHANNELS],
        }
    }

    fn sample(&mut self, now: HostInstant, reading: &Reading) {
        let is_first = self.samples == 0;
        self.samples += 1;
        self.restart_flags += u32::from(reading.status.restarted());
        self.sequence_stands += u32::from(!is_first && reading.sequence == self.last.sequence);
        self.sequence_largest = self.sequence_largest.max(reading.sequence);
        self.widest_us = self.widest_us.max(now.us_since(self.heard));
        // Of other pads than those with nine channels nobody knows which have noise.
        if let (Some(counts), Some(first)) = (reading.nine_counts(), self.first.nine_counts()) {
            for (has_changed, (count, first)) in self.has_changed.iter_mut().zip(counts.iter().zip(first)) {
                *has_changed |= count != first;
            }
        }
        (self.heard, self.last) = (now, *reading);
    }

    /// Follows the pad's clock.
    fn show(&mut self, now: HostInstant, reading: &Reading, arrival: Arrival) {
        let last_us = reading.time_us;
        self.all.take(now, last_us, last_us.saturating_sub(self.all.last_us));
        let begins = reading.status.restarted() || reading.sequence < self.last.sequence;
        let before_us = self.clock.filter(|_| !begins).map_or(last_us, |clock| clock.last_us);
        let step_us = last_us.saturating_sub(before_us);
        if arrival.breaks {
            self.clock_breaks += 1;
            self.broken_us = self.broken_us.saturating_add(step_us);
        }
        let Some(delay_us) = arrival.delay_us else { return };
        self.take(reading);
        let part = (now.us_since(self.begun) / BURST_US) as usize;
        let shown_us = &mut self.shown_us[part.min(PARTS - 1)];
        *shown_us = shown_us.saturating_add(step_us);
        self.clock.get_or_insert(ShownTime::beginning(now, last_us, delay_us)).take(now, last_us, step_us);
    }

    /// Takes a sample that goes on from the last one, or begins anew.
    fn take(&mut self, reading: &Reading) {
        let last = self.taken.replace(*reading);
        self.sequence_falls += u32::from(last.is_some_and(|last| falls(&last, reading)));
    }

    /// The largest number, where the next one is zero and it is all that eight bits or more can count.
    fn wrapped(&self, reading: &Reading) -> Option<u32> {
        // An old frame may have come between them.
        let last = self.taken?;
        let largest = last.sequence;
        let is_full = largest >= u8::MAX.into() && largest & largest.wrapping_add(1) == 0;
        (is_full && reading.sequence == 0 && falls(&last, reading)).then_some(largest)
    }

    /// The most that was shown within two neighbouring parts, which a burst may lie in, µs.
    fn burst_us(&self) -> u64 {
        self.shown_us.windows(2).map(|pair| pair[0].saturating_add(pair[1])).max().unwrap_or(0)
    }

    /// The gravest that it shows, where what came may have waited for so long, µs.
    fn found(&self, waited_us: u64) -> Option<LineFinding> {
        if self.samples < SAMPLES_MIN {
            return None;
        }
        let most = |count: u32| 2 * count > self.samples;
        let passed_us = self.heard.us_since(self.begun);
        // An old frame says nothing of the clock, but where most seem to be old it is the clock.
        let all = ShownTime { us: self.all.steady_us, ..self.all };
        let heard = self.clock.filter(|clock| most(clock.samples));
        let (is_clock_heard, shown) = (heard.is_some(), heard.unwrap_or(all));
        let shown_us = shown.us;
        let late_us = shown.delay_us.saturating_add(waited_us);
        let is_too_fast = |shown_us: u64| shown_us > (CLOCK_OFF * passed_us).saturating_add(late_us);
        let is_too_slow = shown.steady_us.saturating_mul(CLOCK_OFF) < shown.steady_passed_us;
        // A clock that jumped was set anew, and by how much says nothing; what it shows beside the jump may be too much still.
        let is_set_anew = (1..=SET_ANEW_MAX).contains(&self.clock_breaks);
        let is_off = if is_set_anew {
            is_clock_heard && is_too_fast(shown_us.saturating_sub(self.broken_us))
        } else {
            is_too_slow || is_too_fast(shown_us)
        };
        let is_clock_off = is_off && shown.steady_passed_us >= STEADY_MIN_US;
        // What is lost was sent; where samples do not go on from one another, only the pad's numbers tell how many that were.
        let counted = self.last.sequence.wrapping_sub(self.first.sequence);
        let mean_us = passed_us as f32 / counted.max(self.lost + self.samples - 1) as f32;
        let is_even = (self.widest_us as f32) < EVEN * mean_us;
        let is_slow = 1e6 / mean_us < SAMPLES_PER_S_MIN && is_even;
        let percent = 100.0 * self.lost as f32 / (self.lost + self.samples) as f32;
        let still = self.has_changed.iter().position(|has_changed| !has_changed);
        let lively = self.has_changed.iter().filter(|has_changed| **has_changed).count();
        if most(self.restart_flags) {
            Some(LineFinding::RestartFlagStays)
        } else if most(self.sequence_stands) {
            Some(LineFinding::SequenceStands { sequence: self.last.sequence })
        } else if self.sequence_falls > 0 && self.sequence_largest <= u16::MAX.into() && !is_clock_off {
            Some(LineFinding::SequenceWraps { largest: self.sequence_largest })
        } else if is_clock_off {
            Some(LineFinding::Clock { shown_us, passed_us })
        } else if is_slow {
            Some(LineFinding::Rate { samples_per_s: 1e6 / mean_us })
        } else if let Some(channel) = still.filter(|_| lively >= LIVELY_MIN) {
            // It keeps all from being pressed, which few lost frames do not.
            let counts = self.last.nine_counts().and_then(|counts| counts.get(channel)).copied();
            Some(LineFinding::ChannelStands { channel, counts: counts.unwrap_or_default() })
        } else {
            (self.lost >= LOSS_FRAMES_MIN && percent >= LOSS_PERCENT_MIN)
                .then_some(LineFinding::Loss { percent })
        }
    }
}

/// Whether the number falls though time goes on: neither an old frame nor a pad that began anew.
const fn falls(last: &Reading, next: &Reading) -> bool {
    !next.status.restarted() && next.sequence < last.sequence && next.time_us > last.time_us
}

#[cfg(test)]
mod tests {
    use firmware_proto::sample::{Sample, Status};

    use super::*;

    /// Sample `i` of a sound pad at 1 kHz.
    fn sound(i: u32) -> Sample {
        Sample {
            sequence: i,
            time_us: 1_000 * u64::from(i),
            counts: std::array::from_fn(|k| ((i * 7 + k as u32 * 3) % 11) as i32),
            temperature_centi_c: 2_500,
            status: Status::OK,
        }
    }

    /// What is found by the end of so many milliseconds of a pad with this period, of which each sample is made from a sound one.
    fn found(ms: u32, period_ms: u32, make: impl Fn(Sample, u32) -> Sample) -> Option<LineFinding> {
        let mut check = LineCheck::new();
        let mut last_us = 0;
        let mut breaks = |sample: &Sample, number: u32| {
            let step_us = sample.time_us.wrapping_sub(std::mem::replace(&mut last_us, sample.time_us));
            number > 0 && step_us > 100_000
        };
        for (number, at_ms) in (0..ms).step_by(period_ms as usize).enumerate() {
            let sample = make(Sample { sequence: number as u32, ..sound(at_ms) }, number as u32);
            let now = HostInstant::default().plus_us(1_000 * u64::from(at_ms));
            let is_break = breaks(&sample, number as u32);
            let arrival = Arrival { lost: 0, breaks: is_break, delay_us: Some(0) };
            check.sample(now, &sample.into(), arrival);
        }
        check.finding().copied()
    }

    #[test]
    fn a_sound_pad_has_no_finding_at_any_rate() {
        for period_ms in [1, 2, 5, 10] {
            assert_eq!(found(20_000, period_ms, |sample, _| sample), None, "{period_ms} ms");
        }
    }

    #[test]
    fn mistakes_of_a_first_firmware_are_found_within_a_second_or_two() {
        use LineFinding::{ChannelStands, Clock, Rate, RestartFlagStays, SequenceStands, SequenceWraps};
        let timed = |us_per_ms: u64| {
            found(1_000, 1, move |sample, _| Sample { time_us: sample.time_us * us_per_ms / 1_000, ..sample })
        };
        assert!(matches!(timed(1), Some(Clock { .. })), "milliseconds");
        assert!(matches!(timed(1_000_000), Some(Clock { .. })), "nanoseconds");
        assert!(matches!(timed(10_000), Some(Clock { .. })), "ten times too fast");
        let too_fast = found(2_000, 1, |sample, _| Sample { time_us: 3 * sample.time_us, ..sample });
        assert!(matches!(too_fast, Some(Clock { .. })), "three times too fast");
        let flagged = |sample, _| Sample { status: Status::OK.with_restarted(), ..sample };
        assert_eq!(found(1_000, 1, flagged), Some(RestartFlagStays));
        let constant = |sample, _| Sample { sequence: 7, ..sample };
        assert_eq!(found(1_000, 1, constant), Some(SequenceStands { sequence: 7 }));
        let short = |sample: Sample, number| Sample { sequence: number & 255, ..sample };
        assert_eq!(found(2_000, 2, short), Some(SequenceWraps { largest: 255 }));
        for period_ms in [71, 100] {
            let slow = found(1_100, period_ms, |sample, _| sample);
            assert!(matches!(slow, Some(Rate { samples_per_s }) if samples_per_s < 15.0), "{slow:?}");
        }
        let standing = |mut sample: Sample, _| {
            sample.counts[4] = 1_234;
            sample
        };
        assert_eq!(found(2_000, 1, standing), Some(ChannelStands { channel: 4, counts: 1_234 }));
    }

    #[test]
    fn a_number_of_few_bits_is_found_when_it_begins_again_and_is_not_taken_back() {
        for (largest, ms) in [(255, 260), (255, 9_000), (4_095, 4_100), (65_535, 65_540), (65_535, 80_000)] {
            let short = move |sample: Sample, number| Sample { sequence: number & largest, ..sample };
            assert_eq!(found(ms, 1, short), Some(LineFinding::SequenceWraps { largest }), "{ms} ms");
        }
    }

    #[test]
    fn a_number_that_begins_again_between_two_looks_is_found() {
        // The first look ends with the 901st sample.
        let short = |sample: Sample, number| Sample { sequence: (number + 123) & 1_023, ..sample };
        assert_eq!(found(902, 1, short), Some(LineFinding::SequenceWraps { largest: 1_023 }));
    }

    #[test]
    fn an_old_frame_hides_no_number_that_begins_again() {
        let mut check = LineCheck::new();
        let mut hear = |ms: u32, sample: Sample, delay_us| {
            let now = HostInstant::default().plus_us(1_000 * u64::from(ms));
            check.sample(now, &sample.into(), Arrival { lost: 0, breaks: false, delay_us });
        };
        (100..256).for_each(|number| hear(number, sound(number), Some(0)));
        hear(256, sound(3), None);
        hear(256, Sample { sequence: 0, ..sound(256) }, None);
        assert_eq!(check.finding(), Some(&LineFinding::SequenceWraps { largest: 255 }));
    }

    #[test]
    fn old_frames_are_no_number_that_begins_again() {
        let old = |sample: Sample, number: u32| {
            let behind = if number > 700 && number.is_multiple_of(300) { 200 + number / 7 } else { 0 };
            let time_us = sample.time_us - 1_000 * u64::from(behind);
            Sample { sequence: sample.sequence - behind, time_us, ..sample }
        };
        assert_eq!(found(9_000, 1, old), None);
    }

    #[test]
    fn a_clock_that_is_set_once_and_a_restart_are_no_mistakes() {
        for at in [300, 899, 900, 1_500] {
            let set = move |sample: Sample, number| {
                let ahead_us = if number >= at { 3_600_000_000 } else { 0 };
                Sample { time_us: sample.time_us + ahead_us, ..sample }
            };
            assert_eq!(found(4_000, 1, set), None, "{at}");
            let restarted = move |sample: Sample, number: u32| match number.checked_sub(at) {
                Some(since) => Sample { sequence: since, time_us: 1_000 * u64::from(since), ..sample },
                None => sample,
            };
            assert_eq!(found(4_000, 1, restarted), None, "{at}");
        }
    }

    #[test]
    fn a_pad_that_begins_anew_twice_is_no_number_that_begins_again() {
        let again = |sample: Sample, number: u32| {
            let since = number - [0, 700, 1_200].into_iter().rfind(|begun| *begun <= number).unwrap_or(0);
            Sample { sequence: since, ..sample }
        };
        assert_eq!(found(2_700, 1, again), None);
    }

    #[test]
    fn a_channel_that_stands_is_found_on_a_line_that_loses_frames_in_every_other_look() {
        let mut check = LineCheck::new();
        for ms in 0..4_600 {
            let mut sample = sound(ms);
            sample.counts[4] = 1_234;
            let lost = if ms % 1_800 == 100 { 20 } else { 0 };
            check.sample(
                HostInstant::default().plus_us(1_000 * u64::from(ms)),
                &sample.into(),
                Arrival { lost, breaks: false, delay_us: Some(0) },
            );
        }
        assert!(matches!(check.finding(), Some(LineFinding::ChannelStands { channel: 4, .. })));
    }

    #[test]
    fn a_channel_that_stood_is_taken_back_though_frames_are_lost_now_and_then() {
        let mut check = LineCheck::new();
        for ms in 0..10_000 {
            let mut sample = sound(ms);
            if ms < 2_000 {
                sample.counts[4] = 1_234;
            }
            let lost = if ms >= 2_000 && ms % 1_800 == 0 { 20 } else { 0 };
            check.sample(
                HostInstant::default().plus_us(1_000 * u64::from(ms)),
                &sample.into(),
                Arrival { lost, breaks: false, delay_us: Some(0) },
            );
        }
        assert_eq!(check.finding(), None);
    }

    #[test]
    fn a_line_that_loses_frames_is_found_and_taken_back() {
        let mut check = LineCheck::new();
        let at = |check: &mut LineCheck, ms: u32, lost: u32| {
            check.sample(
                HostInstant::default().plus_us(1_000 * u64::from(ms)),
                &sound(ms).into(),
                Arrival { lost, breaks: false, delay_us: Some(0) },
            );
        };
        (0..3_000).for_each(|ms| at(&mut check, ms, u32::from(ms % 40 == 0)));
        let Some(LineFinding::Loss { percent }) = check.finding() else { panic!("{:?}", check.finding()) };
        assert!((percent - 2.5).abs() < 0.2, "{percent} %");
        (3_000..10_000).for_each(|ms| at(&mut check, ms, 0));
        assert_eq!(check.finding(), None);
    }
}
