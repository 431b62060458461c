//! The force range: light and hard presses in a drawn order, and a profile whose forces suit them.

use super::cue_sequence::CueTarget;
use super::guide::{GuideContext, GuideResult, GuideStatus, PageGuide, Proposal};
use super::pieces::Pieces;
use super::recording::{NO_NAME, Recording};
use crate::dashboard::practice::{Level, PressWish, Wish};
use tactpad_bridge::request::Request;
use tactpad_core::counted::counted;
use tactpad_core::pipeline::mapping::read::check::{self, OutputChoice};
use tactpad_lab::tuning::fitting::Fitted;
use tactpad_lab::tuning::force_range::fit::{ForceRangeError, fit};
use tactpad_lab::tuning::force_range::peaks::Peaks;
use tactpad_lab::tuning::force_range::range::{PRESSES_MIN, Range};
use tactpad_lab::tuning::words;

/// Each kind of press is asked for so often.
const REPEATS: usize = 8;

/// The guide.
#[derive(Default)]
pub(super) struct ForceRange {
    recording: Recording,
    /// The profile that is fitted: its name and its text.
    profile: (String, String),
}

/// The kinds of presses: light ones, then hard ones.
pub(super) fn kinds() -> Vec<CueTarget> {
    let kind = |word: &str, cue: &str, level| CueTarget {
        word: word.into(),
        cue: cue.into(),
        wish: Wish::Press(PressWish {
            at_mm: [0.0; 2],
            push: [0.0; 2],
            level,
            is_long: false,
            is_double: false,
        }),
    };
    vec![
        kind("light", "press in the middle, as lightly as feels sure", Level::Light),
        kind("hard", "press in the middle, as hard as is comfortable", Level::Hard),
    ]
}

impl PageGuide for ForceRange {
    fn id(&self) -> &'static str {
        "force-range"
    }

    fn start(&mut self, context: &GuideContext<'_>) -> Result<(), String> {
        let profile = (context.profile)().ok_or(NO_NAME)?;
        *self = Self { recording: Recording::begin(context, kinds(), REPEATS)?, profile };
        Ok(())
    }

    fn stop(&mut self, context: &GuideContext<'_>) {
        context.host.practise(Wish::Rest);
        *self = Self::default();
    }

    fn update(&mut self, context: &GuideContext<'_>) {
        let (name, text) = &self.profile;
        let (name, text) = (name.clone(), text.clone());
        self.recording.go_on(context, move |pieces| fitted(&name, &text, pieces));
    }

    fn act(
        &mut self,
        action: &str,
        _number: Option<f64>,
        context: &GuideContext<'_>,
    ) -> Result<Option<Request>, String> {
        self.recording.act(action, context).map(|()| None)
    }

    fn status(&self) -> GuideStatus {
        let text = "Light and hard presses are asked for in no order. Take your time: each waits until you have pressed and lifted the finger.";
        GuideStatus {
            id: self.id(),
            title: "Force range",
            about: "Some light and some hard presses, at your own pace. The forces of the profile in play are then fitted to your hand; you see \
                    them in the editor before anything is saved.",
            state: self.recording.progress(),
            steps: vec![
                self.recording.asking("presses", "Press lightly and hard", text),
                self.recording.working(),
            ],
            result: self.recording.outcome(),
        }
    }
}

/// The profile with the forces of a recording's presses, or why it has none.
pub(super) fn fitted(name: &str, text: &str, pieces: &Pieces) -> Result<GuideResult, String> {
    let profile =
        check::read(text, OutputChoice::AsWritten).0.ok_or("the profile has errors: mend it first")?;
    let presses = pieces.presses();
    let of_kind = |kind: usize| {
        let own = presses.iter().filter(|(target, press)| *target == kind && press.length_s > 0.0);
        own.map(|(_, press)| press.force_n[2]).collect()
    };
    let peaks = Peaks { light_n: of_kind(0), hard_n: of_kind(1) };
    let range = Range::of(&peaks).ok_or_else(|| {
        format!(
            "There were {} and {}, and {PRESSES_MIN} of each are needed: begin anew.",
            counted(peaks.light_n.len(), "light press"),
            counted(peaks.hard_n.len(), "hard press")
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
