//! The force range: half a minute of presses, light and then hard, and a profile whose forces suit them.

use super::guide::{GuideContext, GuideResult, GuideStatus, PageGuide, PageStep, Proposal, StepState};
use super::recording::{NO_NAME, Recording};
use tactpad_core::counted::counted;
use tactpad_core::pipeline::mapping::read::check::{self, OutputChoice};
use tactpad_lab::tuning::fitting::Fitted;
use tactpad_lab::tuning::force_range::fit::{ForceRangeError, fit};
use tactpad_lab::tuning::force_range::peaks::Peaks;
use tactpad_lab::tuning::force_range::range::{PRESSES_MIN, Range};
use tactpad_lab::tuning::trace::Trace;
use tactpad_lab::tuning::words;

/// Each kind of press is recorded so long.
const KIND_US: u64 = 15_000_000;

/// The guide.
#[derive(Default)]
pub(super) struct ForceRange {
    recording: Recording,
    /// The profile that is fitted: its name and its text.
    profile: (String, String),
    /// How many touches there were at the begin, and how many there are since.
    touches_before: u64,
    touches: u64,
}

impl PageGuide for ForceRange {
    fn id(&self) -> &'static str {
        "force-range"
    }

    fn start(&mut self, context: &GuideContext<'_>) -> Result<(), String> {
        let profile = (context.profile)().ok_or(NO_NAME)?;
        let touches_before = context.status.health.pipeline.contacts;
        *self = Self { recording: Recording::begin(context), profile, touches_before, touches: 0 };
        Ok(())
    }

    fn stop(&mut self, _scene: &GuideContext<'_>) {
        *self = Self::default();
    }

    fn update(&mut self, context: &GuideContext<'_>) {
        let (name, text) = self.profile.clone();
        if self.recording.for_us().is_some() {
            self.touches = context.status.health.pipeline.contacts.saturating_sub(self.touches_before);
        }
        self.recording.go_on(context, 2 * KIND_US, move |trace| fitted(&name, &text, trace));
    }

    fn status(&self) -> GuideStatus {
        let recorded_us = self.recording.for_us();
        let part = recorded_us.map(|us| us as f64 / KIND_US as f64);
        let steps = [
            (
                "light",
                "Light presses",
                "Press again and again as lightly as feels sure, and lift the finger after each press.",
            ),
            ("hard", "Hard presses", "And now again and again as hard as is comfortable."),
        ];
        let kinds = (0..).zip(steps).map(|(index, (id, title, text))| {
            let done = part.map(|part| part - f64::from(index));
            let state = self.recording.step(done);
            PageStep {
                state,
                detail: (state == StepState::Doing)
                    .then(|| format!("{} so far", counted(self.touches, "press"))),
                progress: done.filter(|_| state == StepState::Doing),
                ..PageStep::to_do(id, title, text)
            }
        });
        GuideStatus {
            id: self.id(),
            title: "Force range",
            about: "Half a minute of presses. The forces of the profile in play are then fitted to your hand; you see them in the editor before \
                    anything is saved.",
            state: self.recording.progress(),
            steps: kinds.chain([self.recording.working()]).collect(),
            result: self.recording.outcome(),
        }
    }
}

/// The profile with the forces of a recording's presses, or why it has none.
fn fitted(name: &str, text: &str, trace: &Trace) -> Result<GuideResult, String> {
    let profile =
        check::read(text, OutputChoice::AsWritten).0.ok_or("the profile has errors: mend it first")?;
    let peaks = Peaks::of(trace);
    let range = Range::of(&peaks).ok_or_else(|| {
        format!(
            "There were {} light presses and {} hard ones, and {PRESSES_MIN} of each are needed: begin anew.",
            peaks.light_n.len(),
            peaks.hard_n.len()
        )
    })?;
    let Fitted { text, profile, changes } = fit(text, &profile, &range).map_err(|why| unfit(name, why))?;
    let hand = format!(
        "Nine of ten light presses reach {:.2} N, one in ten exceeds {:.2} N. Nine of ten hard presses reach {:.2} N.",
        range.light_n, range.light_most_n, range.hard_n
    );
    if changes.is_empty() {
        return Ok(GuideResult::words(format!("{hand} The profile fits this hand: nothing changes.")));
    }
    let changes: Vec<_> =
        changes.iter().map(|change| words::ChangedNumber::of(change, &profile).words).collect();
    let draft = Some(Proposal { profile: name.to_owned(), text });
    Ok(GuideResult { draft, ..GuideResult::words(format!("{hand} Proposed: {}.", changes.join("; "))) })
}

fn unfit(name: &str, why: ForceRangeError) -> String {
    match why {
        ForceRangeError::NoLevels => format!("{name} asks for no normal force: there is nothing to fit."),
        ForceRangeError::NotApart(Range { light_most_n, hard_n, .. }) => format!(
            "{name} asks for light presses and for hard ones, which this hand does not give surely apart: one light press in ten exceeds \
             {light_most_n:.2} N, one hard press in ten stays below {hard_n:.2} N. Choose a profile that needs one force, as one-button."
        ),
        ForceRangeError::NoProfile(range) => format!(
            "No profile can ask for these forces, {:.2} N to {:.2} N. Measure the zero, and begin anew.",
            range.lowest_n(),
            range.highest_n()
        ),
    }
}
