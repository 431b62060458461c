//! The smallest error that the twin's noise allows, whatever the decoder: the Cramér-Rao bound.
//!
//! No unbiased decoder's covariance C is below the inverse of Fisher's information:
//!
//! ```text
//! C ≥ I⁻¹,    I = Jᵀ W J,    Jₖᵢ = ∂sₖ/∂(x, y, Fx, Fy, Fz)ᵢ,    W = diag(1/σₖ²)
//! ```
//!
//! with the pad's true channels s and their variances σ². Only the white and the relative noise count, as they are injected: not
//! hysteresis, creep, drift, pickup or a wrong label. That σ depends on the contact, too, would add information of second order
//! in the relative noise; it is left out.
//!
//! Source: C. R. Rao, Bull. Calcutta Math. Soc. 37 (1945) 81; H. Cramér, Mathematical Methods of Statistics (1946).

use std::f64::consts::FRAC_2_PI;

use super::measurement::{RATE_HZ, READINGS};
use tactpad_core::pad::device::Device;
use tactpad_core::pad::field::PadField;
use tactpad_core::pad::readout::Readout;
use tactpad_core::pad::twin::bridges;
use tactpad_core::quantity::{CHANNELS, Contact};
use tactpad_core::tables::measured::Label;
use tactpad_numeric::linear::Factor;

/// Half the span of the differences that make J: small against the field's features, large against its rounding.
const HALF_SPAN: f32 = 0.05;
/// Least standard deviation of a channel.
const QUIET_UV: f64 = 1e-3;

/// How a contact is read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ContactReading {
    /// Once, as a row of a time series.
    Single,
    /// As the mean over a second, as a static sample.
    Mean,
}

/// A pad whose parameters and noise are known.
#[derive(Clone, Debug)]
pub struct Bound {
    field: PadField,
    readout: Readout,
    temperature_c: f64,
    /// Standard deviations of one reading: in µV, and as a share of the reading.
    additive_uv: [f64; CHANNELS],
    share: [f64; CHANNELS],
    /// Variance of a mean's relative noise, as a share of a single reading's.
    relative_variance: f64,
}

impl Bound {
    /// The bound of the pad that `seed` draws of `device`, whose field is `field`.
    pub fn new(device: &Device, field: &PadField, seed: u64) -> Self {
        let device = tactpad_core::pad::twin::drawn(device, seed);
        let noise = device.behaviour.noise;
        Self {
            field: PadField { sensitivities: Vec::new(), ..field.clone() },
            readout: Readout::of(&device),
            temperature_c: device.behaviour.thermal.reference_c,
            additive_uv: noise.additive_uv,
            share: noise.share,
            relative_variance: variance_of_mean(noise.share_time_s),
        }
    }

    /// Least covariance of x, y (mm), Fx, Fy, Fz (N) of this contact; `None` where the channels do not tell it, as without
    /// force.
    pub fn covariance(&self, contact: &Label, reading: ContactReading) -> Option<[[f64; 5]; 5]> {
        let uv = self.signal_uv(contact.numbers());
        let slopes: [[f64; CHANNELS]; 5] = std::array::from_fn(|k| self.slope(contact, k));
        // I = Σₖ Jₖ Jₖᵀ/σₖ², with row k of J in `slopes[..][k]`.
        let mut information = [[0.0; 5]; 5];
        for channel in 0..CHANNELS {
            let weight = 1.0 / self.variance(channel, uv[channel], reading);
            for (i, left) in slopes.iter().enumerate() {
                for (entry, right) in information[i].iter_mut().zip(&slopes) {
                    *entry += weight * left[channel] * right[channel];
                }
            }
        }
        Factor::of(&information).map(|factor| factor.inverse())
    }

    /// Mean magnitude of the error of each of x, y, Fx, Fy, Fz over contacts, if all errors are as small as they can be;
    /// contacts that the channels do not tell are left out.
    pub fn expected(&self, contacts: &[Label], reading: ContactReading) -> [f64; 5] {
        let covariances: Vec<_> = contacts.iter().filter_map(|it| self.covariance(it, reading)).collect();
        let count = covariances.len().max(1) as f64;
        // E|e| = √(2/π) σ of a normal error.
        let mean = |k: usize| covariances.iter().map(|it| it[k][k].sqrt()).sum::<f64>() / count;
        std::array::from_fn(|k| FRAC_2_PI.sqrt() * mean(k))
    }

    /// Column of J by a central difference.
    fn slope(&self, contact: &Label, along: usize) -> [f64; CHANNELS] {
        // Beyond the field's rim the channels stay as they are: there, the slope is that a little inwards.
        let beyond = contact.x_mm.hypot(contact.y_mm) / f64::from(self.field.signals.radius_mm() - HALF_SPAN);
        let [x_mm, y_mm] = [contact.x_mm, contact.y_mm].map(|mm| mm / beyond.max(1.0));
        // (s(p + h) − s(p − h))/2h.
        let at = |step: f32| {
            let mut numbers = Label { x_mm, y_mm, ..*contact }.numbers();
            numbers[along] += f64::from(step);
            self.signal_uv(numbers)
        };
        let (above, below) = (at(HALF_SPAN), at(-HALF_SPAN));
        std::array::from_fn(|channel| (above[channel] - below[channel]) / (2.0 * f64::from(HALF_SPAN)))
    }

