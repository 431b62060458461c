//! `--figures`: the plate's deflection and stress, strain and stress of a film and its module, the 27 influence maps.

use tactpad::mechanics::deformed::von_mises_mpa;
use tactpad::mechanics::mesh::Layer;
use tactpad::mechanics::mesh::half_sizes_mm;
use tactpad::mechanics::pressed::{PressedPad, plane_von_mises_mpa};
use tactpad::pad::device::{Device, GAUGES};
use tactpad::pad::field::PadField;
use tactpad::pad::influence::{InfluenceField, MAPS};
use tactpad::plot::bands::Bands;
use tactpad::plot::colour::Rgb;
use tactpad::plot::figure::{Ends, Figure, Ink, Stroke};
use tactpad::plot::grid::Grid;
use tactpad::plot::isoline::Isolines;
use tactpad::plot::multiples::{Bars, Multiples};
use tactpad::plot::plan::{Field, Plan};
use tactpad::plot::shape::{PaintStyle, Shape};
use tactpad::quantity::{CHANNEL_NAMES, CHANNELS, MODULES};

const DARK: Rgb = Rgb::new(0x1f, 0x24, 0x2b);

/// Nodes along a side of the plate's grid, alone and among many.
const NODES: usize = 121;
const SMALL_NODES: usize = 61;

/// Strains near the window's edge are many times those at the gauges.
const STRAIN_DECADES: usize = 2;

/// Colours of the plate's stress.
const STRESS_BANDS: usize = 12;

/// Stresses below this share of the largest have one colour.
const STRESS_SHARE_MIN: f64 = 0.01;

/// Channels over a module are a hundred times those at its far side.
const INFLUENCE_DECADES: usize = 2;

/// All figures with the names of their files.
pub(super) fn of(pressed: &PressedPad, field: &PadField) -> Vec<(&'static str, Figure)> {
    vec![
        ("deflection", deflection(pressed).figure(560.0)),
        ("plate-stress", plate_stress(pressed).figure()),
        ("strain-x", strain(pressed, 0).figure(720.0)),
        ("strain-y", strain(pressed, 1).figure(720.0)),
        ("film-stress", film_stress(pressed).figure(720.0)),
        ("module-stress", module_stress(pressed).figure(900.0)),
        ("influence", influence(&pressed.pad.device, &field.signals).figure()),
    ]
}

fn deflection(pressed: &PressedPad) -> Plan {
    let device = &pressed.pad.device;
    let grid =
        Grid::over_disc(device.plate.radius_mm(), NODES, |x, y| -1e3 * pressed.plate([x, y]).top_mm[2]);
    let bands = Bands::diverging(grid.largest(), 8);
    let label = "down, µm".to_owned();
    let field = Field { grid, bands, isolines: Isolines::Labelled, label };
    let mut shapes = films(device);
    shapes.push(Shape::Dots {
        places: vec![pressed.place_mm],
        radius_px: 3.5,
        look: PaintStyle::fill(Ink::opaque(DARK)),
    });
    let title = format!("Deflection of the plate under {}", load(pressed));
    plate(title, device, field, shapes)
}

/// Von Mises's stress on both sides of the plate.
fn plate_stress(pressed: &PressedPad) -> Multiples {
    let device = &pressed.pad.device;
    let (radius_mm, half_mm) = (device.plate.radius_mm(), 0.5 * device.plate.thickness_mm);
    let grids = [half_mm, -half_mm].map(|height_mm| {
        Grid::over_disc(radius_mm, NODES, |x, y| {
            plane_von_mises_mpa(pressed.plate_strain([x, y], height_mm), device.material.plate)
        })
    });
    let largest = grids.iter().map(Grid::largest).fold(0.0, f64::max);
    let bands = Bands::sequential(Some([0.0, largest]), STRESS_BANDS);
    let plans = grids.map(|grid| {
        let field = Field { grid, bands: bands.clone(), isolines: Isolines::None, label: "MPa".to_owned() };
        plate(String::new(), device, field, films(device))
    });
    Multiples {
        title: format!("Von Mises stress of the plate under {}", load(pressed)),
        note: "Both seen from above; outlines: the modules’ films.".to_owned(),
        column_titles: ["top side", "underside"].map(str::to_owned).to_vec(),
        row_titles: vec![String::new()],
        plans: plans.to_vec(),
        plan_width: 360.0,
        bars: Bars::Shared,
    }
}

/// Von Mises's stress of the first module's film on its underside.
fn film_stress(pressed: &PressedPad) -> Plan {
    let device = &pressed.pad.device;
    let module = pressed.module(0);
    let material = Layer::Pi.material(device, &device.modules[0]);
    let grid = over_film(device, |place| {
        module.underside_strain(place).map_or(f64::NAN, |strain| von_mises_mpa(&strain, material))
    });
    let title = format!("Von Mises stress of module 0’s film, underside, under {}", load(pressed));
    film(title, device, stress_field(grid))
}

/// Von Mises's stress of the first module, cut along its middle.
fn module_stress(pressed: &PressedPad) -> Plan {
    let device = &pressed.pad.device;
    let module = pressed.module(0);
    let x = film_half_mm(device)[0];
    let [low, high] = [0, usize::MAX].map(|at| {
        let lines_mm = &module.mesh.lines_mm[2];
        lines_mm.get(at.min(lines_mm.len().saturating_sub(1))).copied().unwrap_or_default()
    });
    // Twenty-five nodes per millimetre along the film, forty across the layers.
    let nodes = [(50.0 * x) as usize + 1, (40.0 * (high - low)) as usize + 1];
    let grid = Grid::over_rectangle([-x, x], [low, high], nodes, |x, z| {
        module.strain_at([x, 0.0, z]).map_or(f64::NAN, |(strain, layer)| {
            von_mises_mpa(&strain, layer.material(device, &device.modules[0]))
        })
    });
    Plan {
        title: format!("Von Mises stress of module 0, cut at y = 0, under {}", load(pressed)),
        x: [-x, x],
        y: [low, high],
        x_label: "x (tangential), mm".to_owned(),
        y_label: "z, mm".to_owned(),
        field: Some(stress_field(grid)),
        shapes: vec![],
    }
}

