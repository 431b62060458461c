//! Writing a table.

use std::fmt::Write as _;
use std::io::{self, BufWriter, Write};

use super::columns::{Column, LABEL, channel_columns};
use super::{Row, Table};
use crate::quantity::CHANNELS;

/// Beyond it thousandths of a microvolt are no whole numbers of an `f64` any more.
const EXACT_UV: f64 = 1e12;

/// Writes a whole table: those columns that any of its rows has.
pub fn table(to: impl Write, table: &Table) -> io::Result<()> {
    let mut writer = Writer::begin(to, &table.columns(), table)?;
    for row in &table.rows {
        writer.row(row, table)?;
    }
    writer.end()
}

/// Writes a table row by row.
///
/// All numbers are written so that they read as the same again, but channels: they are rounded to 0.001 µV.
pub struct Writer<W: Write> {
    to: BufWriter<W>,
    columns: Vec<Column>,
    text: String,
}

impl<W: Write> Writer<W> {
    /// Begins a table with the names of its columns; the label is always among them. `of` names the other ones.
    pub fn begin(to: W, columns: &[Column], of: &Table) -> io::Result<Self> {
        let has = |column: &Column| {
            columns.contains(column) && (*column != Column::Others || !of.others.names.is_empty())
        };
        let columns: Vec<_> = Column::ALL.into_iter().filter(has).collect();
        let mut text = String::new();
        for column in columns.iter().filter(|column| column.stands_first()) {
            text.extend([column.name().unwrap_or_default(), ","]);
        }
        text.push_str(&LABEL.join(","));
        for column in columns.iter().filter(|column| !column.stands_first()) {
            for name in names(*column, of) {
                text.push(',');
                push_text(&mut text, &name);
            }
        }
        let mut writer = Self { to: BufWriter::new(to), columns, text };
        writer.line()?;
        Ok(writer)
    }

    /// Writes one row. `of` is the table whose trials, sessions and other texts the row names.
    ///
    /// What the row has and the table's columns do not is left out. A name with a line break cannot be written.
    pub fn row(&mut self, row: &Row, of: &Table) -> io::Result<()> {
        for column in self.columns.iter().filter(|column| column.stands_first()) {
            push_cell(&mut self.text, *column, row, of);
            self.text.push(',');
        }
        let label = &row.label;
        for (index, number) in
            [label.x_mm, label.y_mm, label.fx_n, label.fy_n, label.fz_n].into_iter().enumerate()
        {
            if index > 0 {
                self.text.push(',');
            }
            push_number(&mut self.text, number);
        }
        for column in self.columns.iter().filter(|column| !column.stands_first()) {
            self.text.push(',');
            push_cell(&mut self.text, *column, row, of);
        }
        self.line()
    }

    /// Ends the table; without it rows may be lost.
    pub fn end(mut self) -> io::Result<()> {
        self.to.flush()
    }

    fn line(&mut self) -> io::Result<()> {
        if self.text.contains(['\n', '\r']) {
            let why = "a name holds a line break, which a table cannot have";
            return Err(io::Error::new(io::ErrorKind::InvalidInput, why));
        }
        self.text.push('\n');
        self.to.write_all(self.text.as_bytes())?;
        self.text.clear();
        Ok(())
    }
}

impl Column {
    /// Whether it is written before the label.
    const fn stands_first(self) -> bool {
        matches!(self, Self::Trial | Self::Session | Self::Time | Self::Temperature | Self::Cycle)
    }
}

/// The names that a column stands for.
fn names(column: Column, of: &Table) -> Vec<String> {
    match column {
        Column::Channels => channel_columns().to_vec(),
        Column::Others => of.others.names.clone(),
        named => named.name().map(str::to_owned).into_iter().collect(),
    }
}

/// Appends what a row has in a column; nothing, if it has nothing.
fn push_cell(text: &mut String, column: Column, row: &Row, of: &Table) {
    let name = |names: &'_ [String], index: Option<usize>| index.and_then(|index| names.get(index).cloned());
    let (named, number) = match column {
        Column::Trial => (name(&of.trials, row.trial), None),
        Column::Session => (name(&of.sessions, row.session), None),
        Column::Time => (None, row.t_s),
        Column::Temperature => (None, row.temp_c),
        Column::Cycle => (None, row.cycle),
        Column::Dwell => (None, row.dwell_s),
        Column::Approach => (row.approach.map(|approach| approach.name().to_owned()), None),
        Column::Turned => (None, row.turned_deg),
        Column::Weight => (None, row.weight_g),
        Column::Channels => return push_channels(text, row.uv),
        Column::Others => return push_others(text, row.line, of),
    };
    if let Some(name) = named {
        push_text(text, &name);
    }
    if let Some(number) = number {
        push_number(text, number);
    }
}

