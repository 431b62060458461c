//! Kinds of rows of a table, and the zeros of their channels.

use std::collections::BTreeMap;

use tactpad_core::quantity::CHANNELS;
use tactpad_core::tables::measured::zero::alike::ZerosByTemperature;
use tactpad_core::tables::measured::zero::{self, UNLOADED_N, UntouchedRows};
use tactpad_core::tables::measured::{Label, Row, Table};
use tactpad_numeric::statistics::median;

/// Largest shear of a pure press: what a reference writes whose zero is off by the first and that is tilted
/// by 3°.
const PRESS_SHEAR_N: f64 = 0.05;
const PRESS_SHEAR_SHARE: f64 = 0.05;

/// How far a load may be from the one that is looked for, as a share of it.
const LOAD_SHARE: f64 = 0.1;

/// Places closer than this are the same.
const SAME_PLACE_MM: f64 = 0.1;

/// Rows are of the usual temperature if they are as close to it.
const USUAL_TEMPERATURE_C: f64 = 2.5;

/// A pad with fewer cycles than this more than the least one in the table is as good as new.
const FRESH_CYCLES: f64 = 1_000.0;

/// Whether nothing touches the pad.
pub(super) fn is_unloaded(label: &Label) -> bool {
    label.resultant_n() <= UNLOADED_N
}

/// Whether it is a load without shear worth mentioning.
pub(super) fn is_press(label: &Label) -> bool {
    let shear_n = label.fx_n.hypot(label.fy_n);
    !is_unloaded(label) && label.fz_n > 0.0 && shear_n <= PRESS_SHEAR_N + PRESS_SHEAR_SHARE * label.fz_n
}

/// Whether a load is the one that is looked for.
pub(super) fn is_load(fz_n: f64, wanted_n: f64) -> bool {
    (fz_n - wanted_n).abs() <= LOAD_SHARE * wanted_n
}

/// Whether both labels are of one place.
pub(super) fn is_same_place(one: &Label, other: &Label) -> bool {
    (one.x_mm - other.x_mm).hypot(one.y_mm - other.y_mm) <= SAME_PLACE_MM
}

/// What the channels read without load.
pub(super) struct Zeros<'t> {
    table: &'t Table,
    alike: Option<ZerosByTemperature<'t>>,
}

impl<'t> Zeros<'t> {
    pub(super) fn of(table: &'t Table) -> Self {
        let zeros = zero::Zeros::by(table, &UntouchedRows::unloaded(table));
        Self { table, alike: zeros.map(|zeros| ZerosByTemperature::of(table, zeros)) }
    }

    pub(super) const fn is_empty(&self) -> bool {
        self.alike.is_none()
    }

    /// The zero at the row with this index, by [`ZerosByTemperature::at`]; `None` where there is none.
    pub(super) fn at(&self, index: usize) -> Option<[f64; CHANNELS]> {
        self.alike.as_ref()?.at(index)
    }

    /// What the channels of a row read beyond their zero; `None` without channels or zero.
    pub(super) fn tared(&self, index: usize) -> Option<[f64; CHANNELS]> {
        let uv = self.table.rows.get(index)?.uv?;
        Some(less(&uv, &self.at(index)?))
    }
}

/// Channel by channel.
pub(super) fn less(uv: &[f64; CHANNELS], zero_uv: &[f64; CHANNELS]) -> [f64; CHANNELS] {
    std::array::from_fn(|channel| uv[channel] - zero_uv[channel])
}

/// A static load for which a zero is known. A table may have a million: they stay in the table.
#[derive(Clone, Copy)]
pub(super) struct StaticReading<'z, 't> {
    zeros: &'z Zeros<'t>,
    index: usize,
}

impl<'t> StaticReading<'_, 't> {
    pub(super) fn row(&self) -> &'t Row {
        &self.zeros.table.rows[self.index]
    }

    /// What it adds to the channels: beyond the zero.
    pub(super) fn uv(&self) -> [f64; CHANNELS] {
        self.zeros.tared(self.index).unwrap_or_default()
    }
}

