//! Gain factor of a pad by a known weight: by how much its readings have changed, and how sure that is.

use serde::Serialize;

use super::refusal::WeighError;
use super::resting::MeanReading;
use crate::pad::weight::{WEIGHT_SHARE, Weight};
use crate::pipeline::contact::inverse::Inverse;
use crate::pipeline::contact::{Decoder, watch};

/// Factors beyond these are no pad's that still works: another weight was meant, or another pad.
const FACTORS: [f64; 2] = [0.5, 2.0];

/// Where decoders end that do not know their pad's field: the farthest that a contact can be on the plate.
const REACH_MM: f64 = 29.0;
/// A place so near to that may be beyond it.
const RIM_MM: f64 = 0.5;

/// Result of a weighing.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Weighed {
    /// S: what the pad reads, over what it would read if it were as it was calibrated.
    pub factor: f64,
    /// Standard deviation of S as a share of it. Where the decoder does not know how unsure it is, that part is missing.
    pub deviation: f64,
    /// About where the weight stood.
    pub x_mm: f64,
    /// About where the weight stood.
    pub y_mm: f64,
    /// Force by the decoder, N.
    pub force_n: f64,
}

impl Weighed {
    /// Gain factor by readings of a weight.
    ///
    /// # Errors
    /// There are none, or what they show is not the weight on the plate.
    pub fn of(readings: &[MeanReading], weight: Weight, decoder: &Decoder) -> Result<Self, WeighError> {
        let mean = |of: fn(&MeanReading) -> f32| {
            readings.iter().map(|reading| f64::from(of(reading))).sum::<f64>() / readings.len() as f64
        };
        let force_n = mean(|it| it.contact.fz_n);
        let radius_mm = mean(|it| libm::hypotf(it.contact.x_mm, it.contact.y_mm));
        if !force_n.is_finite() {
            return Err(WeighError::NothingCame);
        }
        // S = F̄ / (m g)
        let factor = force_n / weight.force_n();
        if !is_possible(factor) {
            return Err(WeighError::OtherForce { force_n, weight_g: weight.g() });
        }
        if radius_mm > reach_mm(decoder) - RIM_MM {
            return Err(WeighError::OverRim);
        }
        if decoder.inverse().is_some_and(|inverse| is_foreign(readings, inverse)) {
            return Err(WeighError::NotOneLoad);
        }
        let deviation = deviation(readings, force_n, decoder.inverse());
        let (x_mm, y_mm) = (mean(|it| it.contact.x_mm), mean(|it| it.contact.y_mm));
        Ok(Self { factor, deviation, x_mm, y_mm, force_n })
    }
}

/// Whether a pad that still works can have changed so.
pub fn is_possible(factor: f64) -> bool {
    let [least, largest] = FACTORS;
    (least..=largest).contains(&factor)
}

fn reach_mm(decoder: &Decoder) -> f64 {
    decoder.inverse().map_or(REACH_MM, |inverse| f64::from(inverse.field().radius_mm()))
}

/// Whether most readings are not one load on the decoder's pad. A gain that all channels share leaves nothing over.
fn is_foreign(readings: &[MeanReading], inverse: &Inverse) -> bool {
    let foreign = readings.iter().filter(|it| watch::warns(inverse, &it.strain) != Some(false)).count();
    2 * foreign > readings.len()
}

/// Standard deviation of a mean force, as a share of it, with that of the weight.
fn deviation(readings: &[MeanReading], force_n: f64, inverse: Option<&Inverse>) -> f64 {
    // σ² = w² + (v̄ + q / n) / F̄², where w is the weight's own share, q the scatter of n readings, and v the variance of a
    // reading's force by what lasts: the field that the decoder does not know, and noise that holding longer does not average out.
    let count = readings.len() as f64;
    let off_n2 = |it: &MeanReading| {
        let off_n = f64::from(it.contact.fz_n) - force_n;
        off_n * off_n
    };
    let scatter_n2 = readings.iter().map(off_n2).sum::<f64>() / (count - 1.0).max(1.0);
    let lasting_n2 = inverse.map_or(0.0, |inverse| {
        readings.iter().filter_map(|it| variance_n2(inverse, it)).sum::<f64>() / count
    });
    libm::sqrt(WEIGHT_SHARE * WEIGHT_SHARE + (lasting_n2 + scatter_n2 / count) / (force_n * force_n))
}

/// Variance of a normal force without that of the gain that all channels share.
fn variance_n2(inverse: &Inverse, reading: &MeanReading) -> Option<f64> {
    // C₅₅ − g² Fz², see [`Noise::gain`]
    let estimate = inverse.estimate(&reading.strain)?;
    let by_gain_n = inverse.noise().gain * f64::from(estimate.contact.fz_n);
    Some((estimate.covariance[4][4] - by_gain_n * by_gain_n).max(0.0))
}
