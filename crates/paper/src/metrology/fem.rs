//! The finite-element model against the pad: presses of 1 N at many places.

use serde::Serialize;

use super::Needs;
use super::output::is_z;
use super::rows::{StaticReading, Zeros, by_place, is_load, is_ordinary, is_press, loads, readings};
use tactpad_core::pad::influence::InfluenceField;
use tactpad_core::quantity::CHANNELS;
use tactpad_core::tables::measured::{Label, Row, Table};
use tactpad_numeric::statistics::{Line, mean, mean_vector};

/// The load that is compared.
const LOAD_N: f64 = 1.0;

/// Fewer places say nothing about a pad.
const PLACES_MIN: usize = 10;

/// Channels below this share of the largest simulated reading of their kind are left out.
const LEAST_SHARE: f64 = 0.01;

/// Least range of the loads at a place, where there are no zeros.
const LOAD_RANGE_N: f64 = 1.0;

const NEEDED: &str = "static presses of 1 N without shear at ten places or more, with unloaded rows or several \
                      loads at each place";

/// Mean of |measured − simulated| / |simulated|, over places and channels.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct FemError {
    /// Of the z channels.
    pub z_share: f64,
    /// Of the x and y channels.
    pub xy_share: f64,
    /// Number of places.
    pub places: usize,
}

/// Measured and simulated readings of the channels at a place.
struct Pair {
    measured_uv: [f64; CHANNELS],
    simulated_uv: [f64; CHANNELS],
}

/// Compares static presses of 1 N with the `signals` of a simulated pad (µV/N) at the labelled place and
/// force.
///
/// Channels whose simulated reading is below 1 % of the largest one of their kind (z; x and y), over all
/// places, are left out. Readings at one place count once, as their mean. Without any unloaded static row,
/// the slope over the loads at a place takes the place of the tared reading.
///
/// # Errors
/// Fewer than ten places.
pub fn against_pad(table: &Table, signals: &InfluenceField) -> Result<FemError, Needs> {
    let zeros = Zeros::of(table);
    let pairs = if zeros.is_empty() { by_slope(table, signals) } else { by_zero(table, &zeros, signals) };
    if pairs.len() < PLACES_MIN {
        return Err(Needs::Rows(NEEDED));
    }
    Ok(FemError {
        z_share: relative_error(&pairs, is_z),
        xy_share: relative_error(&pairs, |channel| !is_z(channel)),
        places: pairs.len(),
    })
}

/// µV under a labelled contact.
pub(super) fn simulated_uv(signals: &InfluenceField, label: &Label) -> [f64; CHANNELS] {
    let gains = signals.gains(label.x_mm as f32, label.y_mm as f32).value;
    gains.map(|[x, y, z]| x * label.fx_n + y * label.fy_n + z * label.fz_n)
}

fn by_zero(table: &Table, zeros: &Zeros, signals: &InfluenceField) -> Vec<Pair> {
    let is_ordinary = is_ordinary(table);
    let is_wanted = |reading: &StaticReading| {
        let label = &reading.row().label;
        is_press(label) && is_load(label.fz_n, LOAD_N) && is_ordinary(reading.row())
    };
    let places = by_place(readings(zeros).filter(is_wanted), |reading| reading.row().label);
    let pairs = places.each().map(|place| Pair {
        measured_uv: channel_means(place.clone().map(StaticReading::uv)),
        simulated_uv: channel_means(place.map(|reading| simulated_uv(signals, &reading.row().label))),
    });
    pairs.collect()
}

fn channel_means(samples: impl Iterator<Item = [f64; CHANNELS]>) -> [f64; CHANNELS] {
    let samples: Vec<_> = samples.collect();
    mean_vector(&samples)
}

fn by_slope(table: &Table, signals: &InfluenceField) -> Vec<Pair> {
    let is_ordinary = is_ordinary(table);
    let presses = loads(table).filter(|(_, row)| is_press(&row.label) && is_ordinary(row));
    let places = by_place(presses.map(|(_, row)| row), |row| row.label);
    let loads = |row: &&Row| Some((row.label, row.uv?));
    places.each().filter_map(|place| slopes(&place.filter_map(loads).collect::<Vec<_>>(), signals)).collect()
}

