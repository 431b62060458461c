//! Strains of a row, by its place, its force and the field there.

use crate::diagnosis::model::chain::Chain;
use crate::diagnosis::model::mechanics::Maps;
use tactpad_core::pad::influence::{Gains, InfluenceField};
use tactpad_core::quantity::CHANNELS;

/// A row under a chain.
pub(crate) struct Row {
    pub(crate) place_mm: [f64; 2],
    pub(crate) force_n: [f64; 3],
    pub(crate) gains: Gains,
    pub(crate) laplacian: Maps,
    /// Addition of each change of the field to the strains.
    pub(crate) changes: Vec<[f64; CHANNELS]>,
}

impl Row {
    /// Σₐ Fₐ Gₐ about a patch of another size or height, with the changes of the field and what modules take of each other.
    pub(crate) fn strain(&self, chain: &Chain) -> [f64; CHANNELS] {
        let Self { force_n, gains, laplacian, changes, .. } = self;
        let mechanics = &chain.mechanics;
        // Half the mean square of the patch's radius along each axis, over its nominal one: (R² − R₀²)/8.
        let spread_mm2 = mechanics.patch_mm2 / 8.0;
        let [fx_n, fy_n, _] = *force_n;
        let mut strain: [f64; CHANNELS] = std::array::from_fn(|channel| {
            let couple = fx_n * gains.dx[channel][2] + fy_n * gains.dy[channel][2];
            response(&gains.value[channel], force_n)
                + spread_mm2 * response(&laplacian[channel], force_n)
                + mechanics.height_mm * couple
        });
        for (weight, change) in mechanics.weights.iter().zip(changes).filter(|(weight, _)| **weight != 0.0) {
            strain.iter_mut().zip(change).for_each(|(strain, change)| *strain += weight * change);
        }
        chain.channels.couple(&mut strain);
        strain
    }
}

/// The field at a place; beyond its radius it goes on straight, as a plate does that does not end there.
pub(crate) fn continued(field: &InfluenceField, place_mm: [f64; 2]) -> Gains {
    let beyond = libm::hypot(place_mm[0], place_mm[1]) / f64::from(field.radius_mm());
    let [x_mm, y_mm] = place_mm.map(|mm| mm / beyond.max(1.0));
    let mut gains = field.gains(x_mm as f32, y_mm as f32);
    let by_mm = [place_mm[0] - x_mm, place_mm[1] - y_mm];
    for channel in 0..CHANNELS {
        for axis in 0..3 {
            let slope = [gains.dx[channel][axis], gains.dy[channel][axis]];
            gains.value[channel][axis] += slope[0] * by_mm[0] + slope[1] * by_mm[1];
        }
    }
    gains
}

/// Σₐ Fₐ Gₐ.
pub(crate) fn response(map: &[f64; 3], force_n: &[f64; 3]) -> f64 {
    map.iter().zip(force_n).map(|(map, n)| map * n).sum()
}
