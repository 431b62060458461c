//! Figures as a reader sees them.
//!
//! Every figure is also written to `figures/` in the tests' temporary folder, for people to look at.
#![expect(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use std::fs;
use std::path::{Path, PathBuf};

use proptest::prelude::*;
use tactpad::pad::field::PadField;
use tactpad::pad::influence::InfluenceField;
use tactpad::plot::bands::Bands;
use tactpad::plot::chart::{Chart, GuideLine, GuidePlace, Series, SeriesLook, Side, Value};
use tactpad::plot::colour::Rgb;
use tactpad::plot::figure::{Ends, Figure, Ink, Stroke};
use tactpad::plot::grid::Grid;
use tactpad::plot::isoline::Isolines;
use tactpad::plot::multiples::{Bars, Multiples};
use tactpad::plot::plan::{Field, Plan};
use tactpad::plot::scale::Scale;
use tactpad::plot::shape::{PaintStyle, Shape};
use tactpad::plot::{png, svg};
use tactpad::quantity::{CHANNEL_NAMES, Contact};

const DARK: Rgb = Rgb::new(0x1f, 0x24, 0x2b);

/// Writes a figure for people to look at, checks that both formats hold it, and gives the SVG.
fn shown(name: &str, figure: &Figure) -> String {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("figures");
    fs::create_dir_all(&folder).unwrap();
    let text = svg::text(figure);
    let picture = png::bytes(figure, 2.0).unwrap();
    fs::write(folder.join(name).with_extension("svg"), &text).unwrap();
    fs::write(folder.join(name).with_extension("png"), &picture).unwrap();
    let decoded = tiny_skia::Pixmap::decode_png(&picture).unwrap();
    let size = figure.size().map(|side| 2 * side as u32);
    assert_eq!([decoded.width(), decoded.height()], size, "{name}");
    text
}

/// Compares with a stored figure.
fn assert_as_stored(name: &str, figure: &Figure) {
    let text = shown(name, figure);
    assert!(text.len() < 20_000, "{name}: {} bytes", text.len());
    let stored =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/program/plot").join(name).with_extension("svg");
    let stored = fs::read_to_string(stored).unwrap_or_default();
    assert!(
        text == stored,
        "{name} has changed: look at figures/{name}.png, and store the SVG if it is better"
    );
}

fn footprint(angle_deg: f64) -> Shape {
    let (sin, cos) = angle_deg.to_radians().sin_cos();
    Shape::Rectangle {
        centre: [20.0 * cos, 20.0 * sin],
        size: [5.4, 9.8],
        turn_deg: angle_deg,
        look: PaintStyle::line(Stroke::solid(DARK, 0.8)),
    }
}

/// A channel per newton over the plate; `column` counts channels, and in each the forces.
fn influence(field: &InfluenceField, column: usize, nodes: usize) -> Grid {
    Grid::over_disc(29.0, nodes, |x, y| {
        let mut force = [0.0; 3];
        force[column % 3] = 1.0;
        let [fx_n, fy_n, fz_n] = force;
        let contact = Contact { x_mm: x as f32, y_mm: y as f32, fx_n, fy_n, fz_n };
        f64::from(field.strain_uv(&contact).uv[column / 3])
    })
}

fn plate(title: &str, field: Option<Field>, shapes: Vec<Shape>) -> Plan {
    Plan {
        title: title.to_owned(),
        x: [-30.0, 30.0],
        y: [-30.0, 30.0],
        x_label: "x, mm".to_owned(),
        y_label: "y, mm".to_owned(),
        field,
        shapes,
    }
}

fn modules() -> Vec<Shape> {
    [0.0, 120.0, 240.0].map(footprint).to_vec()
}

fn in_uv(grid: Grid, bands: Bands, isolines: Isolines) -> Field {
    Field { grid, bands, isolines, label: "µV/N".to_owned() }
}

