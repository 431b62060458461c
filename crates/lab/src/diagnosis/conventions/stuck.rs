//! Labels that stand still while the contacts go on: a force sensor that froze, a column that was filled in.

use super::mapping::WrittenContact;
use crate::diagnosis::data::target::LABELS;
use tactpad_numeric::statistics::median;

/// Fewest contacts in a row with one label …
const CONTACTS_MIN: usize = 8;
/// … whose places, or forces by the median one, scatter by this …
const PLACE_MM: f64 = 3.0;
const FORCE_SHARE: f64 = 0.1;
/// … and by so many times what the readings miss the label by elsewhere. Where it is never another one, forces scatter by this share: what
/// is decoded of one force by another pad's field does by less.
const TIMES: f64 = 3.0;
const FORCE_SHARE_OF_ALL: f64 = 0.25;
/// A deviation of normal numbers by the median of their magnitudes.
const OF_MEDIAN: f64 = 1.4826;

/// A label that stands still.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StuckLabel {
    /// Which of x, y, Fx, Fy, Fz.
    pub(crate) column: usize,
    /// The rows in which it does.
    pub(crate) rows: Vec<usize>,
}

impl StuckLabel {
    /// The column's name.
    pub const fn name(&self) -> &'static str {
        LABELS[self.column]
    }

    /// Of contacts in the order of their rows. Where labels and readings do not agree at all only a column that never changes is one.
    pub(super) fn of(contacts: &[WrittenContact], do_agree: bool) -> Vec<Self> {
        (0..LABELS.len()).filter_map(|column| Self::of_column(contacts, column, do_agree)).collect()
    }

    fn of_column(contacts: &[WrittenContact], column: usize, do_agree: bool) -> Option<Self> {
        let label = |it: &WrittenContact| it.label.numbers()[column];
        let decoded = |it: &WrittenContact| it.decoded.numbers()[column];
        let force_n = median(contacts.iter().map(|it| it.decoded.resultant_n()))?;
        let least = |share: f64| if column < 2 { PLACE_MM } else { share * force_n };
        let scatter = |run: &&[WrittenContact]| {
            let middle = median(run.iter().map(decoded)).unwrap_or_default();
            OF_MEDIAN * median(run.iter().map(|it| (decoded(it) - middle).abs())).unwrap_or_default()
        };
        let runs = contacts.chunk_by(|one, next| label(one) == label(next));
        let (still, others): (Vec<_>, Vec<_>) =
            runs.partition(|run| run.len() >= CONTACTS_MIN && scatter(run) > least(FORCE_SHARE));
        let missed = others.concat();
        let missed = median(missed.iter().map(|it| (decoded(it) - label(it)).abs()));
        let is_sure = |run: &&[WrittenContact]| match missed {
            Some(missed) => do_agree && scatter(run) > TIMES * OF_MEDIAN * missed,
            None => still.len() == 1 && scatter(run) > least(FORCE_SHARE_OF_ALL),
        };
        let rows: Vec<usize> =
            still.iter().filter(|run| is_sure(run)).flat_map(|run| run.iter().map(|it| it.row)).collect();
        (!rows.is_empty()).then_some(Self { column, rows })
    }
}

#[cfg(test)]
mod tests {
    use super::super::decoding::DecodedContact;
    use super::*;
    use tactpad_core::tables::measured::Label;

    /// Contacts with forces of 1 to 3 N, as the readings tell them to 2 %; those of `stuck` are written as the one before.
    fn contacts(stuck: std::ops::Range<usize>) -> Vec<WrittenContact> {
        let force = |at: usize| 1.0 + (at * 7 % 20) as f64 / 10.0;
        let contact = |row: usize| {
            let fz_n = force(if stuck.contains(&row) { stuck.start } else { row });
            let off = if row.is_multiple_of(2) { 1.02 } else { 0.98 };
            WrittenContact {
                row,
                decoded: DecodedContact {
                    place_mm: [0.0; 2],
                    force_n: [0.0, 0.0, off * force(row)],
                    missed: 0.0,
                },
                label: Label { fz_n, ..Label::default() },
            }
        };
        (0..200).map(contact).collect()
    }

    #[test]
    fn a_force_that_stands_still_is_found_and_one_that_is_held_is_not() {
        assert_eq!(
            StuckLabel::of(&contacts(50..80), true),
            [StuckLabel { column: 4, rows: (50..80).collect() }]
        );
        assert_eq!(
            StuckLabel::of(&contacts(0..200), false),
            [StuckLabel { column: 4, rows: (0..200).collect() }]
        );
        assert_eq!(StuckLabel::of(&contacts(0..0), true), []);
        assert_eq!(StuckLabel::of(&contacts(50..80), false), []);
        let mut held = contacts(0..0);
        held.iter_mut().for_each(|it| it.decoded.force_n = [0.0, 0.0, 2.0 + 0.01 * it.row as f64 / 200.0]);
        held.iter_mut().for_each(|it| it.label.fz_n = 2.0);
        assert_eq!(StuckLabel::of(&held, true), []);
    }
}
