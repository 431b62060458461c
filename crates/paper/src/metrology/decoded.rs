//! Errors of the decoded contacts, and what the temperature adds to them.

use std::collections::BTreeMap;

use serde::Serialize;

use super::rows::{Zeros, by_place, is_ordinary, is_usual, less, loads, usual_temperature_c};
use super::same::DistinctContacts;
use super::thermal::STEP_C;
use super::{Decode, Needs};
use tactpad_core::quantity::{CHANNELS, Contact};
use tactpad_core::tables::measured::zero::UntouchedRows;
use tactpad_core::tables::measured::{Label, Row, Table};
use tactpad_numeric::statistics;

const NEEDED: &str = "static loads, with unloaded rows";
const NEEDED_RAW: &str = "static loads";
const NEEDED_WARM: &str = "static loads of the same places and forces at two temperatures (temp_c), 5 °C \
                           apart, with unloaded rows at the usual one";

/// Least temperature change from the usual one.
const CHANGE_C: f64 = 5.0;

/// Errors of decoded contacts against the labels.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct DecodedErrors {
    /// Root of the mean square, Fx, Fy, Fz.
    pub force_rmse_n: [f64; 3],
    /// The same of the resultant force.
    pub resultant_rmse_n: f64,
    /// Mean magnitude, over Fx, Fy and Fz.
    pub force_mae_n: f64,
    /// Mean magnitude, over x and y.
    pub place_mae_mm: f64,
    /// Mean distance.
    pub place_distance_mm: f64,
    /// Number of contacts.
    pub contacts: usize,
}

/// Increase of the mean magnitude of the errors by a change of 10 °C.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct DecodedDrift {
    /// Fx, Fy, Fz.
    pub force_n: [f64; 3],
    /// Mean over x and y.
    pub place_mm: f64,
    /// Number of compared contacts.
    pub contacts: usize,
}

/// Decoded minus labelled.
#[derive(Clone, Copy)]
struct Difference {
    force_n: [f64; 3],
    place_mm: [f64; 2],
    resultant_n: f64,
}

impl Difference {
    fn of(contact: &Contact, label: &Label) -> Self {
        let Contact { x_mm, y_mm, fx_n, fy_n, fz_n } = *contact;
        let [x_mm, y_mm, fx_n, fy_n, fz_n] = [x_mm, y_mm, fx_n, fy_n, fz_n].map(f64::from);
        Self {
            force_n: [fx_n - label.fx_n, fy_n - label.fy_n, fz_n - label.fz_n],
            place_mm: [x_mm - label.x_mm, y_mm - label.y_mm],
            resultant_n: fx_n.hypot(fy_n).hypot(fz_n) - label.resultant_n(),
        }
    }

    fn place_magnitude_mm(&self) -> f64 {
        0.5 * (self.place_mm[0].abs() + self.place_mm[1].abs())
    }
}

/// Errors over the static loads of a pad that is as good as new, at the usual temperature, tared. A contact
/// that comes again counts once, by its first row.
///
/// # Errors
/// No such rows, or no decoder.
pub fn errors(table: &Table, decode: Option<Decode>) -> Result<DecodedErrors, Needs> {
    let zeros = Zeros::of(table);
    over(table, |index| zeros.tared(index), NEEDED, decode)
}

/// The same for a decoder of raw channels, from which nothing is taken off.
///
/// # Errors
/// As for [`errors`].
pub fn raw_errors(table: &Table, decode: Option<Decode>) -> Result<DecodedErrors, Needs> {
    over(table, |index| table.rows.get(index)?.uv, NEEDED_RAW, decode)
}