#[test]
fn a_map_over_the_plate() {
    let saddle = Grid::over_disc(29.0, 41, |x, y| 12.0 * x - 0.7 * (x * x - y * y));
    let bands = Bands::diverging(saddle.largest(), 2);
    let field = in_uv(saddle, bands, Isolines::Labelled);
    assert_as_stored("plate", &plate("S_{z} of F_{z}", Some(field), modules()).figure(400.0));
    let grid = influence(&PadField::nominal().signals, 8, 121);
    let field = in_uv(grid, Bands::diverging_decades(2400.0, 2), Isolines::Labelled);
    shown("plate-decades", &plate("m0z per newton of F_{z}", Some(field), modules()).figure(560.0));
}

fn maps(bars: Bars) -> Multiples {
    let field = PadField::nominal().signals;
    let bands = |grid: &Grid| match bars {
        Bars::Shared => Bands::diverging_decades(2400.0, 2),
        Bars::Each => Bands::diverging(grid.largest(), 6),
    };
    let plan = |column: usize| {
        let grid = influence(&field, column, 61);
        let bands = bands(&grid);
        plate("", Some(in_uv(grid, bands, Isolines::None)), modules())
    };
    Multiples {
        title: "Influence of a force on the nine channels".to_owned(),
        note: "Nominal pad, contacts out to 29 mm. Outlines: modules.".to_owned(),
        column_titles: ["x", "y", "z"].map(|axis| format!("per F_{{{axis}}}")).to_vec(),
        row_titles: CHANNEL_NAMES.map(str::to_owned).to_vec(),
        plans: (0..27).map(plan).collect(),
        plan_width: 120.0,
        bars,
    }
}

#[test]
fn the_27_influence_maps_are_small() {
    for (name, bars) in [("maps-shared", Bars::Shared), ("maps-each", Bars::Each)] {
        let text = shown(name, &maps(bars).figure());
        assert!(text.len() < 400_000, "{name}: {} bytes", text.len());
        assert_eq!(text.matches("<circle").count(), 27, "one rim for each plate");
    }
}

#[test]
fn a_map_over_a_film_with_gauges() {
    use std::f64::consts::PI;
    let strain = |x: f64, y: f64| 120.0 * (PI * x / 9.8).cos() * (PI * y / 5.4).cos() * (1.4 * x).sin();
    let grid = Grid::over_rectangle([-4.9, 4.9], [-2.7, 2.7], [197, 109], strain);
    let gauge = |centre: [f64; 2], size: [f64; 2]| Shape::Rectangle {
        centre,
        size,
        turn_deg: 0.0,
        look: PaintStyle::line(Stroke::solid(DARK, 1.0)),
    };
    let bands = Bands::diverging(grid.largest(), 6);
    let plan = Plan {
        title: "Strain ε_{xx} at the film’s underside".to_owned(),
        x: [-4.9, 4.9],
        y: [-2.7, 2.7],
        x_label: "x (tangential), mm".to_owned(),
        y_label: "y (radial), mm".to_owned(),
        field: Some(Field { grid, bands, isolines: Isolines::Labelled, label: "µm/m".to_owned() }),
        shapes: vec![
            gauge([-3.2, 0.0], [1.2, 2.0]),
            gauge([3.2, 0.0], [1.2, 2.0]),
            gauge([0.0, 1.7], [2.0, 1.0]),
            gauge([0.0, -1.7], [2.0, 1.0]),
        ],
    };
    let text = shown("film", &plan.figure(640.0));
    assert!(text.contains("aria-label=\"−100\""), "the isolines carry their values");
}

