//! A table of contacts: `t_s,x_mm,y_mm,fx_n,fy_n,fz_n` in a CSV file.

use std::fmt::Display;
use std::fs::File;
use std::io::{self, BufRead, BufReader, Read};
use std::ops::RangeInclusive;
use std::path::Path;

use super::Failure;
use super::written::reason;
use crate::quantity::Contact;
use crate::time::StreamInstant;

/// A longer line is no row of a table; without a limit `/dev/zero` would be one endless line.
const LINE_BYTES_MAX: usize = 1 << 20;

/// Rows of a table without times are this far apart.
const PERIOD_US: u64 = 1_000;

const TIME: &str = "t_s";
const TIMES_S: RangeInclusive<f64> = 0.0..=1e6;
const FORCES_N: RangeInclusive<f64> = -100.0..=100.0;

/// The columns that a table must have, in the order of [`Contact`]'s fields.
const COLUMNS: [&str; 5] = ["x_mm", "y_mm", "fx_n", "fy_n", "fz_n"];

/// The contacts of a table, in its order.
#[derive(Debug)]
pub(super) struct Contacts {
    /// Where the rows' times come from.
    pub(super) times: Times,
    /// At least one.
    pub(super) rows: Vec<Row>,
}

/// Where times come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Times {
    /// The table has them.
    Written,
    /// It has none: rows are 1 ms apart.
    Supposed,
}

/// A contact, its time, and the line of the table that it stands in.
#[derive(Clone, Copy, Debug)]
pub(super) struct Row {
    pub(super) line: usize,
    pub(super) at: StreamInstant,
    pub(super) contact: Contact,
}

/// Reads all rows of a table of contacts on a plate of this radius.
///
/// `t_s` may be missing; columns of other names are ignored, and so are empty lines.
pub(super) fn read(path: &Path, plate_radius_mm: f64) -> Result<Contacts, Failure> {
    let file = File::open(path).map_err(|error| unreadable(path, &error))?;
    let mut lines = Lines { path, from: BufReader::new(file), number: 0 };
    let Some(header) = lines.next_line()? else {
        return Err(lines.refusal(format_args!("the file is empty; it begins with {}", expected())));
    };
    let table = Table::new(&lines, &header, plate_radius_mm)?;
    let mut rows = Vec::new();
    while let Some(line) = lines.next_line()? {
        let row = table.row(&lines, &line, rows.last())?;
        rows.push(row);
    }
    if rows.is_empty() {
        return Err(lines.refusal(format_args!("no contact follows the names of the columns")));
    }
    let times = if table.time.is_some() { Times::Written } else { Times::Supposed };
    Ok(Contacts { times, rows })
}

fn expected() -> String {
    format!("a line of the columns' names: {TIME} if times are known, {}", COLUMNS.join(", "))
}

fn unreadable(path: &Path, error: &io::Error) -> Failure {
    Failure::Unusable(format!(
        "{} cannot be read: {}; name a CSV file of contacts",
        path.display(),
        reason(error)
    ))
}

/// The file's lines, counted.
struct Lines<'p> {
    path: &'p Path,
    from: BufReader<File>,
    number: usize,
}

impl Lines<'_> {
    /// The next line that is not empty. What is no UTF-8 is no number either, and no column's name.
    fn next_line(&mut self) -> Result<Option<String>, Failure> {
        loop {
            let mut line = Vec::new();
            let mut limited = self.from.by_ref().take(LINE_BYTES_MAX as u64 + 1);
            let read = limited.read_until(b'\n', &mut line);
            if read.map_err(|error| unreadable(self.path, &error))? == 0 {
                return Ok(None);
            }
            self.number += 1;
            if line.len() > LINE_BYTES_MAX {
                return Err(self.refusal("the line is longer than 1 MB: this is no table of contacts"));
            }
            let line = String::from_utf8_lossy(&line);
            if !line.trim().is_empty() {
                return Ok(Some(line.trim_start_matches('\u{feff}').to_owned()));
            }
        }
    }

    /// What is wrong with the line read last.
    fn refusal(&self, what: impl Display) -> Failure {
        Failure::Unusable(format!("{}:{}: {what}", self.path.display(), self.number.max(1)))
    }
}

/// Where the columns stand.
struct Table {
    width: usize,
    time: Option<usize>,
    columns: [usize; COLUMNS.len()],
    places_mm: RangeInclusive<f64>,
}