/// Sensitivity at a place, by the slope over its loads; `None` where the loads are too close to each other.
fn slopes(place: &[(Label, [f64; CHANNELS])], signals: &InfluenceField) -> Option<Pair> {
    let fz_n = || place.iter().map(|(label, _)| label.fz_n);
    let range_n = fz_n().fold(f64::MIN, f64::max) - fz_n().fold(f64::MAX, f64::min);
    let label = Label { fx_n: 0.0, fy_n: 0.0, fz_n: LOAD_N, ..place.first()?.0 };
    let slope = |channel: usize| {
        let points: Vec<[f64; 2]> = place.iter().map(|(label, uv)| [label.fz_n, uv[channel]]).collect();
        LOAD_N * Line::through(&points).slope
    };
    (range_n >= LOAD_RANGE_N).then(|| Pair {
        measured_uv: std::array::from_fn(slope),
        simulated_uv: simulated_uv(signals, &label),
    })
}

fn relative_error(pairs: &[Pair], is_of_kind: impl Fn(usize) -> bool) -> f64 {
    let channels = (0..CHANNELS).filter(|channel| is_of_kind(*channel));
    let channels: Vec<usize> = channels.collect();
    let of_kind = || pairs.iter().flat_map(|pair| channels.iter().map(move |channel| (pair, *channel)));
    let largest = of_kind().map(|(pair, k)| pair.simulated_uv[k].abs()).fold(0.0, f64::max);
    let counted = of_kind().filter(|(pair, k)| pair.simulated_uv[*k].abs() >= LEAST_SHARE * largest);
    let errors: Vec<f64> =
        counted.map(|(pair, k)| (pair.measured_uv[k] / pair.simulated_uv[k] - 1.0).abs()).collect();
    mean(&errors)
}

#[cfg(test)]
mod tests {
    use super::super::fixture::{row, table, unloaded};
    use super::*;
    use tactpad_core::pad::influence::MAPS;

    /// Each channel reads (channel + 1) · 100 µV per newton pressing; channel 0 nearly nothing.
    fn signals() -> InfluenceField {
        let maps = |_: [f64; 2]| {
            std::array::from_fn::<f64, MAPS, _>(|map| match (map / 3, map % 3) {
                (0, 2) => 1.0,
                (channel, 2) => 100.0 * (channel + 1) as f64,
                _ => 0.0,
            })
        };
        InfluenceField::sampled(1.0, 29.0, 30.0, maps)
    }

    /// A press whose z channels read 11 % more and whose x and y channels read 32 % less than simulated,
    /// beside 50 µV.
    fn faulty(place: usize, fz_n: f64) -> Row {
        let label = Label { x_mm: place as f64, fz_n, ..Label::default() };
        let gain = |channel: usize| match channel {
            // Far off, and left out.
            0 => 30.0,
            _ if is_z(channel) => 111.0 * (channel + 1) as f64,
            _ => 68.0 * (channel + 1) as f64,
        };
        row(label, std::array::from_fn(|channel| 50.0 + fz_n * gain(channel)))
    }

    fn assert_found(rows: Vec<Row>) {
        let found = against_pad(&table(rows), &signals()).unwrap();
        assert!((found.z_share - 0.11).abs() < 1e-6 && (found.xy_share - 0.32).abs() < 1e-6, "{found:?}");
        assert_eq!(found.places, 12);
    }

    #[test]
    fn gain_errors_come_out_as_shares() {
        let mut rows = vec![unloaded(50.0)];
        rows.extend((0..12).flat_map(|place| [faulty(place, 1.0), faulty(place, 1.0), faulty(place, 3.0)]));
        assert_found(rows.clone());
        // A worn and a hot pad are another matter.
        rows.extend([
            Row { cycle: Some(50_000.0), ..faulty(3, 0.9) },
            Row { cycle: Some(0.0), ..faulty(3, 1.0) },
        ]);
        assert_found(rows);
    }

    #[test]
    fn slopes_stand_in_for_zeros() {
        assert_found((0..12).flat_map(|place| [1.0, 3.0, 5.0].map(|fz_n| faulty(place, fz_n))).collect());
    }

    #[test]
    fn it_says_what_it_needs() {
        let needs = |rows: Vec<Row>| against_pad(&table(rows), &signals()).unwrap_err().to_string();
        let without_zeros = (0..12).map(|place| faulty(place, 1.0)).collect();
        let few: Vec<Row> = (0..9).map(|place| faulty(place, 1.0)).chain([unloaded(50.0)]).collect();
        for told in [needs(vec![]), needs(without_zeros), needs(few)] {
            assert_eq!(told, format!("needs {NEEDED}"));
        }
    }
}
