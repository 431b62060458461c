//! Drift of the unloaded channels with the temperature.

use std::collections::BTreeMap;

use serde::Serialize;

use super::Needs;
use super::rows::is_unloaded;
use tactpad_core::quantity::CHANNELS;
use tactpad_core::tables::measured::{Row, Table};
use tactpad_numeric::statistics::{Line, mean, mean_vector};

/// Least range of temperatures.
const RANGE_C: f64 = 5.0;

/// The paper's unit of temperature change.
pub(super) const STEP_C: f64 = 10.0;

const NEEDED: &str = "rows with temp_c at two temperatures or more, 5 °C apart, and no load";

/// Temperature coefficients of the unloaded channels.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ThermalDrift {
    /// Mean over the channels of the slope's magnitude.
    pub uv_per_10_c: f64,
    /// The slope of each channel.
    pub slope_uv_per_c: [f64; CHANNELS],
    /// The largest distance of a temperature's mean reading from the channel's line, as a share of the line's
    /// whole change; the mean over the channels.
    pub nonlinearity_share: f64,
    /// Temperatures and the channels' mean change there, from the middle of the lines; for the plot.
    #[serde(skip)]
    pub readings: Vec<(f64, [f64; CHANNELS])>,
}

/// Unloaded rows: a temperature and the channels, less the mean of their session.
#[derive(Clone, Copy)]
struct UnloadedReading {
    temp_c: f64,
    relative_c: f64,
    uv: [f64; CHANNELS],
}

/// The mean of a session's unloaded rows.
struct SessionMean {
    temp_c: f64,
    uv: [f64; CHANNELS],
}

/// The temperature and the channels of an unloaded row.
type Warm<'t> = (f64, &'t [f64; CHANNELS]);

/// A line through each channel's unloaded readings over the temperature. Each session has its own zero.
///
/// # Errors
/// No session with unloaded rows at two temperatures.
pub fn drift(table: &Table) -> Result<ThermalDrift, Needs> {
    let wide = sessions(table).into_iter().filter(|session| range_c(session) >= RANGE_C);
    let sessions: Vec<(SessionMean, Vec<Warm>)> =
        wide.map(|session| (SessionMean::of(&session), session)).collect();
    if sessions.is_empty() {
        return Err(Needs::Rows(NEEDED));
    }
    let readings =
        || sessions.iter().flat_map(|(middle, session)| session.iter().map(|row| middle.relative(row)));
    let lines: [Line; CHANNELS] = std::array::from_fn(|channel| {
        let points: Vec<[f64; 2]> =
            readings().map(|reading| [reading.relative_c, reading.uv[channel]]).collect();
        Line::through(&points)
    });
    let slope_uv_per_c = lines.map(|line| line.slope);
    let steps = by_temperature(readings());
    Ok(ThermalDrift {
        uv_per_10_c: STEP_C * mean(slope_uv_per_c.map(f64::abs)),
        slope_uv_per_c,
        nonlinearity_share: nonlinearity(&steps, &lines),
        readings: steps.iter().map(|step| (step.temp_c, step.uv)).collect(),
    })
}

/// Temperature and channels of the unloaded rows, session by session; rows without session are one.
fn sessions(table: &Table) -> Vec<Vec<Warm<'_>>> {
    let mut sessions = vec![Vec::new(); table.sessions.len() + 1];
    for row in table.rows.iter().filter(|row| is_unloaded(&row.label)) {
        let session = sessions.get_mut(row.session.map_or(0, |session| session + 1));
        if let (Some(session), Row { temp_c: Some(temp_c), uv: Some(uv), .. }) = (session, row) {
            session.push((*temp_c, uv));
        }
    }
    sessions
}

fn range_c(session: &[Warm]) -> f64 {
    let temperatures = || session.iter().map(|(temp_c, _)| *temp_c);
    temperatures().fold(f64::MIN, f64::max) - temperatures().fold(f64::MAX, f64::min)
}

impl SessionMean {
    fn of(session: &[Warm]) -> Self {
        Self {
            temp_c: mean(session.iter().map(|(temp_c, _)| temp_c)),
            uv: mean_vector(session.iter().map(|(_, uv)| *uv)),
        }
    }

    fn relative(&self, (temp_c, uv): &Warm) -> UnloadedReading {
        UnloadedReading {
            temp_c: *temp_c,
            relative_c: temp_c - self.temp_c,
            uv: std::array::from_fn(|channel| uv[channel] - self.uv[channel]),
        }
    }
}

