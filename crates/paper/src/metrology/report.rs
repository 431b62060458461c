//! The paper's published figures beside those that were found.

use serde::{Deserialize, Serialize};
use tactpad_numeric::statistics::{deviation, mean};

use super::Needs;
use super::figures::Figures;
use super::lines::{LINES, Line, Openness};

/// The proof that a published figure and others exclude each other.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Conflict {
    /// Key of the line that is given up.
    pub row: String,
    /// The value that it reaches where it alone is fitted, inside the physical bounds of the imperfections.
    pub alone: f64,
    /// The lines that then leave their bounds.
    pub leaving: Vec<Leaving>,
    /// Why, in one sentence.
    pub reason: String,
}

/// A line that leaves its bound where another one is met.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Leaving {
    /// Its key.
    pub row: String,
    /// Its value then.
    pub value: f64,
}

/// Outcome of a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Status {
    /// Within its bound.
    Inside,
    /// Not within its bound.
    Outside,
    /// Not found: something is needed.
    Open,
    /// Not within its bound, and shown to exclude others.
    Conflict,
    /// Found; the paper published none.
    Unpublished,
}

/// A line that is filled in.
#[derive(Clone, Debug, Serialize)]
pub struct ReportEntry {
    /// As in [`Line`].
    pub key: &'static str,
    /// As in [`Line`].
    pub name: &'static str,
    /// As in [`Line`].
    pub unit: &'static str,
    /// The paper's value.
    pub paper: Option<f64>,
    /// Mean over the tables.
    pub mean: Option<f64>,
    /// Standard deviation over the tables; none below two.
    pub spread: Option<f64>,
    /// Mean less published, of published.
    pub difference_percent: Option<f64>,
    /// Within how much it must be.
    pub bound_percent: Option<f64>,
    /// Its outcome.
    pub status: Status,
    /// The missing rows, where it was not found.
    pub needs: Option<Needs>,
    /// The proof of a conflict.
    pub conflict: Option<Conflict>,
}

/// All lines for the figures of one table, or of several by different seeds.
pub fn entries(figures: &[Figures], conflicts: &[Conflict]) -> Vec<ReportEntry> {
    LINES.iter().map(|line| line.filled(figures, conflicts)).collect()
}

impl Line {
    fn filled(&self, figures: &[Figures], conflicts: &[Conflict]) -> ReportEntry {
        let found: Vec<Result<f64, Needs>> = figures.iter().map(self.value).collect();
        let values: Vec<f64> = found.iter().filter_map(|value| value.ok()).collect();
        let mean = (!values.is_empty()).then(|| mean(&values));
        let conflict = conflicts.iter().find(|conflict| self.is_shown_by(conflict));
        let status = self.status(mean, conflict);
        ReportEntry {
            key: self.key,
            name: self.name,
            unit: self.unit,
            paper: self.published.map(|published| published.value),
            mean,
            spread: (values.len() > 1).then(|| deviation(&values)),
            difference_percent: mean.and_then(|mean| Some(self.published?.difference_percent(mean))),
            bound_percent: self.published.map(|published| published.bound_percent),
            status,
            needs: found.iter().find_map(|value| value.err()),
            conflict: conflict.filter(|_| status == Status::Conflict).cloned(),
        }
    }

    fn status(&self, mean: Option<f64>, conflict: Option<&Conflict>) -> Status {
        match (mean, self.published) {
            (None, _) => Status::Open,
            (Some(_), None) => Status::Unpublished,
            (Some(mean), Some(published)) if published.holds(mean) => Status::Inside,
            _ if conflict.is_some() => Status::Conflict,
            _ => Status::Outside,
        }
    }

    /// Whether it may be in conflict, and this shows it: fitted alone it is still outside, or others leave
    /// their bounds.
    pub(super) fn is_shown_by(&self, conflict: &Conflict) -> bool {
        let leaves = |leaving: &Leaving| {
            let line = LINES.iter().find(|line| line.key == leaving.row);
            line.and_then(|line| line.published).is_some_and(|published| !published.holds(leaving.value))
        };
        let may = self.published.filter(|published| published.openness == Openness::MayConflict);
        let is_unreached = may.is_some_and(|published| !published.holds(conflict.alone));
        conflict.row == self.key && may.is_some() && (is_unreached || conflict.leaving.iter().any(leaves))
    }
}

