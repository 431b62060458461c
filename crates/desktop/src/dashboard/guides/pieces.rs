//! What of a recording belongs to cues: the stretches in which they were answered, one after the other.

use super::permutation_test::FeltPress;
use tactpad_core::quantity::Contact;
use tactpad_core::time::StreamInstant;
use tactpad_lab::tuning::trace::{Trace, TraceEvents, TracePoint};

/// So much before the first touch of a cue and after the last belongs to it.
const LEAD_US: u64 = 300_000;
pub(super) const TAIL_US: u64 = 600_000;

/// A cue, by the number of its target, and from when to when it was answered.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Answer {
    pub(super) target: usize,
    pub(super) begin_us: u64,
    pub(super) end_us: u64,
}

/// Stretches of a recording without the time between them.
#[derive(Debug, Default)]
pub(super) struct Pieces {
    pub(super) trace: Trace,
    /// The cues in the time of this trace.
    pub(super) answers: Vec<Answer>,
}

impl Pieces {
    /// Of stretches of a recording: the target of each cue, and what came from when it was given until after the pad was left.
    pub(super) fn of(stretches: impl IntoIterator<Item = (usize, Trace)>) -> Self {
        let (mut moments, mut answers, mut now_us) = (Vec::new(), Vec::new(), 0);
        for (target, trace) in stretches {
            let all_us = trace.duration_us();
            let mut touched_us =
                trace.moments().iter().filter(|it| touch(it).is_some()).map(|it| it.at.as_us());
            let first_us = touched_us.next();
            let end_us = touched_us.next_back().or(first_us).unwrap_or(all_us);
            let from_us = first_us.map_or(0, |us| us.saturating_sub(LEAD_US));
            let to_us = end_us + TAIL_US;
            let moved = |us: u64| us - from_us + now_us;
            let own = within(&trace, from_us, to_us).iter();
            moments
                .extend(own.map(|it| TracePoint { at: StreamInstant::from_us(moved(it.at.as_us())), ..*it }));
            answers.push(Answer { target, begin_us: moved(from_us), end_us: moved(end_us) + 1 });
            now_us = moved(to_us) + 1;
        }
        Self { trace: Trace::new(moments), answers }
    }

    /// The press that came for each cue.
    pub(super) fn presses(&self) -> Vec<(usize, FeltPress)> {
        let press =
            |answer: &Answer| (answer.target, felt(within(&self.trace, answer.begin_us, answer.end_us)));
        self.answers.iter().map(press).collect()
    }
}

fn within(trace: &Trace, from_us: u64, to_us: u64) -> &[TracePoint] {
    let moments = trace.moments();
    let before = |us: u64| moments.partition_point(|it| it.at.as_us() < us);
    moments.get(before(from_us)..before(to_us)).unwrap_or_default()
}

const fn touch(it: &TracePoint) -> Option<Contact> {
    match it.heard {
        TraceEvents::Contact(contact) => Some(contact),
        TraceEvents::Nothing | TraceEvents::Doubt => None,
    }
}

/// The press of a stretch, where it was pressed most.
fn felt(moments: &[TracePoint]) -> FeltPress {
    let most = moments.iter().filter_map(touch).max_by(|one, other| one.fz_n.total_cmp(&other.fz_n));
    let Some(Contact { x_mm, y_mm, fx_n, fy_n, fz_n }) = most else { return FeltPress::default() };
    let touched_us = moments.windows(2).filter_map(|pair| match pair {
        [one, next] if touch(one).is_some() => Some(next.at.as_us() - one.at.as_us()),
        _ => None,
    });
    FeltPress {
        place_mm: [x_mm, y_mm].map(f64::from),
        force_n: [fx_n, fy_n, fz_n].map(f64::from),
        length_s: touched_us.sum::<u64>() as f64 * 1e-6,
    }
}
