//! Chooses the numbers of a profile with which most of what was meant comes out.

use rayon::prelude::*;

use super::delay::delay_us;
use super::knobs::{self, Knob, Settings, rounded};
use super::labels::Labels;
use super::places::{self, HandPose};
use super::scoring::{AFTER_US, Score};
use super::trace::Trace;
use tactpad_core::pipeline::mapping::profile::Profile;
use tactpad_core::pipeline::mapping::read::check::{self, OutputChoice};
use tactpad_core::toml_text::edit::{self, Table, Value};

/// While values are compared, samples are so far apart at least.
const PERIOD_US: u64 = 4_000;

/// A value has to bring so many events more, in the mean with its neighbours, to be worth a change.
const WORTH: f64 = 0.5;

/// All numbers are gone through so often at most.
const ROUNDS_MAX: usize = 3;

/// Data to which a profile is fitted.
#[derive(Clone, Copy, Debug)]
pub struct Study<'s> {
    /// The contacts.
    pub trace: &'s Trace,
    /// What was meant.
    pub labels: &'s Labels,
    /// A profile may decide so late, see [`delay_us`]; one that is later already may stay as late as it is.
    pub delay_max_us: u64,
}

/// A profile that was fitted.
#[derive(Clone, Debug)]
pub struct Fitted {
    /// Its text: the given one with other numbers.
    pub text: String,
    /// The profile.
    pub profile: Profile,
    /// Which numbers are others, each with what it was before; nothing for one that was not there and meant nothing then.
    pub changes: Vec<Change>,
}

/// A number that has changed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Change {
    /// The table in which it stands.
    pub table: Table,
    /// Its key.
    pub key: &'static str,
    /// What it was.
    pub from: Option<f64>,
    /// What it is.
    pub to: f64,
}

impl Study<'_> {
    /// Score of a profile against the labels.
    pub fn score(&self, profile: &Profile) -> Score {
        Score::of(profile, self.trace, self.labels, self.after_us())
    }

    /// How long after a label's end an event is still its own.
    pub const fn after_us(&self) -> u64 {
        AFTER_US + self.delay_max_us
    }

    /// Fits the profile of a text. `None` if that is none. `report` hears how much is done, of how much.
    pub fn fit(&self, text: &str, report: &(dyn Fn(usize, usize) + Sync)) -> Option<Fitted> {
        let profile = check::read(text, OutputChoice::AsWritten).0?;
        let thinned = self.trace.thinned(PERIOD_US);
        let period_us = self.trace.period_us();
        let delay_max_us = self.delay_max_us.max(delay_us(&profile, period_us));
        let search = Search { study: self, text, trace: &thinned, period_us, delay_max_us };
        let knobs = knobs::all(&profile, text);
        let mut settings = search.placed(&profile);
        let of = ROUNDS_MAX * knobs.len();
        let mut since_change = 0;
        for (done, knob) in std::iter::repeat_n(&knobs, ROUNDS_MAX).flatten().enumerate() {
            report(done, of);
            let turned = search.turned(knob, &settings);
            since_change = if turned == settings { since_change + 1 } else { 0 };
            settings = turned;
            // All have been gone through with these.
            if since_change == knobs.len() {
                break;
            }
        }
        // What the thinned samples promise must hold for all of them.
        let (fitted, is) = search.profile(&settings)?;
        if self.score(&is).correct() <= self.score(&profile).correct() {
            return Some(Fitted { text: text.to_owned(), profile, changes: Vec::new() });
        }
        Some(Fitted { text: fitted, profile: is, changes: changes(&settings, &knobs, text) })
    }
}

/// Values are compared.
struct Search<'s> {
    study: &'s Study<'s>,
    text: &'s str,
    /// With fewer samples.
    trace: &'s Trace,
    /// Of all samples.
    period_us: u64,
    delay_max_us: u64,
}