/// Over the loads for which the channels as the decoder takes them are known.
fn over(
    table: &Table,
    taken_uv: impl Fn(usize) -> Option<[f64; CHANNELS]>,
    needed: &'static str,
    decode: Option<Decode>,
) -> Result<DecodedErrors, Needs> {
    let is_ordinary = is_ordinary(table);
    let found = loads(table).filter(|(index, row)| is_ordinary(row) && taken_uv(*index).is_some());
    let places = by_place(found.map(|(index, _)| index as u32), |index| table.rows[*index as usize].label);
    let mut different = places.each().flat_map(|place| different(table, place)).peekable();
    if different.peek().is_none() {
        return Err(Needs::Rows(needed));
    }
    let decode = decode.ok_or(Needs::Decoder)?;
    let error =
        |index: usize| Some(Difference::of(&decode(&taken_uv(index)?), &table.rows.get(index)?.label));
    Ok(summary(different.filter_map(error)))
}

/// The first row of each force at a place.
fn different<'p>(table: &Table, place: impl Iterator<Item = &'p u32>) -> impl Iterator<Item = usize> {
    let mut different = DistinctContacts::default();
    place.map(|index| *index as usize).filter(move |index| different.take(&table.rows[*index].label))
}

/// Sums, so that a million differences need not be kept.
fn summary(differences: impl Iterator<Item = Difference>) -> DecodedErrors {
    let mut contacts = 0;
    let (mut squares, mut magnitudes) = ([0.0; 4], [0.0; 3]);
    for difference in differences {
        let [fx_n, fy_n, fz_n] = difference.force_n;
        let force_n = difference.force_n.map(f64::abs).iter().sum::<f64>() / 3.0;
        let distance_mm = difference.place_mm[0].hypot(difference.place_mm[1]);
        let add = |sums: &mut [f64], numbers: &[f64]| {
            sums.iter_mut().zip(numbers).for_each(|(sum, number)| *sum += number);
        };
        add(&mut squares, &[fx_n, fy_n, fz_n, difference.resultant_n].map(|n| n.powi(2)));
        add(&mut magnitudes, &[force_n, difference.place_magnitude_mm(), distance_mm]);
        contacts += 1;
    }
    let [fx_n, fy_n, fz_n, resultant_rmse_n] = squares.map(|sum| (sum / contacts as f64).sqrt());
    let [force_mae_n, place_mae_mm, place_distance_mm] = magnitudes.map(|sum| sum / contacts as f64);
    DecodedErrors {
        force_rmse_n: [fx_n, fy_n, fz_n],
        resultant_rmse_n,
        force_mae_n,
        place_mae_mm,
        place_distance_mm,
        contacts,
    }
}

/// A load, and the same contact at the usual temperature.
struct Pair<'t> {
    load: &'t Row,
    same: &'t Row,
    /// The difference of temperatures in units of 10 °C.
    steps: f64,
}

/// The increase of the errors when the pad is warmer or colder than when it was tared, per 10 °C. Each
/// contact is compared with the same place and force at the usual temperature.
///
/// # Errors
/// No such pairs, or no decoder.
pub fn drift(table: &Table, decode: Option<Decode>) -> Result<DecodedDrift, Needs> {
    let usual_c = usual_temperature_c(table).ok_or(Needs::Rows(NEEDED_WARM))?;
    let zeros = UsualZeros::of(table, usual_c).ok_or(Needs::Rows(NEEDED_WARM))?;
    let places = by_place(loads(table).map(|(_, row)| row), |row| row.label);
    let mut pairs = places.each().flat_map(|place| pairs(place, usual_c)).peekable();
    if pairs.peek().is_none() {
        return Err(Needs::Rows(NEEDED_WARM));
    }
    let decode = decode.ok_or(Needs::Decoder)?;
    let error = |row: &Row| Some(Difference::of(&decode(&zeros.tared(row)?), &row.label));
    Ok(increase(pairs.filter_map(|pair| Some((error(pair.load)?, error(pair.same)?, pair.steps)))))
}

/// Pairs of the loads at one place.
fn pairs<'t: 'p, 'p>(place: impl Iterator<Item = &'p &'t Row>, usual_c: f64) -> Vec<Pair<'t>> {
    let (mut usual, other): (Vec<&Row>, Vec<&Row>) =
        place.copied().partition(|row| is_usual(row.temp_c, Some(usual_c)));
    let mut different = DistinctContacts::default();
    usual.retain(|row| different.take(&row.label));
    let pair = |load: &'t Row| {
        let change_c = (load.temp_c? - usual_c).abs();
        let same = usual.get(different.find(&load.label)?)?;
        (change_c >= CHANGE_C).then_some(Pair { load, same, steps: change_c / STEP_C })
    };
    other.into_iter().filter_map(pair).collect()
}

