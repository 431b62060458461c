//! `tactpad tune --force-range`: fits a profile's normal forces to presses that are light at first and hard afterwards.

use std::fmt;
use std::io::Write;
use std::path::Path;

use serde::Serialize;

use super::arguments::Arguments;
use super::report::Pair;
use crate::cli::failure::Failure;
use crate::cli::playing::profile;
use crate::cli::printing::written::{print_json, stdout};
use tactpad::counted::counted;
use tactpad::lab::tuning::fitting::Fitted;
use tactpad::lab::tuning::force_range::fit::{ForceRangeError, ReachCount, fit};
use tactpad::lab::tuning::force_range::levels::{self, ends_n, is_one_force};
use tactpad::lab::tuning::force_range::peaks::Peaks;
use tactpad::lab::tuning::force_range::range::{PRESSES_MIN, Range};
use tactpad::lab::tuning::words::{ChangedNumber, path};
use tactpad::pipeline::mapping::profile::Profile;
use tactpad::pipeline::mapping::read::check::{OutputChoice, read};
use tactpad::pipeline::mapping::read::shipped;

/// With fewer presses of a kind none are left to try a fit on that has not seen them.
const HELD_OUT_MIN: usize = 2 * PRESSES_MIN;

/// A profile and its text.
#[derive(Clone, Copy)]
struct ProfileText<'p> {
    profile: &'p Profile,
    text: &'p str,
}

/// How many presses there are of each kind.
#[derive(Clone, Copy, Serialize)]
struct Presses {
    light: usize,
    hard: usize,
}

/// Of [`Range`], in newtons.
#[derive(Serialize)]
struct Forces {
    light_n: f64,
    light_most_n: f64,
    hard_n: f64,
}

/// A threshold and how many presses reach it.
#[derive(Clone, Copy, Serialize)]
struct Threshold {
    force_n: f64,
    light: usize,
    hard: usize,
}

/// A threshold before and after.
#[derive(Serialize)]
struct ThresholdRow {
    key: String,
    #[serde(flatten)]
    force: Pair<Threshold>,
}

/// How many presses do what they should.
#[derive(Clone, Copy, Serialize)]
struct ReachCounts {
    /// Light ones that reach the lowest threshold,
    light_lowest: usize,
    /// and those that reach the highest one;
    light_highest: usize,
    /// hard ones that reach the highest one.
    hard_highest: usize,
}

/// Numbers of later presses with a profile that was fitted to earlier ones alone.
#[derive(Serialize)]
struct HeldOutPresses {
    presses: Presses,
    reach: Pair<ReachCounts>,
}

/// The report of `tactpad tune --force-range`.
#[derive(Serialize)]
struct ForceRangeReport {
    presses: Presses,
    range: Forces,
    thresholds: Vec<ThresholdRow>,
    /// Of the same recording that was fitted to.
    reach: Pair<ReachCounts>,
    held_out: Option<HeldOutPresses>,
    changes: Vec<ChangedNumber>,
    /// Whether one force is enough for the profile.
    #[serde(skip)]
    is_one_force: bool,
    /// The file that was written.
    written: Option<String>,
}

pub(super) fn run(arguments: &Arguments, capture: &Path) -> Result<(), Failure> {
    let Arguments { profile: name, write, json, .. } = arguments;
    let read = profile::read(name, OutputChoice::AsWritten)?;
    let stored = write.as_deref().map(|to| arguments.stored(to, capture)).transpose()?;
    let peaks = Peaks::of(&arguments.trace(capture, read.profile())?);
    let range = Range::of(&peaks).ok_or_else(|| too_few(capture, &peaks))?;
    let given = ProfileText { profile: read.profile(), text: read.text() };
    let fitted = fit(given.text, given.profile, &range).map_err(|why| refused(name, given, why))?;
    let mut outcome = ForceRangeReport::of(given, &fitted, &peaks, &range);
    if let Some(stored) = stored.filter(|_| !fitted.changes.is_empty()) {
        outcome.written = Some(stored.write(&fitted.text)?.display().to_string());
    }
    if *json { print_json(&outcome) } else { Ok(writeln!(stdout(), "{outcome}")?) }
}

