//! Figures of the study of size: what a pad can do over its diameter, a curve for each thickness.

use super::sizes::{Law, Size, SizedPad, Sizes, THICKNESSES_MM};
use crate::plot::chart::{Chart, Guide, GuidePlace, Series, SeriesLook, Side, Value};
use crate::plot::figure::Figure;
use crate::plot::scale::Scale;

const WIDTH: f64 = 560.0;
const HEIGHT: f64 = 400.0;

/// The sensitivity.
pub fn sensitivity(sizes: &Sizes) -> Figure {
    let y = Side { also: vec![0.0], ..side("Three z channels, press in the middle, µV/N", Scale::Linear) };
    chart(sizes, "Sensitivity by size".to_owned(), y, "sensitivity", |pad| pad.sensitivity_uv_per_n).figure()
}

/// The worst location error at best.
pub fn error(sizes: &Sizes) -> Figure {
    let title = format!("Location error at best by size, press of 1 N, noise {} µV", sizes.noise_uv);
    let y = side("Worst error over the plate, mm", Scale::Log10);
    chart(sizes, title, y, "worst error at 1 N", |pad| pad.precision.worst_mm).figure()
}

/// The first natural frequency, beside the converter's.
pub fn frequency(sizes: &Sizes) -> Figure {
    let y = side("First natural frequency, Hz", Scale::Log10);
    let title = "First natural frequency by size".to_owned();
    let mut chart = chart(sizes, title, y, "first natural frequency", |pad| pad.first_hz);
    let half_hz = sizes.converter_hz / 2.0;
    chart.guides.push(Guide {
        at: GuidePlace::Y(half_hz),
        label: format!("half of {} conversions per second", sizes.converter_hz),
    });
    chart.figure()
}

fn chart(sizes: &Sizes, title: String, y: Side, quantity: &str, value: fn(&SizedPad) -> f64) -> Chart {
    let curve = |thickness_mm: f64| {
        let pads = sizes.pads.iter().filter(move |pad| pad.size.thickness_mm == thickness_mm);
        let values = pads.map(|pad| Value::new(pad.size.diameter_mm, value(pad))).collect();
        Series { name: format!("{thickness_mm} mm"), values, look: SeriesLook::LineAndPoints }
    };
    let mut series: Vec<Series> = THICKNESSES_MM.map(curve).to_vec();
    series.extend(sizes.laws.iter().find(|law| law.quantity == quantity).map(|law| of_law(law, sizes)));
    let x = side("Diameter of the plate, mm", Scale::Linear);
    Chart { title, width: WIDTH, height: HEIGHT, x, y, series, guides: vec![] }
}

/// The law for plates of 1 mm.
fn of_law(law: &Law, sizes: &Sizes) -> Series {
    let mut diameters: Vec<f64> = sizes.pads.iter().map(|pad| pad.size.diameter_mm).collect();
    diameters.dedup();
    let at = |diameter_mm: f64| Value::new(diameter_mm, law.at(Size { diameter_mm, thickness_mm: 1.0 }));
    let name = if law.thickness_power == 0.0 { "law of stiff plates" } else { "law of stiff plates, 1 mm" };
    Series {
        name: name.to_owned(),
        values: diameters.into_iter().map(at).collect(),
        look: SeriesLook::Dashes,
    }
}

fn side(label: &str, scale: Scale) -> Side {
    Side { label: label.to_owned(), scale, also: vec![] }
}
