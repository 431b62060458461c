//! What may keep a pad from playing, by the simulator's knowledge, and which words are right about it.

use crate::state::State;
use tactpad_core::pipeline::line_check::LineFinding;
use tactpad_core::quantity::CHANNELS;
use tactpad_core::time::HostInstant;

/// Something that keeps a pad from playing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Cause {
    /// It is pulled out.
    Unplugged,
    /// Its port may not be opened.
    Denied,
    /// What is plugged in cannot be used.
    Unusable,
    /// It says nothing.
    Silent,
    /// The player paused.
    Paused,
    /// A finger is on it.
    Touched,
    /// A finger is on it since the zero was measured, or may have been, so that the zero is a load: what comes after looks like no finger.
    ZeroUnderLoad,
    /// A weight is weighed.
    Weighing,
    /// A channel is off.
    Channel,
    /// Several channels are off at once, or one after the other with no moment between in which the pad was sound and untouched.
    Channels,
    /// Frames are lost or damaged.
    Loss,
    /// Its clock does not count microseconds.
    Clock,
    /// The loop does not come to run.
    Frozen,
    /// What it sent while it was silent comes now.
    Delayed,
    /// It begins anew.
    Restarted,
    /// Its sequence number has too few bits, and begins again.
    Wraps,
    /// It began anew without a word, and went on by number and clock from where it was: it looks as if a finger had come.
    UnflaggedRestart,
    /// An old frame came again.
    RepeatedFrame,
    /// Something was over in a moment: a zero that somebody wants anew.
    ZeroRequested,
}

use Cause::{
    Channel, Channels, Clock, Delayed, Denied, Frozen, Loss, Paused, RepeatedFrame, Restarted, Silent,
    Touched, UnflaggedRestart, Unplugged, Unusable, Weighing, Wraps, ZeroRequested, ZeroUnderLoad,
};

const ALL: [Cause; 19] = [
    Unplugged,
    Denied,
    Unusable,
    Silent,
    Paused,
    Touched,
    ZeroUnderLoad,
    Weighing,
    Channel,
    Channels,
    Loss,
    Clock,
    Frozen,
    Delayed,
    Restarted,
    Wraps,
    UnflaggedRestart,
    RepeatedFrame,
    ZeroRequested,
];

impl Cause {
    /// So long after it is over the pad plays, µs: half a second. A port is looked for four times a second, and where the clock's pace is in
    /// doubt the pad is looked at for a second first. Several channels that are off look like several fingers, which play for ten
    /// seconds, and so may other offsets.
    const fn aftermath_us(self) -> u64 {
        match self {
            Unplugged | Denied | Unusable => 750_000,
            Clock | Delayed => 1_500_000,
            Channels | UnflaggedRestart => 10_500_000,
            RepeatedFrame => 100_000,
            _ => 500_000,
        }
    }

    /// Whether this state is one that comes of it.
    const fn explains(self, state: State) -> bool {
        match self {
            Unplugged => matches!(state, State::Waiting),
            Denied => matches!(state, State::Denied),
            Unusable => matches!(state, State::Unclear),
            Silent | Frozen => matches!(state, State::Silent | State::Doubtful),
            Paused => matches!(state, State::Paused),
            // A finger that comes while a pad plays keeps nothing from playing.
            Touched => false,
            ZeroUnderLoad => matches!(state, State::Loaded | State::Taring | State::Faulty | State::Doubtful),
            Weighing => matches!(state, State::Weighing),
            Channel | Channels | UnflaggedRestart => {
                matches!(state, State::Faulty | State::Doubtful | State::Taring | State::Loaded)
            }
            RepeatedFrame => matches!(state, State::Doubtful),
            Loss | Clock => matches!(state, State::Doubtful | State::Silent),
            Delayed => matches!(state, State::Doubtful | State::Silent),
            Restarted | Wraps | ZeroRequested => {
                matches!(state, State::Taring | State::Doubtful | State::Silent)
            }
        }
    }

