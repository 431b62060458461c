//! Figures of a layout study: the scan over radius and turn, and the effective regions under the plate.

use super::module_count::{ModuleCounts, Ringed, Wiring, load_sharing};
use super::placement::{Candidate, Placement};
use super::precision::Precision;
use super::spacing::Radii;
use super::study::{Simulated, SpacingAnswers};
use super::swarm;
use tactpad_core::pad::device::Device;
use tactpad_core::pad::device::pose::Pose;
use tactpad_core::quantity::MODULES;
use tactpad_plot::chart::{Chart, GuideLine, GuidePlace, Series, SeriesLook, Side, Value};
use tactpad_plot::colour::Rgb;
use tactpad_plot::figure::{Ends, Figure, Ink, Stroke, Text};
use tactpad_plot::plan::Plan;
use tactpad_plot::scale::Scale;
use tactpad_plot::shape::{PaintStyle, Shape};

const WIDTH: f64 = 480.0;
const HEIGHT: f64 = 360.0;
const PLAN_WIDTH: f64 = 560.0;
const NOTE_SIZE: f64 = 10.0;
const NOTE_LINE: f64 = 15.0;
const NOTES: [&str; 3] = [
    "Lines: the isolines, each in the colour of its module’s circle; they end where contacts do.",
    "Dashed circles: what the paper’s rule takes them for, with their mean distance as radius.",
    "Rectangles: the modules as built (dark), by the paper’s rule (grey), with the smallest worst error (dotted).",
];
const DARK: Rgb = Rgb::new(0x1f, 0x24, 0x2b);
const PALE: Rgb = Rgb::new(0x9a, 0xa2, 0xab);

/// Location errors over the modules' radius, and beside them what they cost: the largest signal.
pub fn scan(pad: &Simulated) -> Figure {
    let [_, _, fz] = pad.press_n;
    let press = format!("press of {fz} N, noise {} µV", pad.noise_uv);
    let errors =
        chart(pad, format!("Location error at best, {press}"), "Worst error over the plate, mm", |found| {
            found.worst_mm
        });
    let signals =
        chart(pad, format!("Largest signal, {press}"), "Largest signal of any channel, µV", |found| {
            found.largest_uv
        });
    let mut both = Figure::new(2.0 * WIDTH, HEIGHT, "Location error and largest signal by module radius");
    both.place(errors, [0.0, 0.0]);
    both.place(signals, [WIDTH, 0.0]);
    both
}

/// Swarms whose courses are drawn.
const SWARMS: u64 = 6;

/// The paper's Figure 1b: the best cost of swarms after each iteration. On the left they
/// look for the distances, with a penalty for what breaks the rule; on the right for layouts that keep it, as the study
/// does. The seeds are `first_seed` and the next ones.
pub fn swarms(radii: &Radii, first_seed: u64) -> Figure {
    let optimum_mm2 = radii.widest().area_mm2;
    let [r1, r2, r3] = radii.mm();
    let penalised = Chart {
        title: format!("Swarms over the distances, radii {r1:.1}, {r2:.1}, {r3:.1} mm"),
        ..costs(radii, first_seed, swarm::penalised_costs)
    };
    let ruled = Chart {
        title: "Swarms over layouts that keep the rule".to_owned(),
        guides: vec![GuideLine { at: GuidePlace::Y(-optimum_mm2), label: "closed form".to_owned() }],
        ..costs(radii, first_seed, swarm::costs)
    };
    let mut both = Figure::new(2.0 * WIDTH, HEIGHT, "Best cost of the particle swarm by iteration");
    both.place(Chart { guides: ruled.guides.clone(), ..penalised }.figure(), [0.0, 0.0]);
    both.place(ruled.figure(), [WIDTH, 0.0]);
    both
}

/// The best cost of each of a swarm's rounds, for a seed.
type SwarmCosts = fn(&Radii, u64) -> Vec<f64>;

