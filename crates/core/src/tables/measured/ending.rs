//! The end of a table.
//!
//! Many sound editors leave off the last line end. So does a copy that broke off, and then 3.5 may have become 3. Only the
//! column's other numbers can tell: if all are written with so many digits behind the point, the last one is whole with as
//! many and cut off with fewer. Where they differ, or there is no point, nobody knows.

use std::fmt;

/// A last line that has no line end and may be cut off.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct OpenEnd {
    /// The line, from 1.
    pub line: usize,
    /// The last column's name.
    pub name: String,
    /// What it was read as; its beginning, if that is long.
    pub text: String,
}

impl fmt::Display for OpenEnd {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { name, text, .. } = self;
        write!(
            f,
            "the file ends without a line end, and its last {name} was read as {text:?}; end the line if that is all of it"
        )
    }
}

/// What the last cell of a line without a line end is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum LastCell {
    Whole,
    CutOff,
    Unknown,
}

/// How the numbers of the last column are written.
#[derive(Debug, Default)]
pub(super) struct LastColumn {
    /// The least and the most digits of its numbers; none before the first.
    digits: Option<[Digits; 2]>,
}

/// How many digits a number has behind its point and in its exponent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Digits {
    decimals: usize,
    exponent: usize,
}

impl Digits {
    /// None, if the cell holds no number.
    fn of(cell: &str) -> Option<Self> {
        cell.parse::<f64>().ok().filter(|number| number.is_finite())?;
        let (number, exponent) = cell.split_once(['e', 'E']).unwrap_or((cell, ""));
        let decimals = number.split_once('.').map_or(0, |(_, decimals)| decimals.len());
        Some(Self { decimals, exponent: exponent.trim_start_matches(['+', '-']).len() })
    }

    fn by(self, other: Self, choose: fn(usize, usize) -> usize) -> Self {
        Self {
            decimals: choose(self.decimals, other.decimals),
            exponent: choose(self.exponent, other.exponent),
        }
    }
}

impl LastColumn {
    /// Takes a cell of a line that has its line end.
    pub(super) fn see(&mut self, cell: &str) {
        let Some(seen) = Digits::of(cell.trim()) else { return };
        let [least, most] = self.digits.unwrap_or([seen; 2]);
        self.digits = Some([least.by(seen, usize::min), most.by(seen, usize::max)]);
    }

    /// Judges the cell at the end of a file.
    pub(super) fn judge(&self, cell: &str) -> LastCell {
        let Some([least, most]) = self.digits.filter(|_| !cell.trim().is_empty()) else {
            return LastCell::Unknown;
        };
        let Some(last) = Digits::of(cell.trim()) else { return LastCell::CutOff };
        let is_fixed = if most.exponent > 0 {
            least.exponent == most.exponent
        } else {
            least.decimals == most.decimals && most.decimals > 0
        };
        if last.by(least, usize::min) != least {
            LastCell::CutOff
        } else if is_fixed && last.exponent == most.exponent && (last.exponent > 0 || last == most) {
            LastCell::Whole
        } else {
            LastCell::Unknown
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn judged(above: &[&str], last: &str) -> LastCell {
        let mut column = LastColumn::default();
        above.iter().for_each(|cell| column.see(cell));
        column.judge(last)
    }

    #[test]
    fn a_last_number_is_held_against_those_above_it() {
        for (above, last, wanted) in [
            (&["2.5", "-11.0"][..], "3.5", LastCell::Whole),
            (&["2.5"], "3", LastCell::CutOff),
            (&["2.5"], "3.", LastCell::CutOff),
            (&["2.5"], "-", LastCell::CutOff),
            (&["2.50", "1.25"], "3.5", LastCell::CutOff),
            (&["2.5", "1.25"], "3.5", LastCell::Unknown),
            (&["2.5", "1.25"], "3", LastCell::CutOff),
            (&["2.5", "1.25", "4"], "3.5", LastCell::Unknown),
            (&["2", "15"], "1", LastCell::Unknown),
            (&["1.5e-05", "2.25e+12"], "1.5e-05", LastCell::Whole),
            (&["1.5e-05", "2.5e-12"], "1.5e-0", LastCell::CutOff),
            (&["1.5e-05", "2.5e-12"], "1.5e-", LastCell::CutOff),
            (&["1.5e-05", "2.5e-12"], "1.5", LastCell::CutOff),
            (&["1.5e5", "2.5e12"], "1.5e1", LastCell::Unknown),
            (&["1.5e5", "2.5"], "1.5e1", LastCell::Unknown),
            (&["", "nan", "play"], "pla", LastCell::Unknown),
            (&[], "3.5", LastCell::Unknown),
            (&["2.5"], "", LastCell::Unknown),
        ] {
            assert_eq!(judged(above, last), wanted, "{last} below {above:?}");
        }
    }
}