    /// Whether this finding about the stream is true of it.
    const fn is_found_as(self, finding: &LineFinding) -> bool {
        match finding {
            LineFinding::Loss { .. } => matches!(self, Loss | Frozen | Silent),
            LineFinding::Clock { .. } => matches!(self, Clock),
            LineFinding::ChannelStands { .. } => matches!(self, Channel | Channels),
            // That is what is seen of a pad that begins anew again and again, does not say so, and whose clock goes on.
            LineFinding::SequenceWraps { .. } => matches!(self, Restarted | Wraps),
            _ => false,
        }
    }
}

/// When each cause was there last.
#[derive(Clone, Debug, Default)]
pub(super) struct Causes {
    there: [Option<HostInstant>; ALL.len()],
    /// When each channel was off last.
    off: [Option<HostInstant>; CHANNELS],
    /// When the pad had not been sound and untouched for long enough since each channel was off.
    off_since_sound: [Option<HostInstant>; CHANNELS],
}

impl Causes {
    /// It is there at `now`.
    pub(super) fn note(&mut self, now: HostInstant, cause: Cause) {
        self.there[cause as usize] = Some(now);
    }

    /// These channels are off at `now`, and those were since the pad was sound.
    pub(super) fn note_off(
        &mut self,
        now: HostInstant,
        off: [bool; CHANNELS],
        since_sound: [bool; CHANNELS],
    ) {
        for (at, _) in self.off.iter_mut().zip(off).filter(|(_, is_off)| *is_off) {
            *at = Some(now);
        }
        for (at, _) in self.off_since_sound.iter_mut().zip(since_sound).filter(|(_, was_off)| *was_off) {
            *at = Some(now);
        }
    }

    /// What was there within the last `us` is there at `now`.
    pub(super) fn note_again(&mut self, now: HostInstant, us: u64) {
        for at in self.there.iter_mut().chain(&mut self.off).chain(&mut self.off_since_sound) {
            *at = at.map(|at| if now.us_since(at) <= us { now } else { at });
        }
    }

    /// Whether this channel was off within the last `us`.
    pub(super) fn was_off(&self, now: HostInstant, us: u64, channel: usize) -> bool {
        self.off[channel].is_some_and(|at| now.us_since(at) <= us)
    }

    /// The same of one that may have become its own zero meanwhile: it reads otherwise when it is sound again.
    pub(super) fn was_off_since_sound(&self, now: HostInstant, us: u64, channel: usize) -> bool {
        self.off_since_sound[channel].is_some_and(|at| now.us_since(at) <= us)
    }

    /// Whether it no longer keeps a pad from playing.
    pub(super) fn has_passed(&self, now: HostInstant, cause: Cause) -> bool {
        self.there[cause as usize].is_none_or(|at| now.us_since(at) > cause.aftermath_us())
    }

    /// When it was there last.
    pub(super) fn last(&self, cause: Cause) -> Option<HostInstant> {
        self.there[cause as usize]
    }

    /// Those that were there within the last `us`.
    pub(super) fn within(&self, now: HostInstant, us: u64) -> impl Iterator<Item = Cause> {
        ALL.into_iter()
            .filter(move |cause| self.there[*cause as usize].is_some_and(|at| now.us_since(at) <= us))
    }

    /// Whether a pad has to play, with a finger on it or without: whatever kept it from that is over for long enough.
    pub(super) fn have_passed(&self, now: HostInstant) -> bool {
        ALL.into_iter().all(|cause| cause == Touched || self.has_passed(now, cause))
    }

    /// Whether nothing at all was wrong for `us`.
    pub(super) fn are_away_for(&self, now: HostInstant, us: u64) -> bool {
        self.within(now, us).next().is_none()
    }

    /// Whether a cause makes this state right that was there within the last `us`, or whose aftermath lasts still.
    pub(super) fn explain(&self, now: HostInstant, us: u64, state: State) -> bool {
        ALL.into_iter().any(|cause| {
            let lasts_us = us.max(cause.aftermath_us());
            cause.explains(state) && self.there[cause as usize].is_some_and(|at| now.us_since(at) <= lasts_us)
        })
    }

    /// Whether a cause within the last `us` makes this finding right.
    pub(super) fn make_true(&self, now: HostInstant, us: u64, finding: &LineFinding) -> bool {
        self.within(now, us).any(|cause| cause.is_found_as(finding))
    }
}
