//! The figures as plots, in the form of the paper's.

use super::ageing::Ageing;
use super::decoded::DecodedErrors;
use super::fem::simulated_uv;
use super::figures::Figures;
use super::hysteresis::Hysteresis;
use super::location::LocationSpread;
use super::rows::{StaticReading, Zeros, by_place, is_ordinary, is_press, is_same_place, readings};
use super::series;
use super::thermal::ThermalDrift;
use tactpad_core::pad::influence::InfluenceField;
use tactpad_core::quantity::{CHANNEL_NAMES, CHANNELS, MODULES};
use tactpad_core::tables::measured::{Label, Table};
use tactpad_numeric::statistics::{deviation, mean, mean_vector};
use tactpad_plot::chart::{Chart, GuideLine, GuidePlace, Series, SeriesLook, Side, Value};
use tactpad_plot::columns::{Column, Columns};
use tactpad_plot::scale::Scale;

const WIDTH: f64 = 560.0;
const HEIGHT: f64 = 420.0;

/// Width of the bins of force over which loads are averaged.
const LOAD_BIN_N: f64 = 0.25;

/// Points of a loop to a newton.
const LOOP_POINTS_PER_N: f64 = 5.0;

/// A load, with what it adds to the channels.
type Load = (Label, [f64; CHANNELS]);

/// Simulated and measured channels of a module over the force, after the paper's Figure 4: at the place with
/// the most different presses, of the module that reads most there. `None` where no place has three.
pub fn by_force(table: &Table, signals: &InfluenceField) -> Option<Chart> {
    let places = static_loads(table).into_iter().chain(loading_trials(table));
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

/// The presses of each place, tared, by their force.
fn static_loads(table: &Table) -> Vec<Vec<Load>> {
    let is_ordinary = is_ordinary(table);
    let zeros = Zeros::of(table);
    let presses =
        readings(&zeros).filter(|reading| is_press(&reading.row().label) && is_ordinary(reading.row()));
    let places = by_place(presses, |reading| reading.row().label);
    let load = |reading: &StaticReading| (reading.row().label, reading.uv());
    places.each().map(|place| binned(place.map(load).collect())).collect()
}

/// The presses of each trial at one place, up to its largest, by their force.
fn loading_trials(table: &Table) -> Vec<Vec<Load>> {
    let loading = |trial: Vec<series::Sample>| -> Option<Vec<Load>> {
        let first = trial.first()?.label();
        let stays = trial.iter().all(|sample| is_same_place(first, sample.label()));
        let (top, _) =
            trial.iter().enumerate().max_by(|a, b| a.1.label().fz_n.total_cmp(&b.1.label().fz_n))?;
        let up = trial.iter().take(top + 1).filter(|sample| is_press(sample.label()));
        stays.then(|| binned(up.map(|sample| (*sample.label(), sample.uv())).collect()))
    };
    series::Trials::of(table).each().filter_map(loading).collect()
}

/// Means over loads of about the same force, by force.
fn binned(mut loads: Vec<Load>) -> Vec<Load> {
    let bin = |label: &Label| (label.fz_n / LOAD_BIN_N).round();
    loads.sort_by(|a, b| a.0.fz_n.total_cmp(&b.0.fz_n));
    let middle = |same: &[Load]| {
        let over = |of: &dyn Fn(&Load) -> f64| mean(same.iter().map(of));
        let (x_mm, y_mm) = (over(&|(label, _)| label.x_mm), over(&|(label, _)| label.y_mm));
        let [fx_n, fy_n, fz_n] =
            [over(&|(label, _)| label.fx_n), over(&|(label, _)| label.fy_n), over(&|(label, _)| label.fz_n)];
        let uv = std::array::from_fn(|channel| over(&|(_, uv)| uv[channel]));
        (Label { x_mm, y_mm, fx_n, fy_n, fz_n }, uv)
    };
    loads.chunk_by(|one, next| bin(&one.0) == bin(&next.0)).map(middle).collect()
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
        let [x, y] = mean_vector(&spread.places_mm);
        let values = spread.places_mm.iter().map(|place| Value::new(place[0] - x, place[1] - y));
        let name = format!("{} N: {:.2} mm", spread.load_n, spread.spread_mm);
        series(name, values, SeriesLook::Points)
    };
    let series: Vec<Series> = spreads.iter().map(of_load).collect();
    let all = series.iter().flat_map(|series| &series.values);
    let farthest = all.flat_map(|value| [value.x.abs(), value.y.abs()]).fold(0.0, f64::max);
    let Chart { x, y, .. } = chart("x from the mean in mm", "y from the mean in mm");
    // Both sides show the same span, on a page that is about square.
    let also = vec![-farthest, farthest];
    Chart {
        title: "Decoded places of a contact that stays".to_owned(),
        series,
        width: HEIGHT,
        x: Side { also: also.clone(), ..x },
        y: Side { also, ..y },
        ..chart("", "")
    }
}

