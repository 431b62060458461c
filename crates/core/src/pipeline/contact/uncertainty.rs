//! How sure a decoded contact is: the channels' noise, and what a calibration does not know.

use crate::quantity::{CHANNELS, Contact};
use tactpad_numeric::linear::Factor;

/// The unknowns: x, y in mm; Fx, Fy, Fz in N.
pub const UNKNOWNS: usize = 5;

/// A symmetric matrix over the unknowns.
pub type Covariance = [[f64; UNKNOWNS]; UNKNOWNS];

/// How the channels scatter around the field's answer, as the decoder gets them, and how unsure the field is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Noise {
    /// Standard deviation of each channel without load.
    pub additive_uv: [f64; CHANNELS],
    /// Standard deviation as a share of the channel's own reading.
    pub share: [f64; CHANNELS],
    /// Standard deviation of what grows with the force alone: a finger that is not still.
    pub force_uv_per_n: [f64; CHANNELS],
    /// Standard deviation of what the field says of a force of 1 N.
    pub field_uv_per_n: [f64; CHANNELS],
    /// Standard deviation of a gain that all channels share.
    pub gain: f64,
    /// Covariance of what the field's errors do to x, y (mm), and to Fx, Fy, Fz as shares of the whole force, alike all over the
    /// plate: all of them where the pad was never measured, and what the modes leave out where it was.
    pub by_field: Covariance,
}

/// Variances of the channels at one reading.
#[derive(Clone, Copy, Debug)]
pub struct Variances {
    /// Variance by the reading's own noise, µV².
    pub noise: [f64; CHANNELS],
    /// Variance by the field's own error, µV².
    pub field: [f64; CHANNELS],
}

/// Estimate of a contact by the channels, with its covariance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// The most likely contact.
    pub contact: Contact,
    /// Covariance of x, y (mm), Fx, Fy, Fz (N), for the noise that the decoder was given.
    pub covariance: Covariance,
    /// Sum of the squares of what the contact does not explain, in the channels' standard deviations. Of one contact on
    /// the pad that the field describes it is about 4, its degrees of freedom: nine channels, five unknowns.
    pub misfit: f64,
}

impl Estimate {
    /// The same with the forces' uncertainty in another measure of force, which counts so many times as much.
    #[must_use]
    pub fn with_forces_times(mut self, ratio: f64) -> Self {
        let times = |unknown: usize| if unknown < 2 { 1.0 } else { ratio };
        for (i, row) in self.covariance.iter_mut().enumerate() {
            row.iter_mut().enumerate().for_each(|(j, value)| *value *= times(i) * times(j));
        }
        self
    }
}

/// The estimate's dependence on the channels around a contact.
#[derive(Clone, Copy, Debug)]
pub(super) struct Linear {
    /// K = H⁻¹ JᵀW: of the unknowns by the channels, per microvolt.
    pub(super) response: [[f64; CHANNELS]; UNKNOWNS],
    /// H⁻¹ Λ H⁻¹: what is left of the prior.
    prior: Covariance,
}

impl Noise {
    /// Channels that scatter so around a field that is certain.
    pub const fn of_channels(additive_uv: [f64; CHANNELS], share: [f64; CHANNELS]) -> Self {
        Self {
            additive_uv,
            share,
            force_uv_per_n: [0.0; CHANNELS],
            field_uv_per_n: [0.0; CHANNELS],
            gain: 0.0,
            by_field: [[0.0; UNKNOWNS]; UNKNOWNS],
        }
    }

    /// The same with all deviations of the channels larger by a factor.
    #[must_use]
    pub fn widened(self, factor: f64) -> Self {
        let times = |deviations: [f64; CHANNELS]| deviations.map(|deviation| factor * deviation);
        Self {
            additive_uv: times(self.additive_uv),
            share: times(self.share),
            force_uv_per_n: times(self.force_uv_per_n),
            ..self
        }
    }