impl Search<'_> {
    /// The profile with these settings; `None` where they are no profile, or decide too late.
    fn profile(&self, settings: &Settings) -> Option<(String, Profile)> {
        let text = edit::edited(self.text, &knobs::edits(settings)).ok()?;
        let profile = check::read(&text, OutputChoice::AsWritten).0?;
        let is_soon = delay_us(&profile, self.period_us) <= self.delay_max_us;
        is_soon.then_some((text, profile))
    }

    fn correct(&self, settings: &Settings) -> Option<f64> {
        let (_, profile) = self.profile(settings)?;
        let score = Score::of(&profile, self.trace, self.study.labels, self.study.after_us());
        Some(score.correct() as f64)
    }

    /// Where the hand is: nothing, its rotation, its centre or both, whichever is right more often; the earlier of equals.
    fn placed(&self, profile: &Profile) -> Settings {
        let none = Settings::new();
        let Some(dpad) = &profile.dpad else { return none };
        let rotation_deg = f64::from(dpad.rotation_deg);
        let Some(found) = places::hand(dpad, self.trace, self.study.labels, rotation_deg) else {
            return none;
        };
        let side = if edit::written(self.text, Table::Root, "left_handed") == Some(Value::Flag(true)) {
            -1.0
        } else {
            1.0
        };
        let mut tried = vec![none];
        for (hand, fitted) in [
            (found.turned, FittedPose { centre: false, rotation: true }),
            (found.shifted, FittedPose { centre: true, rotation: false }),
            (found.turned, FittedPose { centre: true, rotation: true }),
        ] {
            tried.push(of_hand(hand, fitted, side));
        }
        let scores: Vec<_> = tried.par_iter().map(|settings| self.correct(settings)).collect();
        let mut best = 0;
        for (index, score) in scores.iter().enumerate() {
            let gain = |index: usize| scores.get(index).copied().flatten().unwrap_or(-1.0);
            if score.is_some_and(|score| score >= gain(best) + WORTH) {
                best = index;
            }
        }
        tried.swap_remove(best)
    }

    /// Gives a number the value that is best: see `docs/tuning.md`.
    fn turned(&self, knob: &Knob, settings: &Settings) -> Settings {
        let tried: Vec<Settings> = knob.values.iter().map(|value| knob.turned(settings, *value)).collect();
        let scores: Vec<Option<f64>> = tried.par_iter().map(|settings| self.correct(settings)).collect();
        let present = knob.values.iter().position(|value| *value == knob.present);
        match chosen(&scores, present) {
            Some(best) => tried.into_iter().nth(best).unwrap_or_else(|| settings.clone()),
            None => settings.clone(),
        }
    }
}

/// Which of the values to take: the present one, if no other is worth a change, else the middle of the best.
fn chosen(scores: &[Option<f64>], present: Option<usize>) -> Option<usize> {
    let smooth: Vec<Option<f64>> = (0..scores.len()).map(|index| smoothed(scores, index)).collect();
    let at = |index: usize| smooth.get(index).copied().flatten();
    let best = smooth.iter().flatten().copied().fold(f64::NEG_INFINITY, f64::max);
    if let Some(present) = present.filter(|present| at(*present).is_some_and(|score| score >= best - WORTH)) {
        return Some(present);
    }
    let is_good = |index: usize| at(index).is_some_and(|score| score >= best - WORTH);
    let mut longest = 0..0;
    let mut index = 0;
    while index < scores.len() {
        let end = (index..scores.len()).find(|index| !is_good(*index)).unwrap_or(scores.len());
        let holds_best = (index..end).any(|index| at(index) == Some(best));
        if holds_best && end - index > longest.len() {
            longest = index..end;
        }
        index = end + 1;
    }
    (!longest.is_empty()).then(|| longest.start + (longest.len() - 1) / 2)
}