/// Root-mean-square errors of the forces, axis by axis, and of the resultant, after the paper's Figure 9: means over
/// the tables with their standard deviations. `None` where no table has them.
pub fn by_axis(figures: &[Figures]) -> Option<Columns> {
    let errors: Vec<_> = figures.iter().filter_map(|figures| figures.decoded.as_ref().ok()).collect();
    let first = errors.first()?;
    let column = |name: &str, of: &dyn Fn(&DecodedErrors) -> f64| {
        let values: Vec<f64> = errors.iter().map(|errors| of(errors)).collect();
        let value = mean(&values);
        let off = if values.len() > 1 { deviation(&values) } else { 0.0 };
        let label = if off > 0.0 { format!("{value:.3} ± {off:.3}") } else { format!("{value:.3}") };
        Column { name: name.to_owned(), value, range: [value - off, value + off], label }
    };
    let axes = ["F_{x}", "F_{y}", "F_{z}"].into_iter().enumerate();
    let axes = axes.map(|(axis, name)| column(name, &|errors| errors.force_rmse_n[axis]));
    let resultant = column("resultant", &|errors| errors.resultant_rmse_n);
    let pads = if errors.len() > 1 { format!(", {} pads", errors.len()) } else { String::new() };
    Some(Columns {
        title: format!("Decoded force: RMSE over {} contacts{pads}", first.contacts),
        width: WIDTH,
        height: 0.75 * HEIGHT,
        y_label: "root-mean-square error, N".to_owned(),
        columns: axes.chain([resultant]).collect(),
    })
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
    sorted.chunk_by(|one, next| part(one) == part(next)).map(mean_vector).collect()
}

