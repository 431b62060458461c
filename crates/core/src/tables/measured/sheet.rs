//! Tables of any sensor: a header, and columns of numbers under whatever names.
//!
//! A column counts as numbers if most of its cells that are not empty are; cells without a finite number are missing values. Texts
//! are kept of those columns that a reader asks for: a text takes many times the memory of a number.

use std::borrow::Cow;
use std::io::BufRead;

use super::ending::OpenEnd;
use super::error::{Fault, ReadError};
use super::rows::Rows;

/// Of a column's cells that are not empty, so many are numbers at least.
const NUMBERS_MIN: f64 = 0.5;
/// As many numbers as a gigabyte holds.
const CELLS_MAX: usize = 1 << 27;

/// A table of named columns, all of them equally long.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Sheet {
    columns: Vec<Column>,
    rows: usize,
    open_end: Option<OpenEnd>,
}

#[derive(Clone, Debug, PartialEq)]
struct Column {
    name: String,
    /// Not a number where a value is missing.
    numbers: Vec<f64>,
    /// What stands there, where it is kept.
    texts: Option<Vec<String>>,
    /// How many cells are not empty.
    written: usize,
    is_number: bool,
}

impl Sheet {
    /// How many rows there are.
    pub const fn rows(&self) -> usize {
        self.rows
    }

    /// The last line, if it may be cut off.
    pub const fn open_end(&self) -> Option<&OpenEnd> {
        self.open_end.as_ref()
    }

    /// The names of the columns of numbers, in the file's order.
    pub fn numeric(&self) -> impl Iterator<Item = &str> {
        self.columns.iter().filter(|column| column.is_number).map(|column| column.name.as_str())
    }

    /// Whether there is a column of this name, of whatever kind.
    pub fn has(&self, name: &str) -> bool {
        self.column(name).is_some()
    }

    /// A column of numbers, NaN where one is missing.
    pub fn numbers(&self, name: &str) -> Option<&[f64]> {
        self.column(name).filter(|column| column.is_number).map(|column| column.numbers.as_slice())
    }

    /// What stands in a column whose texts are kept; empty where nothing does.
    pub fn texts(&self, name: &str) -> Option<&[String]> {
        self.column(name)?.texts.as_deref()
    }

    /// The same rows with the numbers that `other` has in these columns.
    ///
    /// Columns that one of the two has not stay as they are.
    #[must_use]
    pub fn with_numbers_of(&self, other: &Self, names: &[String]) -> Self {
        let mut sheet = self.clone();
        for column in sheet.columns.iter_mut().filter(|column| names.contains(&column.name)) {
            if let Some(numbers) = other.numbers(&column.name).filter(|it| it.len() == column.numbers.len()) {
                column.numbers = numbers.to_vec();
            }
        }
        sheet
    }

    fn column(&self, name: &str) -> Option<&Column> {
        self.columns.iter().find(|column| column.name == name)
    }
}

/// Reads a table; at least one row, or it is an error. `texts` names the columns whose texts are kept.
///
/// # Errors
/// The text is no table: where, and why.
pub fn sheet(from: impl BufRead, texts: &[&str]) -> Result<Sheet, ReadError> {
    let mut rows = Rows::begin(from, Fault::NoHeader)?;
    let mut sheet = headed(rows.names(), texts).map_err(|fault| rows.error(fault))?;
    sheet.open_end = rows.each(|_, cells| sheet.push(cells))?;
    if sheet.rows == 0 {
        return Err(rows.error(Fault::NoRows));
    }
    for column in &mut sheet.columns {
        let numbers = column.numbers.iter().filter(|number| number.is_finite()).count() as f64;
        column.is_number = numbers > NUMBERS_MIN * column.written as f64;
    }
    Ok(sheet)
}

fn headed(names: &[String], texts: &[&str]) -> Result<Sheet, Fault> {
    let mut sheet = Sheet::default();
    for name in names {
        if sheet.has(name) {
            return Err(Fault::DoubledColumn(name.clone()));
        }
        let texts = texts.contains(&name.as_str()).then(Vec::new);
        let (name, numbers) = (name.clone(), Vec::new());
        sheet.columns.push(Column { name, numbers, texts, written: 0, is_number: true });
    }
    if let [one] = names
        && one.contains([';', '\t'])
    {
        return Err(Fault::Separator);
    }
    Ok(sheet)
}

impl Sheet {
    fn push(&mut self, cells: &[Cow<'_, str>]) -> Result<(), Fault> {
        if (self.rows + 1) * self.columns.len() > CELLS_MAX {
            return Err(Fault::TooManyRows(self.rows));
        }
        for (column, cell) in self.columns.iter_mut().zip(cells) {
            let text = cell.trim();
            let number = text.parse::<f64>().ok().filter(|number| number.is_finite());
            column.numbers.push(number.unwrap_or(f64::NAN));
            column.texts.iter_mut().for_each(|texts| texts.push(text.to_owned()));
            column.written += usize::from(!text.is_empty());
        }
        self.rows += 1;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_of_any_name_are_numbers_texts_and_gaps() {
        let text = "a b,note,\"c,1\"\n1,x,-2e3\n\n,y,nan\n3,,error\n4,z,5\n";
        let sheet = sheet(text.as_bytes(), &["note"]).unwrap();
        assert_eq!(sheet.rows(), 4);
        assert_eq!(sheet.numeric().collect::<Vec<_>>(), ["a b"]);
        let numbers = sheet.numbers("a b").unwrap();
        assert!(numbers[1].is_nan() && numbers[0] == 1.0 && numbers[2..] == [3.0, 4.0]);
        assert_eq!(sheet.texts("note").unwrap(), ["x", "y", "", "z"]);
        assert!(
            sheet.texts("a b").is_none()
                && sheet.numbers("note").is_none()
                && sheet.has("c,1")
                && !sheet.has("d")
        );
    }

    #[test]
    fn what_is_no_table_says_where() {
        for (text, line, said) in [
            ("", 1, "the file is empty"),
            ("a,b\n", 1, "no contact follows"),
            ("a,b\n1,2\n1\n", 3, "1 values"),
            ("a,a\n1,2\n", 1, "two columns are named a"),
            ("a;b\n1;2\n", 1, "not separated by commas"),
            ("a,\"b\n1,2\n", 1, "a quotation mark"),
        ] {
            let error = sheet(text.as_bytes(), &[]).unwrap_err();
            assert_eq!(error.line, line, "{text}");
            assert!(error.fault.to_string().contains(said), "{}", error.fault);
        }
    }
}