fn too_few(capture: &Path, peaks: &Peaks) -> Failure {
    Failure::Unusable(format!(
        "{} has {} in its first half and {} in its second, and {PRESSES_MIN} of each are needed: press again and again and \
         lift the finger in between, lightly up to the recording's middle and hard after it",
        capture.display(),
        counted(peaks.light_n.len(), "press"),
        peaks.hard_n.len(),
    ))
}

/// Why a profile is not fitted, and what would be one for this hand.
fn refused(name: &str, ProfileText { profile, text }: ProfileText<'_>, why: ForceRangeError) -> Failure {
    let asked = ends_n(&levels::all(profile, text)).unwrap_or_default();
    Failure::Unusable(match why {
        ForceRangeError::NoLevels => format!("{name} asks for no normal force: there is nothing to fit"),
        ForceRangeError::NotApart(Range { light_most_n, hard_n, .. }) => format!(
            "{name} asks for light presses ({} N) and hard ones ({} N), which this hand does not give surely apart (one light \
             press in ten exceeds {light_most_n:.2} N, one hard press in ten stays below {hard_n:.2} N): choose a profile \
             that needs one force, as {}, or tell presses by time, with tap, hold and long_press_ms or with dwell_ms, and by \
             zone, with press_n no more than {:.1} times the lowest force",
            asked[0],
            asked[1],
            one_force_names().join(", "),
            levels::ONE_FORCE,
        ),
        ForceRangeError::NoProfile(range) => format!(
            "no profile can ask for the forces of this recording, {:.2} N to {:.2} N: record it again, and tare the pad before",
            range.lowest_n(),
            range.highest_n()
        ),
    })
}

/// The profiles inside the program that need one force only.
fn one_force_names() -> Vec<&'static str> {
    let is_one = |name: &&str| {
        let text = shipped::text(name).unwrap_or_default();
        let profile = read(text, OutputChoice::AsWritten).0;
        profile.and_then(|profile| ends_n(&levels::all(&profile, text))).is_some_and(is_one_force)
    };
    shipped::names().filter(is_one).collect()
}

impl ForceRangeReport {
    fn of(given: ProfileText<'_>, fitted: &Fitted, peaks: &Peaks, range: &Range) -> Self {
        let [before, after] = [given, whole(fitted)].map(|profile| thresholds(profile, peaks));
        let row = |((key, before), (_, after))| ThresholdRow { key, force: Pair { before, after } };
        Self {
            presses: Presses::of(peaks),
            range: Forces { light_n: range.light_n, light_most_n: range.light_most_n, hard_n: range.hard_n },
            thresholds: before.into_iter().zip(after).map(row).collect(),
            reach: Pair {
                before: ReachCounts::of(given, peaks),
                after: ReachCounts::of(whole(fitted), peaks),
            },
            held_out: held_out(given, peaks),
            changes: fitted.changes.iter().map(|change| ChangedNumber::of(change, &fitted.profile)).collect(),
            is_one_force: ends_n(&levels::all(given.profile, given.text)).is_some_and(is_one_force),
            written: None,
        }
    }
}

const fn whole(fitted: &Fitted) -> ProfileText<'_> {
    ProfileText { profile: &fitted.profile, text: fitted.text.as_str() }
}

impl Presses {
    const fn of(peaks: &Peaks) -> Self {
        Self { light: peaks.light_n.len(), hard: peaks.hard_n.len() }
    }
}

impl ReachCounts {
    fn of(ProfileText { profile, text }: ProfileText<'_>, peaks: &Peaks) -> Self {
        let [lowest_n, highest_n] = ends_n(&levels::all(profile, text)).unwrap_or_default();
        let ReachCount { light, hard } = ReachCount::of(peaks, highest_n);
        Self { light_lowest: ReachCount::of(peaks, lowest_n).light, light_highest: light, hard_highest: hard }
    }
}