impl Table {
    fn new(lines: &Lines<'_>, header: &str, plate_radius_mm: f64) -> Result<Self, Failure> {
        let names = cells(header);
        let place = |name: &str| names.iter().position(|other| *other == name);
        let missing: Vec<_> = COLUMNS.into_iter().filter(|name| place(name).is_none()).collect();
        if !missing.is_empty() {
            let missing = missing.join(", ");
            return Err(
                lines.refusal(format_args!("no column is named {missing}; expected is {}", expected()))
            );
        }
        for name in COLUMNS.into_iter().chain([TIME]) {
            if names.iter().filter(|other| **other == name).count() > 1 {
                return Err(lines.refusal(format_args!("two columns are named {name}; rename one of them")));
            }
        }
        // None is missing.
        let columns = COLUMNS.map(|name| place(name).unwrap_or_default());
        let places_mm = -plate_radius_mm..=plate_radius_mm;
        Ok(Self { width: names.len(), time: place(TIME), columns, places_mm })
    }

    fn row(&self, lines: &Lines<'_>, line: &str, before: Option<&Row>) -> Result<Row, Failure> {
        let cells = cells(line);
        if cells.len() != self.width {
            let (found, width) = (cells.len(), self.width);
            return Err(lines.refusal(format_args!("{found} values where the header names {width} columns")));
        }
        let cell = |column: usize| cells.get(column).copied().unwrap_or_default();
        let at = self.time(lines, self.time.map(cell), before.map(|row| row.at))?;
        let mut numbers = [0.0; COLUMNS.len()];
        for ((name, column), number) in COLUMNS.iter().zip(self.columns).zip(&mut numbers) {
            let is_place = name.ends_with("_mm");
            let (allowed, unit) = if is_place { (&self.places_mm, "mm") } else { (&FORCES_N, "N") };
            *number = value(name, cell(column), allowed, unit).map_err(|what| lines.refusal(what))? as f32;
        }
        let [x_mm, y_mm, fx_n, fy_n, fz_n] = numbers;
        Ok(Row { line: lines.number, at, contact: Contact { x_mm, y_mm, fx_n, fy_n, fz_n } })
    }

    fn time(
        &self,
        lines: &Lines<'_>,
        cell: Option<&str>,
        before: Option<StreamInstant>,
    ) -> Result<StreamInstant, Failure> {
        let Some(cell) = cell else {
            return Ok(before.map_or_else(StreamInstant::default, |before| before.plus_us(PERIOD_US)));
        };
        let seconds = value(TIME, cell, &TIMES_S, "s").map_err(|what| lines.refusal(what))?;
        let at = StreamInstant::from_us((seconds * 1e6).round() as u64);
        match before {
            Some(before) if at < before => {
                let before = before.as_us() as f64 * 1e-6;
                Err(lines
                    .refusal(format_args!("{TIME} goes back from {before} to {cell}; sort the rows by time")))
            }
            _ => Ok(at),
        }
    }
}

fn value(name: &str, cell: &str, allowed: &RangeInclusive<f64>, unit: &str) -> Result<f64, String> {
    let number = cell.parse::<f64>().ok().filter(|number| number.is_finite());
    match number {
        Some(number) if allowed.contains(&number) => Ok(number),
        Some(_) => {
            let (low, high) = (allowed.start(), allowed.end());
            Err(format!("{name} is {cell}, and the pad's are {low} to {high} {unit}"))
        }
        None if cell.is_empty() => Err(format!("{name} is empty")),
        None => {
            Err(format!("{name} is {:?}, which is not a number", cell.chars().take(40).collect::<String>()))
        }
    }
}

