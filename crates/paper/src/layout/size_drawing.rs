//! Figures of the study of size: what a pad can do over its diameter, a curve for each thickness.

use super::sizes::{CHANGE, ERROR, FREQUENCY, Law, SizeStudy, SizedPad, THICKNESSES_MM};
use tactpad_plot::chart::{Chart, GuideLine, GuidePlace, Series, SeriesLook, Side, Value};
use tactpad_plot::figure::Figure;
use tactpad_plot::scale::Scale;

const WIDTH: f64 = 560.0;
const HEIGHT: f64 = 400.0;

/// The sensitivity to a place: that to the force is the same for all.
pub fn sensitivity(sizes: &SizeStudy) -> Figure {
    let y = side("Change of the channels, µV per N and mm", Scale::Log10);
    let title = "Sensitivity to place by size, press in the middle".to_owned();
    chart(sizes, title, y, CHANGE, |pad| pad.change_uv_per_n_mm).figure()
}

/// The worst location error at best.
pub fn error(sizes: &SizeStudy) -> Figure {
    let title = format!("Location error at best by size, press of 1 N, noise {} µV", sizes.noise_uv);
    let y = side("Worst error over the plate, mm", Scale::Log10);
    chart(sizes, title, y, ERROR, |pad| pad.precision.worst_mm).figure()
}

/// The first natural frequency, beside the converter's.
pub fn frequency(sizes: &SizeStudy) -> Figure {
    let y = side("First natural frequency, Hz", Scale::Log10);
    let title = "First natural frequency by size".to_owned();
    let mut chart = chart(sizes, title, y, FREQUENCY, |pad| pad.first_hz);
    let half_hz = sizes.converter_hz / 2.0;
    chart.guides.push(GuideLine {
        at: GuidePlace::Y(half_hz),
        label: format!("half of {} conversions per second", sizes.converter_hz),
    });
    chart.figure()
}

fn chart(
    sizes: &SizeStudy,
    title: String,
    y: Side,
    (quantity, _): (&str, &str),
    value: fn(&SizedPad) -> f64,
) -> Chart {
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

/// The law for plates of 1 mm, where these are stiff.
fn of_law(law: &Law, sizes: &SizeStudy) -> Series {
    let stiff = sizes.pads.iter().filter(|pad| pad.size.thickness_mm == 1.0 && pad.is_stiff());
    let values = stiff.map(|pad| Value::new(pad.size.diameter_mm, law.at(pad.size))).collect();
    Series { name: "law of stiff plates, 1 mm".to_owned(), values, look: SeriesLook::Dashes }
}

fn side(label: &str, scale: Scale) -> Side {
    Side { label: label.to_owned(), scale, also: vec![] }
}
