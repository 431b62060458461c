//! Reading a table.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::io::BufRead;
use std::ops::RangeInclusive;

use super::columns::{Column, LABEL, TableKind, channel_columns};
use super::error::{Fault, ReadError, short};
use super::layout::Layout;
use super::rows::Rows;
use super::write::push_text;
use super::{Approach, Label, Row, Table};
use crate::quantity::CHANNELS;
use crate::tables::units::{CHANNEL_UNITS, FORCE_UNITS, PLACE_UNITS, UnitTable, Units};

/// As many rows as a gigabyte holds.
pub const ROWS_MAX: usize = (1 << 30) / size_of::<Row>();

const FORCE_MAX_N: f64 = 100.0;
/// Eleven days: what plays in a game, or streams from a pad, counts from its beginning.
const CONTACT_TIMES_S: RangeInclusive<f64> = 0.0..=1e6;
/// Whoever measures may count from 1970.
const TIMES_S: RangeInclusive<f64> = 0.0..=1e10;
const TEMPERATURES_C: RangeInclusive<f64> = -100.0..=200.0;
const CYCLES: RangeInclusive<f64> = 0.0..=1e12;
const DWELLS_S: RangeInclusive<f64> = 0.0..=1e6;
const TURNS_DEG: RangeInclusive<f64> = -360.0..=360.0;
const WEIGHTS_G: RangeInclusive<f64> = 0.0..=10_000.0;
const CHANNEL_MAX_UV: f64 = 1e8;

/// Reads all rows of a table; at least one, or it is an error.
///
/// Places beyond ±`place_max_mm` are refused. The first line names the columns, in any order. Empty lines do not count.
/// Columns whose names are not known are carried along as texts, but for [`TableKind::Contacts`]. An empty cell of an
/// optional column says that this row has none; a table of contacts has all times or no column of them.
pub fn table(from: impl BufRead, kind: TableKind, place_max_mm: f64) -> Result<Table, ReadError> {
    written_in(from, kind, place_max_mm, &Units::default())
}

/// The same of labels and channels in these units. They are left as they are written.
///
/// # Errors
/// As of [`table`].
pub fn written_in(
    from: impl BufRead,
    kind: TableKind,
    place_max_mm: f64,
    units: &Units,
) -> Result<Table, ReadError> {
    let mut rows = Rows::begin(from, Fault::Empty(kind))?;
    let names: Vec<_> = rows.names().iter().map(String::as_str).collect();
    let layout = Layout::of(&names, kind).map_err(|fault| rows.error(fault))?;
    let mut reader = Reader::new(layout, kind, place_max_mm, units);
    reader.table.open_end = rows.each(|line, cells| reader.row(line, cells))?;
    if reader.table.rows.is_empty() {
        return Err(rows.error(Fault::NoRows));
    }
    // Half of what it grew to may be empty.
    reader.table.rows.shrink_to_fit();
    Ok(reader.table)
}

/// Numbers of a column that may be.
struct AllowedNumbers {
    range: RangeInclusive<f64>,
    unit: &'static str,
}

impl AllowedNumbers {
    /// Up to ±`max` in the pad's unit, written in units of this size.
    fn within(max: f64, size: f64, names: UnitTable, own: &'static str) -> Self {
        let max = max / size;
        let by_name = names.iter().find(|(_, known)| *known == size).map_or("units", |(name, _)| *name);
        Self { range: -max..=max, unit: if size == 1.0 { own } else { by_name } }
    }
}

/// A table as far as it is read.
struct Reader {
    kind: TableKind,
    layout: Layout,
    channel_columns: [String; CHANNELS],
    places: AllowedNumbers,
    forces: AllowedNumbers,
    channels: AllowedNumbers,
    trials: BTreeMap<String, usize>,
    sessions: BTreeMap<String, usize>,
    table: Table,
}

impl Reader {
    fn new(layout: Layout, kind: TableKind, place_max_mm: f64, units: &Units) -> Self {
        let mut table = Table::default();
        table.others.names = layout.others.iter().map(|(_, name)| name.clone()).collect();
        Self {
            kind,
            layout,
            channel_columns: channel_columns(),
            places: AllowedNumbers::within(place_max_mm, units.mm, PLACE_UNITS, "mm"),
            forces: AllowedNumbers::within(FORCE_MAX_N, units.n, FORCE_UNITS, "N"),
            channels: AllowedNumbers::within(CHANNEL_MAX_UV, units.uv, CHANNEL_UNITS, "µV"),
            trials: BTreeMap::new(),
            sessions: BTreeMap::new(),
            table,
        }
    }