/// Stresses at edges are many times those between.
fn stress_field(grid: Grid) -> Field {
    let largest = grid.largest();
    let bands = Bands::sequential_decades(Some([largest * STRESS_SHARE_MIN, largest]));
    Field { grid, bands, isolines: Isolines::None, label: "MPa".to_owned() }
}

/// Strain of the first module's film along an axis of the module.
fn strain(pressed: &PressedPad, axis: usize) -> Plan {
    let device = &pressed.pad.device;
    let module = pressed.module(0);
    let grid = over_film(device, |place| {
        module.underside_strain(place).map_or(f64::NAN, |strain| 1e6 * strain[axis])
    });
    let bands = Bands::diverging_decades(grid.largest(), STRAIN_DECADES);
    let name = ["x", "y"][axis];
    let title = format!("Strain ε_{{{name}{name}}} of module 0’s film, underside, under {}", load(pressed));
    film(title, device, Field { grid, bands, isolines: Isolines::None, label: "µm/m".to_owned() })
}

/// Values over a module's film.
fn over_film(device: &Device, value: impl Fn([f64; 2]) -> f64) -> Grid {
    let half_mm = film_half_mm(device);
    let [x, y] = half_mm.map(|half| [-half, half]);
    // Twenty nodes per millimetre: the mesh's finest elements.
    let nodes = half_mm.map(|half| (40.0 * half) as usize + 1);
    Grid::over_rectangle(x, y, nodes, |x, y| value([x, y]))
}

/// A field over a module's film with its gauges.
fn film(title: String, device: &Device, field: Field) -> Plan {
    let [x, y] = film_half_mm(device).map(|half| [-half, half]);
    Plan {
        title,
        x,
        y,
        x_label: "x (tangential), mm".to_owned(),
        y_label: "y (radial), mm".to_owned(),
        field: Some(field),
        shapes: gauges(device),
    }
}

fn gauges(device: &Device) -> Vec<Shape> {
    let mut shapes = Vec::with_capacity(2 * GAUGES);
    for (index, gauge) in device.gauges.iter().enumerate() {
        let centre = [gauge.x_mm, gauge.y_mm];
        let size = half_sizes_mm(gauge).map(|half| 2.0 * half);
        let look = PaintStyle::line(Stroke::solid(DARK, 1.0));
        shapes.push(Shape::Rectangle { centre, size, turn_deg: 0.0, look });
        shapes.push(Shape::Label { place: centre, text: format!("R{}", index + 1) });
    }
    shapes
}

fn influence(device: &Device, signals: &InfluenceField) -> Multiples {
    let reach_mm = f64::from(signals.radius_mm());
    // A row for each force, a column for each channel.
    let grids: Vec<Grid> = (0..MAPS)
        .map(|plan| {
            let (force, channel) = (plan / CHANNELS, plan % CHANNELS);
            let gain = |x: f64, y: f64| signals.gains(x as f32, y as f32).value[channel][force];
            Grid::over_disc(reach_mm, SMALL_NODES, gain)
        })
        .collect();
    let largest = grids.iter().map(Grid::largest).fold(0.0, f64::max);
    let plan = |grid: Grid| {
        let bands = Bands::diverging_decades(largest, INFLUENCE_DECADES);
        let field = Field { grid, bands, isolines: Isolines::None, label: "µV/N".to_owned() };
        plate(String::new(), device, field, films(device))
    };
    Multiples {
        title: "What a newton anywhere on the plate does to the nine channels".to_owned(),
        note: format!("Places up to {reach_mm} mm from the centre; outlines: the modules’ films."),
        column_titles: CHANNEL_NAMES.map(str::to_owned).to_vec(),
        row_titles: ["along x", "along y", "pressing"].map(|force| format!("1 N {force}")).to_vec(),
        plans: grids.into_iter().map(plan).collect(),
        plan_width: 110.0,
        bars: Bars::Shared,
    }
}

fn plate(title: String, device: &Device, field: Field, shapes: Vec<Shape>) -> Plan {
    let radius_mm = device.plate.radius_mm();
    Plan {
        title,
        x: [-radius_mm, radius_mm],
        y: [-radius_mm, radius_mm],
        x_label: "x, mm".to_owned(),
        y_label: "y, mm".to_owned(),
        field: Some(field),
        shapes,
    }
}

/// The outlines of the modules' films.
fn films(device: &Device) -> Vec<Shape> {
    let film = |module: usize| Shape::Line {
        corners: device.poses()[module].corners_mm(film_half_mm(device)).to_vec(),
        ends: Ends::Closed,
        look: PaintStyle::line(Stroke::solid(DARK, 0.8)),
    };
    (0..MODULES).map(film).collect()
}

fn film_half_mm(device: &Device) -> [f64; 2] {
    [device.stack.film_length_x_mm / 2.0, device.stack.film_width_y_mm / 2.0]
}

fn load(pressed: &PressedPad) -> String {
    let [x, y] = pressed.place_mm;
    format!("1 N at ({x}, {y}) mm").replace('-', "−")
}