#[cfg(test)]
mod tests {
    use super::super::figures::Evidence;
    use super::*;
    use crate::metrology::ageing::Ageing;
    use crate::metrology::resolution::Resolution;
    use tactpad_core::pad::influence::{InfluenceField, MAPS};
    use tactpad_core::tables::measured::Table;

    /// Nothing found but these.
    fn figures(step_n: f64, change_share: f64) -> Figures {
        let signals = InfluenceField::sampled(5.0, 29.0, 30.0, |_| [0.0; MAPS]);
        let table = Table::default();
        let evidence = Evidence { table: &table, signals: &signals, decoder: None, simulation: None };
        let resolution = Resolution {
            step_n,
            without_drift_n: step_n,
            unloaded_step_n: Some(step_n),
            load_n: 1.0,
            means: 60,
        };
        Figures {
            resolution: Ok(resolution),
            ageing: Ok(Ageing { change_share, curve: vec![] }),
            ..Figures::of(&evidence)
        }
    }

    fn entry(key: &str, figures: &[Figures], conflicts: &[Conflict]) -> ReportEntry {
        entries(figures, conflicts).into_iter().find(|entry| entry.key == key).unwrap()
    }

    fn conflict(row: &str, alone: f64, leaving: &[(&str, f64)]) -> Conflict {
        let leaving = leaving.iter().map(|(row, value)| Leaving { row: (*row).to_owned(), value: *value });
        Conflict { row: row.into(), alone, leaving: leaving.collect(), reason: "noise".into() }
    }

    #[test]
    fn keys_are_unique() {
        let mut keys: Vec<&str> = LINES.iter().map(|line| line.key).collect();
        keys.sort_unstable();
        keys.dedup();
        assert_eq!(keys.len(), LINES.len());
    }

    #[test]
    fn mean_spread_and_difference_are_over_the_seeds() {
        let seeds = [figures(0.005, -0.19), figures(0.006, -0.20)];
        let found = entry("resolution", &seeds, &[]);
        let near = |found: Option<f64>, expected: f64| assert!((found.unwrap() - expected).abs() < 1e-9);
        near(found.mean, 5.5);
        near(found.spread, 0.5_f64.sqrt());
        near(found.difference_percent, 10.0);
        assert_eq!((found.status, found.needs), (Status::Inside, None));
        assert_eq!(entry("ageing", &seeds[..1], &[]).spread, None);
        assert_eq!(entry("resolution_without_drift", &seeds, &[]).status, Status::Unpublished);
    }

    #[test]
    fn what_is_not_found_is_open_and_says_why() {
        let found = entry("hysteresis", &[figures(0.005, 0.19)], &[]);
        assert_eq!((found.status, found.mean), (Status::Open, None));
        assert!(found.needs.unwrap().to_string().starts_with("needs trials that load"), "{found:?}");
    }

    #[test]
    fn a_conflict_must_be_shown_and_allowed() {
        let off = [figures(0.020, -0.30)];
        assert_eq!(entry("resolution", &off, &[]).status, Status::Outside);
        // It cannot be reached at all, or only where another line leaves its bound.
        for shown in [conflict("resolution", 9.0, &[]), conflict("resolution", 5.0, &[("ageing", 30.0)])] {
            let found = entry("resolution", &off, std::slice::from_ref(&shown));
            assert_eq!((found.status, found.conflict), (Status::Conflict, Some(shown)));
        }
        // It can be reached, and nothing that was published is lost.
        for idle in [
            conflict("resolution", 5.0, &[("ageing", 19.0)]),
            conflict("resolution", 5.0, &[("step_rise", 9.0)]),
        ] {
            assert_eq!(entry("resolution", &off, &[idle]).status, Status::Outside);
        }
        // A line that must be met stays outside; one that is met is in no conflict.
        assert_eq!(entry("ageing", &off, &[conflict("ageing", 9.0, &[])]).status, Status::Outside);
        let met = entry("resolution", &[figures(0.005, 0.19)], &[conflict("resolution", 9.0, &[])]);
        assert_eq!((met.status, met.conflict), (Status::Inside, None));
    }
}
