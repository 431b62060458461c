//! Rewind: replays the last minute of play with two profiles and compares their presses.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::replay_buffer::{ReplayBuffer, make};
use tactpad_core::pipeline::call::OwnedCall;
use tactpad_core::pipeline::control::OutputEvent;
use tactpad_core::pipeline::mapping::plain::{controls, named};
use tactpad_core::pipeline::mapping::profile::Profile;
use tactpad_core::pipeline::mapping::read::check::{self, OutputChoice};
use tactpad_lab::tuning::difference::{Difference, Press, Side, UnmatchedPress, presses};

/// Two profiles to compare.
#[derive(Debug, Deserialize)]
pub(super) struct RewindRequest {
    /// The changed one,
    text: String,
    /// and the one that it is held against; without it the one that is played.
    saved: Option<String>,
}

/// The presses of both profiles, compared.
#[derive(Debug, Serialize)]
pub(super) struct RewindAnswer {
    ok: bool,
    /// So long was the play.
    seconds: f64,
    now: PressCounts,
    draft: PressCounts,
    /// What people call the controls.
    names: BTreeMap<String, String>,
    /// How many presses both give.
    both: usize,
    /// By how much the later one of them is later at most.
    shift_max_ms: f64,
    only_now: Vec<JsonUnmatchedPress>,
    only_draft: Vec<JsonUnmatchedPress>,
}

/// How many presses there are of each control.
#[derive(Debug, Serialize)]
struct PressCounts {
    downs: usize,
    presses: BTreeMap<String, usize>,
}

/// A press that only one of both gives.
#[derive(Debug, Serialize)]
struct JsonUnmatchedPress {
    #[serde(flatten)]
    press: Press,
    /// The control as bindings write it.
    control: String,
    /// Since the beginning of the play.
    at_s: f64,
}

/// Why nothing can be compared.
#[derive(Debug, PartialEq, Eq)]
pub(super) enum RewindError {
    /// A profile has errors.
    Errors,
    /// Nothing was played yet.
    NoPlay,
}

impl RewindRequest {
    /// Plays the past once more with each profile. It takes about a third of a second for a minute at 1 kHz.
    pub(super) fn answer(
        &self,
        past: Option<ReplayBuffer>,
        output: OutputChoice,
    ) -> Result<RewindAnswer, RewindError> {
        let past = past.filter(|past| past.duration_us() > 0).ok_or(RewindError::NoPlay)?;
        let read = |text: &str| check::read(text, output).0.ok_or(RewindError::Errors);
        let draft = read(&self.text)?;
        let now = self.saved.as_deref().map_or_else(|| Ok(past.begin.profile().clone()), read)?;
        let labels = named::labels(&draft);
        let [now, draft] = [now, draft].map(|profile| replayed(&past, profile));
        let begin_us = past.begin.at().as_us();
        Ok(RewindAnswer::of(past.duration_us(), begin_us, &labels, [&now, &draft]))
    }
}

/// The events of the past with another profile; changes of it are left out.
fn replayed(past: &ReplayBuffer, profile: Profile) -> Vec<OutputEvent> {
    let mut pipeline = past.begin.clone();
    let Some((begin, _)) = past.calls.front() else { return Vec::new() };
    pipeline.set_profile(*begin, profile);
    let mut events = Vec::new();
    for (at, call) in past.calls.iter().filter(|(_, call)| !matches!(call, OwnedCall::Profile(_))) {
        make(&mut pipeline, *at, call, |pipeline| {
            events.extend_from_slice(pipeline.events());
            pipeline.forget_verdicts();
        });
    }
    events
}

impl RewindAnswer {
    fn of(
        duration_us: u64,
        begin_us: u64,
        labels: &BTreeMap<String, String>,
        [now, draft]: [&[OutputEvent]; 2],
    ) -> Self {
        let Difference { both, shift_max_us, only, .. } = Difference::between(now, draft);
        let once = |only: &UnmatchedPress| JsonUnmatchedPress {
            press: only.press,
            control: control(&only.press),
            at_s: only.press.t_us.saturating_sub(begin_us) as f64 * 1e-6,
        };
        let of = |side: Side| only.iter().filter(|it| it.with == side).map(once).collect();
        let name = |it: Press| (control(&it), named::control(labels, it.device, it.code, it.value));
        Self {
            ok: true,
            seconds: duration_us as f64 * 1e-6,
            now: PressCounts::of(now),
            draft: PressCounts::of(draft),
            names: [now, draft].into_iter().flat_map(presses).map(name).collect(),
            both,
            shift_max_ms: shift_max_us as f64 * 1e-3,
            only_now: of(Side::Old),
            only_draft: of(Side::New),
        }
    }
}

/// A press's control as bindings write it.
fn control(press: &Press) -> String {
    controls::written(press.code, press.value)
}

impl PressCounts {
    fn of(events: &[OutputEvent]) -> Self {
        let all = presses(events);
        let mut tally = Self { downs: all.len(), presses: BTreeMap::new() };
        for press in all {
            *tally.presses.entry(control(&press)).or_default() += 1;
        }
        tally
    }
}