/// The best costs of one kind of swarms by iteration, a curve for each seed.
fn costs(radii: &Radii, first_seed: u64, of: SwarmCosts) -> Chart {
    let curve = |seed: u64| {
        let costs_mm2 = of(radii, seed);
        let values = (1_u32..).zip(costs_mm2).map(|(round, cost)| Value::new(f64::from(round), cost));
        Series { name: format!("seed {seed}"), values: values.collect(), look: SeriesLook::Line }
    };
    let seeds = (0..SWARMS).map(|number| first_seed.saturating_add(number));
    Chart {
        title: String::new(),
        width: WIDTH,
        height: HEIGHT,
        x: Side { scale: Scale::Log10, ..side("Iteration") },
        y: side("Best cost: −area, mm²"),
        series: seeds.map(curve).collect(),
        guides: vec![],
    }
}

/// One figure of merit over the modules' radius: a curve for the least and the greatest turn.
fn chart(pad: &Simulated, title: String, label: &str, merit: fn(&Precision) -> f64) -> Figure {
    let range = pad.search.range;
    let curve = |step: usize| {
        let rows = pad.search.grid.chunks(range.rotation_steps + 1);
        let row: Vec<&Candidate> = rows.filter_map(|row| row.get(step)).collect();
        let turn_deg = row.first().map_or(0.0, |candidate| candidate.placement.rotation_deg);
        let values = row.into_iter().filter_map(|candidate| value(candidate, merit)).collect();
        Series { name: format!("turned {turn_deg}°"), values, look: SeriesLook::Line }
    };
    let point = |name: &str, candidate: &Candidate| Series {
        name: name.to_owned(),
        values: value(candidate, merit).into_iter().collect(),
        look: SeriesLook::Points,
    };
    let mut series = [0, range.rotation_steps].map(curve).to_vec();
    series.push(point("as built", &pad.as_built));
    series.extend(pad.search.best.as_ref().map(|best| point("smallest worst error", best)));
    let rule_mm = pad.by_rule.placement.centre_radius_mm;
    let chart = Chart {
        title,
        width: WIDTH,
        height: HEIGHT,
        x: side("Radius of the module centres, mm"),
        y: Side { also: vec![0.0], ..side(label) },
        series,
        guides: vec![GuideLine {
            at: GuidePlace::X(rule_mm),
            label: format!("the paper’s rule, {rule_mm:.1} mm"),
        }],
    };
    chart.figure()
}

fn value(candidate: &Candidate, merit: fn(&Precision) -> f64) -> Option<Value> {
    let found = candidate.precision.as_ref()?;
    Some(Value::new(candidate.placement.centre_radius_mm, merit(found)))
}

fn side(label: &str) -> Side {
    Side { label: label.to_owned(), scale: Scale::Linear, also: vec![] }
}

/// Worst location errors over the number of modules: half-bridges and gauges, with all modules read and without one;
/// and how three modules' error would grow if more of them only shared the load. An error as large as the plate is
/// left out: there nothing is located.
pub fn module_counts(counts: &ModuleCounts) -> Figure {
    let worst: fn(&Ringed) -> f64 = |row| row.precision.worst_mm;
    let one_lost: fn(&Ringed) -> f64 = |row| row.worst_without_one_mm;
    let curve = |name: &str, wiring: Wiring, error_mm: fn(&Ringed) -> f64| {
        let rows = counts.rows.iter().filter(|row| row.wiring == wiring);
        let values = rows.map(|row| Value::new(row.modules as f64, error_mm(row)));
        let values = values.filter(|value| value.y < counts.plate_radius_mm).collect();
        Series { name: name.to_owned(), values, look: SeriesLook::LineAndPoints }
    };
    let [_, _, fz] = counts.press_n;
    let chart = Chart {
        title: format!("Location error at best, press of {fz} N, noise {} µV", counts.noise_uv),
        width: WIDTH,
        height: HEIGHT,
        x: side("Modules at equal angles"),
        y: Side { also: vec![0.0], ..side("Worst error over the plate, mm") },
        series: vec![
            curve("half-bridges", Wiring::Bridges, worst),
            curve("half-bridges, one module not read", Wiring::Bridges, one_lost),
            curve("every gauge alone", Wiring::Gauges, worst),
            curve("every gauge alone, one module not read", Wiring::Gauges, one_lost),
            sharing(counts),
        ],
        guides: vec![],
    };
    chart.figure()
}