    /// Covariance of a contact with this force by those of the field's errors that are alike all over the plate.
    pub(super) fn covariance_by_field(&self, force_n: &[f64; 3]) -> Covariance {
        // S B S: the shares B of the force in newtons again.
        let [fx_n, fy_n, fz_n] = *force_n;
        let whole_n = libm::sqrt(fx_n * fx_n + fy_n * fy_n + fz_n * fz_n);
        let scale = [1.0, 1.0, whole_n, whole_n, whole_n];
        std::array::from_fn(|i| std::array::from_fn(|j| scale[i] * self.by_field[i][j] * scale[j]))
    }

    /// For these readings, under about this force.
    pub fn variances(&self, uv: &[f64; CHANNELS], force_n: f64) -> Variances {
        // With a force F a channel u has σ² = a² + (b u)² + (c F)² by noise, and (d F)² by the field.
        let square = |number: f64| number * number;
        let noise = |k: usize| {
            let (own, force) = (self.share[k] * uv[k], self.force_uv_per_n[k] * force_n);
            square(self.additive_uv[k]) + square(own) + square(force)
        };
        Variances {
            noise: std::array::from_fn(noise),
            field: self.field_uv_per_n.map(|uv_per_n| square(uv_per_n * force_n)),
        }
    }
}

impl Variances {
    /// One over each channel's variance.
    pub(super) fn weights(&self) -> [f64; CHANNELS] {
        std::array::from_fn(|k| 1.0 / (self.noise[k] + self.field[k]))
    }
}

impl Estimate {
    /// How far another contact is from this one, squared, in standard deviations by the covariance; `None` if that has no
    /// inverse.
    pub fn distance_square(&self, other: &[f64; UNKNOWNS]) -> Option<f64> {
        // Δᵀ C⁻¹ Δ
        let Contact { x_mm, y_mm, fx_n, fy_n, fz_n } = self.contact;
        let here = [x_mm, y_mm, fx_n, fy_n, fz_n].map(f64::from);
        let off: [f64; UNKNOWNS] = std::array::from_fn(|k| other[k] - here[k]);
        let solved = Factor::of(&self.covariance)?.solve(&off);
        Some(off.iter().zip(solved).map(|(off, solved)| off * solved).sum())
    }
}

impl Linear {
    /// `rows` are the slopes J of the channels, `prior` is Λ, one over the prior's covariance: a diagonal matrix.
    pub(super) fn of(
        rows: &[[f64; UNKNOWNS]; CHANNELS],
        weights: &[f64; CHANNELS],
        prior: &Covariance,
    ) -> Option<Self> {
        // H = JᵀWJ + Λ
        let mut curvature = *prior;
        for (row, weight) in rows.iter().zip(weights) {
            for (line, left) in curvature.iter_mut().zip(row) {
                line.iter_mut().zip(row).for_each(|(entry, right)| *entry += weight * left * right);
            }
        }
        let inverse = Factor::of(&curvature)?.inverse();
        let response = std::array::from_fn(|i| {
            std::array::from_fn(|k| {
                weights[k] * inverse[i].iter().zip(&rows[k]).map(|(a, b)| a * b).sum::<f64>()
            })
        });
        let prior = std::array::from_fn(|i| {
            std::array::from_fn(|j| (0..UNKNOWNS).map(|k| inverse[i][k] * prior[k][k] * inverse[k][j]).sum())
        });
        Some(Self { response, prior })
    }

    /// Covariance of an estimate with this force, where the field's errors have the covariance `by_field`.
    pub(super) fn covariance(
        &self,
        noise: &Noise,
        variances: &Variances,
        force_n: &[f64; 3],
        by_field: &Covariance,
    ) -> Covariance {
        // C = K N Kᵀ + H⁻¹ Λ H⁻¹ + g² f fᵀ + what the field's errors do, where N are the noise's variances, and g is the deviation
        // of the gain that all channels share, which acts along the force f.
        let [fx_n, fy_n, fz_n] = *force_n;
        let along = [0.0, 0.0, fx_n, fy_n, fz_n].map(|n| noise.gain * n);
        std::array::from_fn(|i| {
            std::array::from_fn(|j| {
                let by_noise: f64 = (0..CHANNELS)
                    .map(|k| self.response[i][k] * variances.noise[k] * self.response[j][k])
                    .sum();
                by_noise + self.prior[i][j] + by_field[i][j] + along[i] * along[j]
            })
        })
    }
}
