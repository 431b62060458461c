//! A fixed part of a game: what a finger means to do when, in words of the profile.

use std::fmt::Write;

use tactpad::lab::tuning::labels::HEADER;
use tactpad::lab::tuning::vocabulary::Vocabulary;
use tactpad::pipeline::control::OutputEvent;
use tactpad::pipeline::mapping::profile::{Binding, Profile};
use tactpad::time::StreamInstant;

/// A finger goes down somewhere and is lifted. Times are counted from the segment's begin.
#[derive(Clone, Debug)]
pub(crate) struct Touch {
    pub(crate) begin_ms: u64,
    pub(crate) end_ms: u64,
    /// `up`, `down`, `left`, `right`; `None` is the middle.
    pub(crate) towards: Option<&'static str>,
    /// In order of time, within the touch.
    pub(crate) presses: Vec<Press>,
}

/// The finger that is down presses harder for a while.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Press {
    pub(crate) begin_ms: u64,
    pub(crate) end_ms: u64,
    /// As in tables for `tune`: `button 1`, `button 1 tap`, `button 1 hold`.
    pub(crate) meant: &'static str,
}

/// Touches in order of time.
#[derive(Clone, Debug, Default)]
pub(crate) struct Segment(pub(crate) Vec<Touch>);

/// A label begins so long before its touch.
const LABEL_EARLY_MS: u64 = 30;
/// It ends so long after it.
const LABEL_LATE_MS: u64 = 60;

impl Segment {
    /// A touch towards a side.
    pub(crate) fn steer(self, towards: &'static str, begin_ms: u64, end_ms: u64) -> Self {
        self.touch(Touch { begin_ms, end_ms, towards: Some(towards), presses: Vec::new() })
    }

    /// Presses harder during the last touch.
    pub(crate) fn press(mut self, meant: &'static str, begin_ms: u64, end_ms: u64) -> Self {
        let touch = self.0.last_mut().unwrap();
        assert!(touch.begin_ms <= begin_ms && end_ms <= touch.end_ms, "{meant} outside of its touch");
        touch.presses.push(Press { begin_ms, end_ms, meant });
        self
    }

    /// A press in the middle and nothing else.
    pub(crate) fn tap(self, meant: &'static str, begin_ms: u64, end_ms: u64) -> Self {
        self.touch(Touch { begin_ms, end_ms, towards: None, presses: Vec::new() })
            .press(meant, begin_ms, end_ms)
    }

    fn touch(mut self, touch: Touch) -> Self {
        assert!(self.0.last().is_none_or(|last| last.end_ms <= touch.begin_ms), "there is one finger");
        self.0.push(touch);
        self
    }

    /// The same with left and right exchanged.
    pub(crate) fn mirrored(&self) -> Self {
        let other = |side| match side {
            "left" => "right",
            "right" => "left",
            other => other,
        };
        let touches = self.0.iter().cloned();
        Self(touches.map(|touch| Touch { towards: touch.towards.map(other), ..touch }).collect())
    }

    /// As long, and nobody touches anything.
    pub(crate) fn muted(&self) -> Self {
        let end_ms = self.length_ms();
        Self(vec![Touch { begin_ms: end_ms, end_ms, towards: None, presses: Vec::new() }])
    }

    /// The same, later.
    pub(crate) fn after(&self, ms: u64) -> Self {
        self.at_times(|at_ms| at_ms + ms)
    }

    /// The same at another pace: all takes so many times as long.
    pub(crate) fn slower(&self, times: f64) -> Self {
        self.at_times(|at_ms| (at_ms as f64 * times) as u64)
    }

    fn at_times(&self, at: impl Fn(u64) -> u64) -> Self {
        let press =
            |press: &Press| Press { begin_ms: at(press.begin_ms), end_ms: at(press.end_ms), ..*press };
        let touch = |touch: &Touch| Touch {
            begin_ms: at(touch.begin_ms),
            end_ms: at(touch.end_ms),
            towards: touch.towards,
            presses: touch.presses.iter().map(press).collect(),
        };
        Self(self.0.iter().map(touch).collect())
    }

    /// Whether there is anything to do.
    pub(crate) fn means_something(&self) -> bool {
        self.0.iter().any(|touch| touch.towards.is_some() || !touch.presses.is_empty())
    }