/// The static loads for which a zero is known.
pub(super) fn readings<'z, 't>(zeros: &'z Zeros<'t>) -> impl Iterator<Item = StaticReading<'z, 't>> {
    let known = loads(zeros.table).filter(|(index, _)| zeros.tared(*index).is_some());
    known.map(|(index, _)| StaticReading { zeros, index })
}

/// The static loads that have channels, with their indices.
pub(super) fn loads(table: &Table) -> impl Iterator<Item = (usize, &Row)> {
    let untouched = UntouchedRows::unloaded(table);
    let is_load = move |row: &Row| row.trial.is_none() && row.uv.is_some() && !untouched.is(row);
    table.rows.iter().enumerate().filter(move |(_, row)| is_load(row))
}

/// The temperature of most static loads; `None` where none is known.
pub(super) fn usual_temperature_c(table: &Table) -> Option<f64> {
    median(loads(table).filter_map(|(_, row)| row.temp_c))
}

/// Whether a temperature is the usual one, as far as both are known.
pub(super) fn is_usual(temp_c: Option<f64>, usual_c: Option<f64>) -> bool {
    match (temp_c, usual_c) {
        (Some(temp_c), Some(usual_c)) => (temp_c - usual_c).abs() <= USUAL_TEMPERATURE_C,
        _ => true,
    }
}

/// Picks the rows of a pad that is as good as new, at the usual temperature.
pub(super) fn is_ordinary(table: &Table) -> impl Fn(&Row) -> bool + use<> {
    let usual_c = usual_temperature_c(table);
    let least = loads(table).filter_map(|(_, row)| row.cycle).fold(f64::INFINITY, f64::min);
    move |row| is_usual(row.temp_c, usual_c) && row.cycle.is_none_or(|cycle| cycle < least + FRESH_CYCLES)
}

/// Items by their place.
pub(super) struct Places<T> {
    /// Those of one place stand together, in the order in which they were given.
    items: Vec<(u32, T)>,
}

impl<T> Places<T> {
    /// The items of each place, in the order in which the places first appear.
    pub(super) fn each(&self) -> impl Iterator<Item = impl ExactSizeIterator<Item = &T> + Clone> {
        self.items.chunk_by(|(one, _), (next, _)| one == next).map(|place| place.iter().map(|(_, item)| item))
    }
}

/// Sorts items by their place.
pub(super) fn by_place<T>(items: impl IntoIterator<Item = T>, label: impl Fn(&T) -> Label) -> Places<T> {
    let mut found = KnownPlaces::default();
    let mut items: Vec<(u32, T)> = items.into_iter().map(|item| (found.place(&label(&item)), item)).collect();
    items.sort_by_key(|(place, _)| *place);
    Places { items }
}

/// The places that were found among labels so far.
#[derive(Default)]
struct KnownPlaces {
    /// For each place where it is, and the one before it that lies in the same square of the plate.
    places: Vec<([f64; 2], Option<u32>)>,
    /// The last place in each square: near ones are in the squares around.
    squares: BTreeMap<[i64; 2], u32>,
}

impl KnownPlaces {
    /// The number of the label's place: the first one that is near enough, else a new one.
    fn place(&mut self, label: &Label) -> u32 {
        let here = square(label);
        let [column, row] = here;
        let around = (column - 1..=column + 1).flat_map(|x| (row - 1..=row + 1).map(move |y| [x, y]));
        let near = around.flat_map(|square| {
            let last = self.squares.get(&square).copied();
            std::iter::successors(last, |place| self.places.get(*place as usize)?.1)
        });
        let is_same = |place: &u32| {
            let first = self.places.get(*place as usize);
            first.is_some_and(|([x_mm, y_mm], _)| {
                is_same_place(&Label { x_mm: *x_mm, y_mm: *y_mm, ..*label }, label)
            })
        };
        near.filter(is_same).min().unwrap_or_else(|| {
            let new = self.places.len() as u32;
            self.places.push(([label.x_mm, label.y_mm], self.squares.insert(here, new)));
            new
        })
    }
}

