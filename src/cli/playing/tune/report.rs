//! The report of a fitted profile, for people and programs.

use std::fmt;

use serde::Serialize;

use tactpad::lab::tuning::confusion::Confusion;
use tactpad::lab::tuning::delay::delay_us;
use tactpad::lab::tuning::fitting::{Fitted, Study};
use tactpad::lab::tuning::words::ChangedNumber;
use tactpad::pipeline::mapping::profile::Profile;

/// With the profile that was given, and with the fitted one.
#[derive(Clone, Copy, Debug, Serialize)]
pub(super) struct Pair<T> {
    pub(super) before: T,
    pub(super) after: T,
}

/// How late the profiles decide.
#[derive(Serialize)]
struct Delay {
    limit: f64,
    before: f64,
    after: f64,
}

/// Numbers of right presses of the second half with a profile that was fitted to the first alone.
#[derive(Serialize)]
pub(super) struct HeldOut {
    pub(super) events: usize,
    pub(super) correct: Pair<usize>,
}

/// The report of `tactpad tune`.
#[derive(Serialize)]
pub(super) struct TuneReport {
    events: usize,
    correct: Pair<usize>,
    share: Pair<f64>,
    /// Numbers of presses where the labels say nothing.
    unlabelled: Pair<usize>,
    confusion: Pair<Confusion>,
    held_out: Option<HeldOut>,
    changes: Vec<ChangedNumber>,
    delay_ms: Delay,
    /// The file that was written.
    pub(super) written: Option<String>,
}

impl TuneReport {
    /// Compares both profiles.
    pub(super) fn of(study: &Study<'_>, given: &Profile, fitted: &Fitted, held_out: Option<HeldOut>) -> Self {
        let scores = [given, &fitted.profile].map(|profile| study.score(profile));
        let [before, after] = &scores;
        let period_us = study.trace.period_us();
        let [late_before, late_after] =
            [given, &fitted.profile].map(|profile| milliseconds(delay_us(profile, period_us)));
        Self {
            events: study.labels.labels().len(),
            correct: Pair { before: before.correct(), after: after.correct() },
            share: Pair { before: before.share(), after: after.share() },
            unlabelled: Pair { before: before.strays(), after: after.strays() },
            confusion: Pair {
                before: Confusion::of(study.labels, before),
                after: Confusion::of(study.labels, after),
            },
            held_out,
            changes: fitted.changes.iter().map(|change| ChangedNumber::of(change, &fitted.profile)).collect(),
            delay_ms: Delay {
                limit: milliseconds(study.delay_max_us),
                before: late_before,
                after: late_after,
            },
            written: None,
        }
    }
}

fn milliseconds(us: u64) -> f64 {
    us as f64 * 1e-3
}

fn percent(share: f64) -> String {
    format!("{:.1} %", 100.0 * share)
}

impl fmt::Display for TuneReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { events, correct, share, unlabelled, confusion, delay_ms, .. } = self;
        writeln!(f, "as it is: {} of {events} correct ({})", correct.before, percent(share.before))?;
        writeln!(f, "{}", confusion.before)?;
        if self.changes.is_empty() {
            write!(f, "\nno other numbers are better: nothing changes")?;
        } else {
            writeln!(f, "\nproposed:")?;
            self.changes.iter().try_for_each(|change| writeln!(f, "  {}", change.words))?;
            writeln!(
                f,
                "\nwith the fitted profile: {} of {events} correct ({})",
                correct.after,
                percent(share.after)
            )?;
            writeln!(f, "{}", confusion.after)?;
            let Delay { limit, before, after } = delay_ms;
            write!(
                f,
                "\nit decides {after:.0} ms late at most, before {before:.0} ms; allowed: {limit:.0} ms"
            )?;
        }
        if [unlabelled.before, unlabelled.after] != [0, 0] {
            let Pair { before, after } = unlabelled;
            write!(f, "\nbetween the labelled presses {after} came, before {before}")?;
        }
        if let Some(HeldOut { events, correct: Pair { before, after } }) = &self.held_out {
            write!(
                f,
                "\nfitted to the first half alone: {after} of {events} correct in the second, before {before}"
            )?;
        }
        self.written.iter().try_for_each(|path| write!(f, "\n{path} is written"))
    }
}
