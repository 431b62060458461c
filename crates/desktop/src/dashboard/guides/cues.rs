//! Cues: the page says what to press, and a profile is fitted to what came.

use std::fmt::Write as _;

use super::cue_sequence::CueTarget;
use super::guide::{GuideContext, GuideResult, GuideStatus, PageGuide, Proposal};
use super::pieces::Pieces;
use super::recording::{NO_NAME, Recording};
use crate::dashboard::practice::{Level, PressWish, Wish};
use tactpad_bridge::request::Request;
use tactpad_core::pipeline::mapping::profile::Profile;
use tactpad_core::pipeline::mapping::profile::sketch::{ButtonForces, Sketch, polar};
use tactpad_core::pipeline::mapping::read::check::{self, OutputChoice};
use tactpad_lab::tuning::fitting::{Fitted, Study};
use tactpad_lab::tuning::labels::{HEADER, Labels};
use tactpad_lab::tuning::words;

/// So many cues are given at least, …
const CUES: usize = 15;

/// … and each so often at least: how alike presses are shows in repetition.
const REPEATS: usize = 3;

/// A fitted profile may decide so late.
const DELAY_MAX_US: u64 = 200_000;

/// A direction is lit so far from the hand's centre, and so far beyond where directions begin.
const DIRECTION_MM: f32 = 18.0;
const BEYOND_MM: f32 = 5.0;

/// The guide.
#[derive(Default)]
pub(super) struct Cues {
    recording: Recording,
    /// The profile that is fitted: its name and its text.
    profile: (String, String),
    targets: Vec<CueTarget>,
}

const fn press(at_mm: [f32; 2], push: [f32; 2], level: Level) -> PressWish {
    PressWish { at_mm, push, level, is_long: false, is_double: false }
}

/// The targets that a profile has: its directions, and the controls of its buttons. Where that is one, nothing is another one, as one alone
/// tells nothing.
pub(super) fn targets(profile: &Profile) -> Vec<CueTarget> {
    let sketch = Sketch::of(profile);
    let mut all = directions(&sketch);
    all.extend(sketch.buttons.iter().flat_map(|button| of_button(button, &sketch)));
    if all.len() == 1 {
        all.push(CueTarget { word: "none".into(), cue: "leave the pad alone".into(), wish: Wish::Rest });
    }
    all
}

fn directions(sketch: &Sketch) -> Vec<CueTarget> {
    let Some(dpad) = &sketch.dpad else { return Vec::new() };
    let out_mm = DIRECTION_MM.max(dpad.centre_radius_mm + BEYOND_MM);
    let target = |(word, deg): (&str, f32)| CueTarget {
        word: word.into(),
        cue: format!("press {word} of the middle"),
        wish: Wish::Press(press(
            polar(sketch.centre_mm, dpad.rotation_deg + deg, out_mm),
            [0.0; 2],
            Level::Touch,
        )),
    };
    [("right", 0.0), ("up", 90.0), ("left", 180.0), ("down", 270.0)].map(target).to_vec()
}

fn of_button(button: &ButtonForces, sketch: &Sketch) -> Vec<CueTarget> {
    let zone = button.zone.as_ref().and_then(|name| sketch.zones.iter().find(|zone| zone.name == *name));
    let at_mm = zone.map_or(sketch.centre_mm, |zone| zone.name_at_mm);
    let place = zone.map_or_else(|| " in the middle".to_owned(), |zone| format!(" in {}", zone.name));
    let (push, towards) = towards(button.force);
    let target = |(role, word): (&str, &str)| {
        let kind = if button.does.len() == 1 { String::new() } else { format!(" {role}") };
        let how = match role {
            "tap" => "press shortly",
            "hold" => "press and hold for a second",
            "double" => "press twice, quickly",
            "light" => "press lightly",
            "hard" => "press hard",
            _ => "press",
        };
        let level = match role {
            "light" => Level::Light,
            "hard" => Level::Hard,
            _ => Level::Usual,
        };
        let wish = press(at_mm, push, level);
        CueTarget {
            word: format!("button {}{kind}", button.number),
            cue: format!("{how}{place}{towards} ({word})"),
            wish: Wish::Press(PressWish { is_long: role == "hold", is_double: role == "double", ..wish }),
        }
    };
    button.does.iter().map(|does| target((does.role, &does.word))).collect()
}

/// Where a force pushes, and how that is told.
fn towards(force: &str) -> ([f32; 2], &'static str) {
    match force {
        "fx" => ([1.0, 0.0], ", pushing to the right"),
        "-fx" => ([-1.0, 0.0], ", pushing to the left"),
        "fy" => ([0.0, 1.0], ", pushing away from you"),
        "-fy" => ([0.0, -1.0], ", pushing towards you"),
        _ => ([0.0; 2], ""),
    }
}