/// The square of the plate, as wide as a place, in which a label lies.
fn square(label: &Label) -> [i64; 2] {
    // Far from the ends of the integers, so that its neighbours are some, too.
    [label.x_mm, label.y_mm].map(|mm| (mm / SAME_PLACE_MM).floor().clamp(-1e15, 1e15) as i64)
}

#[cfg(test)]
mod tests {
    use super::super::fixture::{pressed, table, unloaded};
    use super::*;

    #[test]
    fn kinds_of_labels_are_told_apart() {
        let label = |fx_n, fz_n| Label { fx_n, fz_n, ..Label::default() };
        assert!(is_unloaded(&label(0.05, -0.05)) && !is_unloaded(&label(0.0, 0.5)));
        assert!(is_press(&label(0.09, 1.0)) && !is_press(&label(0.11, 1.0)) && !is_press(&label(0.0, -1.0)));
        assert!(is_load(0.95, 1.0) && is_load(1.05, 1.0) && !is_load(1.2, 1.0));
        assert!(!is_press(&label(f64::NAN, 1.0)) && !is_load(f64::NAN, 1.0));
    }

    #[test]
    fn a_zero_lies_between_its_neighbours() {
        let table = table([unloaded(10.0), pressed(1.0, 0.0), pressed(1.0, 0.0), unloaded(40.0)]);
        let zeros = Zeros::of(&table);
        assert_eq!((zeros.at(1).unwrap()[0], zeros.at(2).unwrap()[8]), (20.0, 30.0));
        assert_eq!(zeros.tared(1).unwrap()[0], -20.0);
    }

    #[test]
    fn zeros_of_the_same_session_and_temperature_come_first() {
        let at =
            |session, temp_c, uv: f64| Row { session: Some(session), temp_c: Some(temp_c), ..unloaded(uv) };
        let load = Row { session: Some(0), temp_c: Some(25.2), ..pressed(1.0, 0.0) };
        let table = table([at(0, 25.0, 7.0), at(1, 25.0, 1.0), at(0, 35.0, 2.0), load, at(1, 25.0, 3.0)]);
        assert_eq!(Zeros::of(&table).at(3), Some([7.0; CHANNELS]));
        assert_eq!(Zeros::of(&table).at(99), None);
    }

    #[test]
    fn zeros_may_be_a_session_of_their_own() {
        let in_session = |session, row: Row| Row { session: Some(session), ..row };
        let rows = [unloaded(4.0), pressed(1.0, 0.0), unloaded(8.0)];
        let table = table([0, 1, 0].into_iter().zip(rows).map(|(session, row)| in_session(session, row)));
        assert_eq!(Zeros::of(&table).at(1), Some([6.0; CHANNELS]));
    }

    #[test]
    fn warm_and_worn_rows_are_not_ordinary() {
        let with = |temp_c, cycle| Row { temp_c, cycle, ..pressed(1.0, 0.0) };
        let rows = [
            with(Some(25.0), Some(100.0)),
            with(Some(26.0), None),
            with(None, Some(900.0)),
            with(Some(35.0), None),
            with(Some(25.0), Some(50_000.0)),
        ];
        let table = table(rows);
        let is_ordinary = is_ordinary(&table);
        let kept: Vec<bool> = table.rows.iter().map(is_ordinary).collect();
        assert_eq!(kept, [true, true, true, false, false]);
    }

    #[test]
    fn places_are_collected() {
        let at = |x_mm| Label { x_mm, ..Label::default() };
        // −0.04 and 0.05 lie in two squares.
        let labels = [0.0, 5.0, 0.05, -0.04, 5.2, f64::NAN, f64::INFINITY, -1e300].map(at);
        let places = by_place(labels, |label| *label);
        assert_eq!(places.each().map(|place| place.len()).collect::<Vec<_>>(), [3, 1, 1, 1, 1, 1]);
        let many = (0..200_000).map(|k| at(0.3 * f64::from(k)));
        assert_eq!(by_place(many, |label| *label).each().count(), 200_000);
    }
}
