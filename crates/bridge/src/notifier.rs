//! The notifier: decides which states, warnings and losses of the bridge are reported to people, and when.

use std::mem::{Discriminant, discriminant};

use crate::snapshot::Drops;
use crate::state::State;
use crate::weighing::gain_sentence;
use tactpad_core::pipeline::contact::watch::Warning;
use tactpad_core::pipeline::line_check::LineFinding;
use tactpad_core::pipeline::weighing::{Progress, WeighingReport};
use tactpad_core::time::HostInstant;

/// Debounces reports: a state is reported once it has lasted for a second. A state in which the player must act is reported at once, and
/// where several take turns, so that nothing plays, one of them after two seconds. That a bridge begins without a pad is reported at once, too.
/// What comes and goes is not reported each time, see [`RateLimit`].
#[derive(Clone, Debug)]
pub(super) struct Notifier {
    /// The state that was reported last.
    reported: State,
    /// The current state, and since when it lasts.
    candidate: State,
    since: HostInstant,
    /// Whether no state was looked at yet.
    begins: bool,
    /// Since when the bridge has not played and nothing was reported.
    untold_since: Option<HostInstant>,
    /// The lasting warning that was reported, if it is still so.
    reported_warning: Option<Warning>,
    /// Whether it was reported that groups of events were dropped.
    reported_groups: bool,
    /// Whether it was reported that calls were not recorded.
    reported_calls: bool,
    /// The number of the weighing whose end was reported last.
    reported_weighing: u64,
    /// What was reported to be wrong with the pad's stream, and when, if that is still so.
    reported_line: Option<(Subject, HostInstant)>,
    /// Whether a state was reported since, so that nobody knows that it is still so.
    is_line_overtaken: bool,
    limit: RateLimit,
}

/// What can be wrong again and again.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Topic {
    State(State),
    Warning(Discriminant<Warning>),
    Line(Subject),
}

/// What a finding is about, whatever its numbers: its kind, and the channel if it is about one.
type Subject = (Discriminant<LineFinding>, Option<usize>);

impl Topic {
    /// How often it is reported in a minute: people bring about states, as by a plug, and look for the answer.
    const fn reports_max(self) -> usize {
        if matches!(self, Self::State(_)) { 3 } else { 1 }
    }
}

/// What was reported within the last minute. A fault that comes and goes would fill the screen.
#[derive(Clone, Debug, Default)]
struct RateLimit {
    reported: Vec<(Topic, HostInstant)>,
}

impl RateLimit {
    /// Whether this may be reported at `now`; then it counts as reported.
    fn allows(&mut self, now: HostInstant, topic: Topic) -> bool {
        self.reported.retain(|(_, at)| now.us_since(*at) < REPEAT_US);
        let reports = self.reported.iter().filter(|(reported, _)| *reported == topic).count();
        let is_allowed = reports < topic.reports_max();
        if is_allowed {
            self.reported.push((topic, now));
        }
        is_allowed
    }
}

/// After so long a thing is reported again, in microseconds.
const REPEAT_US: u64 = 60_000_000;

/// A state that lasts this long is reported, in microseconds.
const LASTING_US: u64 = 1_000_000;

/// So long nothing plays without a word, in microseconds.
const UNTOLD_US: u64 = 2_000_000;

impl Notifier {
    /// A notifier that reports nothing as long as the bridge plays.
    pub(super) fn new(now: HostInstant) -> Self {
        Self {
            reported: State::Playing,
            candidate: State::Playing,
            since: now,
            begins: true,
            untold_since: None,
            reported_warning: None,
            reported_groups: false,
            reported_calls: false,
            reported_weighing: 0,
            reported_line: None,
            is_line_overtaken: false,
            limit: RateLimit::default(),
        }
    }

    /// Whether no state was looked at yet.
    pub(super) const fn begins(&self) -> bool {
        self.begins
    }

    /// The state to report at `now`, if there is one.
    pub(super) fn state_to_report(&mut self, now: HostInstant, state: State) -> Option<State> {
        if state != self.candidate {
            (self.candidate, self.since) = (state, now);
        }
        self.untold_since = if state == State::Playing { None } else { self.untold_since.or(Some(now)) };
        let is_untold = self.untold_since.is_some_and(|since| now.us_since(since) >= UNTOLD_US);
        let begins_without_pad = std::mem::take(&mut self.begins) && state == State::Waiting;
        // A lift may be all that there is of it, and a press that is not heard must not go without a word.
        let is_urgent = state == State::Loaded || begins_without_pad;
        let lasts = is_urgent || now.us_since(self.since) >= LASTING_US || is_untold;
        let is_reported = lasts && state != self.reported && self.limit.allows(now, Topic::State(state));
        is_reported.then(|| {
            (self.reported, self.untold_since, self.is_line_overtaken) = (state, None, true);
            state
        })
    }

