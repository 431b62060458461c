//! The paper's Figure 2d and 2e, from the device file: half-bridges, gauges on the film, films under the plate.

use tactpad::pad::device::pose::Pose;
use tactpad::pad::device::{Device, Direction, Gauge};
use tactpad::pad::wiring::{HALF_BRIDGES, HalfBridge, gauge_name};
use tactpad::plot::colour::Rgb;
use tactpad::plot::figure::{Anchor, Circle, Ends, Figure, Ink, Mark, Path, Point, Stroke, Text};
use tactpad::plot::plan::Plan;
use tactpad::plot::shape::{PaintStyle, Shape};
use tactpad::quantity::{CHANNEL_NAMES, MODULES};

pub(super) const DARK: Rgb = Rgb::new(0x1f, 0x24, 0x2b);
const PALE: Rgb = Rgb::new(0x9a, 0xa2, 0xab);
pub(super) const QUIET: Rgb = Rgb::new(0x52, 0x5b, 0x66);
const POST: Rgb = Rgb::new(0xf4, 0xef, 0xdf);
const EPOXY: Rgb = Rgb::new(0xec, 0xee, 0xf1);
pub(super) const INK: Ink = Ink::opaque(DARK);
pub(super) const WIRE: Stroke = Stroke::solid(DARK, 1.3);
pub(super) const TITLE_SIZE: f64 = 13.0;
pub(super) const TEXT_SIZE: f64 = 11.0;
pub(super) const NOTE_LINE: f64 = 16.0;
pub(super) const MARGIN: f64 = 14.0;

