//! `module-gauges`: a module alone under 0 to 5 N along each axis, gauge by gauge, beside the same in the pad; after the
//! paper's Figure 4.

use tactpad::mechanics::gauges::GaugeReadings;
use tactpad::mechanics::pressed::PressedPad;
use tactpad::mechanics::system::SolveError;
use tactpad::pad::device::GAUGES;
use tactpad::pad::wiring::HALF_BRIDGES;
use tactpad::plot::chart::{Chart, Series, SeriesLook, Side, Value};
use tactpad::plot::figure::Figure;
use tactpad::plot::scale::Scale;

const WIDTH: f64 = 400.0;
const HEIGHT: f64 = 310.0;
const FORCES: [&str; 3] = ["F_{x}", "F_{y}", "F_{z}"];

/// Gauges alone, gauges in the pad, channels of both: a row each, with a column for each force on module 0.
///
/// # Errors
/// A module without stiffness.
pub(super) fn gauges(pressed: &PressedPad) -> Result<Figure, SolveError> {
    let pad = &pressed.pad;
    let alone = GaugeReadings::alone(&pad.device, &pad.modules[0])?;
    let in_pad = GaugeReadings::in_pad(pad, 0);
    let full_scale_n = pad.device.contact.full_scale_n;
    let mut page = Figure::new(3.0 * WIDTH, 3.0 * HEIGHT, "A module alone and in the pad, gauge by gauge");
    for (column, force) in FORCES.into_iter().enumerate() {
        let of_gauges = |readings: &GaugeReadings| {
            let names = (1..=GAUGES).map(|number| format!("R{number}"));
            names.zip(readings.uv_per_n[column]).collect::<Vec<_>>()
        };
        let of_channels = |readings: &GaugeReadings, whose: &str| {
            let names = HALF_BRIDGES.map(|bridge| format!("{} {whose}", bridge.axis));
            names.into_iter().zip(readings.channels_uv_per_n()[column]).collect::<Vec<_>>()
        };
        let channels = [of_channels(&alone, "alone"), of_channels(&in_pad, "in pad")].concat();
        let rows = [
            (format!("Gauges of module 0 alone under {force}"), "δ ΔR/R, mV", of_gauges(&alone)),
            (format!("Gauges of module 0 in the pad under {force}"), "δ ΔR/R, mV", of_gauges(&in_pad)),
            (format!("Channels of module 0 under {force}"), "channel, mV", channels),
        ];
        for (row, (title, label, slopes)) in rows.into_iter().enumerate() {
            let chart = chart(title, format!("{force}, N"), label, &slopes, full_scale_n);
            page.place(chart.figure(), [column as f64 * WIDTH, row as f64 * HEIGHT]);
        }
    }
    Ok(page)
}

/// Lines through zero with their slopes in the legend, in mV/N.
fn chart(title: String, x: String, y: &str, slopes_uv: &[(String, f64)], full_scale_n: f64) -> Chart {
    let line = |(name, uv_per_n): &(String, f64)| {
        let mv_per_n = 1e-3 * uv_per_n;
        let values = [0.0, full_scale_n].map(|force_n| Value::new(force_n, mv_per_n * force_n));
        // What symmetry makes zero shows no sign.
        let rounded = (1e3 * mv_per_n).round() / 1e3 + 0.0;
        let name = format!("{name} {rounded}").replace('-', "−");
        Series { name, values: values.to_vec(), look: SeriesLook::ThinDashes }
    };
    let side = |label: String| Side { label, scale: Scale::Linear, also: vec![0.0] };
    Chart {
        title,
        width: WIDTH,
        height: HEIGHT,
        x: side(x),
        y: side(format!("{y} (legend: mV/N)")),
        series: slopes_uv.iter().map(line).collect(),
        guides: vec![],
    }
}
