//! `dataset`: how the paper's contacts are drawn, after its Figure 3a: places, forces, their magnitudes and directions.

use tactpad::pad::device::Device;
use tactpad::plot::chart::{Chart, Series, SeriesLook, Side, Value};
use tactpad::plot::colour::Rgb;
use tactpad::plot::figure::{Figure, Ink, Stroke};
use tactpad::plot::plan::Plan;
use tactpad::plot::scale::Scale;
use tactpad::plot::shape::{PaintStyle, Shape};
use tactpad::tables::dataset::PAPER_HALF;
use tactpad::tables::measured::Label;

const SIDE: f64 = 440.0;
const GAP: f64 = 16.0;
const DARK: Rgb = Rgb::new(0x1f, 0x24, 0x2b);

/// Contacts of each half that are shown as dots: more would be one blot.
const DOTS: usize = 450;

/// Bins of the histograms.
const BINS: usize = 40;

const HALVES: [&str; 2] = ["three-axis", "normal"];

/// The contacts of `dataset::paper`, the three-axis half first.
pub(super) fn of(contacts: &[Label], device: &Device) -> Figure {
    let halves = [&contacts[..PAPER_HALF.min(contacts.len())], &contacts[PAPER_HALF.min(contacts.len())..]];
    let places = places(&halves, device);
    let below = places.size()[1].max(SIDE) + GAP;
    let mut page = Figure::new(2.0 * SIDE, below + SIDE, "How the paper’s contacts are drawn");
    page.place(places, [0.0, 0.0]);
    page.place(tangential(&halves).figure(), [SIDE, 0.0]);
    let magnitude = histogram("Magnitude of the force", "|F|, N", &halves, |label| Some(label.resultant_n()));
    page.place(magnitude.figure(), [0.0, below]);
    let tilt = histogram("Direction of the force", "tilt from the normal, °", &halves[..1], tilt_deg);
    page.place(tilt.figure(), [SIDE, below]);
    page
}

/// Angle between the force and the plate's normal; a contact without force has none.
fn tilt_deg(label: &Label) -> Option<f64> {
    let shear_n = label.fx_n.hypot(label.fy_n);
    (shear_n > 0.0 || label.fz_n != 0.0).then(|| shear_n.atan2(label.fz_n).to_degrees())
}

fn places(halves: &[&[Label]; 2], device: &Device) -> Figure {
    let circle = |radius, stroke| Shape::Circle { centre: [0.0; 2], radius, look: PaintStyle::line(stroke) };
    let radius_mm = device.plate.radius_mm();
    let dots = |(order, half): (usize, &&[Label])| Shape::Dots {
        places: half.iter().take(DOTS).map(|label| [label.x_mm, label.y_mm]).collect(),
        radius_px: 1.7,
        look: PaintStyle::fill(Ink::opaque(Rgb::of_series(order))),
    };
    let rims = [
        circle(radius_mm, Stroke::solid(DARK, 1.2)),
        circle(device.contact.max_centre_radius_mm, Stroke::solid(DARK, 0.7).dashed(3.0, 3.0)),
    ];
    let plan = Plan {
        title: format!("Places: the first {DOTS} of {} in each half", halves[0].len()),
        x: [-radius_mm, radius_mm],
        y: [-radius_mm, radius_mm],
        x_label: "x, mm".to_owned(),
        y_label: "y, mm".to_owned(),
        field: None,
        shapes: rims.into_iter().chain(halves.iter().enumerate().map(dots)).collect(),
    };
    plan.figure(SIDE)
}

fn tangential(halves: &[&[Label]; 2]) -> Chart {
    let dots = |(name, half): (&str, &&[Label])| Series {
        name: name.to_owned(),
        values: half.iter().take(DOTS).map(|label| Value::new(label.fx_n, label.fy_n)).collect(),
        look: SeriesLook::Points,
    };
    Chart {
        title: format!("Tangential forces: the first {DOTS}"),
        series: HALVES.into_iter().zip(halves).map(dots).collect(),
        ..chart("F_{x}, N", "F_{y}, N")
    }
}

/// Share of the halves' contacts by a quantity, as steps.
fn histogram(title: &str, x: &str, halves: &[&[Label]], of: impl Fn(&Label) -> Option<f64>) -> Chart {
    let values: Vec<Vec<f64>> = halves.iter().map(|half| half.iter().filter_map(&of).collect()).collect();
    let largest = values.iter().flatten().copied().fold(0.0, f64::max);
    let width = if largest > 0.0 { largest / BINS as f64 } else { 1.0 };
    let steps = |(name, values): (&str, &Vec<f64>)| {
        let mut counts = [0_u32; BINS];
        values.iter().for_each(|value| counts[((value / width) as usize).min(BINS - 1)] += 1);
        let shares = counts.map(|count| 100.0 * f64::from(count) / values.len().max(1) as f64);
        let step =
            |(bin, share): (usize, f64)| [bin, bin + 1].map(|edge| Value::new(edge as f64 * width, share));
        let look = SeriesLook::Line;
        Series {
            name: name.to_owned(),
            values: shares.into_iter().enumerate().flat_map(step).collect(),
            look,
        }
    };
    let chart = chart(x, "share of the contacts in a bin, %");
    Chart {
        title: title.to_owned(),
        series: HALVES.into_iter().zip(&values).map(steps).collect(),
        y: Side { also: vec![0.0], ..chart.y },
        ..chart
    }
}

fn chart(x: &str, y: &str) -> Chart {
    let side = |label: &str| Side { label: label.to_owned(), scale: Scale::Linear, also: vec![] };
    Chart {
        title: String::new(),
        width: SIDE,
        height: SIDE,
        x: side(x),
        y: side(y),
        series: vec![],
        guides: vec![],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_histogram_counts_every_contact_once() {
        let half = |fx_n: f64| Label { fx_n, fz_n: 3.0, ..Label::default() };
        let three: Vec<Label> = (0..80).map(|k| half(0.05 * f64::from(k))).collect();
        let normal = [Label { fz_n: 2.0, ..Label::default() }; 5];
        let chart = histogram("", "", &[&three, &normal], tilt_deg);
        let total = |series: &Series| series.values.iter().step_by(2).map(|value| value.y).sum::<f64>();
        assert!(chart.series.iter().all(|series| (total(series) - 100.0).abs() < 1e-9));
        // All normal contacts are in the first bin.
        assert_eq!(chart.series[1].values[0].y, 100.0);
        let last = chart.series[0].values.last().unwrap().x;
        assert!((last - 3.95_f64.atan2(3.0).to_degrees()).abs() < 1e-9, "{last}");
    }
}