    /// The warning to report at `now`, if there is one: one that lasts is reported once, and not again at once if it comes again.
    pub(super) fn warning_to_report(
        &mut self,
        now: HostInstant,
        warning: Option<Warning>,
    ) -> Option<Warning> {
        let lasting = warning.filter(|warning| warning.lasts());
        if lasting.is_none() {
            self.reported_warning = None;
        }
        let new = lasting.filter(|warning| {
            self.reported_warning != Some(*warning)
                && self.limit.allows(now, Topic::Warning(discriminant(warning)))
        });
        self.reported_warning = new.or(self.reported_warning);
        new
    }

    /// What to report of the pad's stream at `now`: what is wrong with it, or that nothing is any more and for how long it was.
    pub(super) fn line_to_report(
        &mut self,
        now: HostInstant,
        finding: Option<&LineFinding>,
    ) -> Option<String> {
        let Some(finding) = finding else {
            let (_, since) = self.reported_line.take()?;
            let seconds = now.us_since(since) / 1_000_000;
            return Some(format!("the pad's stream is in order again, after {seconds} s"));
        };
        let subject = (discriminant(finding), finding.channel());
        let is_new =
            self.is_line_overtaken || self.reported_line.is_none_or(|(reported, _)| reported != subject);
        if !is_new || !self.limit.allows(now, Topic::Line(subject)) {
            return None;
        }
        let since =
            self.reported_line.filter(|(reported, _)| *reported == subject).map_or(now, |(_, since)| since);
        (self.reported_line, self.is_line_overtaken) = (Some((subject, since)), false);
        Some(finding.to_string())
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

    /// At which milliseconds of three minutes something is told, looked at every 40 ms.
    fn told_ms(mut told: impl FnMut(HostInstant, u64) -> bool) -> Vec<u64> {
        (0..180_000).step_by(40).filter(|ms| told(HostInstant::default().plus_us(ms * 1_000), *ms)).collect()
    }

    #[test]
    fn what_comes_and_goes_is_told_once_a_minute() {
        let mut notifier = Notifier::new(HostInstant::default());
        // A fast drift accuses one channel after the other, and sometimes none.
        let warnings = told_ms(|now, ms| {
            let channel = (ms / 480 % 9) as usize;
            let warning = (channel != 4).then_some(Warning::SilentChannel { channel });
            notifier.warning_to_report(now, warning).is_some()
        });
        assert_eq!(warnings, [0, 60_000, 120_000]);
        let mut notifier = Notifier::new(HostInstant::default());
        let lines = told_ms(|now, ms| {
            let finding = (ms / 6_000 % 2 == 0).then_some(LineFinding::Loss { percent: 2.0 });
            notifier.line_to_report(now, finding.as_ref()).is_some()
        });
        assert_eq!(lines, [0, 6_000, 60_000, 66_000, 120_000, 126_000], "and that it is over");
        let mut notifier = Notifier::new(HostInstant::default());
        let states = told_ms(|now, ms| {
            let state = if ms / 1_200 % 2 == 0 { State::Faulty } else { State::Playing };
            notifier.state_to_report(now, state).is_some()
        });
        assert!(states.len() <= 18 && states.len() >= 12, "{states:?}");
    }

    #[test]
    fn another_thing_is_told_at_once() {
        let at = |s: u64| HostInstant::default().plus_us(s * 1_000_000);
        let mut notifier = Notifier::new(at(0));
        assert!(notifier.warning_to_report(at(1), Some(Warning::OtherPad)).is_some());
        assert!(notifier.warning_to_report(at(2), Some(Warning::SilentChannel { channel: 1 })).is_some());
        let stands = LineFinding::SequenceStands { sequence: 3 };
        assert!(notifier.line_to_report(at(3), Some(&stands)).is_some());
        assert!(notifier.line_to_report(at(4), Some(&LineFinding::RestartFlagStays)).is_some());
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
    fn a_begin_without_a_pad_is_told_at_once() {
        let now = HostInstant::default();
        let mut notifier = Notifier::new(now);
        assert_eq!(notifier.state_to_report(now, State::Waiting), Some(State::Waiting));
        assert_eq!(notifier.state_to_report(now.plus_us(2_000_000), State::Waiting), None);
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
