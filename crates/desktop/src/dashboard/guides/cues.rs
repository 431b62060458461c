//! Half a minute of cues: the page says what to press, and a profile is fitted to what came.

use std::fmt::Write as _;

use super::guide::{
    GuideContext, GuideResult, GuideState, GuideStatus, PageGuide, PageStep, Proposal, StepState,
};
use super::recording::{NO_NAME, Recording};
use tactpad_core::pipeline::mapping::profile::Profile;
use tactpad_core::pipeline::mapping::profile::sketch::Sketch;
use tactpad_core::pipeline::mapping::read::check::{self, OutputChoice};
use tactpad_lab::tuning::fitting::{Fitted, Study};
use tactpad_lab::tuning::labels::{HEADER, Labels};
use tactpad_lab::tuning::trace::Trace;
use tactpad_lab::tuning::words;

/// So many cues are given, …
const CUES: usize = 15;

/// … each for so long, …
const CUE_US: u64 = 2_000_000;

/// … of which the end is for lifting the finger.
const LIFT_US: u64 = 300_000;

/// A fitted profile may decide so late.
const DELAY_MAX_US: u64 = 200_000;

/// The guide.
#[derive(Default)]
pub(super) struct Cues {
    recording: Recording,
    /// The profile that is fitted: its name and its text.
    profile: (String, String),
    /// The targets of presses: each by its word, and as the cue shows it.
    meant: Vec<CueTarget>,
}

/// Something that can be meant.
#[derive(Clone, Debug, PartialEq)]
struct CueTarget {
    word: String,
    cue: String,
}

/// The targets that a profile has: its directions, and the controls of its buttons.
fn meant(profile: &Profile) -> Vec<CueTarget> {
    let directions = profile.dpad.iter().flat_map(|_| ["right", "up", "left", "down"]);
    let mut all: Vec<_> = directions
        .map(|word| CueTarget { word: word.into(), cue: format!("press {word} of the middle") })
        .collect();
    for button in Sketch::of(profile).buttons {
        let is_one = button.does.len() == 1;
        for does in button.does {
            let kind = if is_one { String::new() } else { format!(" {}", does.role) };
            let how = match does.role {
                "tap" => "press shortly",
                "hold" => "press and hold for a second",
                "double" => "press twice, quickly",
                "light" => "press lightly",
                "hard" => "press hard",
                _ => "press",
            };
            all.push(CueTarget {
                word: format!("button {}{kind}", button.number),
                cue: format!("{how}{} ({})", towards(button.force), does.word),
            });
        }
    }
    all
}

/// Where a force pushes.
fn towards(force: &str) -> &'static str {
    match force {
        "fx" => ", pushing to the right",
        "-fx" => ", pushing to the left",
        "fy" => ", pushing away from you",
        "-fy" => ", pushing towards you",
        _ => " in the middle",
    }
}

impl Cues {
    /// The cue at this time since the start, in microseconds, if there is one.
    fn cue(&self, us: u64) -> Option<&CueTarget> {
        let number = usize::try_from(us / CUE_US).ok()?;
        self.meant.get(number % self.meant.len().max(1)).filter(|_| number < CUES)
    }

    /// The cues and their times, as a table of labels.
    fn table(&self) -> String {
        let mut table = format!("{HEADER}\n");
        for number in 0..CUES as u64 {
            let begin_us = number * CUE_US;
            if let Some(meant) = self.cue(begin_us) {
                let [begin_s, end_s] = [begin_us, begin_us + CUE_US - LIFT_US].map(|us| us as f64 * 1e-6);
                let _ = writeln!(table, "{begin_s},{end_s},{}", meant.word);
            }
        }
        table
    }
}

impl PageGuide for Cues {
    fn id(&self) -> &'static str {
        "tune"
    }

    fn start(&mut self, context: &GuideContext<'_>) -> Result<(), String> {
        let (name, text) = (context.profile)().ok_or(NO_NAME)?;
        let profile =
            check::read(&text, OutputChoice::AsWritten).0.ok_or("the profile has errors: mend it first")?;
        let meant = meant(&profile);
        if meant.is_empty() {
            return Err("this profile has neither directions nor buttons: there is nothing to fit".into());
        }
        *self = Self { recording: Recording::begin(context), profile: (name, text), meant };
        Ok(())
    }

    fn stop(&mut self, _scene: &GuideContext<'_>) {
        *self = Self::default();
    }

    fn update(&mut self, context: &GuideContext<'_>) {
        if self.recording.progress() != GuideState::Running {
            return;
        }
        let ((name, text), table) = (self.profile.clone(), self.table());
        self.recording.go_on(context, CUES as u64 * CUE_US, move |trace| fitted(&name, &text, &table, trace));
    }

    fn status(&self) -> GuideStatus {
        let recorded_us = self.recording.for_us();
        let done = recorded_us.map(|us| us as f64 / (CUES as u64 * CUE_US) as f64);
        let state = self.recording.step(done);
        let cue = recorded_us.and_then(|us| Some((us / CUE_US + 1, self.cue(us)?)));
        let text = "Every two seconds you are asked for something else. Do it at once, then lift the finger.";
        let cues = PageStep {
            state,
            detail: cue.map(|(number, _)| format!("{number} of {CUES}")),
            cue: cue.map(|(_, meant)| meant.cue.clone()),
            progress: done.filter(|_| state == StepState::Doing),
            ..PageStep::to_do("cues", "Do what is asked", text)
        };
        GuideStatus {
            id: self.id(),
            title: "Tune in 30 seconds",
            about: "The page asks for presses, and fits the numbers of the profile in play so that more of what you mean comes out. You see \
                    them in the editor before anything is saved.",
            state: self.recording.progress(),
            steps: vec![cues, self.recording.working()],
            result: self.recording.outcome(),
        }
    }
}

/// The profile that gives most of what was asked for.
fn fitted(name: &str, text: &str, table: &str, trace: &Trace) -> Result<GuideResult, String> {
    let profile =
        check::read(text, OutputChoice::AsWritten).0.ok_or("the profile has errors: mend it first")?;
    let labels = Labels::read(table, &profile).map_err(|error| error.to_string())?;
    let study = Study { trace, labels: &labels, delay_max_us: DELAY_MAX_US };
    let before = study.score(&profile).correct();
    let Fitted { text, profile, changes } =
        study.fit(text, &|_, _| ()).ok_or("the profile cannot be fitted")?;
    let after = study.score(&profile).correct();
    let came = format!("{before} of {CUES} came as they were asked for");
    if changes.is_empty() {
        return Ok(GuideResult::words(format!("{came}. No other numbers give more: nothing changes.")));
    }
    let changes: Vec<_> =
        changes.iter().map(|change| words::ChangedNumber::of(change, &profile).words).collect();
    let text_told = format!(
        "{came}; with what is proposed it would have been {after}, which looks better than it is, as it was fitted to the same presses. \
         Proposed: {}.",
        changes.join("; ")
    );
    let draft = Some(Proposal { profile: name.to_owned(), text });
    Ok(GuideResult { draft, ..GuideResult::words(text_told) })
}