    fn signal_uv(&self, numbers: [f64; 5]) -> [f64; CHANNELS] {
        let [x_mm, y_mm, fx_n, fy_n, fz_n] = numbers.map(|number| number as f32);
        let bridges = bridges(&self.field, &Contact { x_mm, y_mm, fx_n, fy_n, fz_n });
        self.readout
            .signal_uv(&self.readout.strain_uv(&bridges), &self.readout.conditions(self.temperature_c))
    }

    /// σ² = a²/n + v (b s)² with the relative noise's v of [`variance_of_mean`]; a single reading has n = v = 1.
    fn variance(&self, channel: usize, uv: f64, reading: ContactReading) -> f64 {
        let (additive, relative) = match reading {
            ContactReading::Single => (1.0, 1.0),
            ContactReading::Mean => (1.0 / f64::from(READINGS), self.relative_variance),
        };
        let own = additive * self.additive_uv[channel].powi(2);
        (own + relative * (self.share[channel] * uv).powi(2)).max(QUIET_UV * QUIET_UV)
    }
}

/// Variance of the mean of a static sample's n readings, as a share of a single reading's, for noise whose autocorrelation decays
/// with this time constant τ:
///
/// ```text
/// (n + 2 Σ (n − k) ρ(k))/n²,    ρ(k) = exp(−k/(rate τ)),    k = 1 … n − 1
/// ```
fn variance_of_mean(time_s: f64) -> f64 {
    let readings = f64::from(READINGS);
    let correlation = |steps: f64| if time_s > 0.0 { (-steps / RATE_HZ / time_s).exp() } else { 0.0 };
    let later: f64 =
        (1..READINGS).map(f64::from).map(|steps| 2.0 * (readings - steps) * correlation(steps)).sum();
    (readings + later) / (readings * readings)
}

#[cfg(test)]
mod tests {
    use super::*;
    use tactpad_core::pipeline::contact::inverse::Inverse;
    use tactpad_core::pipeline::contact::uncertainty::Noise;
    use tactpad_core::quantity::Strain;

    fn noisy(share_time_s: f64) -> Device {
        let mut device = Device::nominal();
        let noise = &mut device.behaviour.noise;
        (noise.additive_uv, noise.share, noise.share_time_s) =
            ([8.0; CHANNELS], [0.01; CHANNELS], share_time_s);
        device
    }

    #[test]
    fn it_is_what_the_inverse_decoder_says_of_itself() {
        let (device, field) = (noisy(0.0), PadField::nominal());
        let bound = Bound::new(&device, &field, 1);
        let decoder =
            Inverse::new(field.signals.clone(), Noise::of_channels([8.0; CHANNELS], [0.01; CHANNELS]));
        for (x_mm, y_mm, fx_n) in [(0.0, 0.0, 0.5), (12.0, -5.0, 0.0), (-20.0, 18.0, -1.0)] {
            let contact = Label { x_mm, y_mm, fx_n, fy_n: 0.3, fz_n: 4.0 };
            let least = bound.covariance(&contact, ContactReading::Single).unwrap();
            let Strain { uv } = field.signals.strain_uv(&contact.into());
            let stated = decoder.estimate(&Strain { uv }).unwrap().covariance;
            // The decoder's prior makes it a little surer.
            let ratio = |k: usize| (stated[k][k] / least[k][k]).sqrt();
            assert!((0..5).all(|k| (0.97..1.005).contains(&ratio(k))), "{:?}", [0, 1, 2, 3, 4].map(ratio));
        }
    }

    #[test]
    fn a_mean_is_as_sure_as_its_noise_lets_it() {
        let contact = Label { x_mm: 5.0, y_mm: 5.0, fz_n: 3.0, ..Label::default() };
        let variance = |share_time_s: f64, reading: ContactReading| {
            let bound = Bound::new(&noisy(share_time_s), &PadField::nominal(), 1);
            bound.covariance(&contact, reading).unwrap()[4][4]
        };
        let gain = |share_time_s: f64| {
            variance(share_time_s, ContactReading::Single) / variance(share_time_s, ContactReading::Mean)
        };
        assert!(
            (gain(0.0) / f64::from(READINGS) - 1.0).abs() < 1e-6,
            "fresh noise goes as one over the count"
        );
        assert!((1.0..4.0).contains(&gain(1e6)), "noise that stays is not averaged away");
    }

    #[test]
    fn without_force_nothing_is_told() {
        let bound = Bound::new(&noisy(1.0), &PadField::nominal(), 1);
        assert_eq!(bound.covariance(&Label::default(), ContactReading::Mean), None);
        assert_eq!(bound.expected(&[Label::default()], ContactReading::Mean), [0.0; 5]);
    }
}