fn increase(compared: impl Iterator<Item = (Difference, Difference, f64)>) -> DecodedDrift {
    let mut contacts = 0;
    let mut sums = [0.0; 4];
    for (load, same, steps) in compared {
        let magnitudes = |difference: &Difference| {
            let [fx_n, fy_n, fz_n] = difference.force_n.map(f64::abs);
            [fx_n, fy_n, fz_n, difference.place_magnitude_mm()]
        };
        let both = magnitudes(&load).into_iter().zip(magnitudes(&same));
        sums.iter_mut().zip(both).for_each(|(sum, (load, same))| *sum += (load - same) / steps);
        contacts += 1;
    }
    let [fx_n, fy_n, fz_n, place_mm] = sums.map(|sum| sum / contacts as f64);
    DecodedDrift { force_n: [fx_n, fy_n, fz_n], place_mm, contacts }
}

/// What the sessions read unloaded at the usual temperature, on average.
struct UsualZeros {
    by_session: BTreeMap<Option<usize>, [f64; CHANNELS]>,
    of_all: [f64; CHANNELS],
}

impl UsualZeros {
    /// `None` where nothing is read so.
    fn of(table: &Table, usual_c: f64) -> Option<Self> {
        let untouched = UntouchedRows::unloaded(table);
        let is_zero = |row: &&Row| row.trial.is_none() && untouched.is(row) && is_near(row, usual_c);
        let zeros =
            || table.rows.iter().filter(is_zero).filter_map(|row| Some((row.session, row.uv.as_ref()?)));
        let mut by_session: BTreeMap<Option<usize>, Vec<&[f64; CHANNELS]>> = BTreeMap::new();
        zeros().for_each(|(session, uv)| by_session.entry(session).or_default().push(uv));
        let mean = |(session, own): (_, Vec<_>)| (session, statistics::mean_vector(own.iter().copied()));
        (!by_session.is_empty()).then(|| Self {
            by_session: by_session.into_iter().map(mean).collect(),
            of_all: statistics::mean_vector(zeros().map(|(_, uv)| uv)),
        })
    }

    /// A row's channels less those of its session; of all, where the session has none of its own.
    fn tared(&self, row: &Row) -> Option<[f64; CHANNELS]> {
        Some(less(row.uv.as_ref()?, self.by_session.get(&row.session).unwrap_or(&self.of_all)))
    }
}

fn is_near(row: &Row, usual_c: f64) -> bool {
    row.temp_c.is_some() && is_usual(row.temp_c, Some(usual_c))
}

#[cfg(test)]
mod tests {
    use super::super::fixture::{row, table};
    use super::*;

    /// Channels 0..5 are x, y in mm and the forces in N, each a thousandfold.
    fn decode(uv: &[f64; CHANNELS]) -> Contact {
        let [x_mm, y_mm, fx_n, fy_n, fz_n] = std::array::from_fn(|k| (uv[k] / 1e3) as f32);
        Contact { x_mm, y_mm, fx_n, fy_n, fz_n }
    }

    /// A contact whose channels are off by `off` (x, y, fx, fy, fz), beside a zero of 70 µV.
    fn contact(label: Label, off: [f64; 5], temp_c: f64) -> Row {
        let truth = [label.x_mm, label.y_mm, label.fx_n, label.fy_n, label.fz_n];
        let uv = |k: usize| 70.0 + if k < 5 { 1e3 * (truth[k] + off[k]) } else { 0.0 };
        Row { temp_c: Some(temp_c), ..row(label, std::array::from_fn(uv)) }
    }

    fn zero(temp_c: f64) -> Row {
        contact(Label::default(), [0.0; 5], temp_c)
    }