/// Bridges, gauges and modules, with the names of their files.
pub(super) fn of(device: &Device) -> [(&'static str, Figure); 3] {
    [("wiring-bridges", bridges(device)), ("wiring-film", film(device)), ("wiring-plate", plate(device))]
}

/// Places of the circuit diagram, in pixels.
const LEFT: f64 = 78.0;
const BRIDGE_WIDTH: f64 = 96.0;
const MODULE_GAP: f64 = 26.0;
const SUPPLY_Y: f64 = 84.0;
const TAP_Y: f64 = 214.0;
const GROUND_Y: f64 = 320.0;
const RESISTOR: [f64; 2] = [15.0, 40.0];

/// The half-bridges of all modules, with their channels at the taps.
fn bridges(device: &Device) -> Figure {
    let title = format!("Half-bridges of {}", device.name);
    let per_module = HALF_BRIDGES.len() as f64 * BRIDGE_WIDTH;
    let right = LEFT + MODULES as f64 * per_module + (MODULES - 1) as f64 * MODULE_GAP;
    let notes = [
        "V: a tap’s voltage against ground. A channel is what its label says; it depends on the excitation δ only as a factor.".to_owned(),
        format!("With r = ΔR/R, to first order: {}.", first_order()),
        "A converter with two inputs takes δ/2 from two equal resistors, common to all taps.".to_owned(),
    ];
    let height = GROUND_Y + 62.0 + notes.len() as f64 * NOTE_LINE;
    let mut figure = Figure::new(right + MARGIN, height, title.clone());
    figure.text(Text::new(title, [MARGIN, MARGIN + TITLE_SIZE], TITLE_SIZE, INK).semi_bold());
    rails(&mut figure, device.circuit.excitation_v, right);
    for (channel, channel_name) in CHANNEL_NAMES.into_iter().enumerate() {
        let (module, axis) = (channel / 3, channel % 3);
        let left = LEFT + module as f64 * (per_module + MODULE_GAP);
        if axis == 0 {
            let at = [left + 0.5 * per_module, SUPPLY_Y - 18.0];
            let text = Text::new(format!("module {module}"), at, TEXT_SIZE, INK).anchored(Anchor::Middle);
            figure.text(text.semi_bold());
        }
        let x = left + (axis as f64 + 0.42) * BRIDGE_WIDTH;
        half_bridge(&mut figure, device, &HALF_BRIDGES[axis], channel_name, x);
    }
    for (line, note) in (1_u32..).zip(notes) {
        let at = [MARGIN, GROUND_Y + 42.0 + f64::from(line) * NOTE_LINE];
        figure.text(Text::new(note, at, TEXT_SIZE, INK));
    }
    figure
}

/// The signals as sums of r, such as x = δ (r1 − r2).
fn first_order() -> String {
    let signal = |bridge: &HalfBridge| {
        let mut sum = String::new();
        for (gauge, sign) in bridge.signs().into_iter().enumerate().filter(|(_, sign)| *sign != 0.0) {
            sum += match (sum.is_empty(), sign > 0.0) {
                (true, true) => "",
                (true, false) => "−",
                (false, true) => " + ",
                (false, false) => " − ",
            };
            sum += &format!("r_{{{}}}", gauge + 1);
        }
        format!("{} = δ ({sum})", bridge.axis)
    };
    HALF_BRIDGES.iter().map(signal).collect::<Vec<_>>().join(", ")
}

/// Excitation and ground, to which all half-bridges are joined.
fn rails(figure: &mut Figure, excitation_v: f64, right: f64) {
    let from = LEFT - 6.0;
    let lines = [SUPPLY_Y, GROUND_Y].map(|y| vec![[from, y], [right, y]]);
    figure.path(Path::strokes(lines.to_vec(), WIRE));
    terminal(figure, [from, SUPPLY_Y]);
    let middle = 0.36 * TEXT_SIZE;
    let at = [from - 8.0, SUPPLY_Y + middle];
    figure.text(Text::new(format!("δ = {excitation_v} V"), at, TEXT_SIZE, INK).anchored(Anchor::End));
    figure.text(Text::new("ground", [from - 8.0, GROUND_Y + middle], TEXT_SIZE, INK).anchored(Anchor::End));
    let bar = |step: f64| {
        let (y, half) = (GROUND_Y + 10.0 + 4.0 * step, 9.0 - 3.0 * step);
        vec![[from - half, y], [from + half, y]]
    };
    let lines = vec![vec![[from, GROUND_Y], [from, GROUND_Y + 10.0]], bar(0.0), bar(1.0), bar(2.0)];
    figure.path(Path::strokes(lines, WIRE));
}

/// One divider at this x, with its tap and its channel.
fn half_bridge(figure: &mut Figure, device: &Device, bridge: &HalfBridge, channel: &str, x: f64) {
    divider(figure, device, bridge, x, [SUPPLY_Y, TAP_Y, GROUND_Y]);
    for y in [SUPPLY_Y, TAP_Y, GROUND_Y] {
        node(figure, [x, y]);
    }
    let end = [x + 24.0, TAP_Y];
    figure.path(Path::strokes(vec![vec![[x, TAP_Y], end]], WIRE));
    terminal(figure, end);
    let beside = [end[0] + 8.0, TAP_Y + 0.36 * TEXT_SIZE];
    figure.text(Text::new(channel, beside, TEXT_SIZE, INK).semi_bold());
    let sign = if bridge.polarity < 0.0 { "−" } else { "" };
    let reads = Text::new(format!("{sign}4 (V − δ/2)"), [x, GROUND_Y + 22.0], TEXT_SIZE, INK);
    figure.text(reads.anchored(Anchor::Middle));
}

/// Wires that are joined.
pub(super) fn node(figure: &mut Figure, centre: Point) {
    figure.add(Mark::Circle(Circle { centre, radius: 2.4, fill: Some(INK), stroke: None }));
}

/// The gauges of a half-bridge at this x, from supply to tap to ground.
pub(super) fn divider(
    figure: &mut Figure,
    device: &Device,
    bridge: &HalfBridge,
    x: f64,
    [supply_y, tap_y, ground_y]: [f64; 3],
) {
    let sides = [(bridge.to_supply, supply_y, tap_y), (bridge.to_ground, tap_y, ground_y)];
    for (gauges, from, to) in sides {
        let step = (to - from) / gauges.len() as f64;
        let mut wire = from;
        for (place, gauge) in gauges.iter().enumerate() {
            let middle = from + (place as f64 + 0.5) * step;
            let [top, bottom] = [middle - 0.5 * RESISTOR[1], middle + 0.5 * RESISTOR[1]];
            figure.path(Path::strokes(vec![vec![[x, wire], [x, top]]], WIRE));
            resistor(figure, *gauge, &device.gauges[*gauge], [x, middle]);
            wire = bottom;
        }
        figure.path(Path::strokes(vec![vec![[x, wire], [x, to]]], WIRE));
    }
}

/// A resistor about its middle: its gauge on the left, its resistance on the right.
fn resistor(figure: &mut Figure, number: usize, gauge: &Gauge, [x, y]: Point) {
    let corner = [x - 0.5 * RESISTOR[0], y - 0.5 * RESISTOR[1]];
    figure.path(Path { stroke: Some(WIRE), ..Path::rectangle(corner, RESISTOR) });
    let baseline = y + 0.36 * TEXT_SIZE;
    let name =
        Text::new(gauge_name(number), [corner[0] - 5.0, baseline], TEXT_SIZE, INK).anchored(Anchor::End);
    figure.text(name);
    let at = [corner[0] + RESISTOR[0] + 5.0, baseline];
    figure.text(Text::new(resistance(gauge.resistance_ratio), at, TEXT_SIZE, Ink::opaque(QUIET)));
}

/// A resistance as a share of R.
fn resistance(ratio: f64) -> String {
    if ratio == 1.0 {
        "R".to_owned()
    } else if ratio == 0.5 {
        "R/2".to_owned()
    } else {
        format!("{ratio} R")
    }
}

/// An open end of a wire.
pub(super) fn terminal(figure: &mut Figure, centre: Point) {
    let (fill, stroke) = (Some(Ink::opaque(Rgb::WHITE)), Some(WIRE));
    figure.add(Mark::Circle(Circle { centre, radius: 3.4, fill, stroke }));
}

/// Grid lines of a gauge, as many as can be told apart.
const GRID_LINES: u32 = 6;

/// How far labels stand from their gauges, in millimetres.
const LABEL_GAP_MM: f64 = 0.14;

/// The film from below, where the gauges are, true to scale.
fn film(device: &Device) -> Figure {
    let half_mm = film_half_mm(device);
    let window_mm = half_mm.map(|half| half - device.stack.frame_width_mm);
    let post_mm = [device.stack.post_length_x_mm, device.stack.post_width_y_mm];
    let rectangle = |half: [f64; 2], look| Shape::Rectangle {
        centre: [0.0; 2],
        size: half.map(|half| 2.0 * half),
        turn_deg: 0.0,
        look,
    };
    let filled = |colour, stroke| PaintStyle { fill: Some(Ink::opaque(colour)), stroke: Some(stroke) };
    let mut shapes = vec![
        rectangle(half_mm, filled(EPOXY, Stroke::solid(DARK, 1.2))),
        rectangle(window_mm, filled(Rgb::WHITE, Stroke::solid(PALE, 0.9))),
        rectangle(post_mm.map(|side| 0.5 * side), PaintStyle::fill(Ink::opaque(POST))),
    ];
    for (number, gauge) in device.gauges.iter().enumerate() {
        let half = half_of(gauge);
        shapes.extend(grid(number, gauge));
        let place = [gauge.x_mm, gauge.y_mm - half[1] - LABEL_GAP_MM];
        shapes.push(Shape::Label { place, text: gauge_name(number) });
    }
    let [x, y] = half_mm.map(|half| [-half, half]);
    let plan = Plan {
        title: format!("Gauges of {} on the film, seen from below", device.name),
        x,
        y,
        x_label: "x, mm: along the tangent, counter-clockwise seen from above".to_owned(),
        y_label: "y, mm: outwards".to_owned(),
        field: None,
        shapes,
    };
    let colours = HALF_BRIDGES.map(|bridge| {
        let gauges: Vec<String> =
            (0..device.gauges.len()).filter(|g| bridge.has(*g)).map(gauge_name).collect();
        format!("{}: {}", bridge.axis, gauges.join(", "))
    });
    let colours: Vec<(String, Ink)> = colours
        .into_iter()
        .enumerate()
        .map(|(axis, text)| (text, Ink::opaque(Rgb::of_series(axis))))
        .collect();
    let note = "Lines of a gauge run along its grid. Grey: the frame; yellow: the post on the other side.";
    noted(plan.figure(760.0), &colours, note)
}

/// A gauge with its grid, in the colour of its half-bridge.
fn grid(number: usize, gauge: &Gauge) -> [Shape; 2] {
    let axis = HALF_BRIDGES.iter().position(|bridge| bridge.has(number)).unwrap_or_default();
    let colour = Rgb::of_series(axis);
    let half = half_of(gauge);
    let outline = Shape::Rectangle {
        centre: [gauge.x_mm, gauge.y_mm],
        size: half.map(|half| 2.0 * half),
        turn_deg: 0.0,
        look: PaintStyle::line(Stroke::solid(colour, 0.7)),
    };
    let (along, across) = match gauge.direction {
        Direction::X => (0, 1),
        Direction::Y => (1, 0),
    };
    // There and back, as the foil is etched.
    let corner = |line: u32, end: f64| {
        let share = (2.0 * f64::from(line) + 1.0) / f64::from(GRID_LINES) - 1.0;
        let mut at = [gauge.x_mm, gauge.y_mm];
        at[along] += 0.88 * end * half[along];
        at[across] += share * half[across];
        at
    };
    let ends = |line: u32| if line.is_multiple_of(2) { [-1.0, 1.0] } else { [1.0, -1.0] };
    let corners = (0..GRID_LINES).flat_map(|line| ends(line).map(|end| corner(line, end))).collect();
    [outline, Shape::Line { corners, ends: Ends::Open, look: PaintStyle::line(Stroke::solid(colour, 1.6)) }]
}

/// The films under the plate, seen from above.
fn plate(device: &Device) -> Figure {
    let radius_mm = device.plate.radius_mm();
    let mut shapes = vec![Shape::Circle {
        centre: [0.0; 2],
        radius: radius_mm,
        look: PaintStyle::line(Stroke::solid(DARK, 1.2)),
    }];
    for (index, pose) in device.poses().iter().enumerate() {
        shapes.extend(module(device, index, pose));
    }
    let plan = Plan {
        title: format!("Modules of {} under the plate, seen from above", device.name),
        x: [-radius_mm, radius_mm],
        y: [-radius_mm, radius_mm],
        x_label: "x, mm".to_owned(),
        y_label: "y, mm".to_owned(),
        field: None,
        shapes,
    };
    let note = "Gauges lie on the films’ undersides: from above they are seen through the film.";
    noted(plan.figure(520.0), &[], note)
}

/// A module's film with its gauges, its number, and the names of the gauges at both ends.
fn module(device: &Device, index: usize, pose: &Pose) -> Vec<Shape> {
    let half_mm = film_half_mm(device);
    let place = |[x, y]: [f64; 2]| -> [f64; 2] {
        std::array::from_fn(|axis| pose.centre_mm[axis] + x * pose.along_x[axis] + y * pose.along_y[axis])
    };
    let closed = |corners: Vec<[f64; 2]>, stroke| Shape::Line {
        corners,
        ends: Ends::Closed,
        look: PaintStyle::line(stroke),
    };
    let mut shapes = vec![closed(pose.corners_mm(half_mm).to_vec(), Stroke::solid(DARK, 1.0))];
    for (number, gauge) in device.gauges.iter().enumerate() {
        let [x, y] = half_of(gauge);
        let corners = [[x, y], [-x, y], [-x, -y], [x, -y]];
        let corners = corners.map(|[x, y]| place([gauge.x_mm + x, gauge.y_mm + y]));
        let axis = HALF_BRIDGES.iter().position(|bridge| bridge.has(number)).unwrap_or_default();
        shapes.push(closed(corners.to_vec(), Stroke::solid(Rgb::of_series(axis), 1.2)));
    }
    let by_x = |one: &(usize, &Gauge), other: &(usize, &Gauge)| one.1.x_mm.total_cmp(&other.1.x_mm);
    let gauges = || device.gauges.iter().enumerate();
    for (end, side) in [(gauges().min_by(by_x), -1.0), (gauges().max_by(by_x), 1.0)] {
        if let Some((number, gauge)) = end {
            let at = place([side * (half_mm[0] + 1.5), gauge.y_mm]);
            shapes.push(Shape::Label { place: at, text: gauge_name(number) });
        }
    }
    let text = format!("module {index}");
    shapes.push(Shape::Label { place: place([0.0, -half_mm[1] - 3.6]), text });
    shapes
}

/// A figure with coloured words and a note under it.
fn noted(figure: Figure, words: &[(String, Ink)], note: &str) -> Figure {
    let [width, height] = figure.size();
    let lines = if words.is_empty() { 1.0 } else { 2.0 };
    let mut page = Figure::new(width, height + (lines + 0.6) * NOTE_LINE, figure.description().to_owned());
    page.place(figure, [0.0, 0.0]);
    let mut x = MARGIN;
    for (word, ink) in words {
        let text = Text::new(format!("half-bridge {word}"), [x, height + 0.9 * NOTE_LINE], TEXT_SIZE, *ink)
            .semi_bold();
        x += text.width() + 24.0;
        page.text(text);
    }
    page.text(Text::new(note, [MARGIN, height + (lines - 0.1) * NOTE_LINE], TEXT_SIZE, INK));
    page
}

/// Half a gauge's sizes along the module's x and y.
fn half_of(gauge: &Gauge) -> [f64; 2] {
    let [along, across] = [0.5 * gauge.length_mm, 0.5 * gauge.width_mm];
    match gauge.direction {
        Direction::X => [along, across],
        Direction::Y => [across, along],
    }
}

fn film_half_mm(device: &Device) -> [f64; 2] {
    [device.stack.film_length_x_mm, device.stack.film_width_y_mm].map(|side| 0.5 * side)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texts(figure: &Figure) -> Vec<&Text> {
        let marks = figure.marks().iter();
        marks.filter_map(|mark| if let Mark::Text(text) = mark { Some(text) } else { None }).collect()
    }

    #[test]
    fn every_channel_and_every_gauge_is_in_the_diagram() {
        let figure = bridges(&Device::nominal());
        let texts = texts(&figure);
        let count = |wanted: &str| texts.iter().filter(|text| text.text == wanted).count();
        assert!(CHANNEL_NAMES.iter().all(|channel| count(channel) == 1));
        assert!((0..7).all(|gauge| count(&gauge_name(gauge)) == MODULES));
        assert_eq!((count("R"), count("R/2")), (5 * MODULES, 2 * MODULES));
        let notes = texts.iter().find(|text| text.text.contains("first order")).unwrap();
        assert!(notes.text.contains("z = δ (r_{5} + r_{6} − r_{7})"), "{}", notes.text);
    }

    #[test]
    fn in_series_from_the_supply_down() {
        let figure = bridges(&Device::nominal());
        let y = |wanted: &str| texts(&figure).iter().find(|text| text.text == wanted).unwrap().at[1];
        assert!(y("R5") < y("R6") && y("R6") < y("m0z") && y("m0z") < y("R7"));
        assert!(y("R2") < y("m0x") && y("m0x") < y("R1"));
    }

    #[test]
    fn the_film_is_true_to_scale() {
        let device = Device::nominal();
        let figure = film(&device);
        let rectangles: Vec<&Path> = figure
            .marks()
            .iter()
            .filter_map(|mark| match mark {
                Mark::Path(path) if path.ends == Ends::Closed => Some(path),
                _ => None,
            })
            .collect();
        let width = |path: &Path| {
            path.lines[0].iter().map(|at| at[0]).fold(f64::MIN, f64::max)
                - path.lines[0].iter().map(|at| at[0]).fold(f64::MAX, f64::min)
        };
        // Film, window and post, then the gauges.
        let per_mm = width(rectangles[0]) / device.stack.film_length_x_mm;
        assert!((width(rectangles[2]) - 2.0 * per_mm).abs() < 1e-9);
        let gauges = device.gauges.map(|gauge| 2.0 * half_of(&gauge)[0] * per_mm);
        for (path, wanted) in rectangles[3..].iter().zip(gauges) {
            assert!((width(path) - wanted).abs() < 1e-9);
        }
    }
}
