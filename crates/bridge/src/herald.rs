//! What of the bridge's doings is told to people, and when.

use crate::snapshot::Drops;
use crate::state::State;
use crate::weighing::gain_sentence;
use tactpad_core::pipeline::contact::watch::Warning;
use tactpad_core::pipeline::weighing::{Progress, WeighingReport};
use tactpad_core::time::HostInstant;

/// Says a state when it has lasted, so that a flicker is not told; but at once what the player must do.
#[derive(Clone, Copy, Debug)]
pub(super) struct Herald {
    told: State,
    candidate: State,
    since: HostInstant,
    /// The lasting warning that was told last.
    warned: Option<Warning>,
    /// Whether it was told that groups are dropped, and that calls are not recorded.
    told_drops: (bool, bool),
    /// The weighing whose end was told last.
    weighed: u64,
}

/// A state that lasts this long is told.
const LASTING_US: u64 = 1_000_000;

impl Herald {
    /// Nothing needs to be told while all is well.
    pub(super) const fn new(now: HostInstant) -> Self {
        Self {
            told: State::Playing,
            candidate: State::Playing,
            since: now,
            warned: None,
            told_drops: (false, false),
            weighed: 0,
        }
    }

    /// The state to tell now, if there is one.
    pub(super) fn hear(&mut self, now: HostInstant, state: State) -> Option<State> {
        if state != self.candidate {
            (self.candidate, self.since) = (state, now);
        }
        // A lift may be all that there is of it, and a press that is not heard must not go without a word.
        let lasts = state == State::Loaded || now.us_since(self.since) >= LASTING_US;
        (lasts && state != self.told).then(|| {
            self.told = state;
            state
        })
    }

    /// The warning to tell now, if there is one: each that lasts is told once.
    pub(super) fn warn(&mut self, warning: Option<Warning>) -> Option<Warning> {
        let lasting = warning.filter(|warning| warning.lasts() && self.warned != Some(*warning));
        self.warned = lasting.or(self.warned);
        lasting
    }

    /// What came of a weighing, once it has ended.
    pub(super) fn weighed(&mut self, account: Option<&WeighingReport>) -> Option<String> {
        let WeighingReport { number, progress: Progress::Ended(outcome), .. } = account? else { return None };
        (std::mem::replace(&mut self.weighed, *number) != *number).then(|| match outcome {
            Ok(weighed) => gain_sentence(weighed.factor).unwrap_or_else(|| UNCHANGED.into()),
            Err(error) => format!("the weighing failed: {error}"),
        })
    }

    /// What to tell of things that nobody took in time: each kind is told once.
    pub(super) fn drops(&mut self, drops: Drops) -> [Option<&'static str>; 2] {
        let Drops { groups_dropped, calls_unrecorded } = drops;
        let now = (groups_dropped > 0, calls_unrecorded > 0);
        let before = std::mem::replace(&mut self.told_drops, now);
        [(now.0 && !before.0).then_some(GROUPS_DROPPED), (now.1 && !before.1).then_some(CALLS_UNRECORDED)]
    }
}

const UNCHANGED: &str = "the pad reads what it read when it was calibrated";

const GROUPS_DROPPED: &str =
    "the event log is not read in time: groups of events are dropped and counted until it is";

const CALLS_UNRECORDED: &str =
    "the capture ends here and says so: its file takes no more; playing goes on, and calls are counted";

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_kind_of_drop_is_told_once() {
        let mut herald = Herald::new(HostInstant::default());
        let drops = [(0, 0), (1, 0), (5, 0), (5, 1), (6, 2)];
        let told = drops.map(|(groups_dropped, calls_unrecorded)| {
            herald.drops(Drops { groups_dropped, calls_unrecorded }).map(|line| line.is_some())
        });
        assert_eq!(told, [[false, false], [true, false], [false, false], [false, true], [false, false]]);
    }

    #[test]
    fn only_what_lasts_is_told_and_only_once() {
        let at = |ms: u64| HostInstant::default().plus_us(ms * 1_000);
        let mut herald = Herald::new(at(0));
        let mut told = Vec::new();
        for ms in (0..6_000).step_by(40) {
            let state = match ms {
                0..2_000 if ms % 80 == 0 => State::Doubtful,
                0..2_000 => State::Playing,
                2_000..4_000 => State::Waiting,
                _ => State::Playing,
            };
            told.extend(herald.hear(at(ms), state).map(|state| (ms, state)));
        }
        assert_eq!(told, [(3_000, State::Waiting), (5_000, State::Playing)]);
    }

    #[test]
    fn a_finger_in_the_way_is_told_at_once_and_once_however_often_it_comes() {
        let at = |ms: u64| HostInstant::default().plus_us(ms * 1_000);
        let mut herald = Herald::new(at(0));
        let state = |ms: u64| if (ms / 200).is_multiple_of(2) { State::Taring } else { State::Loaded };
        let told: Vec<_> =
            (0..900).step_by(40).filter_map(|ms| Some((ms, herald.hear(at(ms), state(ms))?))).collect();
        assert_eq!(told, [(200, State::Loaded)]);
    }
}