#[test]
fn a_layout() {
    let (side, dark) = (30.0, Stroke::solid(DARK, 1.2));
    let places = [90.0_f64, 210.0, 330.0].map(|angle_deg| {
        let (sin, cos) = angle_deg.to_radians().sin_cos();
        [side / 3.0_f64.sqrt() * cos, side / 3.0_f64.sqrt() * sin]
    });
    let region = |(index, centre): (usize, [f64; 2])| {
        let colour = Rgb::of_series(index);
        let look = PaintStyle {
            fill: Some(Ink { colour, opacity: 0.12 }),
            stroke: Some(Stroke::solid(colour, 1.2)),
        };
        Shape::Circle { centre, radius: side, look }
    };
    let length = |k: usize| Shape::Dimension {
        from: places[k],
        to: places[(k + 1) % 3],
        text: format!("d_{{{}}} = r", k + 1),
    };
    let mut shapes: Vec<Shape> = places.into_iter().enumerate().map(region).collect();
    shapes.push(Shape::Circle {
        centre: [0.0; 2],
        radius: 30.0,
        look: PaintStyle::line(dark.dashed(4.0, 3.0)),
    });
    shapes.extend((0..3).map(length));
    shapes.push(Shape::Dots {
        places: places.to_vec(),
        radius_px: 3.5,
        look: PaintStyle::fill(Ink::opaque(DARK)),
    });
    shapes.push(Shape::Label { place: [0.0, 42.0], text: "A_{1}".to_owned() });
    let plan = plate("Effective regions of the three modules", None, shapes);
    assert_as_stored("layout", &Plan { x: [-50.0, 50.0], y: [-45.0, 50.0], ..plan }.figure(440.0));
}

fn side(label: &str, scale: Scale) -> Side {
    Side { label: label.to_owned(), scale, also: vec![] }
}

#[test]
fn a_convergence_study() {
    const SIZES_MM: [f64; 4] = [1.0, 0.5, 0.25, 0.125];
    let error = |name: &str, order: f64, percent: f64| {
        let value = |size_mm: f64| {
            let y = percent * size_mm.powf(order);
            Value { x: size_mm, y, y_range: [0.8 * y, 1.2 * y] }
        };
        let (name, values) = (name.to_owned(), SIZES_MM.map(value).to_vec());
        Series { name, values, look: SeriesLook::LineAndPoints }
    };
    let second = SIZES_MM.map(|size_mm| Value::new(size_mm, 4.5 * size_mm * size_mm));
    let second = Series { name: "order 2".to_owned(), values: second.to_vec(), look: SeriesLook::Dashes };
    let chart = Chart {
        title: "Convergence".to_owned(),
        width: 460.0,
        height: 340.0,
        x: side("Element size, mm", Scale::Log10),
        y: side("Error of the strains, %", Scale::Log10),
        series: vec![error("S_{x}", 2.1, 3.0), error("S_{y}", 1.9, 1.6), error("S_{z}", 2.0, 0.7), second],
        guides: vec![GuideLine { at: GuidePlace::Y(0.5), label: "limit 0.5 %".to_owned() }],
    };
    assert_as_stored("convergence", &chart.figure());
}

#[test]
fn a_scan_with_measured_points() {
    let curve = |phase: f64| {
        (0..=48)
            .map(move |k| f64::from(k) / 2.0)
            .map(move |x| Value::new(x, 2.0 - (0.2 * x + phase).sin() * (x - 12.0) * 0.2))
    };
    let measured =
        curve(0.4).step_by(6).map(|value| Value { y_range: [value.y - 0.3, value.y + 0.3], ..value });
    let series = |name: &str, values: Vec<Value>, look| Series { name: name.to_owned(), values, look };
    let mut chart = Chart {
        title: "Location error by module radius".to_owned(),
        width: 460.0,
        height: 300.0,
        x: side("Module radius, mm", Scale::Linear),
        y: side("Worst location error, mm", Scale::Linear),
        series: vec![
            series("0.5 N", curve(0.0).collect(), SeriesLook::Line),
            series("1 N", curve(1.0).collect(), SeriesLook::Line),
            series("measured", measured.collect(), SeriesLook::Points),
        ],
        guides: vec![GuideLine { at: GuidePlace::X(18.0), label: "paper".to_owned() }],
    };
    chart.y.also.push(0.0);
    let text = shown("scan", &chart.figure());
    assert!(["Module radius, mm", "measured", "paper"].iter().all(|name| text.contains(name)));
}

