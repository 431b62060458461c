//! The figures as plots, in the form of the paper's.

use super::ageing::Ageing;
use super::fem::simulated_uv;
use super::hysteresis::Hysteresis;
use super::location::LocationSpread;
use super::rows::{Zeros, by_place, is_ordinary, is_press, is_same_place, readings};
use super::series;
use super::thermal::ThermalDrift;
use crate::influence::InfluenceField;
use crate::measured::{Label, Table};
use crate::plot::chart::{Chart, Guide, GuidePlace, Series, SeriesLook, Side, Value};
use crate::plot::scale::Scale;
use crate::quantity::{CHANNEL_NAMES, CHANNELS, MODULES};

const WIDTH: f64 = 560.0;
const HEIGHT: f64 = 420.0;

/// Loads are drawn as means over so much.
const LOAD_BIN_N: f64 = 0.25;

/// What is told apart: forces of loops, so many to a newton.
const LOOP_POINTS_PER_N: f64 = 5.0;

/// A load, with what it adds to the channels.
type Load = (Label, [f64; CHANNELS]);

/// Simulated and measured channels of a module over the force, after the paper's Figure 4: at the place with the most
/// different presses, of the module that reads most there. `None` where no place has three.
pub fn by_force(table: &Table, signals: &InfluenceField) -> Option<Chart> {
    let places = static_loads(table).into_iter().chain(loading_trials(table)).map(binned);
    let steps = places.max_by_key(Vec::len).filter(|steps| steps.len() >= 3)?;
    let (Label { x_mm, y_mm, .. }, most) = *steps.last()?;
    let module = (0..MODULES).max_by(|a, b| most[3 * a + 2].total_cmp(&most[3 * b + 2]))?;
    let of_channel = |channel: usize| {
        let measured = steps.iter().map(|(label, uv)| Value::new(label.fz_n, uv[channel]));
        let simulated =
            steps.iter().map(|(label, _)| Value::new(label.fz_n, simulated_uv(signals, label)[channel]));
        let name = CHANNEL_NAMES[channel];
        [
            series(format!("{name} measured"), measured, SeriesLook::Points),
            series(format!("{name} simulated"), simulated, SeriesLook::Dashes),
        ]
    };
    Some(Chart {
        title: format!("Simulation and measurement at {x_mm:.1}, {y_mm:.1} mm"),
        series: (0..3).flat_map(|axis| of_channel(3 * module + axis)).collect(),
        ..chart("normal force in N", "channel in µV")
    })
}

/// The presses of each place, tared.
fn static_loads(table: &Table) -> Vec<Vec<Load>> {
    let is_ordinary = is_ordinary(table);
    let presses = readings(table, &Zeros::of(table));
    let presses =
        presses.into_iter().filter(|reading| is_press(&reading.row.label) && is_ordinary(reading.row));
    let loads: Vec<Load> = presses.map(|reading| (reading.row.label, reading.uv)).collect();
    by_place(loads, |(label, _)| label)
}

/// The presses of each trial at one place, up to its largest.
fn loading_trials(table: &Table) -> Vec<Vec<Load>> {
    let loading = |trial: Vec<series::Sample>| -> Option<Vec<Load>> {
        let first = trial.first()?.label;
        let stays = trial.iter().all(|sample| is_same_place(&first, &sample.label));
        let (top, _) = trial.iter().enumerate().max_by(|a, b| a.1.label.fz_n.total_cmp(&b.1.label.fz_n))?;
        let up = trial.iter().take(top + 1).filter(|sample| is_press(&sample.label));
        stays.then(|| up.map(|sample| (sample.label, sample.uv)).collect())
    };
    series::all(table).into_iter().filter_map(loading).collect()
}

/// Means over loads of about the same force, by force.
fn binned(mut loads: Vec<Load>) -> Vec<Load> {
    let bin = |label: &Label| (label.fz_n / LOAD_BIN_N).round();
    loads.sort_by(|a, b| a.0.fz_n.total_cmp(&b.0.fz_n));
    let mean = |same: &[Load]| {
        let over = |of: &dyn Fn(&Load) -> f64| same.iter().map(of).sum::<f64>() / same.len() as f64;
        let (x_mm, y_mm) = (over(&|(label, _)| label.x_mm), over(&|(label, _)| label.y_mm));
        let [fx_n, fy_n, fz_n] =
            [over(&|(label, _)| label.fx_n), over(&|(label, _)| label.fy_n), over(&|(label, _)| label.fz_n)];
        let uv = std::array::from_fn(|channel| over(&|(_, uv)| uv[channel]));
        (Label { x_mm, y_mm, fx_n, fy_n, fz_n }, uv)
    };
    loads.chunk_by(|one, next| bin(&one.0) == bin(&next.0)).map(mean).collect()
}

