//! Places that sample the plate evenly, and the maps' root mean squares over it.

use std::f64::consts::PI;

use super::contacts::Maps;
use tactpad_core::pad::influence::InfluenceField;
use tactpad_core::quantity::CHANNELS;

/// Number of places at which maps and their errors are looked at.
pub(crate) const PLACES: u32 = 60;
/// Normal force of the loads: half of full scale.
const LOAD_N: f64 = 2.5;

/// Places evenly over a disc of this radius.
pub(crate) fn places(reach_mm: f64, count: u32) -> impl Iterator<Item = [f64; 2]> {
    // Vogel's spiral, r = R √((k + ½)/n) and θ = k π (3 − √5): each place has the same area (H. Vogel, Math. Biosci. 44 (1979)
    // 179).
    let golden = PI * (3.0 - 5.0_f64.sqrt());
    (0..count).map(move |place| {
        let place = f64::from(place);
        let radius_mm = reach_mm * ((place + 0.5) / f64::from(count)).sqrt();
        [radius_mm * (golden * place).cos(), radius_mm * (golden * place).sin()]
    })
}

/// Loads all over the plate, places and forces in N, that are partly shear.
pub(crate) fn loads(reach_mm: f64) -> impl Iterator<Item = ([f64; 2], [f64; 3])> {
    let shear_n = 0.4 * LOAD_N;
    let forces_n = [[shear_n, 0.0, LOAD_N], [0.0, shear_n, LOAD_N], [-shear_n, -shear_n, LOAD_N]];
    places(reach_mm, PLACES).flat_map(move |place_mm| forces_n.map(|force_n| (place_mm, force_n)))
}

/// Root mean square of each map over the plate; of a map that is small beside its channel's others, a fifth of theirs.
pub(crate) fn scale(signals: &InfluenceField) -> Maps {
    let mut squares = [[0.0; 3]; CHANNELS];
    for [x_mm, y_mm] in places(f64::from(signals.radius_mm()), PLACES) {
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