    /// When the last finger is lifted.
    pub(crate) fn length_ms(&self) -> u64 {
        self.0.last().map_or(0, |touch| touch.end_ms)
    }

    /// The commands themselves, as a pad with a button for each thing gives them: down where it is meant to begin, up where it
    /// is meant to end.
    pub(crate) fn commands(&self, profile: &Profile) -> Vec<OutputEvent> {
        let words = Vocabulary::of(profile);
        let mut events = Vec::new();
        let mut hold = |meant: &str, begin_ms: u64, end_ms: u64| {
            for Binding { device, code, value } in words.meant(meant).unwrap() {
                let event = |ms: u64, value| OutputEvent {
                    at: StreamInstant::from_us(1_000 * ms),
                    device,
                    code,
                    value,
                };
                events.extend([event(begin_ms, value), event(end_ms, 0)]);
            }
        };
        for touch in &self.0 {
            touch.towards.into_iter().for_each(|side| hold(side, touch.begin_ms, touch.end_ms));
            touch.presses.iter().for_each(|press| hold(press.meant, press.begin_ms, press.end_ms));
        }
        // Of one moment, what is let go goes first.
        events.sort_by_key(|event| (event.at, event.value != 0));
        events
    }

    /// A table for `tune`. The segment began `begin_us` after the recording's first sample.
    pub(crate) fn labels(&self, begin_us: u64) -> String {
        let mut table = format!("{HEADER}\n");
        for (from_ms, to_ms, meant) in self.0.iter().flat_map(stretches) {
            let s = |ms: u64| 1e-6 * begin_us as f64 + 1e-3 * ms as f64;
            writeln!(table, "{:.3},{:.3},{meant}", s(from_ms), s(to_ms)).unwrap();
        }
        table
    }
}

/// A touch as lines of a table: begin, end and what is meant. Each control stands once in a line, so a second press begins a
/// second line.
fn stretches(touch: &Touch) -> Vec<(u64, u64, String)> {
    let presses = touch.presses.iter();
    let first = touch.towards.into_iter().chain(presses.clone().take(1).map(|press| press.meant));
    let first = first.collect::<Vec<_>>().join("+");
    let later = presses.skip(1).map(|press| (press.begin_ms, press.meant.to_owned()));
    let lines: Vec<_> = std::iter::once((touch.begin_ms, first))
        .chain(later)
        .filter(|(_, meant)| !meant.is_empty())
        .collect();
    let begins_ms = lines.iter().map(|(begin_ms, _)| begin_ms.saturating_sub(LABEL_EARLY_MS));
    let ends_ms = begins_ms.clone().skip(1).chain([touch.end_ms + LABEL_LATE_MS]);
    let meant = lines.iter().map(|(_, meant)| meant.clone());
    begins_ms.zip(ends_ms).zip(meant).map(|((begin_ms, end_ms), meant)| (begin_ms, end_ms, meant)).collect()
}

#[test]
fn a_segment_is_commands_and_labels() {
    let jump = "button 1";
    let segment = Segment::default()
        .steer("right", 100, 2_000)
        .press(jump, 500, 700)
        .press(jump, 1_000, 1_200)
        .tap(jump, 2_500, 2_600)
        .mirrored();
    let labels = segment.labels(250_000);
    let lines: Vec<_> = labels.lines().collect();
    let expected = [HEADER, "0.320,1.220,left+button 1", "1.220,2.310,button 1", "2.720,2.910,button 1"];
    assert_eq!(lines, expected);
    let profile = crate::trial::profile_of("supertux");
    let commands = segment.commands(&profile);
    let told: Vec<_> = commands
        .iter()
        .map(|event| format!("{} {} {}", event.at.as_us() / 1_000, event.code, event.value))
        .collect();
    let jump = |begin: u64, end: u64| [format!("{begin} KEY_SPACE 1"), format!("{end} KEY_SPACE 0")];
    let mut expected = vec!["100 KEY_LEFT 1".to_owned()];
    expected.extend([jump(500, 700), jump(1_000, 1_200)].concat());
    expected.push("2000 KEY_LEFT 0".into());
    expected.extend(jump(2_500, 2_600));
    assert_eq!(told, expected);
    assert!(segment.muted().commands(&profile).is_empty() && segment.muted().length_ms() == 2_600);
}
