//! The nearest untouched rows of a table that are of a row's own session and temperature, found without looking at all others.

use std::collections::BTreeMap;

use super::Table;
use super::zero::Zeros;
use crate::quantity::CHANNELS;

/// Temperatures closer than this have a common zero.
const SAME_TEMPERATURE_C: f64 = 1.0;

/// Zeros of a table's rows, µV, by the untouched rows of their own temperature.
#[derive(Clone, Debug)]
pub struct ZerosByTemperature<'t> {
    table: &'t Table,
    zeros: Zeros,
    all: Group,
    by_session: BTreeMap<Option<usize>, Group>,
}

/// Untouched rows, in order.
#[derive(Clone, Debug, Default)]
struct Group {
    rows: Vec<usize>,
    /// Those of no known temperature, which are as warm as any row.
    unknown: Vec<usize>,
    /// The others, by their temperature's whole part.
    by_degree: BTreeMap<i64, Degree>,
}

/// Untouched rows whose temperatures have one whole part.
#[derive(Clone, Debug, Default)]
struct Degree {
    rows: Vec<usize>,
    warmest: MaximumTree,
    /// Of the temperatures' negatives.
    coldest: MaximumTree,
}

/// The largest number of each half of a list, of each quarter, and so on.
#[derive(Clone, Debug, Default)]
struct MaximumTree {
    /// A power of two.
    width: usize,
    nodes: Vec<f64>,
}

/// Which way to look.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Side {
    Before,
    After,
}

impl<'t> ZerosByTemperature<'t> {
    /// Of the table's untouched rows `zeros`.
    pub fn of(table: &'t Table, zeros: Zeros) -> Self {
        let mut by_session: BTreeMap<Option<usize>, Vec<usize>> = BTreeMap::new();
        for row in zeros.rows() {
            by_session.entry(table.rows[*row].session).or_default().push(*row);
        }
        let group = |(session, rows)| (session, Group::of(table, rows));
        Self {
            table,
            all: Group::of(table, zeros.rows().to_vec()),
            by_session: by_session.into_iter().map(group).collect(),
            zeros,
        }
    }

    /// Zero of a row, µV, by the untouched rows of its own temperature, as far as temperatures are known. Those of
    /// its own session come first; a session without any, as where zeros are a session of their own, has those of all. `None`
    /// where there is none.
    pub fn at(&self, row: usize) -> Option<[f64; CHANNELS]> {
        let here = self.table.rows.get(row)?;
        let value = |zero: usize| self.table.rows[zero].uv.unwrap_or_default();
        let between = |group: &Group| {
            let [before, after] =
                [Side::Before, Side::After].map(|side| group.nearest(row, here.temp_c, side));
            self.zeros.between(row, before, after, value)
        };
        self.by_session.get(&here.session).and_then(between).or_else(|| between(&self.all))
    }
}

impl Group {
    fn of(table: &Table, rows: Vec<usize>) -> Self {
        let mut unknown = Vec::new();
        let mut by_degree: BTreeMap<i64, Vec<usize>> = BTreeMap::new();
        for row in &rows {
            match table.rows[*row].temp_c {
                Some(temp_c) => by_degree.entry(degree(temp_c)).or_default().push(*row),
                None => unknown.push(*row),
            }
        }
        let of_degree = |(degree, rows): (i64, Vec<usize>)| {
            let temperatures = |sign: f64| -> Vec<f64> {
                rows.iter().map(|row| sign * table.rows[*row].temp_c.unwrap_or_default()).collect()
            };
            let (warmest, coldest) =
                (MaximumTree::of(&temperatures(1.0)), MaximumTree::of(&temperatures(-1.0)));
            (degree, Degree { rows, warmest, coldest })
        };
        Self { rows, unknown, by_degree: by_degree.into_iter().map(of_degree).collect() }
    }

    /// The nearest row on one side of `row` that is as warm.
    fn nearest(&self, row: usize, temp_c: Option<f64>, side: Side) -> Option<usize> {
        let Some(temp_c) = temp_c else { return side.first(&self.rows, row) };
        let here = degree(temp_c);
        let at = |degree: i64| self.by_degree.get(&degree);
        let found = [
            side.first(&self.unknown, row),
            at(here).and_then(|same| side.first(&same.rows, row)),
            at(here - 1)
                .and_then(|colder| colder.at_least(&colder.warmest, row, temp_c - SAME_TEMPERATURE_C, side)),
            at(here + 1)
                .and_then(|warmer| warmer.at_least(&warmer.coldest, row, -temp_c - SAME_TEMPERATURE_C, side)),
        ];
        let found = found.into_iter().flatten();
        if side == Side::Before { found.max() } else { found.min() }
    }
}

fn degree(temp_c: f64) -> i64 {
    (temp_c / SAME_TEMPERATURE_C).floor() as i64
}

impl Degree {
    fn at_least(&self, numbers: &MaximumTree, row: usize, least: f64, side: Side) -> Option<usize> {
        let place = numbers.nearest(self.rows.partition_point(|zero| *zero < row), least, side)?;
        self.rows.get(place).copied()
    }
}

impl Side {
    /// The nearest of these rows.
    fn first(self, rows: &[usize], row: usize) -> Option<usize> {
        let (before, after) = rows.split_at(rows.partition_point(|zero| *zero < row));
        if self == Self::Before { before.last().copied() } else { after.first().copied() }
    }
}

impl MaximumTree {
    fn of(numbers: &[f64]) -> Self {
        let width = numbers.len().next_power_of_two();
        let mut nodes = vec![f64::NEG_INFINITY; 2 * width];
        nodes[width..][..numbers.len()].copy_from_slice(numbers);
        for node in (1..width).rev() {
            nodes[node] = nodes[2 * node].max(nodes[2 * node + 1]);
        }
        Self { width, nodes }
    }

    /// The last place before `split`, or the first one from it on, with this number or a larger one.
    fn nearest(&self, split: usize, least: f64, side: Side) -> Option<usize> {
        self.within(1, 0, self.width, split, least, side)
    }

    fn within(
        &self,
        node: usize,
        from: usize,
        width: usize,
        split: usize,
        least: f64,
        side: Side,
    ) -> Option<usize> {
        let is_beside = if side == Side::Before { from >= split } else { from + width <= split };
        // Not a number, where the list is empty, is not at least anything.
        let is_high = self.nodes.get(node).is_some_and(|highest| *highest >= least);
        if is_beside || !is_high {
            return None;
        }
        if width == 1 {
            return Some(from);
        }
        let half = width / 2;
        let left = || self.within(2 * node, from, half, split, least, side);
        let right = || self.within(2 * node + 1, from + half, half, split, least, side);
        if side == Side::Before { right().or_else(left) } else { left().or_else(right) }
    }
}

#[cfg(test)]
mod tests {
    use super::super::zero::ZERO;
    use super::super::{Label, Row};
    use super::*;
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
                let apart =
                    here.temp_c.zip(table.rows[**zero].temp_c).map(|(one, other)| (one - other).abs());
                apart.is_none_or(|apart_c| apart_c <= SAME_TEMPERATURE_C)
            };
            let before = zeros.rows().iter().filter(|zero| **zero < at).rfind(is_as_warm);
            let after = zeros.rows().iter().filter(|zero| **zero >= at).find(is_as_warm);
            let value = |zero: usize| table.rows[zero].uv.unwrap();
            assert_eq!(alike.at(at), zeros.between(at, before.copied(), after.copied(), value), "{at}");
        }
    }
}
