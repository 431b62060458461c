//! How samples follow one another by number and time, and when one that does not shows that the pad began anew.

use super::clock::GAP_MAX_US;
use super::reading::{Reading, SILENCE_MAX_US};
use crate::time::HostInstant;

/// No pad samples faster than once in so many microseconds.
const PERIOD_MIN_US: u64 = 50;

/// The number of the next frame may be ahead by so much, however little time has passed.
const SKIPPED_MAX: u32 = 64;

/// So many of the newest frames are kept, to tell one that comes again from one of a run that began anew.
const KEPT: usize = 64;

/// Over a gap the pad's clock shows what has passed, but for one part in so many. A coarser look takes a pad for the same that began anew
/// when it had run for a moment.
const PACE_OFF: u64 = 32;

/// A sample with no more delay came without any.
const DELAY_MAX_US: u64 = 20_000;

/// What was late for so long is not: the pad's clock stood meanwhile, or counted something else.
const LATE_MAX_US: u64 = 1_000_000;

/// So many frames that go on from one another are a run of the pad, which began anew. One that is late or came again goes on in
/// nothing.
const RUN_FRAMES: u32 = 3;

/// How one sample follows another.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum SequenceStep {
    /// It is the next one.
    Next,
    /// It came again.
    Again,
    /// So many frames are missing before it.
    Skipped(u32),
    /// It does not go on. It may be of another time, or of a pad that began anew: what follows it will tell.
    Apart,
    /// The pad says that it began anew.
    Anew,
}

/// A run of the pad as it was heard.
#[derive(Clone, Debug)]
pub(super) struct Run {
    /// The newest frames, each in the place of its number.
    newest: [Option<Reading>; KEPT],
    /// The number that it began with.
    first: u32,
    pub(super) last: Reading,
    /// When a sample was heard without delay, and the pad's time then. Those that a host took late, or a pad kept, come after it.
    prompt: (HostInstant, u64),
    /// When the last sample was heard, and for how long all that were heard have been late.
    heard: HostInstant,
    late_us: u64,
}

impl Run {
    /// It begins with this sample, heard at `now`.
    pub(super) const fn beginning(now: HostInstant, first: &Reading) -> Self {
        let mut run = Self {
            newest: [None; KEPT],
            first: first.sequence,
            last: *first,
            prompt: (now, first.time_us),
            heard: now,
            late_us: 0,
        };
        run.newest[Self::place(first)] = Some(*first);
        run
    }

    const fn place(sample: &Reading) -> usize {
        sample.sequence as usize % KEPT
    }

    /// Takes its next sample, heard at `now`.
    pub(super) fn take(&mut self, now: HostInstant, next: &Reading) {
        let passed_us = now.us_since(std::mem::replace(&mut self.heard, now));
        self.late_us += if passed_us <= SILENCE_MAX_US { passed_us } else { 0 };
        let is_late = shown_us(self.last.time_us, next).is_some() && self.delay_us(now, next) > DELAY_MAX_US;
        if !is_late || self.late_us > LATE_MAX_US {
            (self.prompt, self.late_us) = ((now, next.time_us), 0);
        }
        self.newest[Self::place(next)] = Some(*next);
        self.last = *next;
    }

    /// By how much `next`, heard at `now`, comes later than a sample that came without delay.
    pub(super) fn delay_us(&self, now: HostInstant, next: &Reading) -> u64 {
        let (heard, time_us) = self.prompt;
        now.us_since(heard).saturating_sub(shown_us(time_us, next).unwrap_or(0))
    }

    /// The step to `next`, heard at `now`.
    pub(super) fn step(&self, now: HostInstant, next: &Reading) -> SequenceStep {
        if self.has(next) {
            return SequenceStep::Again;
        }
        if next.status.restarted() {
            // The first frame of a run may come again, too, after it was forgotten.
            let is_young = self.newest.iter().any(Option::is_none);
            let is_behind = next.time_us <= self.last.time_us && !is_young;
            return if is_behind { SequenceStep::Apart } else { SequenceStep::Anew };
        }
        match next.sequence.wrapping_sub(self.last.sequence) {
            0 => SequenceStep::Apart,
            1 => SequenceStep::Next,
            ahead
                if ahead <= SKIPPED_MAX && self.can_show_by(now, next)
                    || self.goes_on_after_gap(now, next, now.us_since(self.heard)) =>
            {
                SequenceStep::Skipped(ahead - 1)
            }
            _ => SequenceStep::Apart,
        }
    }

