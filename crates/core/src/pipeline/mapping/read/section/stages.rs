//! When a button's press is hard, as a profile writes it.

use crate::pipeline::mapping::profile::{Role, Skip};
use crate::pipeline::mapping::read::common::limits::{HARD_N, RELEASE_SHARE, SKIP_MS};
use crate::toml_text::diag::Findings;
use crate::toml_text::section::{Bounds, Placed, Section};

/// Keys that only a button with "hard" has.
const KEYS: [&str; 4] = ["hard_press_n", "hard_release_n", "skip", "skip_ms"];
/// How a skip is written, and whether it waits.
const SKIPS: [(&str, Word); 3] = [("no", Word::No), ("may", Word::May), ("must", Word::Must)];

#[derive(Clone, Copy)]
enum Word {
    No,
    May,
    Must,
}

/// When a press is hard, and what then becomes of the light one.
#[derive(Clone, Copy)]
pub(crate) struct Stages {
    pub(crate) press_n: f32,
    pub(crate) release_n: f32,
    pub(crate) skip: Skip,
}

/// Reads them where there is a hard press; `press` is the force of a light one.
pub(crate) fn read(
    table: &Section<'_>,
    press: Option<Placed<f32>>,
    findings: &mut Findings<'_>,
) -> Option<Stages> {
    if table.place_of(Role::Hard.name()).is_none() {
        for (key, at) in KEYS.iter().filter_map(|key| Some((key, table.place_of(key)?))) {
            let message = format!("\"{key}\" does nothing without \"hard\"");
            findings.error(at, message, "remove it, or write \"light\" and \"hard\"");
        }
        return None;
    }
    table.require("hard_press_n", "write the force in newtons from which a press is hard", findings);
    let hard = table.place_of("hard_press_n").and_then(|_| table.number("hard_press_n", HARD_N, findings));
    let share = hard.map_or(HARD_N.default, |force| force.value) * RELEASE_SHARE;
    let release = table.number("hard_release_n", Bounds { low: 0.0, default: share, ..HARD_N }, findings);
    table.require_less(("hard_release_n", release), ("hard_press_n", hard), findings);
    table.require_less(("press_n", press), ("hard_press_n", hard), findings);
    let skip = read_skip(table, findings);
    Some(Stages { press_n: hard?.value, release_n: release?.value, skip: skip? })
}

fn read_skip(table: &Section<'_>, findings: &mut Findings<'_>) -> Option<Skip> {
    let word = match table.place_of("skip") {
        Some(_) => table.word("skip", &SKIPS, findings).map(|word| word.value),
        None => Some(Word::No),
    };
    let time = table.whole("skip_ms", SKIP_MS, findings);
    if let (Some(Word::No), Some(at)) = (word, table.place_of("skip_ms")) {
        findings.error(
            at,
            "\"skip_ms\" does nothing without a skip",
            "remove it, or write skip = \"may\" or \"must\"",
        );
    }
    let us = u64::from(time?.value) * 1_000;
    Some(match word? {
        Word::No => Skip::No,
        Word::May => Skip::May { us },
        Word::Must => Skip::Must { us },
    })
}
