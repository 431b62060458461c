//! How samples follow one another by number and time, and when one that does not shows that the pad began anew.

use firmware_proto::sample::Sample;

use super::clock::GAP_MAX_US;

/// No pad samples faster than once in so many microseconds.
const PERIOD_MIN_US: u64 = 50;

/// So many frames may be missing between two that go on from one another, whatever time has passed.
const SKIPPED_MAX: u32 = 64;

/// So many of the newest frames are kept, to tell one that comes again from one of a run that began anew.
const KEPT: usize = 64;

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

/// The newest frames, each in the place of its number.
#[derive(Clone, Debug)]
pub(super) struct NewestFrames([Option<Sample>; KEPT]);

impl NewestFrames {
    /// None has come.
    pub(super) const fn new() -> Self {
        Self([None; KEPT])
    }

    const fn place(sample: &Sample) -> usize {
        sample.sequence as usize % KEPT
    }

    /// Keeps a frame in place of an older one.
    pub(super) fn keep(&mut self, sample: &Sample) {
        self.0[Self::place(sample)] = Some(*sample);
    }

    /// Whether this very frame is among them. A pad that began anew a moment ago sends the same numbers with other contents.
    fn contain(&self, sample: &Sample) -> bool {
        self.0[Self::place(sample)] == Some(*sample)
    }
}

/// The step from `last` to `next`, which came `passed_us` of host time later than the last of the newest frames.
pub(super) fn step_between(
    newest: &NewestFrames,
    last: &Sample,
    next: &Sample,
    passed_us: u64,
) -> SequenceStep {
    if newest.contain(next) {
        return SequenceStep::Again;
    }
    if next.status.restarted() {
        // The first frame of a run may come again, too.
        let is_behind = next.time_us <= last.time_us;
        return if is_behind { SequenceStep::Apart } else { SequenceStep::Anew };
    }
    match next.sequence.wrapping_sub(last.sequence) {
        0 => SequenceStep::Apart,
        1 => SequenceStep::Next,
        ahead if ahead <= SKIPPED_MAX || goes_on_after_gap(last, next, passed_us) => {
            SequenceStep::Skipped(ahead - 1)
        }
        _ => SequenceStep::Apart,
    }
}

/// The step from the last sample before a silence to `next`, which came `passed_us` of host time later. Nobody counts what is
/// missing. The samples of a pad that kept them meanwhile come late, and go on by number and time from where it fell silent.
pub(super) fn step_over_silence(last: &Sample, next: &Sample, passed_us: u64) -> SequenceStep {
    if next.status.restarted() {
        SequenceStep::Anew
    } else if goes_on_closely(last, next)
        || next.sequence != last.sequence && goes_on_after_gap(last, next, passed_us)
    {
        SequenceStep::Next
    } else {
        SequenceStep::Apart
    }
}

/// Whether `next` is one of the next samples of the run of `last`, by number and by the pad's clock.
fn goes_on_closely(last: &Sample, next: &Sample) -> bool {
    let ahead = next.sequence.wrapping_sub(last.sequence);
    let shown_us = next.time_us.wrapping_sub(last.time_us);
    (1..=SKIPPED_MAX).contains(&ahead) && (1..=GAP_MAX_US).contains(&shown_us)
}

/// Whether `next` can be of the run of `last` after a gap of `passed_us` of host time. A run that began anew shows another time
/// than has passed, or a number that is behind, or farther ahead than samples fit into that time. So does a pad that ran while
/// the host slept, whose zero is as old as that.
fn goes_on_after_gap(last: &Sample, next: &Sample, passed_us: u64) -> bool {
    let ahead = next.sequence.wrapping_sub(last.sequence);
    next.time_us.checked_sub(last.time_us).is_some_and(|shown_us| {
        (passed_us / 2..=2 * passed_us + GAP_MAX_US).contains(&shown_us)
            && u64::from(ahead) <= (shown_us / PERIOD_MIN_US).max(SKIPPED_MAX.into())
    })
}

/// Frames that do not go on from the last sample, but from one another.
#[derive(Clone, Copy, Debug)]
pub(super) struct OtherRun {
    newest: Sample,
    pub(super) frames: u32,
}

impl OtherRun {
    /// The run that `sample` goes on, if it does, or begins.
    pub(super) fn with(run: Option<Self>, sample: &Sample) -> Self {
        let frames = run.filter(|run| goes_on_closely(&run.newest, sample)).map_or(0, |run| run.frames);
        Self { newest: *sample, frames: frames + 1 }
    }

    /// Whether it is long enough to be the pad's own.
    pub(super) const fn is_believed(&self) -> bool {
        self.frames >= RUN_FRAMES
    }
}
