//! The nearest untouched rows of a table that are of a row's own session and temperature.

use std::collections::BTreeMap;

use super::Zeros;
use crate::quantity::CHANNELS;
use crate::tables::measured::Table;

/// Temperatures of one band, or of neighbouring ones, have a common zero: those closer than this have, and those twice as far apart
/// have not.
const BAND_C: f64 = 0.5;

/// No pad is colder or warmer: what is written beyond is of the last band.
const PAD_C: [f64; 2] = [-100.0, 200.0];

/// Zeros of a table's rows, µV, by the untouched rows of their own temperature.
#[derive(Clone, Debug)]
pub struct ZerosByTemperature<'t> {
    table: &'t Table,
    zeros: Zeros,
    all: Bands,
    by_session: BTreeMap<Option<usize>, Bands>,
}

/// Untouched rows in order, by the band of their temperature; those of no known temperature are as warm as any row.
type Bands = BTreeMap<Option<i64>, Vec<usize>>;

impl<'t> ZerosByTemperature<'t> {
    /// Of the table's untouched rows `zeros`.
    pub fn of(table: &'t Table, zeros: Zeros) -> Self {
        let (mut all, mut by_session) = (Bands::new(), BTreeMap::<_, Bands>::new());
        for at in zeros.rows() {
            let row = &table.rows[*at];
            for bands in [&mut all, by_session.entry(row.session).or_default()] {
                bands.entry(row.temp_c.map(band)).or_default().push(*at);
            }
        }
        Self { table, zeros, all, by_session }
    }

    /// Zero of a row, µV, by the untouched rows of its own temperature, as far as temperatures are known. Those of
    /// its own session come first; a session without any, as where zeros are a session of their own, has those of all. `None`
    /// where there is none.
    pub fn at(&self, row: usize) -> Option<[f64; CHANNELS]> {
        let here = self.table.rows.get(row)?;
        let value = |zero: usize| self.table.rows[zero].uv.unwrap_or_default();
        let between = |bands: &Bands| {
            let [before, after] = nearest(bands, row, here.temp_c.map(band));
            self.zeros.between(row, before, after, value)
        };
        self.by_session.get(&here.session).and_then(between).or_else(|| between(&self.all))
    }
}

fn band(temp_c: f64) -> i64 {
    (temp_c.clamp(PAD_C[0], PAD_C[1]) / BAND_C).floor() as i64
}

/// The nearest row before `row`, and from it on, that is as warm.
fn nearest(bands: &Bands, row: usize, here: Option<i64>) -> [Option<usize>; 2] {
    let as_warm: Vec<&Vec<usize>> = match here {
        Some(here) => [None, Some(here - 1), Some(here), Some(here + 1)]
            .iter()
            .filter_map(|band| bands.get(band))
            .collect(),
        None => bands.values().collect(),
    };
    let split = |rows: &[usize]| rows.partition_point(|zero| *zero < row);
    let before = as_warm.iter().filter_map(|rows| rows[..split(rows)].last().copied()).max();
    let after = as_warm.iter().filter_map(|rows| rows[split(rows)..].first().copied()).min();
    [before, after]
}

#[cfg(test)]
mod tests {
    use super::super::ZERO;
    use super::*;
    use crate::tables::measured::{Label, Row};
    use tactpad_numeric::random::SplitMix64;

    fn row(fz_n: f64, uv: f64) -> Row {
        Row { uv: Some([uv; CHANNELS]), ..Row::of(Label { fz_n, ..Label::default() }) }
    }

    fn table(rows: Vec<Row>) -> Table {
        Table { rows, sessions: vec![ZERO.into(), "spread".into()], ..Table::default() }
    }

    #[test]
    fn alike_are_zeros_of_one_temperature_and_session() {
        let at = |session, temp_c, uv| Row { session: Some(session), temp_c: Some(temp_c), ..row(0.0, uv) };
        let load = |session, temp_c| Row { session: Some(session), temp_c: Some(temp_c), ..row(1.0, 0.0) };
        let rows =
            vec![at(0, 25.0, 7.0), at(1, 25.0, 1.0), at(0, 35.0, 2.0), load(0, 25.2), at(1, 25.0, 3.0)];
        let rows = [rows, vec![load(1, 35.5), load(1, 60.0)]].concat();
        let table = Table { sessions: vec!["one".into(), "two".into()], ..table(rows) };
        let alike = ZerosByTemperature::of(&table, Zeros::of(&table).unwrap());
        let first = |row| alike.at(row).map(|uv| uv[0]);
        assert_eq!([first(3), first(5), first(6), first(99)], [Some(7.0), Some(2.0), None, None]);
    }

    #[test]
    fn the_nearest_is_the_one_that_looking_at_all_finds() {
        let mut random = SplitMix64::new(9);
        let rows: Vec<Row> = (0..400)
            .map(|_| {
                let temp_c = (random.fraction() < 0.9).then(|| f64::from(6.0 * random.uniform()));
                let load_n = if random.fraction() < 0.4 { 0.0 } else { 2.0 };
                Row { temp_c, ..row(load_n, f64::from(random.uniform())) }
            })
            .collect();
        let table = table(rows);
        let zeros = Zeros::of(&table).unwrap();
        let alike = ZerosByTemperature::of(&table, zeros.clone());
        for (at, here) in table.rows.iter().enumerate() {
            let is_as_warm = |zero: &&usize| {
                let other = table.rows[**zero].temp_c;
                let apart = here.temp_c.zip(other).map(|(one, other)| band(one).abs_diff(band(other)));
                apart.is_none_or(|bands| bands <= 1)
            };
            let before = zeros.rows().iter().filter(|zero| **zero < at).rfind(is_as_warm);
            let after = zeros.rows().iter().filter(|zero| **zero >= at).find(is_as_warm);
            let value = |zero: usize| table.rows[zero].uv.unwrap();
            assert_eq!(alike.at(at), zeros.between(at, before.copied(), after.copied(), value), "{at}");
        }
    }
}
