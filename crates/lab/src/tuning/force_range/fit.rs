//! A profile with the normal forces of a hand.

use super::levels::{self, DependentNumber, Level};
use super::peaks::Peaks;
use super::range::Range;
use crate::tuning::fitting::{Change, Fitted};
use crate::tuning::knobs::{self, Key, Settings, rounded};
use tactpad_core::pipeline::mapping::profile::Profile;
use tactpad_core::pipeline::mapping::read::check::{self, OutputChoice};
use tactpad_core::toml_text::edit::{self, Table};

/// The step to which forces are rounded: what must be less stays less by so much.
const STEP_N: f64 = 0.01;

const REST: Key = (Table::Named("access"), "rest_n");

/// Why a profile is not fitted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ForceRangeError {
    /// It asks for no normal force.
    NoLevels,
    /// It asks for more than one, and this hand's light and hard presses are not told apart.
    NotApart(Range),
    /// What would come of it is no profile: forces that no key allows.
    NoProfile(Range),
}

/// The profile of a text with the forces of a hand.
///
/// # Errors
/// The profile has no use for them, or the hand has too little range for it.
pub fn fit(text: &str, profile: &Profile, range: &Range) -> Result<Fitted, ForceRangeError> {
    let levels = levels::all(profile, text);
    let ends_n = levels::ends_n(&levels).ok_or(ForceRangeError::NoLevels)?;
    if !levels::is_one_force(ends_n) && !range.is_told_apart() {
        return Err(ForceRangeError::NotApart(*range));
    }
    let mut before = Settings::new();
    let mut after = Settings::new();
    for level in &levels {
        let (table, key) = level.key;
        let least_n = level.above.and_then(|key| after.get(&(table, key))).map_or(0.0, |n| n + STEP_N);
        let force_n = rounded(key, mapped_n(level.force_n, ends_n, range)).max(rounded(key, least_n));
        before.insert(level.key, level.force_n);
        after.insert(level.key, force_n);
        for follower in &level.followers {
            before.insert((table, follower.key), follower.force_n);
            after.insert((table, follower.key), followed_n(follower, level, force_n));
        }
    }
    if let Some(rest_n) = levels::rest_n(profile) {
        before.insert(REST, rest_n);
        after.insert(REST, rest_n.min(rounded(REST.1, range.lowest_n())));
    }
    after.retain(|key, to| before.get(key) != Some(to));
    let no_profile = ForceRangeError::NoProfile(*range);
    let text = edit::edited(text, &knobs::edits(&after)).map_err(|_| no_profile)?;
    let profile = check::read(&text, OutputChoice::AsWritten).0.ok_or(no_profile)?;
    let change = |(key, to): (&Key, &f64)| Change {
        table: key.0,
        key: key.1,
        from: before.get(key).copied(),
        to: *to,
    };
    let changes = after.iter().map(change).collect();
    Ok(Fitted { text, profile, changes })
}

/// What a level becomes: as a share of the way from the lowest to the highest one, in the logarithm of the force. Where one force is
/// enough, the highest is what a light press reaches, and the others keep their share of it.
fn mapped_n(force_n: f64, [lowest_n, highest_n]: [f64; 2], range: &Range) -> f64 {
    let low_n = range.lowest_n();
    if levels::is_one_force([lowest_n, highest_n]) {
        return low_n * force_n / highest_n;
    }
    let share = (force_n / lowest_n).ln() / (highest_n / lowest_n).ln();
    low_n * (range.highest_n() / low_n).powf(share)
}

/// What goes with a level keeps its share, and stays less than it.
fn followed_n(follower: &DependentNumber, level: &Level, force_n: f64) -> f64 {
    let shared_n = follower.force_n * force_n / level.force_n;
    rounded(level.key.1, shared_n.min(force_n - STEP_N).max(follower.least_n))
}

/// How many presses reach a force.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ReachCount {
    /// Of the light ones.
    pub light: usize,
    /// Of the hard ones.
    pub hard: usize,
}