/// Means over the readings whose temperatures round to the same degree, from cold to warm.
fn by_temperature(readings: impl Iterator<Item = UnloadedReading>) -> Vec<UnloadedReading> {
    // For each degree the sums of both temperatures and of the channels, and how many they are.
    let mut degrees: BTreeMap<i64, (UnloadedReading, f64)> = BTreeMap::new();
    for UnloadedReading { temp_c, relative_c, uv } in readings {
        let none = UnloadedReading { temp_c: 0.0, relative_c: 0.0, uv: [0.0; CHANNELS] };
        let (sum, count) = degrees.entry(temp_c.round() as i64).or_insert((none, 0.0));
        sum.temp_c += temp_c;
        sum.relative_c += relative_c;
        sum.uv.iter_mut().zip(uv).for_each(|(sum, uv)| *sum += uv);
        *count += 1.0;
    }
    let mean = |(sum, count): (UnloadedReading, f64)| UnloadedReading {
        temp_c: sum.temp_c / count,
        relative_c: sum.relative_c / count,
        uv: sum.uv.map(|sum| sum / count),
    };
    degrees.into_values().map(mean).collect()
}

fn nonlinearity(steps: &[UnloadedReading], lines: &[Line; CHANNELS]) -> f64 {
    let relative_c = || steps.iter().map(|step| step.relative_c);
    let range_c = relative_c().fold(f64::MIN, f64::max) - relative_c().fold(f64::MAX, f64::min);
    let of_channel = |channel: usize| {
        let line = &lines[channel];
        let off = steps.iter().map(|step| (step.uv[channel] - line.at(step.relative_c)).abs());
        let change = (line.slope * range_c).abs();
        // A channel that does not drift is not off its line by any share of it.
        if change > 0.0 { off.fold(0.0, f64::max) / change } else { 0.0 }
    };
    mean(std::array::from_fn::<f64, CHANNELS, _>(of_channel))
}

#[cfg(test)]
mod tests {
    use super::super::fixture::{pressed, row, table};
    use super::*;
    use tactpad_core::tables::measured::Label;

    const TEMPERATURES_C: [f64; 7] = [-10.0, 0.0, 10.0, 20.0, 30.0, 40.0, 50.0];

    /// Channel k drifts by ±(26 + k) µV/°C, so 30 on average; a session adds its zero.
    fn at(temp_c: f64, session: Option<usize>, curvature: f64) -> Row {
        let uv = |channel: usize| {
            let sign = if channel.is_multiple_of(2) { 1.0 } else { -1.0 };
            let slope = sign * (26 + channel) as f64;
            slope * temp_c + curvature * slope * temp_c * temp_c + 1e3 * session.map_or(0.0, |s| s as f64)
        };
        Row { temp_c: Some(temp_c), session, ..row(Label::default(), std::array::from_fn(uv)) }
    }

    #[test]
    fn slopes_come_out_whatever_the_sessions_zeros() {
        let rows = TEMPERATURES_C.map(|temp_c| at(temp_c, Some(temp_c as usize % 2), 0.0));
        let two = TEMPERATURES_C.map(|temp_c| at(temp_c, Some(1), 0.0));
        let found = drift(&table(rows.into_iter().chain(two))).unwrap();
        assert!((found.uv_per_10_c - 300.0).abs() < 1e-9, "{found:?}");
        assert!((found.slope_uv_per_c[1] + 27.0).abs() < 1e-9 && found.nonlinearity_share < 1e-9);
        assert_eq!(found.readings.len(), 7);
    }

    #[test]
    fn a_parabola_is_told() {
        // About the middle, 20 °C: (1 + 40c)(T − 20) + c (T − 20)², whose largest distance from its line at
        // ±30 °C is c (900 − 400).
        let c = 1e-3;
        let found = drift(&table(TEMPERATURES_C.map(|temp_c| at(temp_c, None, c)))).unwrap();
        let expected = c * 500.0 / ((1.0 + 40.0 * c) * 60.0);
        assert!((found.nonlinearity_share - expected).abs() < 1e-9, "{found:?} {expected}");
    }

    #[test]
    fn it_says_what_it_needs() {
        let loaded = TEMPERATURES_C.map(|temp_c| Row { temp_c: Some(temp_c), ..pressed(1.0, 0.0) });
        for rows in [vec![], loaded.to_vec(), vec![at(20.0, None, 0.0), at(22.0, None, 0.0)]] {
            assert_eq!(drift(&table(rows)).unwrap_err().to_string(), format!("needs {NEEDED}"));
        }
    }
}
