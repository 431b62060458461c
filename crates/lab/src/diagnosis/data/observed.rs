//! The rows of a measured table as observations of nine channels.

use tactpad_core::quantity::{CHANNEL_NAMES, CHANNELS};
use tactpad_core::tables::measured::{Approach, Row, Table};
use tactpad_inference::observations::{Observations, Sample};

/// The rows of a table that have channels, in its order.
pub(crate) fn observed(table: &Table) -> Observations {
    let rows: Vec<(&Row, [f64; CHANNELS])> =
        table.rows.iter().filter_map(|row| Some((row, row.uv?))).collect();
    let sample = |row: &Row| Sample {
        place_mm: [row.label.x_mm, row.label.y_mm],
        load: [row.label.fx_n, row.label.fy_n, row.label.fz_n],
        measurement: row.measurement.into(),
        session: row.session.unwrap_or(0),
        trial: row.trial,
        t_s: row.t_s,
        label_t_s: None,
        dwell_s: row.dwell_s,
        is_unloading: row.approach == Some(Approach::Unloading),
        temp_c: row.temp_c,
        cycle: row.cycle,
        turned_deg: row.turned_deg.unwrap_or(0.0),
        is_weight: row.weight_g.is_some(),
        block: None,
    };
    Observations {
        channels: CHANNEL_NAMES.map(str::to_owned).to_vec(),
        readings: (0..CHANNELS).map(|channel| rows.iter().map(|(_, uv)| uv[channel]).collect()).collect(),
        is_told: vec![vec![true; rows.len()]; CHANNELS],
        samples: rows.iter().map(|(row, _)| sample(row)).collect(),
        numbers: (0..rows.len()).collect(),
    }
}
