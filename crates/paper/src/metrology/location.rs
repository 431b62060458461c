//! Spread of the decoded place of a contact at rest.

use serde::Serialize;

use super::rows::{by_place, is_load, is_press};
use super::series::{self, Sample, Trials, mean_label};
use super::{Decode, Needs, filter};
use tactpad_core::tables::measured::{Label, Table};
use tactpad_numeric::statistics::deviation;

/// The paper's loads.
pub const LOADS_N: [f64; 4] = [0.5, 1.0, 3.0, 5.0];

/// Time that the paper evaluates.
const LOOKED_S: f64 = 10.0;

/// Least time for which a load is held.
const HELD_S: f64 = 8.0;

const NEEDED: &str = "trials that hold 0.5, 1, 3 and 5 N for 10 s at one place, with unloaded rows";

/// Spread of the decoded places under one load.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LocationSpread {
    /// The load that was looked for.
    pub load_n: f64,
    /// Root of the summed variances of x and y.
    pub spread_mm: f64,
    /// The decoded places; for the plot.
    #[serde(skip)]
    pub places_mm: Vec<[f64; 2]>,
}

/// The spread at each of [`LOADS_N`], over the first 10 s of the held load, decoded after the mean filter of
/// 6. It is looked for where most of the loads are held; of several trials with one load the first one
/// counts.
///
/// # Errors
/// One of the loads is not held for 8 s at that place, or there is no decoder.
pub fn spreads(table: &Table, decode: Option<Decode>) -> Result<[LocationSpread; 4], Needs> {
    let trials = Trials::of(table);
    let trials: Vec<Vec<Sample>> = trials.each().collect();
    let held = trials.iter().flat_map(|trial| series::held(trial, HELD_S));
    let labelled = held.map(|part| (mean_label(part), part));
    let places = by_place(labelled.filter(|(label, _)| is_press(label)), |(label, _)| *label);
    let found = places.each().find_map(at_each_load).ok_or(Needs::Rows(NEEDED))?;
    let decode = decode.ok_or(Needs::Decoder)?;
    let index = [0, 1, 2, 3];
    Ok(index.map(|index| spread(LOADS_N[index], found[index], decode)))
}

fn at_each_load<'p, 's: 'p, 't: 's>(
    place: impl Iterator<Item = &'p (Label, &'s [Sample<'t>])> + Clone,
) -> Option<[&'s [Sample<'t>]; 4]> {
    let held =
        |load_n: f64| place.clone().find(|(label, _)| is_load(label.fz_n, load_n)).map(|(_, part)| *part);
    let [a, b, c, d] = LOADS_N.map(held);
    Some([a?, b?, c?, d?])
}

fn spread(load_n: f64, samples: &[Sample], decode: Decode) -> LocationSpread {
    let start_s = samples.first().map_or(0.0, |first| first.t_s());
    let looked = samples.iter().take_while(|sample| sample.t_s() - start_s <= LOOKED_S).count();
    let contacts = filter::means(&samples[..looked], Sample::uv).map(|uv| decode(&uv));
    let places_mm: Vec<[f64; 2]> =
        contacts.map(|contact| [contact.x_mm.into(), contact.y_mm.into()]).collect();
    let along = |axis: usize| deviation(&places_mm.iter().map(|place| place[axis]).collect::<Vec<_>>());
    LocationSpread { load_n, spread_mm: along(0).hypot(along(1)), places_mm }
}

#[cfg(test)]
mod tests {
    use super::super::fixture::{press, series, table};
    use super::*;
    use tactpad_core::quantity::{CHANNELS, Contact};
    use tactpad_core::tables::measured::Row;

    /// Channels 0 and 1 are x and y in µm times the load, channel 2 the load in mN: x goes round with a
    /// period of 24 samples, y with one of 48.
    fn held(trial: usize, fz_n: f64, seconds: f64) -> Vec<Row> {
        let label = move |t_s: f64| press(if t_s < 1.0 { 0.0 } else { fz_n });
        let rows = series(trial, 48.0, seconds + 1.0, |t_s| (label(t_s), 0.0));
        let wandering = rows.enumerate().map(|(k, row)| {
            let wave = |period: f64| (std::f64::consts::TAU * k as f64 / period).sin();
            let mut uv = [0.0; CHANNELS];
            let load_n = row.label.fz_n;
            [uv[0], uv[1], uv[2]] = [1e3 * load_n * wave(24.0), 2e3 * load_n * wave(48.0), 1e3 * load_n];
            Row { uv: Some(uv), ..row }
        });
        wandering.collect()
    }

    fn decode(uv: &[f64; CHANNELS]) -> Contact {
        let load = uv[2].max(1e-9);
        Contact { x_mm: (uv[0] / load) as f32, y_mm: (uv[1] / load) as f32, ..Contact::default() }
    }

    fn trials(seconds: f64) -> Table {
        table(LOADS_N.iter().enumerate().flat_map(|(trial, load_n)| held(trial, *load_n, seconds)))
    }

    #[test]
    fn the_spread_is_that_behind_the_filter() {
        let found = spreads(&trials(12.0), Some(&decode)).unwrap();
        // The filter's gain at a period of p samples: sin(6π/p) / (6 sin(π/p)).
        let gain = |p: f64| (6.0 * std::f64::consts::PI / p).sin() / (6.0 * (std::f64::consts::PI / p).sin());
        let half = 0.5_f64.sqrt();
        let expected = (half * gain(24.0)).hypot(2.0 * half * gain(48.0));
        for (spread, load_n) in found.iter().zip(LOADS_N) {
            assert_eq!(spread.load_n, load_n);
            assert!((spread.spread_mm / expected - 1.0).abs() < 0.01, "{} {expected}", spread.spread_mm);
            assert_eq!(spread.places_mm.len(), 481);
        }
    }

    #[test]
    fn it_says_what_it_needs() {
        assert_eq!(spreads(&trials(12.0), None), Err(Needs::Decoder));
        for table in [trials(5.0), table(held(0, 1.0, 12.0)), Table::default()] {
            assert_eq!(spreads(&table, Some(&decode)), Err(Needs::Rows(NEEDED)));
        }
    }
}
