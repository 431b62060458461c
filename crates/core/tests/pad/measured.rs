//! Measured tables: what is written reads as the same again, and no text at all is a panic.
#![allow(clippy::unwrap_used, reason = "a test that cannot set its scene fails")]

use proptest::collection::vec;
use proptest::option;
use proptest::prelude::*;
use tactpad_core::tables::measured::columns::TableKind;
use tactpad_core::tables::measured::{Approach, Label, Row, Table, read, write};

fn written(table: &Table) -> Vec<u8> {
    let mut text = Vec::new();
    write::table(&mut text, table).unwrap();
    text
}

fn label() -> impl Strategy<Value = Label> {
    let mm = -30.0..=30.0_f64;
    let n = -100.0..=100.0_f64;
    (mm.clone(), mm, n.clone(), n.clone(), n).prop_map(|(x_mm, y_mm, fx_n, fy_n, fz_n)| Label {
        x_mm,
        y_mm,
        fx_n,
        fy_n,
        fz_n,
    })
}

/// A row of one of three sessions.
fn row() -> impl Strategy<Value = Row> {
    let approach = option::of(prop_oneof![Just(Approach::Loading), Just(Approach::Unloading)]);
    let when = (option::of(0..3_usize), option::of(-99.0..199.0_f64), option::of(0.0..1e9_f64));
    let uv = proptest::array::uniform9(-3e6..3e6_f64);
    (label(), when, option::of(0.0..60.0_f64), approach, uv).prop_map(
        |(label, when, dwell_s, approach, uv)| {
            let (session, temp_c, cycle) = when;
            Row { session, temp_c, cycle, dwell_s, approach, uv: Some(uv), ..Row::of(label) }
        },
    )
}

/// A name without line breaks that says something. The mark that replaces what is no UTF-8 is in none.
const NAME: &str = "[^\\pC\\pZ\u{fffd}][^\\pC\u{fffd}]{0,6}";

/// Trials of some rows each, every other one without times, and rows without trial between them.
fn table() -> impl Strategy<Value = Table> {
    let trials = proptest::collection::btree_set(NAME, 0..5);
    let sessions = proptest::collection::btree_set(NAME, 3);
    (trials, sessions, vec(vec(row(), 1..6), 10)).prop_map(|(trials, sessions, series)| {
        let mut table = Table { sessions: sessions.into_iter().collect(), ..Table::default() };
        table.trials = trials.into_iter().collect();
        for (index, mut rows) in series.into_iter().enumerate() {
            let trial = Some(index / 2).filter(|trial| index % 2 == 0 && *trial < table.trials.len());
            for (at, row) in rows.iter_mut().enumerate() {
                row.trial = trial;
                row.t_s = (index % 4 == 0).then(|| at as f64 / 3.0);
            }
            table.rows.extend(rows);
        }
        table
    })
}

/// The same table with the line of each row, and sessions in the order in which they appear.
fn as_read(mut table: Table) -> Table {
    let mut sessions = Vec::new();
    for (index, row) in table.rows.iter_mut().enumerate() {
        row.line = index + 2;
        row.uv = row.uv.map(|uv| uv.map(|uv| (uv * 1e3).round() / 1e3));
        if let Some(session) = row.session {
            let name = table.sessions[session].clone();
            let known = sessions.iter().position(|known| *known == name);
            row.session = Some(known.unwrap_or(sessions.len()));
            sessions.extend(known.is_none().then_some(name));
        }
    }
    Table { sessions, ..table }
}

proptest! {
    #[test]
    fn a_table_reads_as_it_was_written(table in table()) {
        let text = written(&table);
        let read = read::table(&text[..], TableKind::Measured, 30.0).unwrap();
        prop_assert_eq!(&read, &as_read(table));
        prop_assert_eq!(written(&read), text);
    }

    #[test]
    fn no_bytes_are_a_panic(bytes in vec(any::<u8>(), 0..200), kind in 0..3_usize) {
        let kind = [TableKind::Contacts, TableKind::Plan, TableKind::Measured][kind];
        let header = b"trial,t_s,note,x_mm,y_mm,fx_n,fy_n,fz_n,approach\n";
        for text in [bytes.clone(), [&header[..], &bytes].concat()] {
            if let Err(error) = read::table(&text[..], kind, 30.0) {
                prop_assert!(error.line > 0 && !error.fault.to_string().is_empty());
            }
        }
    }

    #[test]
    fn cells_that_look_like_rows_are_read_or_told(cells in vec("[-0-9.,\"eNa ]{0,5}", 9)) {
        let text = format!("trial,t_s,note,x_mm,y_mm,fx_n,fy_n,fz_n,approach\n{}\n", cells.join(","));
        match read::table(text.as_bytes(), TableKind::Plan, 30.0) {
            Ok(table) => prop_assert_eq!(written(&table).iter().filter(|byte| **byte == b'\n').count(), 2),
            Err(error) => prop_assert!(!error.fault.to_string().is_empty()),
        }
    }
}

#[test]
fn unknown_columns_stay_with_their_rows() {
    let text =
        "x_mm,y_mm,fx_n,fy_n,fz_n,note,\"finger, which\"\n0,0,0,0,1,first,\"a \"\"b\"\"\"\n\n1,0,0,0,1,,7\n";
    let mut table = read::table(text.as_bytes(), TableKind::Plan, 30.0).unwrap();
    assert_eq!(written(&table), text.replace("\n\n", "\n").as_bytes());
    table.rows.reverse();
    let reversed = String::from_utf8(written(&table)).unwrap();
    assert!(reversed.ends_with("\n1,0,0,0,1,,7\n0,0,0,0,1,first,\"a \"\"b\"\"\"\n"), "{reversed}");
}