/// The change of the reading over the cycles of load.
pub fn by_cycles(ageing: &Ageing) -> Chart {
    // A logarithmic axis has no zero.
    let values = ageing.curve.iter().map(|[cycles, change]| Value::new(cycles + 1.0, 100.0 * change));
    let chart = chart("cycles of load + 1", "change of the reading in %");
    Chart {
        title: "Reading of 1 N after cycles of 1 N".to_owned(),
        series: vec![series(String::new(), values, SeriesLook::LineAndPoints)],
        guides: vec![GuideLine { at: GuidePlace::X(50_001.0), label: "50,000".to_owned() }],
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

#[cfg(test)]
mod tests {
    use super::super::fixture::{press, pressed, series as rows, table, unloaded};
    use super::*;
    use tactpad_core::pad::influence::MAPS;
    use tactpad_core::tables::measured::Row;

    /// Corners of the series with this name.
    fn values<'c>(chart: &'c Chart, name: &str) -> &'c [Value] {
        &chart.series.iter().find(|series| series.name == name).unwrap().values
    }

    #[test]
    fn the_place_with_most_loads_is_drawn_beside_its_simulation() {
        let signals = InfluenceField::sampled(5.0, 29.0, 30.0, |_| {
            std::array::from_fn::<f64, MAPS, _>(|map| if map % 3 == 2 { 100.0 } else { 0.0 })
        });
        let off_centre = |fz_n: f64, uv: f64| {
            let row = pressed(fz_n, uv);
            Row { label: Label { x_mm: 9.0, ..row.label }, ..row }
        };
        let few = [off_centre(1.0, 20.0), off_centre(2.0, 40.0)];
        let ramp = rows(0, 45.0, 12.0, |t_s| {
            (press((t_s - 1.0).clamp(0.0, 5.0)), 7.0 + 90.0 * (t_s - 1.0).clamp(0.0, 5.0))
        });
        let chart = by_force(&table([unloaded(7.0)].into_iter().chain(few).chain(ramp)), &signals).unwrap();
        assert_eq!(chart.title, "Simulation and measurement at 0.0, 0.0 mm");
        let (measured, simulated) = (values(&chart, "m2z measured"), values(&chart, "m2z simulated"));
        assert_eq!(measured.len(), 21);
        for (measured, simulated) in measured.iter().zip(simulated) {
            // The start of the ramp, below 0.1 N, counts as its zero.
            assert!((measured.y - 90.0 * measured.x).abs() < 2.0, "{measured:?}");
            assert!((simulated.y - 100.0 * simulated.x).abs() < 1e-3, "{simulated:?}");
        }
        assert!(by_force(&table([unloaded(0.0), pressed(1.0, 1.0)]), &signals).is_none());
    }

    #[test]
    fn places_are_drawn_from_their_mean() {
        let places_mm = vec![[10.0, 5.0], [12.0, 5.0], [11.0, 8.0]];
        let spread = LocationSpread { load_n: 0.5, spread_mm: 2.0, places_mm };
        let chart = by_place_decoded(&[spread]);
        let found: Vec<[f64; 2]> =
            values(&chart, "0.5 N: 2.00 mm").iter().map(|value| [value.x, value.y]).collect();
        assert_eq!(found, [[-1.0, -1.0], [1.0, -1.0], [0.0, 2.0]]);
    }

    #[test]
    fn a_loop_is_drawn_as_what_it_adds() {
        let branch =
            |added_n: f64| (0..100).map(|k| [0.05 * f64::from(k), 0.05 * f64::from(k) + added_n]).collect();
        let hysteresis =
            Hysteresis { share: 0.031, trials: 10, loading: branch(-0.01), unloading: branch(0.02) };
        let chart = by_loop(&hysteresis);
        assert_eq!(chart.title, "Hysteresis: 3.1 % of 5 N");
        assert!(values(&chart, "loading").iter().all(|value| (value.y + 10.0).abs() < 1e-9));
        assert!(values(&chart, "unloading").iter().all(|value| (value.y - 20.0).abs() < 1e-9));
        assert_eq!(values(&chart, "loading").len(), 26);
    }

    #[test]
    fn cycles_and_temperatures_are_drawn_as_they_are() {
        let ageing = Ageing { change_share: -0.19, curve: vec![[0.0, 0.0], [50_000.0, -0.19]] };
        assert_eq!(by_cycles(&ageing).series[0].values, [Value::new(1.0, 0.0), Value::new(50_001.0, -19.0)]);
        let readings = vec![(-10.0, [1.0; CHANNELS]), (50.0, [2.0; CHANNELS])];
        let drift = ThermalDrift {
            uv_per_10_c: 0.0,
            slope_uv_per_c: [0.0; CHANNELS],
            nonlinearity_share: 0.0,
            readings,
        };
        assert_eq!(values(&by_temperature(&drift), "m2z"), [Value::new(-10.0, 1.0), Value::new(50.0, 2.0)]);
        assert_eq!(by_temperature(&drift).series.len(), CHANNELS);
    }
}
