//! Where a plan's contacts are.

use tactpad::pad::device::Device;
use tactpad::plot::colour::Rgb;
use tactpad::plot::figure::{Anchor, Figure, Ink, Stroke, Text};
use tactpad::plot::plan::Plan;
use tactpad::plot::shape::{PaintStyle, Shape};
use tactpad::tables::measured::Table;
use tactpad::tables::measured::zero::ZERO;
use tactpad::tables::plans::distinct_places;

const WIDTH: f64 = 460.0;
const DARK: Rgb = Rgb::new(0x1f, 0x24, 0x2b);
const DOT_PX: f64 = 3.2;
const NAME_SIZE: f64 = 12.0;

/// The plate with the places of contacts, in the colours of their sessions, whose names stand below.
pub(super) fn places(title: String, plan: &Table, device: &Device) -> Figure {
    let rim_mm = device.plate.radius_mm();
    let circle = |radius: f64, stroke: Stroke| Shape::Circle {
        centre: [0.0; 2],
        radius,
        look: PaintStyle::line(stroke),
    };
    let dashed = Stroke::solid(DARK, 0.7).dashed(3.0, 3.0);
    let mut shapes =
        vec![circle(rim_mm, Stroke::solid(DARK, 1.2)), circle(device.contact.max_centre_radius_mm, dashed)];
    let mut names = Vec::new();
    for (session, name) in plan.sessions.iter().enumerate().filter(|(_, name)| *name != ZERO) {
        let ink = Ink::opaque(Rgb::of_series(names.len()));
        let places = distinct_places(plan.rows.iter().filter(|row| row.session == Some(session)));
        shapes.push(Shape::Dots { places, radius_px: DOT_PX, look: PaintStyle::fill(ink) });
        names.push((name, ink));
    }
    let axis = |name: &str| format!("{name}, mm");
    let [x, y] = [[-rim_mm, rim_mm]; 2];
    let plan = Plan { title, x, y, x_label: axis("x"), y_label: axis("y"), field: None, shapes };
    let plan = plan.figure(WIDTH);
    let [width, height] = plan.size();
    let mut page = Figure::new(width, height + 2.0 * NAME_SIZE, plan.description().to_owned());
    page.place(plan, [0.0, 0.0]);
    let step = width / (names.len() + 1) as f64;
    for (order, (name, ink)) in (1_u32..).zip(names) {
        let at = [f64::from(order) * step, height + 0.5 * NAME_SIZE];
        page.text(Text::new(name, at, NAME_SIZE, ink).anchored(Anchor::Middle).semi_bold());
    }
    page
}
