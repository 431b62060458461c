//! Places that sample the plate evenly, and the maps' root mean squares over it.

use std::f64::consts::PI;

use super::contacts::Maps;
use crate::pad::influence::InfluenceField;
use crate::quantity::CHANNELS;

/// Number of places.
const PLACES: u32 = 60;

/// Places evenly over a disc of this radius.
pub(super) fn places(reach_mm: f64) -> impl Iterator<Item = [f64; 2]> {
    // Vogel's spiral, r = R √((k + ½)/n) and θ = k π (3 − √5): each place has the same area (H. Vogel, Math. Biosci. 44 (1979)
    // 179).
    let golden = PI * (3.0 - 5.0_f64.sqrt());
    (0..PLACES).map(move |place| {
        let place = f64::from(place);
        let radius_mm = reach_mm * ((place + 0.5) / f64::from(PLACES)).sqrt();
        [radius_mm * (golden * place).cos(), radius_mm * (golden * place).sin()]
    })
}

/// Root mean square of each map over the plate; of a map that is small beside its channel's others, a fifth of theirs.
pub(super) fn scale(signals: &InfluenceField) -> Maps {
    let mut squares = [[0.0; 3]; CHANNELS];
    for [x_mm, y_mm] in places(f64::from(signals.radius_mm())) {
        let gains = signals.gains(x_mm as f32, y_mm as f32).value;
        for (square, gain) in squares.as_flattened_mut().iter_mut().zip(gains.as_flattened()) {
            *square += gain * gain / f64::from(PLACES);
        }
    }
    squares.map(|axes| {
        let roots = axes.map(f64::sqrt);
        let largest = roots.iter().copied().fold(0.0, f64::max);
        roots.map(|root| root.max(0.2 * largest))
    })
}
