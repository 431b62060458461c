//! How often what came for what was meant, as a table.

use std::fmt;

use serde::Serialize;

use super::labels::Labels;
use super::scoring::{LabelOutcome, Score};

/// The column of what was meant, but more than once.
const REPEATED: &str = "more than once";
/// The column of everything else.
const OTHER: &str = "something else";

/// A row for each thing that was meant, a column for each thing that came.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Confusion {
    /// What was meant.
    pub meant: Vec<String>,
    /// What came: the same names, then the two that nobody means.
    pub came: Vec<String>,
    /// How often, row by row.
    pub counts: Vec<Vec<usize>>,
}

impl Confusion {
    /// Counts what came.
    pub fn of(labels: &Labels, score: &Score) -> Self {
        let meant: Vec<String> = labels.classes().iter().map(|class| class.name.clone()).collect();
        let came: Vec<String> = meant.iter().cloned().chain([REPEATED, OTHER].map(str::to_owned)).collect();
        let mut counts = vec![vec![0; came.len()]; meant.len()];
        for (label, came) in labels.labels().iter().zip(score.came()) {
            let column = match came {
                LabelOutcome::Class(class) => *class,
                LabelOutcome::Repeated => meant.len(),
                LabelOutcome::Other => meant.len() + 1,
            };
            if let Some(count) = counts.get_mut(label.class).and_then(|row| row.get_mut(column)) {
                *count += 1;
            }
        }
        Self { meant, came, counts }
    }
}

impl fmt::Display for Confusion {
    /// Rows and columns without a count are left out; those of what was meant and came are both shown where either has one.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let row_has = |row: usize| self.counts.get(row).is_some_and(|row| row.iter().any(|count| *count > 0));
        let column_has =
            |column: usize| self.counts.iter().any(|row| row.get(column).is_some_and(|it| *it > 0));
        let shown: Vec<usize> = (0..self.came.len()).filter(|it| column_has(*it) || row_has(*it)).collect();
        let width = self.meant.iter().map(|name| name.chars().count()).max().unwrap_or(0).max("meant".len());
        write!(f, "{:width$}", "meant")?;
        let name = |column: usize| self.came.get(column).map_or("", String::as_str);
        shown.iter().try_for_each(|column| write!(f, "  {}", name(*column)))?;
        for (row, (meant, counts)) in self.meant.iter().zip(&self.counts).enumerate() {
            if !row_has(row) {
                continue;
            }
            write!(f, "\n{meant:width$}")?;
            for column in &shown {
                let cell =
                    counts.get(*column).filter(|count| **count > 0).map_or("·".into(), usize::to_string);
                write!(f, "  {cell:>0$}", name(*column).chars().count())?;
            }
        }
        Ok(())
    }
}