/// The three modules' half-bridges, if more of them only shared the load.
fn sharing(counts: &ModuleCounts) -> Series {
    let three = counts.rows.iter().find(|row| row.modules == MODULES && row.wiring == Wiring::Bridges);
    let most = counts.rows.iter().map(|row| row.modules).max().unwrap_or(MODULES);
    let shared = |of_three: &Ringed, modules: usize| {
        Value::new(modules as f64, of_three.precision.worst_mm * load_sharing(modules))
    };
    let values = three.map(|row| (MODULES..=most).map(|modules| shared(row, modules)).collect());
    Series {
        name: "if n modules only shared the load: √(n/3)".to_owned(),
        values: values.unwrap_or_default(),
        look: SeriesLook::Dashes,
    }
}

/// The plate with its modules, their isolines, and the circles of the same mean radius that the paper's rule needs.
pub fn regions(pad: &Simulated, spacing: &SpacingAnswers, device: &Device) -> Figure {
    let radius = device.plate.radius_mm();
    let mut shapes =
        vec![Shape::Circle { centre: [0.0; 2], radius, look: PaintStyle::line(Stroke::solid(DARK, 1.2)) }];
    for (module, pose) in device.poses().iter().enumerate() {
        let colour = Rgb::of_series(module);
        let circle = Stroke::solid(colour, 0.9).dashed(4.0, 3.0);
        let (centre, radius) = (pose.centre_mm, spacing.radii_mm[module]);
        shapes.push(Shape::Circle { centre, radius, look: PaintStyle::line(circle) });
        // A direction without a place breaks the line.
        let corners = pad.outlines[module].iter().map(|place| place.unwrap_or([f64::NAN; 2])).collect();
        let look = PaintStyle::line(Stroke::solid(colour, 1.8));
        shapes.push(Shape::Line { corners, ends: Ends::Open, look });
    }
    shapes.extend(moved(device, &pad.by_rule.placement, Stroke::solid(PALE, 1.0)));
    if let Some(best) = &pad.search.best {
        shapes.extend(moved(device, &best.placement, Stroke::solid(PALE, 1.0).dashed(2.0, 2.0)));
    }
    shapes.extend(footprints(device, PaintStyle::line(Stroke::solid(DARK, 1.2))));
    let far_mm = |(pose, radius_mm): (&Pose, f64)| pose.centre_mm[0].hypot(pose.centre_mm[1]) + radius_mm;
    let reach = device.poses().iter().zip(spacing.radii_mm).map(far_mm).fold(radius, f64::max).ceil();
    let plan = Plan {
        title: format!("Where a module carries {} % of a press", 100.0 * pad.threshold),
        x: [-reach, reach],
        y: [-reach, reach],
        x_label: "x, mm".to_owned(),
        y_label: "y, mm".to_owned(),
        field: None,
        shapes,
    };
    with_notes(plan.figure(PLAN_WIDTH), &NOTES)
}

/// A figure with lines of text under it.
fn with_notes(figure: Figure, notes: &[&str]) -> Figure {
    let [width, height] = figure.size();
    let mut page =
        Figure::new(width, height + (notes.len() + 1) as f64 * NOTE_LINE, figure.description().to_owned());
    page.place(figure, [0.0, 0.0]);
    for (line, note) in (1..).zip(notes) {
        let at = [NOTE_LINE, height + f64::from(line) * NOTE_LINE];
        page.text(Text::new(*note, at, NOTE_SIZE, Ink::opaque(DARK)));
    }
    page
}

/// The outlines of the modules, placed otherwise if that can be built.
fn moved(device: &Device, placement: &Placement, stroke: Stroke) -> Vec<Shape> {
    placement.on(device).map_or(vec![], |device| footprints(&device, PaintStyle::line(stroke)))
}

fn footprints(device: &Device, look: PaintStyle) -> Vec<Shape> {
    let half_mm = [device.stack.film_length_x_mm, device.stack.film_width_y_mm].map(|side| 0.5 * side);
    let outline =
        |pose: &Pose| Shape::Line { corners: pose.corners_mm(half_mm).to_vec(), ends: Ends::Closed, look };
    device.poses().iter().map(outline).collect()
}
