//! Sensitivity of each channel to the normal force.

use serde::Serialize;

use super::Needs;
use super::output::is_z;
use super::rows::{StaticReading, Zeros, by_place, is_ordinary, is_press, readings};
use tactpad_core::quantity::CHANNELS;
use tactpad_core::tables::measured::Table;
use tactpad_numeric::statistics::mean;

/// Largest distance of a place that counts as the centre.
const CENTRE_MM: f64 = 1.0;

const NEEDED: &str = "static presses without shear, with unloaded rows";

/// µV per newton pressing.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Sensitivity {
    /// Each channel at the centre, if it was pressed.
    pub centre_uv_per_n: Option<[f64; CHANNELS]>,
    /// Each channel's least over the places.
    pub least_uv_per_n: [f64; CHANNELS],
    /// Each channel's most over the places.
    pub most_uv_per_n: [f64; CHANNELS],
    /// Mean magnitude of the z channels over the places.
    pub z_uv_per_n: f64,
    /// Mean magnitude of the x and y channels over the places.
    pub xy_uv_per_n: f64,
    /// Number of places.
    pub places: usize,
}

/// The slope through zero over all static presses at a place, place by place.
///
/// # Errors
/// No static press with a zero.
pub fn of_channels(table: &Table) -> Result<Sensitivity, Needs> {
    let is_ordinary = is_ordinary(table);
    let zeros = Zeros::of(table);
    let is_wanted = |reading: &StaticReading| is_press(&reading.row().label) && is_ordinary(reading.row());
    let places = by_place(readings(&zeros).filter(is_wanted), |reading| reading.row().label);
    let slopes: Vec<[f64; CHANNELS]> = places.each().map(slopes).collect();
    if slopes.is_empty() {
        return Err(Needs::Rows(NEEDED));
    }
    let is_centre = |place: Option<&StaticReading>| {
        place.is_some_and(|first| first.row().label.x_mm.hypot(first.row().label.y_mm) <= CENTRE_MM)
    };
    let centre = places.each().position(|mut place| is_centre(place.next()));
    let over = |fold: fn(f64, f64) -> f64, start: f64| {
        std::array::from_fn(|channel| slopes.iter().map(|slope| slope[channel]).fold(start, fold))
    };
    Ok(Sensitivity {
        centre_uv_per_n: centre.and_then(|centre| slopes.get(centre).copied()),
        least_uv_per_n: over(f64::min, f64::INFINITY),
        most_uv_per_n: over(f64::max, f64::NEG_INFINITY),
        z_uv_per_n: mean_magnitude(&slopes, is_z),
        xy_uv_per_n: mean_magnitude(&slopes, |channel| !is_z(channel)),
        places: slopes.len(),
    })
}

fn slopes<'r>(place: impl Iterator<Item = &'r StaticReading<'r, 'r>>) -> [f64; CHANNELS] {
    let place: Vec<(f64, [f64; CHANNELS])> =
        place.map(|reading| (reading.row().label.fz_n, reading.uv())).collect();
    let squares: f64 = place.iter().map(|(fz_n, _)| fz_n.powi(2)).sum();
    std::array::from_fn(|channel| {
        let products = place.iter().map(|(fz_n, uv)| fz_n * uv[channel]);
        products.sum::<f64>() / squares
    })
}

fn mean_magnitude(slopes: &[[f64; CHANNELS]], is_of_kind: fn(usize) -> bool) -> f64 {
    let of_kind = slopes.iter().flat_map(|slope| (0..CHANNELS).map(|channel| (channel, slope[channel])));
    let magnitudes: Vec<f64> =
        of_kind.filter(|(channel, _)| is_of_kind(*channel)).map(|(_, slope)| slope.abs()).collect();
    mean(&magnitudes)
}

#[cfg(test)]
mod tests {
    use super::super::fixture::{press, row, table, unloaded};
    use super::*;
    use tactpad_core::tables::measured::{Label, Row};

    fn pressed(x_mm: f64, fz_n: f64) -> Row {
        let label = Label { x_mm, ..press(fz_n) };
        let gain = |channel: usize| if is_z(channel) { 300.0 + x_mm } else { -20.0 };
        row(label, std::array::from_fn(|channel| 9.0 + fz_n * gain(channel)))
    }

    #[test]
    fn slopes_come_out_by_channel_and_place() {
        let loads = [(0.5, 1.0), (0.5, 5.0), (10.0, 2.0), (-10.0, 3.0)];
        let rows = loads.map(|(x_mm, fz_n)| pressed(x_mm, fz_n));
        let found = of_channels(&table(rows.into_iter().chain([unloaded(9.0)]))).unwrap();
        let near = |found: f64, expected: f64| assert!((found - expected).abs() < 1e-9, "{found} {expected}");
        near(found.centre_uv_per_n.unwrap()[2], 300.5);
        near(found.centre_uv_per_n.unwrap()[0], -20.0);
        near(found.least_uv_per_n[5], 290.0);
        near(found.most_uv_per_n[5], 310.0);
        near(found.z_uv_per_n, 300.0 + 0.5 / 3.0);
        near(found.xy_uv_per_n, 20.0);
        assert_eq!(found.places, 3);
    }

    #[test]
    fn it_says_what_it_needs() {
        for table in [Table::default(), table([pressed(0.0, 1.0)])] {
            assert_eq!(of_channels(&table), Err(Needs::Rows(NEEDED)));
        }
        assert_eq!(of_channels(&table([unloaded(9.0), pressed(9.0, 1.0)])).unwrap().centre_uv_per_n, None);
    }
}