/// How often each of so many targets is asked for.
pub(super) fn repeats(targets: usize) -> usize {
    REPEATS.max(CUES.div_ceil(targets.max(1)))
}

/// The cues and their times, as a table of labels.
fn table(targets: &[CueTarget], pieces: &Pieces) -> String {
    let mut table = format!("{HEADER}\n");
    for answer in &pieces.answers {
        let [begin_s, end_s] = [answer.begin_us, answer.end_us].map(|us| us as f64 * 1e-6);
        if let Some(target) = targets.get(answer.target) {
            let _ = writeln!(table, "{begin_s},{end_s},{}", target.word);
        }
    }
    table
}

impl PageGuide for Cues {
    fn id(&self) -> &'static str {
        "tune"
    }

    fn start(&mut self, context: &GuideContext<'_>) -> Result<(), String> {
        let (name, text) = (context.profile)().ok_or(NO_NAME)?;
        let profile =
            check::read(&text, OutputChoice::AsWritten).0.ok_or("the profile has errors: mend it first")?;
        let targets = targets(&profile);
        if targets.is_empty() {
            return Err("this profile has neither directions nor buttons: there is nothing to fit".into());
        }
        let recording = Recording::begin(context, targets.clone(), repeats(targets.len()))?;
        *self = Self { recording, profile: (name, text), targets };
        Ok(())
    }

    fn stop(&mut self, context: &GuideContext<'_>) {
        context.host.practise(Wish::Rest);
        *self = Self::default();
    }

    fn update(&mut self, context: &GuideContext<'_>) {
        let ((name, text), targets) = (self.profile.clone(), self.targets.clone());
        self.recording.go_on(context, move |pieces| fitted(&name, &text, &targets, pieces));
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
        let text = "You are asked for one thing after the other, in no order. Take your time: each waits until you have done it and lifted the finger.";
        GuideStatus {
            id: self.id(),
            title: "Tune by cues",
            about: "The page asks for presses at your own pace, and fits the numbers of the profile in play so that more of what you mean comes out. You see \
                    them in the editor before anything is saved.",
            state: self.recording.progress(),
            steps: vec![self.recording.asking("cues", "Do what is asked", text), self.recording.working()],
            result: self.recording.outcome(),
        }
    }
}

/// The profile that gives most of what was asked for.
pub(super) fn fitted(
    name: &str,
    text: &str,
    targets: &[CueTarget],
    pieces: &Pieces,
) -> Result<GuideResult, String> {
    let profile =
        check::read(text, OutputChoice::AsWritten).0.ok_or("the profile has errors: mend it first")?;
    let labels = Labels::read(&table(targets, pieces), &profile).map_err(|error| error.to_string())?;
    let study = Study { trace: &pieces.trace, labels: &labels, delay_max_us: DELAY_MAX_US };
    let before = study.score(&profile).correct();
    let Fitted { text, profile, changes } =
        study.fit(text, &|_, _| ()).ok_or("the profile cannot be fitted")?;
    let after = study.score(&profile).correct();
    let came = format!("{before} of {} came as they were asked for", pieces.answers.len());
    if changes.is_empty() {
        return Ok(GuideResult::words(format!("{came}. No other numbers give more: nothing changes.")));
    }
    let changes: Vec<_> =
        changes.iter().map(|change| words::ChangedNumber::of(change, &profile).words).collect();
    let text_told = format!(
        "{came}; with the proposal {after} would have come. That looks better than it is, because it was fitted to these same presses. \
         Proposed: {}.",
        changes.join("; ")
    );
    let draft = Some(Proposal { profile: name.to_owned(), text });
    Ok(GuideResult { draft, ..GuideResult::words(text_told) })
}

#[cfg(test)]
mod tests {
    use super::super::cue_sequence::{AnsweredCue, CueSequence, PadObservation};
    use super::super::force_range;
    use super::super::pieces::TAIL_US;
    use super::super::recording::judged;
    use super::*;
    use crate::dashboard::practice::{HANDS, Movement, Practice, PracticeHand};
    use tactpad_core::pipeline::contact::touch::Touch;
    use tactpad_core::pipeline::mapping::read::shipped;
    use tactpad_core::time::{HostInstant, StreamInstant};
    use tactpad_core::virtual_pad::script::Script;
    use tactpad_lab::tuning::trace::{Trace, TraceEvents, TracePoint};
    use tactpad_numeric::random::SplitMix64;

    /// From one sample to the next, and from one look of a guide to the next.
    const SAMPLE_US: u64 = 2_500;
    const LOOK_US: u64 = 100_000;

    fn profile(text: &str) -> Profile {
        check::read(text, OutputChoice::AsWritten).0.unwrap()
    }

    fn finger(movement: Movement) -> Script {
        match movement {
            Movement::Finger(script) | Movement::Weight(script) => script,
        }
    }

