//! What ten minutes of measured contacts at 1 kHz cost as text: `cargo bench --bench measured`.
#![allow(clippy::unwrap_used, reason = "a bench that cannot set its scene fails")]

use criterion::{Criterion, criterion_group, criterion_main};
use tactpad::tables::measured::columns::TableKind;
use tactpad::tables::measured::{Label, Row, Table, read, write};

const ROWS: usize = 600_000;

/// One time series whose numbers have as many digits as numbers can have.
fn ten_minutes() -> Table {
    let row = |index: usize| {
        let turn = index as f64 / 1e3;
        let label = Label {
            x_mm: 20.0 * turn.sin(),
            y_mm: 20.0 * turn.cos(),
            fx_n: turn.sin(),
            fy_n: 0.3,
            fz_n: 3.1,
        };
        let uv = [1.0, -2.0, 3.0, 5.0, -7.0, 11.0, 13.0, -17.0, 19.0].map(|times| 100.0 * times * turn.sin());
        Row { trial: Some(0), t_s: Some(turn), uv: Some(uv), ..Row::of(label) }
    };
    Table { rows: (0..ROWS).map(row).collect(), trials: vec!["hold".into()], ..Table::default() }
}

fn both_ways(criterion: &mut Criterion) {
    let table = ten_minutes();
    let mut text = Vec::new();
    write::table(&mut text, &table).unwrap();
    let mut group = criterion.benchmark_group("600,000 rows");
    group.sample_size(10);
    group.bench_function("written", |bencher| {
        bencher.iter(|| write::table(Vec::with_capacity(text.len()), &table).unwrap());
    });
    group.bench_function("read", |bencher| {
        bencher
            .iter(|| assert_eq!(read::table(&text[..], TableKind::Measured, 30.0).unwrap().rows.len(), ROWS));
    });
    group.finish();
}

criterion_group!(benches, both_ways);
criterion_main!(benches);