/// Appends the shortest number that reads as the same again.
fn push_number(text: &mut String, number: f64) {
    // A string takes whatever is written.
    let _ = write!(text, "{number}");
}

/// Appends nine cells, to 0.001 µV.
fn push_channels(text: &mut String, uv: Option<[f64; CHANNELS]>) {
    let Some(uv) = uv else { return text.push_str(&",".repeat(CHANNELS - 1)) };
    for (index, uv) in uv.into_iter().enumerate() {
        if index > 0 {
            text.push(',');
        }
        let thousandths = (uv * 1e3).round();
        let _ = if thousandths.abs() < EXACT_UV * 1e3 {
            // Whole numbers are written several times as fast, and have no −0.
            let (whole, rest) =
                ((thousandths as i64).unsigned_abs() / 1000, (thousandths as i64).unsigned_abs() % 1000);
            write!(text, "{}{whole}.{rest:03}", if thousandths < 0.0 { "-" } else { "" })
        } else {
            write!(text, "{uv:.3}")
        };
    }
}

/// Appends the cells of a line that came along unread.
fn push_others(text: &mut String, line: usize, of: &Table) {
    match of.others.texts.binary_search_by_key(&line, |(line, _)| *line) {
        Ok(index) => text.push_str(of.others.texts.get(index).map_or("", |(_, cells)| cells)),
        Err(_) => text.push_str(&",".repeat(of.others.names.len().saturating_sub(1))),
    }
}

/// Appends a text, in quotation marks if it would not read as the same without.
pub(super) fn push_text(text: &mut String, cell: &str) {
    if cell.contains(['"', ',']) || cell.trim() != cell {
        text.extend(["\"", &cell.replace('"', "\"\""), "\""]);
    } else {
        text.push_str(cell);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tables::measured::{ExtraColumns, Label};

    fn written(table: &Table) -> Vec<String> {
        let mut text = Vec::new();
        super::table(&mut text, table).unwrap();
        String::from_utf8(text).unwrap().lines().map(str::to_owned).collect()
    }

    #[test]
    fn numbers_are_as_long_as_they_need_to_be() {
        let label = Label { x_mm: 0.1, y_mm: -28.999_998, fx_n: 0.0, fy_n: 1e-7, fz_n: 5.0 };
        let uv = [0.0, -0.000_4, 0.000_6, 1_234.567_89, -1e5, 0.1 + 0.2, -0.000_5, -1e13, -7.25];
        let row = Row { t_s: Some(1.1), weight_g: Some(25.1), uv: Some(uv), ..Row::of(label) };
        let table = Table { rows: vec![row], ..Table::default() };
        assert_eq!(
            written(&table)[1],
            "1.1,0.1,-28.999998,0,0.0000001,5,0.000,0.000,0.001,1234.568,-100000.000,0.300,-0.001,\
             -10000000000000.000,-7.250,25.1"
        );
    }

    #[test]
    fn texts_are_quoted_where_they_must_be() {
        let row = |line, trial| Row { line, trial: Some(trial), ..Row::of(Label::default()) };
        let table = Table {
            rows: vec![row(2, 0), row(0, 1)],
            trials: vec!["a, \"b\"".into(), " c".into()],
            others: ExtraColumns {
                names: vec!["note".into(), "x,y".into()],
                texts: vec![(2, "free,\"1,2\"".into())],
            },
            ..Table::default()
        };
        let wanted = [
            "trial,x_mm,y_mm,fx_n,fy_n,fz_n,note,\"x,y\"",
            "\"a, \"\"b\"\"\",0,0,0,0,0,free,\"1,2\"",
            "\" c\",0,0,0,0,0,,",
        ];
        assert_eq!(written(&table), wanted);
    }

    #[test]
    fn a_name_with_a_line_break_is_refused() {
        let row = Row { trial: Some(0), ..Row::of(Label::default()) };
        let table = Table { rows: vec![row], trials: vec!["a\nb".into()], ..Table::default() };
        assert_eq!(super::table(&mut Vec::new(), &table).unwrap_err().kind(), io::ErrorKind::InvalidInput);
    }
}