    /// What a hand makes of cues that are given to it, to their end.
    fn played(hand: PracticeHand, targets: &[CueTarget], repeats: usize, seed: u64) -> Pieces {
        let at = |us| HostInstant::default().plus_us(us);
        let mut practice = Practice::new(hand, seed);
        let mut seen = PadObservation { now: at(0), is_touched: false, touches: 0 };
        let mut asking = CueSequence::begin(targets.to_vec(), repeats, seed, seen);
        let (mut script, mut asked_us) = (finger(practice.obey(asking.cue().unwrap().wish)), 0);
        let (mut moments, mut touch) = (Vec::new(), Touch::new());
        let mut random = SplitMix64::named(seed, "noise");
        for now_us in (0..).step_by(SAMPLE_US as usize) {
            let mut contact = script.contact_at(now_us - asked_us);
            // What a pad adds after its filter.
            let mut noise = |deviation: f32| deviation * random.normal();
            contact.fx_n += noise(0.02);
            contact.fy_n += noise(0.02);
            contact.fz_n += noise(0.02);
            touch.update(StreamInstant::from_us(now_us), &contact);
            let is_touched = touch.is_touched();
            seen.touches += u64::from(is_touched && !seen.is_touched);
            (seen.now, seen.is_touched) = (at(now_us), is_touched);
            let heard = if is_touched { TraceEvents::Contact(contact) } else { TraceEvents::Nothing };
            moments.push(TracePoint { at: StreamInstant::from_us(now_us), heard });
            if now_us % LOOK_US == 0 && asking.update(seen) {
                let Some(cue) = asking.cue() else { break };
                (script, asked_us) = (finger(practice.obey(cue.wish)), now_us);
            }
            assert!(now_us < 900_000_000, "the cues do not end");
        }
        let stretch = |it: &AnsweredCue| {
            let [from_us, to_us] = [it.begin, it.end.plus_us(TAIL_US)].map(|moment| moment.us_since(at(0)));
            let own = moments.iter().filter(|it| (from_us..to_us).contains(&it.at.as_us()));
            let begun = |it: &TracePoint| StreamInstant::from_us(it.at.as_us() - from_us);
            (it.target, Trace::new(own.map(|it| TracePoint { at: begun(it), ..*it }).collect()))
        };
        Pieces::of(asking.asked.iter().map(stretch))
    }

    /// How many of the cues come out.
    fn correct(text: &str, targets: &[CueTarget], pieces: &Pieces) -> usize {
        let profile = profile(text);
        let labels = Labels::read(&table(targets, pieces), &profile).unwrap();
        Study { trace: &pieces.trace, labels: &labels, delay_max_us: DELAY_MAX_US }.score(&profile).correct()
    }

    /// Whether a hand gets a profile with which more of what it means comes on other days, or none if it ignores the cues.
    fn try_hand(name: &str, hand: PracticeHand) {
        let text = shipped::text(name).unwrap();
        let targets = targets(&profile(text));
        let repeats = repeats(targets.len());
        let pieces = played(hand, &targets, repeats, 1);
        let found = judged(&pieces, 1, |pieces| fitted(name, text, &targets, pieces));
        if hand == PracticeHand::Ignoring {
            assert!(found.is_err_and(|why| why.contains("do not follow")), "{name}");
            return;
        }
        let found = found.unwrap_or_else(|why| panic!("{name}, {hand:?}: {why}"));
        let others: Vec<_> = (2..6).map(|seed| played(hand, &targets, repeats, seed)).collect();
        let with = |text: &str| others.iter().map(|other| correct(text, &targets, other)).sum::<usize>();
        let all: usize = others.iter().map(|other| other.answers.len()).sum();
        let before = with(text);
        let after = found.draft.as_ref().map_or(before, |draft| with(&draft.text));
        println!("{name}, {hand:?}: {before} of {all} came before, {after} after");
        assert!(after > before || before == all, "{name}, {hand:?}: {before} of {all}, {after}");
    }

    #[test]
    fn each_hand_gets_a_profile_with_which_more_comes_on_other_days_and_one_that_ignores_the_cues_none() {
        HANDS.iter().for_each(|(_, hand)| try_hand("super-mario", *hand));
    }

    #[test]
    fn each_hand_gets_the_forces_that_suit_it_and_one_that_ignores_the_cues_none() {
        let text = shipped::text("super-mario").unwrap();
        let kinds = force_range::kinds();
        for (hand_name, hand) in HANDS {
            let pieces = played(hand, &kinds, 8, 3);
            let found = judged(&pieces, 3, |pieces| force_range::fitted("super-mario", text, pieces));
            if hand == PracticeHand::Ignoring {
                assert!(found.is_err_and(|why| why.contains("do not follow")));
                continue;
            }
            let found = found.unwrap_or_else(|why| panic!("{hand_name}: {why}"));
            println!("{hand_name}: {}", found.text);
        }
    }
}
