//! The notifier: decides which states, warnings and losses of the bridge are reported to people, and when.

use std::mem::{Discriminant, discriminant};

use crate::snapshot::Drops;
use crate::state::State;
use crate::weighing::gain_sentence;
use tactpad_core::pipeline::contact::watch::Warning;
use tactpad_core::pipeline::line_check::LineFinding;
use tactpad_core::pipeline::weighing::{Progress, WeighingReport};
use tactpad_core::time::HostInstant;

/// Debounces reports: a state is reported once it has lasted for a second. A state in which the player must act is reported at once.
#[derive(Clone, Copy, Debug)]
pub(super) struct Notifier {
    /// The state that was reported last.
    reported: State,
    /// The current state, and since when it lasts.
    candidate: State,
    since: HostInstant,
    /// The lasting warning that was reported last.
    reported_warning: Option<Warning>,
    /// Whether it was reported that groups of events were dropped.
    reported_groups: bool,
    /// Whether it was reported that calls were not recorded.
    reported_calls: bool,
    /// The number of the weighing whose end was reported last.
    reported_weighing: u64,
    /// What was reported to be wrong with the pad's stream, if that is still so, …
    reported_line: Option<Discriminant<LineFinding>>,
    /// … and since when, if it was ever reported.
    line_since: Option<HostInstant>,
}

/// A state that lasts this long is reported, in microseconds.
const LASTING_US: u64 = 1_000_000;

impl Notifier {
    /// A notifier that reports nothing as long as the bridge plays.
    pub(super) const fn new(now: HostInstant) -> Self {
        Self {
            reported: State::Playing,
            candidate: State::Playing,
            since: now,
            reported_warning: None,
            reported_groups: false,
            reported_calls: false,
            reported_weighing: 0,
            reported_line: None,
            line_since: None,
        }
    }

    /// The state to report at `now`, if there is one.
    pub(super) fn state_to_report(&mut self, now: HostInstant, state: State) -> Option<State> {
        if state != self.candidate {
            (self.candidate, self.since) = (state, now);
        }
        // A lift may be all that there is of it, and a press that is not heard must not go without a word.
        let lasts = state == State::Loaded || now.us_since(self.since) >= LASTING_US;
        (lasts && state != self.reported).then(|| {
            self.reported = state;
            state
        })
    }

    /// The warning to report now, if there is one: each that lasts is reported once.
    pub(super) fn warning_to_report(&mut self, warning: Option<Warning>) -> Option<Warning> {
        let lasting = warning.filter(|warning| warning.lasts() && self.reported_warning != Some(*warning));
        self.reported_warning = lasting.or(self.reported_warning);
        lasting
    }

    /// What to report of the pad's stream at `now`: what is wrong with it, or that nothing is any more and for how long it was.
    pub(super) fn line_to_report(
        &mut self,
        now: HostInstant,
        finding: Option<&LineFinding>,
    ) -> Option<String> {
        let kind = finding.map(discriminant);
        if std::mem::replace(&mut self.reported_line, kind) == kind {
            return None;
        }
        let since = self.line_since.replace(now);
        match (finding, since) {
            (Some(finding), _) => Some(finding.to_string()),
            (None, Some(since)) => Some(format!(
                "the pad's stream is in order again, after {} s",
                now.us_since(since) / 1_000_000
            )),
            (None, None) => None,
        }
    }

    /// The result of a weighing to report, once it has ended.
    pub(super) fn weighing_to_report(&mut self, account: Option<&WeighingReport>) -> Option<String> {
        let WeighingReport { number, progress: Progress::Ended(outcome), .. } = account? else { return None };
        (std::mem::replace(&mut self.reported_weighing, *number) != *number).then(|| match outcome {
            Ok(weighed) => gain_sentence(weighed.factor).unwrap_or_else(|| UNCHANGED.into()),
            Err(error) => format!("the weighing failed: {error}"),
        })
    }

    /// Messages about events and calls that were dropped: each kind is reported once.
    pub(super) fn drops_to_report(&mut self, drops: Drops) -> [Option<&'static str>; 2] {
        let Drops { groups_dropped, calls_unrecorded } = drops;
        let is_new = |is_dropped: bool, reported: &mut bool| {
            let was_reported = std::mem::replace(reported, is_dropped);
            is_dropped && !was_reported
        };
        [
            is_new(groups_dropped > 0, &mut self.reported_groups).then_some(GROUPS_DROPPED),
            is_new(calls_unrecorded > 0, &mut self.reported_calls).then_some(CALLS_UNRECORDED),
        ]
    }
}

const UNCHANGED: &str = "the pad reads what it read when it was calibrated";

const GROUPS_DROPPED: &str =
    "events are not taken in time: groups of them are dropped and counted until they are";

const CALLS_UNRECORDED: &str =
    "the capture ends here and says so: its file takes no more; playing goes on, and calls are counted";

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_kind_of_drop_is_told_once() {
        let mut notifier = Notifier::new(HostInstant::default());
        let drops = [(0, 0), (1, 0), (5, 0), (5, 1), (6, 2)];
        let reported = drops.map(|(groups_dropped, calls_unrecorded)| {
            notifier.drops_to_report(Drops { groups_dropped, calls_unrecorded }).map(|line| line.is_some())
        });
        assert_eq!(reported, [[false, false], [true, false], [false, false], [false, true], [false, false]]);
    }

    #[test]
    fn a_bad_line_is_told_once_and_taken_back() {
        let at = |s: u64| HostInstant::default().plus_us(s * 1_000_000);
        let mut notifier = Notifier::new(at(0));
        let loss = |percent| LineFinding::Loss { percent };
        assert_eq!(notifier.line_to_report(at(1), None), None);
        let told = notifier.line_to_report(at(2), Some(&loss(2.5))).unwrap();
        assert!(told.starts_with("2.5 % of the pad's frames are lost or damaged"), "{told}");
        assert_eq!(notifier.line_to_report(at(3), Some(&loss(3.5))), None);
        let told = notifier.line_to_report(at(14), None).unwrap();
        assert_eq!(told, "the pad's stream is in order again, after 12 s");
        assert_eq!(notifier.line_to_report(at(15), None), None);
    }

    #[test]
    fn only_what_lasts_is_told_and_only_once() {
        let at = |ms: u64| HostInstant::default().plus_us(ms * 1_000);
        let mut notifier = Notifier::new(at(0));
        let mut told = Vec::new();
        for ms in (0..6_000).step_by(40) {
            let state = match ms {
                0..2_000 if ms % 80 == 0 => State::Doubtful,
                0..2_000 => State::Playing,
                2_000..4_000 => State::Waiting,
                _ => State::Playing,
            };
            told.extend(notifier.state_to_report(at(ms), state).map(|state| (ms, state)));
        }
        assert_eq!(told, [(3_000, State::Waiting), (5_000, State::Playing)]);
    }

    #[test]
    fn a_finger_in_the_way_is_told_at_once_and_once_however_often_it_comes() {
        let at = |ms: u64| HostInstant::default().plus_us(ms * 1_000);
        let mut notifier = Notifier::new(at(0));
        let state = |ms: u64| if (ms / 200).is_multiple_of(2) { State::Taring } else { State::Loaded };
        let told: Vec<_> = (0..900)
            .step_by(40)
            .filter_map(|ms| Some((ms, notifier.state_to_report(at(ms), state(ms))?)))
            .collect();
        assert_eq!(told, [(200, State::Loaded)]);
    }
}