    const LABEL: Label = Label { x_mm: 3.0, y_mm: -4.0, fx_n: 0.0, fy_n: 3.0, fz_n: 4.0 };

    #[test]
    fn errors_are_those_that_were_put_in() {
        let off = [3.0, -4.0, 0.3, 0.3, 0.4];
        let elsewhere = Label { x_mm: 9.0, ..LABEL };
        let rows = [
            zero(25.0),
            contact(LABEL, off, 25.0),
            contact(elsewhere, off.map(|off| -off), 25.0),
            contact(LABEL, [1.0; 5], 25.0),
        ];
        let found = errors(&table(rows), Some(&decode)).unwrap();
        let near = |found: f64, expected: f64| assert!((found - expected).abs() < 1e-5, "{found} {expected}");
        near(found.force_rmse_n[0], 0.3);
        near(found.force_rmse_n[2], 0.4);
        near(found.force_mae_n, 1.0 / 3.0);
        near(found.place_mae_mm, 3.5);
        near(found.place_distance_mm, 5.0);
        let [more, less] =
            [1.0_f64, -1.0].map(|sign| (0.3_f64).hypot(3.0 + sign * 0.3).hypot(4.0 + sign * 0.4) - 5.0);
        near(found.resultant_rmse_n, ((more * more + less * less) / 2.0).sqrt());
        assert_eq!(found.contacts, 2);
    }

    #[test]
    fn raw_errors_keep_the_zero() {
        let found = raw_errors(&table([contact(LABEL, [0.0; 5], 25.0)]), Some(&decode)).unwrap();
        assert!(
            (found.place_mae_mm - 0.07).abs() < 1e-5 && (found.force_mae_n - 0.07).abs() < 1e-5,
            "{found:?}"
        );
        assert_eq!(raw_errors(&table([zero(25.0)]), Some(&decode)), Err(Needs::Rows(NEEDED_RAW)));
    }

    #[test]
    fn drift_is_the_increase_per_ten_degrees() {
        let rows = [-20.0, 0.0, 10.0, 0.0, 0.0].map(|change_c: f64| {
            let share = change_c.abs() / 10.0;
            // Errors that are there anyway, and what the temperature adds.
            let off = [
                0.5 + 0.1 * share,
                0.5 + 0.16 * share,
                0.1 + 0.117 * share,
                -0.1 - 0.102 * share,
                0.191 * share,
            ];
            contact(LABEL, off, 25.0 + change_c)
        });
        // Unloaded rows at the other temperatures have drifted as well, and are not used.
        let rows =
            rows.into_iter().chain([zero(25.0), contact(Label::default(), [1.0, 0.0, 0.0, 0.0, 0.0], 35.0)]);
        let found = drift(&table(rows), Some(&decode)).unwrap();
        for (found, expected) in
            found.force_n.into_iter().chain([found.place_mm]).zip([0.117, 0.102, 0.191, 0.13])
        {
            assert!((found - expected).abs() < 1e-5, "{found} {expected}");
        }
        assert_eq!(found.contacts, 2);
    }

    #[test]
    fn it_says_what_it_needs() {
        let untared = table([contact(LABEL, [0.0; 5], 25.0)]);
        let cold = table([zero(25.0), contact(LABEL, [0.0; 5], 25.0)]);
        for table in [Table::default(), untared] {
            assert_eq!(errors(&table, Some(&decode)), Err(Needs::Rows(NEEDED)));
            assert_eq!(drift(&table, Some(&decode)), Err(Needs::Rows(NEEDED_WARM)));
        }
        assert_eq!(drift(&cold, Some(&decode)), Err(Needs::Rows(NEEDED_WARM)));
        assert_eq!(errors(&cold, None), Err(Needs::Decoder));
        let both = table([zero(25.0), contact(LABEL, [0.0; 5], 25.0), contact(LABEL, [0.0; 5], 35.0)]);
        assert_eq!(drift(&both, None), Err(Needs::Decoder));
    }
}