impl ReachCount {
    /// Of these presses, by their highest force in newtons.
    pub fn of(peaks: &Peaks, force_n: f64) -> Self {
        let [light, hard] =
            [&peaks.light_n, &peaks.hard_n].map(|all| all.iter().filter(|n| **n >= force_n).count());
        Self { light, hard }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use tactpad_core::pipeline::mapping::read::shipped;

    const HAND: Range = Range { light_n: 0.4, light_most_n: 0.8, hard_n: 1.25 };
    const FLAT: Range = Range { light_n: 0.4, light_most_n: 0.8, hard_n: 0.9 };

    fn fitted(text: &str, range: &Range) -> Result<Fitted, ForceRangeError> {
        fit(text, &check::read(text, OutputChoice::AsWritten).0.unwrap(), range)
    }

    fn changes(text: &str, range: &Range) -> Vec<(&'static str, f64)> {
        fitted(text, range).unwrap().changes.iter().map(|change| (change.key, change.to)).collect()
    }

    #[test]
    fn the_ends_become_the_hands_and_releases_keep_their_share() {
        let text = shipped::text("super-mario").unwrap();
        // 0.5 × 0.4, and √(0.8 × 1.25).
        let wanted = [("min_force_n", 0.2), ("release_force_n", 0.13), ("press_n", 1.0), ("release_n", 0.7)];
        assert_eq!(changes(text, &HAND), wanted);
        // What is between is so in the logarithm: 0.3, half-way, and 3.0 to 0.2, half-way, and 1.0.
        let stages = text
            .replace("press_n = 2.0", "press_n = 0.9487\nhard_press_n = 3\nhair_n = 0.06")
            .replace("release_n = 1.4", "")
            .replace("long_press_ms = 400", "")
            .replace("tap =", "light =")
            .replace("hold =", "hard =");
        let wanted = [
            ("min_force_n", 0.2),
            ("release_force_n", 0.13),
            ("hair_n", 0.05),
            ("hard_press_n", 1.0),
            ("press_n", 0.45),
        ];
        assert_eq!(changes(&stages, &HAND), wanted);
    }

    #[test]
    fn a_fitted_profile_is_fitted_to_the_same() {
        for name in shipped::names() {
            let once = fitted(shipped::text(name).unwrap(), &HAND).unwrap();
            assert_eq!(changes(&once.text, &HAND), [], "{name}");
            let comments = |text: &str| text.lines().filter(|line| line.contains('#')).count();
            assert_eq!(comments(&once.text), comments(shipped::text(name).unwrap()));
        }
    }

    #[test]
    fn one_force_needs_no_range_and_several_do() {
        let one = shipped::text("one-button").unwrap();
        assert_eq!(changes(one, &FLAT), [("press_n", 0.2), ("release_n", 0.11)]);
        let several = fitted(shipped::text("contra").unwrap(), &FLAT);
        assert_eq!(several.unwrap_err(), ForceRangeError::NotApart(FLAT));
    }

    #[test]
    fn what_must_be_less_stays_less() {
        let text = "schema = 1\nname = \"x\"\noutput = \"gamepad\"\n[dpad]\nmin_force_n = 20\nrelease_force_n = 19.99\n\
            [[trigger]]\ntrigger = \"left\"\nfrom_n = 1\nfull_n = 1.001\n\
            [access]\nrest_n = 0.5\n";
        let wanted = [
            ("rest_n", 0.2),
            ("min_force_n", 1.0),
            ("release_force_n", 0.99),
            ("from_n", 0.2),
            ("full_n", 0.21),
        ];
        assert_eq!(changes(text, &HAND), wanted);
        assert_eq!(
            fitted("schema = 1\nname = \"x\"\noutput = \"gamepad\"\n", &HAND).unwrap_err(),
            ForceRangeError::NoLevels
        );
        let giant = Range { light_n: 60.0, light_most_n: 60.0, hard_n: 600.0 };
        assert_eq!(fitted(text, &giant).unwrap_err(), ForceRangeError::NoProfile(giant));
    }

    #[test]
    fn presses_that_reach_a_force_are_counted() {
        let peaks = Peaks { light_n: vec![0.5, 1.0, 0.2], hard_n: vec![0.5, 0.4] };
        assert_eq!(ReachCount::of(&peaks, 0.5), ReachCount { light: 2, hard: 1 });
    }
}