    /// Takes one line.
    fn row(&mut self, line: usize, cells: &[Cow<'_, str>]) -> Result<(), Fault> {
        if self.table.rows.len() == ROWS_MAX {
            return Err(Fault::TooManyRows(ROWS_MAX));
        }
        let trial = self.trial(cells)?;
        let weight_g = self.optional(cells, Column::Weight, &WEIGHTS_G, "g")?;
        let label = self.label(cells)?;
        let row = Row {
            line,
            measurement: 0,
            trial,
            session: self.session(cells)?,
            t_s: self.time(cells, trial)?,
            temp_c: self.optional(cells, Column::Temperature, &TEMPERATURES_C, "°C")?,
            cycle: self.optional(cells, Column::Cycle, &CYCLES, "")?,
            dwell_s: self.optional(cells, Column::Dwell, &DWELLS_S, "s")?,
            approach: self.approach(cells)?,
            turned_deg: self.optional(cells, Column::Turned, &TURNS_DEG, "°")?,
            weight_g,
            label: weight_g.map_or(label, |weight_g| label.under_weight(weight_g)),
            uv: self.channels(cells)?,
        };
        self.table.rows.push(row);
        if !self.layout.others.is_empty() {
            self.table.others.texts.push((line, self.others(cells)));
        }
        Ok(())
    }

    /// The cell of an optional column; none if it is empty or the table has no such column.
    fn cell<'c>(&self, cells: &'c [Cow<'_, str>], column: Column) -> Option<&'c str> {
        let cell = cells.get(self.layout.place(column)?)?;
        Some(cell.as_ref()).filter(|cell| !cell.trim().is_empty())
    }

    fn trial(&mut self, cells: &[Cow<'_, str>]) -> Result<Option<usize>, Fault> {
        let Some(name) = self.cell(cells, Column::Trial) else { return Ok(None) };
        let before = self.table.rows.last().and_then(|row| row.trial);
        if before.and_then(|index| self.table.trials.get(index)).is_some_and(|trial| trial == name) {
            return Ok(before);
        }
        if self.trials.contains_key(name) {
            return Err(Fault::ScatteredTrial(short(name)));
        }
        index_of(name, "trial", &mut self.trials, &mut self.table.trials).map(Some)
    }

    fn session(&mut self, cells: &[Cow<'_, str>]) -> Result<Option<usize>, Fault> {
        let Some(name) = self.cell(cells, Column::Session) else { return Ok(None) };
        index_of(name, "session", &mut self.sessions, &mut self.table.sessions).map(Some)
    }

    /// The row's time, which in a series is not before the one above.
    fn time(&self, cells: &[Cow<'_, str>], trial: Option<usize>) -> Result<Option<f64>, Fault> {
        let is_contact = self.kind == TableKind::Contacts;
        let allowed = if is_contact { &CONTACT_TIMES_S } else { &TIMES_S };
        let t_s = self.optional(cells, Column::Time, allowed, "s")?;
        if is_contact && t_s.is_none() && self.layout.place(Column::Time).is_some() {
            return Err(Fault::EmptyCell("t_s".into()));
        }
        let before = self.table.rows.last();
        let before = before.filter(|row| is_contact || (trial.is_some() && row.trial == trial));
        let name = trial.and_then(|trial| self.table.trials.get(trial)).map(|name| short(name));
        match (before.map(|row| row.t_s), t_s) {
            (Some(Some(from_s)), Some(to_s)) if to_s < from_s => {
                let text = self.cell(cells, Column::Time).unwrap_or_default().to_owned();
                Err(Fault::TimeGoesBack { from_s, text, trial: name })
            }
            (Some(Some(_)), None) | (Some(None), Some(_)) => {
                Err(Fault::PartlyTimed(name.unwrap_or_default()))
            }
            _ => Ok(t_s),
        }
    }

    fn optional(
        &self,
        cells: &[Cow<'_, str>],
        column: Column,
        allowed: &RangeInclusive<f64>,
        unit: &'static str,
    ) -> Result<Option<f64>, Fault> {
        let cell = self.cell(cells, column);
        cell.map(|cell| number(column.name().unwrap_or_default(), cell, allowed, unit)).transpose()
    }

    fn approach(&self, cells: &[Cow<'_, str>]) -> Result<Option<Approach>, Fault> {
        let cell = self.cell(cells, Column::Approach);
        cell.map(|cell| Approach::of(cell.trim()).ok_or_else(|| Fault::Approach(short(cell)))).transpose()
    }

    fn label(&self, cells: &[Cow<'_, str>]) -> Result<Label, Fault> {
        let mut numbers = [0.0; LABEL.len()];
        for ((name, column), found) in LABEL.iter().zip(self.layout.label).zip(&mut numbers) {
            let is_place = name.ends_with("_mm");
            let AllowedNumbers { range, unit } = if is_place { &self.places } else { &self.forces };
            *found = number(name, cells.get(column).map_or("", AsRef::as_ref), range, unit)?;
        }
        let [x_mm, y_mm, fx_n, fy_n, fz_n] = numbers;
        Ok(Label { x_mm, y_mm, fx_n, fy_n, fz_n })
    }

    fn channels(&self, cells: &[Cow<'_, str>]) -> Result<Option<[f64; CHANNELS]>, Fault> {
        let Some(columns) = self.layout.channels else { return Ok(None) };
        let mut uv = [0.0; CHANNELS];
        for ((name, column), uv) in self.channel_columns.iter().zip(columns).zip(&mut uv) {
            let AllowedNumbers { range, unit } = &self.channels;
            *uv = number(name, cells.get(column).map_or("", AsRef::as_ref), range, unit)?;
        }
        Ok(Some(uv))
    }

    /// The cells that nobody reads, as they are written again.
    fn others(&self, cells: &[Cow<'_, str>]) -> String {
        let mut text = String::new();
        for (index, (column, _)) in self.layout.others.iter().enumerate() {
            if index > 0 {
                text.push(',');
            }
            push_text(&mut text, cells.get(*column).map_or("", AsRef::as_ref));
        }
        text
    }
}

impl Approach {
    /// The one of this name.
    fn of(name: &str) -> Option<Self> {
        [Self::Loading, Self::Unloading].into_iter().find(|approach| approach.name() == name)
    }
}

/// The index of a name, which is kept if it is new.
fn index_of(
    name: &str,
    column: &'static str,
    known: &mut BTreeMap<String, usize>,
    names: &mut Vec<String>,
) -> Result<usize, Fault> {
    if let Some(index) = known.get(name) {
        return Ok(*index);
    }
    // Names that differ in what is no UTF-8 would become one.
    if name.contains(char::REPLACEMENT_CHARACTER) {
        return Err(Fault::NotText(column));
    }
    known.insert(name.to_owned(), names.len());
    names.push(name.to_owned());
    Ok(names.len() - 1)
}

fn number(name: &str, cell: &str, allowed: &RangeInclusive<f64>, unit: &'static str) -> Result<f64, Fault> {
    let cell = cell.trim();
    let name = || name.to_owned();
    match cell.parse::<f64>().ok().filter(|number| number.is_finite()) {
        Some(number) if allowed.contains(&number) => Ok(number),
        Some(_) => {
            let (low, high) = (*allowed.start(), *allowed.end());
            Err(Fault::OutOfRange { name: name(), text: short(cell), low, high, unit })
        }
        None if cell.is_empty() => Err(Fault::EmptyCell(name())),
        None => Err(Fault::NotANumber { name: name(), text: short(cell) }),
    }
}

#[cfg(test)]
mod tests {
    use super::super::lines::LINE_BYTES_MAX;
    use super::*;

    fn read(kind: TableKind, text: impl AsRef<[u8]>) -> Result<Table, String> {
        table(text.as_ref(), kind, 30.0).map_err(|error| format!("{}: {}", error.line, error.fault))
    }

    /// A measured table: these columns before the label, these rows with nine channels behind.
    fn measured(first: &str, rows: &[&str]) -> Result<Table, String> {
        let header = format!("{first}{},{}\n", LABEL.join(","), channel_columns().join(","));
        let rows: String = rows.iter().map(|row| format!("{row},1,2,3,4,5,6,7,8,9.0005\n")).collect();
        read(TableKind::Measured, header + &rows)
    }

    #[test]
    fn columns_come_in_any_order_with_others_between_them() {
        let text = "\u{feff}fz_n, \"note, free\" ,t_s,\"x_mm\",y_mm,fx_n,fy_n\r\n\r\n 5 ,\"a,b\",0.5,1,2,3,\"4\"\r\n";
        let label = Label { x_mm: 1.0, y_mm: 2.0, fx_n: 3.0, fy_n: 4.0, fz_n: 5.0 };
        let row = Row { line: 3, t_s: Some(0.5), ..Row::of(label) };
        let contacts = read(TableKind::Contacts, text).unwrap();
        assert_eq!(contacts, Table { rows: vec![row], ..Table::default() });
        let plan = read(TableKind::Plan, text).unwrap();
        assert_eq!((plan.rows, plan.others.names), (vec![row], vec!["note, free".to_owned()]));
        assert_eq!(plan.others.texts, [(3, "\"a,b\"".to_owned())]);
    }

    #[test]
    fn a_measured_row_has_all_there_is() {
        let first = "trial,session,t_s,temp_c,cycle,dwell_s,approach,";
        let table =
            measured(first, &["a,cold,1.5,-10,3,0.5,unloading,0,0,0,0,1", ",,,,,,,0,0,0,0,2"]).unwrap();
        let [full, bare] = table.rows[..] else { panic!("two rows") };
        assert_eq!(
            (full.trial, full.session, full.t_s, full.temp_c),
            (Some(0), Some(0), Some(1.5), Some(-10.0))
        );
        assert_eq!(
            (full.cycle, full.dwell_s, full.approach),
            (Some(3.0), Some(0.5), Some(Approach::Unloading))
        );
        assert_eq!(full.uv, Some([1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0005]));
        let label = Label { fz_n: 2.0, ..Label::default() };
        assert_eq!(bare, Row { line: 3, uv: full.uv, ..Row::of(label) });
        assert_eq!((table.trials, table.sessions), (vec!["a".to_owned()], vec!["cold".to_owned()]));
    }

    #[test]
    fn a_known_weight_is_the_force_whatever_was_written() {
        let table =
            measured("weight_g,", &["200,1,2,0.1,0.2,3", ",1,2,0.1,0.2,3", "0,1,2,0.1,0.2,3"]).unwrap();
        let forces = table.rows.iter().map(|row| [row.label.fx_n, row.label.fy_n, row.label.fz_n]);
        assert_eq!(forces.collect::<Vec<_>>(), [[0.0, 0.0, 200.0 * 9.806_65e-3], [0.1, 0.2, 3.0], [0.0; 3]]);
        assert_eq!(table.rows[0].weight_g, Some(200.0));
    }

    #[test]
    fn joined_tables_keep_their_series_and_know_which_they_are() {
        let first = measured("trial,session,t_s,", &["a,cold,1,0,0,0,0,1", "a,cold,2,0,0,0,0,2"]).unwrap();
        let second = measured("trial,session,t_s,", &["a,warm,0,0,0,0,0,3", ",cold,,0,0,0,0,4"]).unwrap();
        let both = Table::joined([first.clone(), second]);
        let known = both.rows.iter().map(|row| (row.measurement, row.trial, row.session));
        assert_eq!(
            known.collect::<Vec<_>>(),
            [(0, Some(0), Some(0)), (0, Some(0), Some(0)), (1, Some(1), Some(1)), (1, None, Some(0))]
        );
        assert_eq!(Table::joined([first.clone()]), first);
        assert_eq!(Table::joined([]), Table::default());
    }

    #[test]
    fn rows_of_a_trial_are_one_series() {
        let times = |rows: &[&str]| {
            let rows: Vec<_> = rows.iter().map(|row| format!("{row},0,0,0,0,1")).collect();
            let rows: Vec<_> = rows.iter().map(String::as_str).collect();
            measured("trial,t_s,", &rows).map(|table| table.trials)
        };
        assert_eq!(
            times(&["a,1", "a,1", "b,0.5", ",7", ",3", "c,"]),
            Ok(["a", "b", "c"].map(String::from).into())
        );
        for (rows, what) in [
            (&["a,1", "a,0.9"][..], "3: t_s goes back from 1 to 0.9; sort the rows of trial \"a\" by time"),
            (&["a,1", "b,1", "a,2"], "4: trial \"a\" goes on here after other rows"),
            (&["a,1", ",1", "a,2"], "4: trial \"a\" goes on here"),
            (&["a,1", "a,"], "3: some rows of trial \"a\" have t_s and some none"),
            (&["a,", "a,1"], "3: some rows of trial \"a\" have t_s and some none"),
        ] {
            let found = times(rows).unwrap_err();
            assert!(found.starts_with(what), "{found}");
        }
    }

    #[test]
    fn what_is_no_table_is_told_with_its_line() {
        let label = LABEL.join(",");
        let channels = channel_columns().join(",");
        for (kind, text, what) in [
            (
                TableKind::Measured,
                "\n".into(),
                "1: the file is empty; it begins with a line of the columns' names: t_s",
            ),
            (
                TableKind::Measured,
                format!("{label}\n0,0,0,0,1\n"),
                "1: no column is a channel (m0x_uv to m2z_uv): this is a",
            ),
            (
                TableKind::Measured,
                format!("{label},m0x_uv\n"),
                "1: no column is named m0y_uv, m0z_uv, m1x_uv, ",
            ),
            (
                TableKind::Measured,
                format!("{label},{channels},m1x_uv\n"),
                "1: two columns are named m1x_uv; rename one",
            ),
            (
                TableKind::Measured,
                channels.clone(),
                "1: no column is named x_mm, y_mm, fx_n, fy_n, fz_n; expected is",
            ),
            (
                TableKind::Measured,
                format!("{label},{channels}\n"),
                "1: no contact follows the names of the columns",
            ),
            (TableKind::Plan, label.replace(',', ";"), "1: the columns are not separated by commas"),
            (TableKind::Plan, label.replace(',', "\t"), "1: the columns are not separated by commas"),
            (TableKind::Plan, format!("trial,{label},trial\n"), "1: two columns are named trial"),
            (TableKind::Plan, format!("{label},\"note\n"), "1: a quotation mark does not close"),
            (
                TableKind::Plan,
                format!("{label},note\n0,0,0,0,1,\"a\nb\"\n"),
                "2: a quotation mark does not close",
            ),
            (
                TableKind::Plan,
                format!("{label}\n0,0,0,0,1,2\n"),
                "2: 6 values where the header names 5 columns",
            ),
            (
                TableKind::Plan,
                format!("approach,{label}\nup,0,0,0,0,1\n"),
                "2: approach is \"up\"; write loading or",
            ),
            (
                TableKind::Plan,
                format!("dwell_s,{label}\n-1,0,0,0,0,1\n"),
                "2: dwell_s is -1, and the pad's are 0 to",
            ),
            (
                TableKind::Plan,
                format!("cycle,{label}\n-1,0,0,0,0,1\n"),
                "2: cycle is -1, and the pad's are 0 to",
            ),
            (
                TableKind::Plan,
                format!("temp_c,{label}\nNaN,0,0,0,0,1\n"),
                "2: temp_c is \"NaN\", which is not a number",
            ),
            (TableKind::Contacts, format!("t_s,{label}\n,0,0,0,0,1\n"), "2: t_s is empty"),
        ] {
            let found = read(kind, &text).unwrap_err();
            assert!(found.starts_with(what), "{text:?}: {found}");
        }
        let found = measured("", &["0,0,0,0,1", "0,0,0,0,,1"]).unwrap_err();
        assert_eq!(found, "3: 15 values where the header names 14 columns");
    }

    #[test]
    fn names_that_are_no_text_are_refused_and_notes_are_not() {
        let table = |column: &str| {
            let text = format!("{column},{}\n", LABEL.join(","));
            read(TableKind::Plan, [text.as_bytes(), b"caf\xe9,0,0,0,0,1\n"].concat())
        };
        assert_eq!(table("trial").unwrap_err(), "2: trial is not UTF-8 text; save the table as UTF-8");
        assert!(table("session").unwrap_err().starts_with("2: session is not UTF-8"));
        assert!(table("note").is_ok());
    }

    #[test]
    fn the_outermost_values_pass_and_the_next_do_not() {
        let header = "t_s,x_mm,y_mm,fx_n,fy_n,fz_n\n";
        for row in ["0,30,-30,100,-100,100", "1e6,-30,30,-100,100,-100", "0,0,0,0,0,0"] {
            assert!(read(TableKind::Contacts, format!("{header}{row}")).is_ok(), "{row}");
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
            let found = read(TableKind::Contacts, format!("{header}\n{row}\n")).unwrap_err();
            assert!(found.starts_with(&format!("3: {what}")), "{found}");
        }
    }

    #[test]
    fn a_line_of_a_megabyte_is_the_longest() {
        let row = |bytes: usize| format!("{}\n0,0,0,0,{}1\n", LABEL.join(","), " ".repeat(bytes - 10));
        assert_eq!(read(TableKind::Plan, row(LINE_BYTES_MAX)).map(|table| table.rows.len()), Ok(1));
        let found = read(TableKind::Plan, row(LINE_BYTES_MAX + 1)).unwrap_err();
        assert!(found.starts_with("2: the line is longer than 1 MB"), "{found}");
    }
}