/// The mean with both neighbours, which count half: a value at the edge of a cliff is no good one.
fn smoothed(scores: &[Option<f64>], index: usize) -> Option<f64> {
    let here = scores.get(index).copied().flatten()?;
    let beside =
        |index: Option<usize>| index.and_then(|it| scores.get(it).copied().flatten()).unwrap_or(here);
    Some(0.25 * (beside(index.checked_sub(1)) + 2.0 * here + beside(index.checked_add(1))))
}

/// The parts of a hand's pose that are written into the profile.
#[derive(Clone, Copy)]
struct FittedPose {
    /// Its centre, in millimetres.
    centre: bool,
    /// Its rotation, in degrees.
    rotation: bool,
}

/// The settings of a hand's centre and rotation, as far as they are fitted; `side` is −1 for a left-handed profile, which turns both.
fn of_hand(hand: HandPose, fitted: FittedPose, side: f64) -> Settings {
    let mut settings = Settings::new();
    let [x_mm, y_mm] = hand.centre_mm;
    // To half a millimetre: no finger comes back more exactly.
    let half = |mm: f64| ((2.0 * mm).round() / 2.0).clamp(-15.0, 15.0);
    if fitted.centre {
        settings.insert((Table::Root, "centre_x_mm"), half(side * x_mm));
        settings.insert((Table::Root, "centre_y_mm"), half(y_mm));
    }
    if fitted.rotation {
        settings.insert(
            (Table::Named("dpad"), "rotation_deg"),
            rounded("rotation_deg", side * hand.rotation_deg),
        );
    }
    settings
}

/// Changes of a text by settings.
fn changes(settings: &Settings, knobs: &[Knob], text: &str) -> Vec<Change> {
    let before = |(table, key): knobs::Key| {
        let knob = knobs.iter().find(|knob| knob.key == (table, key)).and_then(|knob| knob.present);
        let written = match edit::written(text, table, key) {
            Some(Value::Real(value)) => Some(value),
            Some(Value::Whole(value)) => Some(value as f64),
            _ => None,
        };
        let is_place = ["centre_x_mm", "centre_y_mm", "rotation_deg"].contains(&key);
        written.or(knob).or(is_place.then_some(0.0))
    };
    let change =
        |(&(table, key), &to): (&knobs::Key, &f64)| Change { table, key, from: before((table, key)), to };
    settings.iter().map(change).filter(|change| change.from != Some(change.to)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn chosen_of(scores: &[f64], present: usize) -> Option<usize> {
        chosen(&scores.iter().map(|score| Some(*score)).collect::<Vec<_>>(), Some(present))
    }

    #[test]
    fn what_is_good_enough_stays() {
        assert_eq!(chosen_of(&[5.0, 9.0, 9.0, 9.0, 9.0], 3), Some(3));
        assert_eq!(chosen_of(&[9.0; 5], 0), Some(0));
        // One event more at one value alone is no reason.
        assert_eq!(chosen_of(&[8.0, 8.0, 9.0, 8.0, 8.0], 0), Some(0));
    }

    #[test]
    fn what_is_better_is_taken_from_its_middle() {
        assert_eq!(chosen_of(&[1.0, 9.0, 9.0, 9.0, 9.0, 9.0, 1.0], 0), Some(3));
        // The edge of a cliff, with the same number of events.
        assert_eq!(chosen_of(&[1.0, 9.0, 9.0, 9.0, 9.0, 9.0, 1.0], 1), Some(3));
        // The longer of two.
        assert_eq!(chosen_of(&[9.0, 9.0, 0.0, 0.0, 9.0, 9.0, 9.0, 9.0, 9.0], 2), Some(6));
    }

    #[test]
    fn what_is_no_profile_is_passed_over() {
        let scores = [None, Some(3.0), None, Some(7.0), Some(7.0), None];
        assert_eq!(chosen(&scores, Some(1)), Some(3));
        assert_eq!(chosen(&[None, None], None), None);
    }
}