/// The unloaded channels over the temperature, after the paper's Figure 8.
pub fn by_temperature(drift: &ThermalDrift) -> Chart {
    let of_channel = |channel: usize| {
        let values = drift.readings.iter().map(|(temp_c, uv)| Value::new(*temp_c, uv[channel]));
        series(CHANNEL_NAMES[channel].to_owned(), values, SeriesLook::LineAndPoints)
    };
    Chart {
        title: "Unloaded channels by temperature".to_owned(),
        series: (0..CHANNELS).map(of_channel).collect(),
        ..chart("temperature in °C", "change from the mean in µV")
    }
}

/// The decoded places under each load, after the paper's Figure 10, from the mean place of each.
pub fn by_place_decoded(spreads: &[LocationSpread]) -> Chart {
    let of_load = |spread: &LocationSpread| {
        let count = spread.places_mm.len() as f64;
        let mean = |axis: usize| spread.places_mm.iter().map(|place| place[axis]).sum::<f64>() / count;
        let (x, y) = (mean(0), mean(1));
        let values = spread.places_mm.iter().map(|place| Value::new(place[0] - x, place[1] - y));
        let name = format!("{} N: {:.2} mm", spread.load_n, spread.spread_mm);
        series(name, values, SeriesLook::Points)
    };
    Chart {
        title: "Decoded places of a contact that stays".to_owned(),
        series: spreads.iter().map(of_load).collect(),
        width: HEIGHT,
        ..chart("x from the mean in mm", "y from the mean in mm")
    }
}

/// The first loop of loading and unloading: what the output adds to the labelled force.
pub fn by_loop(hysteresis: &Hysteresis) -> Chart {
    let branch = |name: &str, values: &[[f64; 2]]| {
        let means = loop_means(values);
        let off = means.into_iter().map(|[fz_n, output_n]| Value::new(fz_n, 1e3 * (output_n - fz_n)));
        series(name.to_owned(), off, SeriesLook::LineAndPoints)
    };
    Chart {
        title: format!("Hysteresis: {:.1} % of 5 N", 100.0 * hysteresis.share),
        series: vec![branch("loading", &hysteresis.loading), branch("unloading", &hysteresis.unloading)],
        ..chart("labelled normal force in N", "output less labelled force in mN")
    }
}

/// Means of a branch over even parts of its forces.
fn loop_means(branch: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let part = |value: &[f64; 2]| (LOOP_POINTS_PER_N * value[0]).round();
    let mut sorted = branch.to_vec();
    sorted.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let mean = |same: &[[f64; 2]]| {
        [0, 1].map(|k| same.iter().map(|value| value[k]).sum::<f64>() / same.len() as f64)
    };
    sorted.chunk_by(|one, next| part(one) == part(next)).map(mean).collect()
}

/// The change of the reading over the cycles of load.
pub fn by_cycles(ageing: &Ageing) -> Chart {
    // A logarithmic axis has no zero.
    let values = ageing.curve.iter().map(|[cycles, change]| Value::new(cycles + 1.0, 100.0 * change));
    let chart = chart("cycles of load + 1", "change of the reading in %");
    Chart {
        title: "Reading of 1 N after cycles of 1 N".to_owned(),
        series: vec![series(String::new(), values, SeriesLook::LineAndPoints)],
        guides: vec![Guide { at: GuidePlace::X(50_001.0), label: "50,000".to_owned() }],
        x: Side { scale: Scale::Log10, also: vec![], ..chart.x },
        ..chart
    }
}

fn series(name: String, values: impl Iterator<Item = Value>, look: SeriesLook) -> Series {
    Series { name, values: values.collect(), look }
}

fn chart(x: &str, y: &str) -> Chart {
    let side = |label: &str| Side { label: label.to_owned(), scale: Scale::Linear, also: vec![0.0] };
    Chart {
        title: String::new(),
        width: WIDTH,
        height: HEIGHT,
        x: side(x),
        y: side(y),
        series: vec![],
        guides: vec![],
    }
}