/// Every number of the SVG is finite, and the PNG can be made.
fn assert_drawn(figure: &Figure) {
    let text = svg::text(figure);
    assert!(!text.contains("NaN") && !text.contains("inf"), "{text}");
    assert!(text.starts_with("<svg") && text.ends_with("</svg>\n"));
    assert!(png::bytes(figure, 0.5).is_ok());
}

fn any_value() -> impl Strategy<Value = f64> {
    let special = [0.0, -0.0, 1.0, f64::NAN, f64::INFINITY, f64::NEG_INFINITY, f64::MAX, f64::MIN_POSITIVE];
    prop_oneof![any::<f64>(), -10.0..10.0, prop::sample::select(special.to_vec())]
}

fn any_scale() -> impl Strategy<Value = Scale> {
    prop_oneof![Just(Scale::Linear), Just(Scale::Log10)]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn any_chart_can_be_drawn(
        numbers in prop::collection::vec([any_value(), any_value(), any_value(), any_value()], 0..8),
        scales in [any_scale(), any_scale()],
        at in any_value(),
    ) {
        let values: Vec<Value> =
            numbers.iter().map(|&[x, y, low, high]| Value { x, y, y_range: [low, high] }).collect();
        let series = |look| Series { name: "a".to_owned(), values: values.clone(), look };
        let chart = Chart {
            title: "t".to_owned(),
            width: 200.0,
            height: 150.0,
            x: side("x", scales[0]),
            y: side("y", scales[1]),
            series: vec![series(SeriesLook::LineAndPoints), series(SeriesLook::Dashes)],
            guides: [GuidePlace::X(at), GuidePlace::Y(at)].map(|at| GuideLine { at, label: "g".to_owned() }).to_vec(),
        };
        assert_drawn(&chart.figure());
    }

    #[test]
    fn any_field_can_be_drawn(
        values in prop::collection::vec(any_value(), 25),
        constant: bool,
        place in [any_value(), any_value()],
        size in any_value(),
    ) {
        let mut next = values.iter().cycle();
        let grid = Grid::over_disc(29.0, 5, |_, _| if constant { values[0] } else { *next.next().unwrap() });
        let look = PaintStyle::line(Stroke::solid(DARK, 1.0));
        let shapes = vec![
            Shape::Circle { centre: place, radius: size, look },
            Shape::Rectangle { centre: place, size: [size, 1.0], turn_deg: size, look },
            Shape::Line { corners: vec![place, [0.0; 2]], ends: Ends::Closed, look },
            Shape::Dimension { from: place, to: [0.0; 2], text: "d".to_owned() },
        ];
        let all = [
            Bands::sequential(grid.span(), 8),
            Bands::diverging(grid.largest(), 4),
            Bands::diverging_decades(grid.largest(), 2),
        ];
        for bands in all {
            let field = in_uv(grid.clone(), bands, Isolines::Labelled);
            assert_drawn(&plate("t", Some(field), shapes.clone()).figure(200.0));
        }
    }
}

#[test]
fn plans_without_extent_are_empty_pages() {
    for x in [[0.0, 0.0], [1.0, -1.0], [f64::NAN, 1.0], [0.0, f64::INFINITY]] {
        let plan = Plan { x, ..plate("t", None, modules()) };
        let text = svg::text(&plan.figure(200.0));
        assert!(!text.contains("NaN") && !text.contains("inf"), "{text}");
    }
    let nothing = Multiples { plans: vec![], ..maps(Bars::Each) };
    assert_drawn(&nothing.figure());
}

#[test]
fn equal_values_give_equal_bytes() {
    let [one, two] = [(); 2].map(|()| maps(Bars::Shared).figure());
    assert_eq!(svg::text(&one), svg::text(&two));
    assert_eq!(png::bytes(&one, 0.5), png::bytes(&two, 0.5));
}
