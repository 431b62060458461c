//! Cues in a drawn order, each until it was answered: the pace is the hand's.

use crate::dashboard::practice::Wish;
use tactpad_core::time::HostInstant;
use tactpad_numeric::random::SplitMix64;

/// A press is over once nothing has touched the pad for so long: a second press of a double one comes sooner.
const QUIET_US: u64 = 900_000;

/// Where nothing is to be pressed, that is asked for so long.
const REST_US: u64 = 4_000_000;

/// Something that can be asked for.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct CueTarget {
    /// What labels call it.
    pub(super) word: String,
    /// What people read.
    pub(super) cue: String,
    /// What a hand is to do.
    pub(super) wish: Wish,
}

/// A cue that was answered.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct AnsweredCue {
    pub(super) target: usize,
    /// It was asked for then,
    pub(super) begin: HostInstant,
    /// and the pad was left then.
    pub(super) end: HostInstant,
}

/// What the pad shows at a moment.
#[derive(Clone, Copy, Debug)]
pub(super) struct PadObservation {
    pub(super) now: HostInstant,
    pub(super) is_touched: bool,
    /// Touches since the bridge began.
    pub(super) touches: u64,
}

/// The cues.
#[derive(Debug)]
pub(super) struct CueSequence {
    pub(super) targets: Vec<CueTarget>,
    order: Vec<usize>,
    pub(super) asked: Vec<AnsweredCue>,
    /// When the cue was given, and how many touches there were by then.
    since: PadObservation,
    quiet_since: Option<HostInstant>,
    pub(super) is_paused: bool,
}

impl CueSequence {
    /// Asks for each target so often, in an order that depends on `seed`.
    pub(super) fn begin(targets: Vec<CueTarget>, repeats: usize, seed: u64, seen: PadObservation) -> Self {
        let mut order: Vec<usize> =
            (0..targets.len() * repeats).map(|number| number % targets.len()).collect();
        SplitMix64::named(seed, "cues").shuffle(&mut order);
        Self { targets, order, asked: Vec::new(), since: seen, quiet_since: None, is_paused: false }
    }

    /// How many cues there are.
    pub(super) fn count(&self) -> usize {
        self.order.len()
    }

    /// What is asked for; nothing at the end, and while it pauses.
    pub(super) fn cue(&self) -> Option<&CueTarget> {
        let target = self.order.get(self.asked.len()).filter(|_| !self.is_paused)?;
        self.targets.get(*target)
    }

    /// Whether all cues were answered.
    pub(super) fn is_over(&self) -> bool {
        self.asked.len() >= self.order.len()
    }

    /// Looks at the pad; whether another cue has begun.
    pub(super) fn update(&mut self, seen: PadObservation) -> bool {
        let Some(cue) = self.cue() else { return false };
        let is_rest = cue.wish == Wish::Rest;
        let is_answered = seen.touches > self.since.touches && !seen.is_touched;
        let end = match (is_rest, is_answered) {
            (true, _) => (seen.now.us_since(self.since.now) >= REST_US).then_some(seen.now),
            (false, true) => {
                let quiet_since = *self.quiet_since.get_or_insert(seen.now);
                (seen.now.us_since(quiet_since) >= QUIET_US).then_some(quiet_since)
            }
            (false, false) => {
                self.quiet_since = None;
                None
            }
        };
        let Some((end, target)) = end.zip(self.order.get(self.asked.len()).copied()) else { return false };
        self.asked.push(AnsweredCue { target, begin: self.since.now, end });
        self.ask(seen);
        true
    }

    fn ask(&mut self, seen: PadObservation) {
        (self.since, self.quiet_since) = (seen, None);
    }

    pub(super) fn pause(&mut self) {
        self.is_paused = true;
    }

    /// Goes on after a pause, with the cue that was given.
    pub(super) fn go_on(&mut self, seen: PadObservation) {
        self.is_paused = false;
        self.ask(seen);
    }

    /// Asks for the last one once more.
    pub(super) fn again(&mut self, seen: PadObservation) {
        self.asked.pop();
        self.ask(seen);
    }

    /// Asks no more for what is asked for: this hand cannot do it.
    pub(super) fn leave_out(&mut self, seen: PadObservation) {
        if let Some(left) = self.order.get(self.asked.len()).copied() {
            self.order.retain(|target| *target != left);
            self.asked.retain(|asked| asked.target != left);
        }
        self.ask(seen);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn seen(s: f64, is_touched: bool, touches: u64) -> PadObservation {
        PadObservation { now: HostInstant::default().plus_us((s * 1e6) as u64), is_touched, touches }
    }

    #[test]
    fn a_cue_waits_as_long_as_the_hand_does_and_is_repeated_paused_and_left_out() {
        let target = |word: &str| CueTarget {
            word: word.into(),
            cue: word.into(),
            wish: Wish::Press(crate::dashboard::practice::PressWish {
                at_mm: [0.0; 2],
                push: [0.0; 2],
                level: crate::dashboard::practice::Level::Usual,
                is_long: false,
                is_double: false,
            }),
        };
        let mut asking = CueSequence::begin(vec![target("one"), target("two")], 2, 1, seen(0.0, false, 7));
        assert_eq!(asking.count(), 4);
        assert!(!asking.update(seen(100.0, false, 7)), "nobody is hurried");
        assert!(!asking.update(seen(101.0, true, 8)) && !asking.update(seen(102.0, false, 8)));
        assert!(!asking.update(seen(102.5, true, 9)), "a second press belongs to it");
        assert!(!asking.update(seen(103.0, false, 9)) && asking.update(seen(104.0, false, 9)));
        assert_eq!(asking.asked[0].end, seen(103.0, false, 0).now);
        asking.again(seen(105.0, false, 9));
        assert!(asking.asked.is_empty());
        asking.pause();
        assert!(asking.cue().is_none() && !asking.update(seen(106.0, true, 10)));
        asking.go_on(seen(107.0, false, 10));
        let left = asking.cue().unwrap().word.clone();
        asking.leave_out(seen(108.0, false, 10));
        assert_eq!(asking.count(), 2);
        assert_ne!(asking.cue().unwrap().word, left);
        asking.leave_out(seen(109.0, false, 10));
        assert!(asking.is_over() && asking.asked.is_empty());
    }
}