/// The values of a line: what stands between commas, without the spaces and quotation marks around it.
fn cells(line: &str) -> Vec<&str> {
    let mut is_quoted = false;
    let cells = line.split(|letter| {
        is_quoted ^= letter == '"';
        letter == ',' && !is_quoted
    });
    cells.map(|cell| cell.trim().trim_matches('"').trim()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read_text(text: impl AsRef<[u8]>) -> Result<Vec<(u64, [f32; 5])>, String> {
        let file = tempfile::NamedTempFile::new().unwrap();
        std::fs::write(file.path(), text).unwrap();
        let row = |Row { at, contact, .. }: Row| {
            let Contact { x_mm, y_mm, fx_n, fy_n, fz_n } = contact;
            (at.as_us(), [x_mm, y_mm, fx_n, fy_n, fz_n])
        };
        match read(file.path(), 30.0) {
            Ok(contacts) => Ok(contacts.rows.into_iter().map(row).collect()),
            Err(Failure::Unusable(what)) => Err(what.replace(file.path().to_str().unwrap(), "FILE")),
            Err(other) => panic!("{other:?}"),
        }
    }

    #[test]
    fn columns_come_in_any_order_with_others_between_them() {
        let text =
            "\u{feff}fz_n, \"note, free\" ,t_s,\"x_mm\",y_mm,fx_n,fy_n\r\n\r\n 5 ,\"a,b\",0.5,1,2,3,4\r\n";
        assert_eq!(read_text(text), Ok(vec![(500_000, [1.0, 2.0, 3.0, 4.0, 5.0])]));
    }

    #[test]
    fn rows_without_times_are_a_millisecond_apart() {
        let rows = read_text("x_mm,y_mm,fx_n,fy_n,fz_n\n1,0,0,0,1\n\n2,0,0,0,1\n3,0,0,0,1").unwrap();
        assert_eq!(
            rows.iter().map(|row| (row.0, row.1[0])).collect::<Vec<_>>(),
            [(0, 1.0), (1_000, 2.0), (2_000, 3.0)]
        );
    }

    #[test]
    fn lines_are_counted_with_the_empty_ones_and_times_are_known_or_not() {
        let file = tempfile::NamedTempFile::new().unwrap();
        let found = |text: &str| {
            std::fs::write(file.path(), text).unwrap();
            let Contacts { times, rows } = read(file.path(), 30.0).unwrap();
            (times, rows.iter().map(|row| row.line).collect::<Vec<_>>())
        };
        let text = "x_mm,y_mm,fx_n,fy_n,fz_n\n\n1,0,0,0,1\n2,0,0,0,1\n";
        assert_eq!(found(text), (Times::Supposed, vec![3, 4]));
        assert_eq!(found("\nt_s,x_mm,y_mm,fx_n,fy_n,fz_n\n0,1,0,0,0,1\n"), (Times::Written, vec![3]));
    }

    #[test]
    fn the_outermost_values_pass_and_the_next_do_not() {
        let header = "t_s,x_mm,y_mm,fx_n,fy_n,fz_n\n";
        for row in ["0,30,-30,100,-100,100", "1e6,-30,30,-100,100,-100", "0,0,0,0,0,0"] {
            assert!(read_text(format!("{header}{row}")).is_ok(), "{row}");
        }
        for (row, what) in [
            ("-0.1,0,0,0,0,1", "t_s is -0.1, and the pad's are 0 to 1000000 s"),
            ("1000001,0,0,0,0,1", "t_s is 1000001, and"),
            ("0,30.1,0,0,0,1", "x_mm is 30.1, and the pad's are -30 to 30 mm"),
            ("0,0,-30.1,0,0,1", "y_mm is -30.1, and"),
            ("0,0,0,100.1,0,1", "fx_n is 100.1, and the pad's are -100 to 100 N"),
            ("0,0,0,0,0,1e39", "fz_n is 1e39, and"),
            ("0,0,0,0,0,nan", "fz_n is \"nan\", which is not a number"),
            ("0,0,0,0,inf,0", "fy_n is \"inf\", which is not a number"),
            ("0,0,0,0,,0", "fy_n is empty"),
        ] {
            let found = read_text(format!("{header}\n{row}\n")).unwrap_err();
            assert!(found.starts_with(&format!("FILE:3: {what}")), "{found}");
        }
    }

    #[test]
    fn a_line_of_a_megabyte_is_the_longest() {
        let header = "x_mm,y_mm,fx_n,fy_n,fz_n\n";
        let row = |bytes: usize| format!("{header}0,0,0,0,{}1\n", " ".repeat(bytes - 10));
        assert_eq!(read_text(row(LINE_BYTES_MAX)).map(|rows| rows.len()), Ok(1));
        assert!(
            read_text(row(LINE_BYTES_MAX + 1))
                .unwrap_err()
                .starts_with("FILE:2: the line is longer than 1 MB")
        );
    }
}