/// Each threshold by its key, and how many presses reach it.
fn thresholds(ProfileText { profile, text }: ProfileText<'_>, peaks: &Peaks) -> Vec<(String, Threshold)> {
    let reached = |force_n: f64| {
        let ReachCount { light, hard } = ReachCount::of(peaks, force_n);
        Threshold { force_n, light, hard }
    };
    let levels = levels::all(profile, text).into_iter();
    let all = levels.map(|level| (path(level.key), reached(level.force_n)));
    all.chain(levels::rest_n(profile).map(|rest_n| ("access.rest_n".to_owned(), reached(rest_n)))).collect()
}

/// Fits to the earlier half of both kinds and counts what becomes of the later half; nothing if they are few, or too near to each other.
fn held_out(given: ProfileText<'_>, peaks: &Peaks) -> Option<HeldOutPresses> {
    let Presses { light, hard } = Presses::of(peaks);
    if light.min(hard) < HELD_OUT_MIN {
        return None;
    }
    let [first, second] = peaks.halves();
    let fitted = fit(given.text, given.profile, &Range::of(&first)?).ok()?;
    let reach =
        Pair { before: ReachCounts::of(given, &second), after: ReachCounts::of(whole(&fitted), &second) };
    Some(HeldOutPresses { presses: Presses::of(&second), reach })
}

/// Numbers of presses that reach the thresholds, in words: a line for each kind.
fn told(
    presses: Presses,
    ReachCounts { light_lowest, light_highest, hard_highest }: ReachCounts,
    is_one: bool,
) -> String {
    let Presses { light, hard } = presses;
    if is_one {
        return format!("  {light_highest} of {light} light presses are enough");
    }
    format!(
        "  {light_lowest} of {light} light presses reach the lowest threshold, {light_highest} the highest\n  \
         {hard_highest} of {hard} hard presses reach the highest"
    )
}

impl fmt::Display for ForceRangeReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { presses, range, thresholds, reach, .. } = self;
        let Forces { light_n, light_most_n, hard_n } = range;
        writeln!(f, "{} light presses and {} hard ones", presses.light, presses.hard)?;
        writeln!(
            f,
            "nine of ten light presses reach {light_n:.2} N, one in ten exceeds {light_most_n:.2} N"
        )?;
        writeln!(f, "nine of ten hard presses reach {hard_n:.2} N\n")?;
        let wide = thresholds.iter().map(|row| row.key.len()).chain([9]).max().unwrap_or_default();
        writeln!(f, "{:<wide$}    before  light  hard     after  light  hard", "threshold")?;
        for ThresholdRow { key, force: Pair { before, after } } in thresholds {
            let [before, after] =
                [before, after].map(|it| format!("{:>6.2} N  {:>5}  {:>4}", it.force_n, it.light, it.hard));
            writeln!(f, "{key:<wide$}  {before}  {after}")?;
        }
        writeln!(f, "light, hard: how many of these presses reach it")?;
        let told = |presses, good| told(presses, good, self.is_one_force);
        writeln!(f, "\nas it is:\n{}", told(*presses, reach.before))?;
        if self.changes.is_empty() {
            write!(f, "\nthe profile fits this hand: nothing changes")?;
        } else {
            writeln!(f, "\nproposed:")?;
            self.changes.iter().try_for_each(|change| writeln!(f, "  {}", change.words))?;
            write!(f, "\nwith that, in this same recording:\n{}", told(*presses, reach.after))?;
        }
        if let Some(HeldOutPresses { presses, reach }) = &self.held_out {
            let after = told(*presses, reach.after);
            write!(f, "\nfitted to the earlier half of both alone, the presses after them:\n{after}")?;
        }
        self.written.iter().try_for_each(|path| write!(f, "\n{path} is written"))
    }
}