    /// The step over a silence to `next`, heard at `now`. Nobody counts what is missing. The samples of a pad that kept them meanwhile
    /// come late, and go on by number and time from where it fell silent.
    pub(super) fn step_over_silence(&self, now: HostInstant, next: &Reading) -> SequenceStep {
        if self.has(next) {
            SequenceStep::Again
        } else if next.status.restarted() {
            SequenceStep::Anew
        } else if goes_on_closely(&self.last, next)
            || next.sequence != self.last.sequence && self.goes_on_after_gap(now, next, 0)
        {
            SequenceStep::Next
        } else {
            SequenceStep::Apart
        }
    }

    /// Whether this very frame is one of the newest, or one of their time that was never heard, which comes late. A pad that began
    /// anew a moment ago sends the same numbers with other contents.
    fn has(&self, frame: &Reading) -> bool {
        let behind = self.last.sequence.wrapping_sub(frame.sequence);
        // What is older than the run is of another one.
        let behind_max = self.last.sequence.wrapping_sub(self.first).min(KEPT as u32 - 1);
        match &self.newest[Self::place(frame)] {
            Some(kept) if kept.sequence == frame.sequence => kept == frame,
            _ => {
                let is_behind = (1..=behind_max).contains(&behind) && frame.time_us < self.last.time_us;
                is_behind && !frame.status.restarted()
            }
        }
    }

    /// Whether the time that `next` shows goes on from the last sample's and has come by `now`. Where frames are missing, a number that is
    /// near by chance is no sign that it is the same run.
    fn can_show_by(&self, now: HostInstant, next: &Reading) -> bool {
        let (heard, time_us) = self.prompt;
        let shown_us = next.time_us.wrapping_sub(time_us);
        next.time_us > self.last.time_us && shown_us <= 2 * now.us_since(heard) + GAP_MAX_US
    }

    /// Whether `next`, heard at `now`, can be of this run after a gap. It may have waited for a host that stood still, µs. A run that began
    /// anew shows another time than has passed, or a number that is behind, or farther ahead than samples fit into that time. So does a
    /// pad that ran while the host slept, whose zero is as old as that.
    fn goes_on_after_gap(&self, now: HostInstant, next: &Reading, waited_us: u64) -> bool {
        let (heard, time_us) = self.prompt;
        let passed_us = now.us_since(heard);
        let off_us = passed_us / PACE_OFF + GAP_MAX_US;
        let in_time_us = passed_us.saturating_sub(off_us + waited_us)..=passed_us + off_us;
        let is_in_time = shown_us(time_us, next).is_some_and(|shown_us| in_time_us.contains(&shown_us));
        let ahead = next.sequence.wrapping_sub(self.last.sequence);
        let missing_us = shown_us(self.last.time_us, next);
        is_in_time
            && missing_us.is_some_and(|us| u64::from(ahead) <= (us / PERIOD_MIN_US).max(SKIPPED_MAX.into()))
    }
}

/// How much later than `time_us` the pad's clock shows at `next`, which may have begun again at zero; `None` if it is earlier.
fn shown_us(time_us: u64, next: &Reading) -> Option<u64> {
    let shown_us = next.time_us.wrapping_sub(time_us);
    (shown_us <= u64::MAX / 2).then_some(shown_us)
}

/// Whether `next` is one of the next samples after `last`, by number and by the pad's clock.
fn goes_on_closely(last: &Reading, next: &Reading) -> bool {
    let ahead = next.sequence.wrapping_sub(last.sequence);
    let shown_us = next.time_us.wrapping_sub(last.time_us);
    (1..=SKIPPED_MAX).contains(&ahead) && (1..=GAP_MAX_US).contains(&shown_us)
}

/// Frames that do not go on from the last sample, but from one another.
#[derive(Clone, Copy, Debug)]
pub(super) struct OtherRun {
    newest: Reading,
    pub(super) frames: u32,
    /// All that came since the last sample.
    total: u32,
}

impl OtherRun {
    /// The run that `sample` goes on, if it does, or begins.
    pub(super) fn with(run: Option<Self>, sample: &Reading) -> Self {
        let frames = run.filter(|run| goes_on_closely(&run.newest, sample)).map_or(0, |run| run.frames);
        Self { newest: *sample, frames: frames + 1, total: run.map_or(0, |run| run.total) + 1 }
    }

    /// Whether `sample` is the next one of it.
    pub(super) fn is_followed_by(&self, sample: &Reading) -> bool {
        sample.sequence.wrapping_sub(self.newest.sequence) == 1 && goes_on_closely(&self.newest, sample)
    }

    /// Whether so many came since the last sample that a sample that goes on from that one after all does so by chance.
    pub(super) const fn is_many(&self) -> bool {
        self.total >= RUN_FRAMES
    }

    /// Whether it is long enough to be the pad's own.
    pub(super) const fn is_believed(&self) -> bool {
        self.frames >= RUN_FRAMES
    }
}
