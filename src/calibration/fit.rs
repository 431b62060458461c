//! The fit: Gauss and Newton's method on all numbers, for several sizes of the background.

use std::fmt;

use super::contacts::{Maps, Measured, Place};
use super::model::Layout;
use super::noise::{self, Rest};
use crate::contact::inverse::{Inverse, Noise};
use crate::device::Device;
use crate::device::parameter::Parameter;
use crate::field::{PadField, Sensitivity};
use crate::influence::{InfluenceField, MAPS};
use crate::linear::{LargeFactor, Symmetric};
use crate::measured::Row;
use crate::quantity::CHANNELS;

/// Sizes of the background that are tried, as a share of each map.
const BACKGROUNDS: [f64; 5] = [1e-6, 0.004, 0.01, 0.025, 0.06];
/// Steps for each size; the channels are nearly linear in the numbers.
const STEPS: usize = 4;

/// A calibrated pad.
#[derive(Clone, Debug)]
pub struct Calibration {
    /// The pad's own field.
    pub field: InfluenceField,
    /// The channels' noise around it.
    pub noise: Noise,
    /// Each channel's gain.
    pub gain: [f64; CHANNELS],
    /// Poses and stiffnesses: number, value, standard deviation.
    pub physical: Vec<(Parameter, f64, f64)>,
    /// Size of the smooth background, as a share of each map.
    pub background: f64,
    /// Contacts that it was fitted to.
    pub contacts: usize,
}

/// Why there is no calibration.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FitError {
    /// There are fewer contacts than numbers to find.
    TooFew {
        /// There are so many.
        contacts: usize,
        /// It takes so many.
        least: usize,
    },
    /// The numbers are beyond anything that a pad can read.
    Senseless,
}

impl fmt::Display for FitError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::TooFew { contacts, least } => {
                write!(
                    f,
                    "it takes {least} contacts with nine channels at least, and here are {contacts}; measure more"
                )
            }
            Self::Senseless => f.write_str("the channels are beyond anything that a pad can read"),
        }
    }
}

impl std::error::Error for FitError {}

impl Calibration {
    /// The decoder of this pad.
    pub fn decoder(&self) -> Inverse {
        Inverse::new(self.field.clone(), self.noise)
    }
}

/// Calibrates the pad that was measured. `field` is that of `device`, the pad as it is thought to be. Channels are relative
/// to the untouched pad.
///
/// # Errors
/// No contact, or senseless numbers.
pub fn fit(contacts: &[Row], device: &Device, field: &PadField) -> Result<Calibration, FitError> {
    let problem = Problem::of(contacts, device, field);
    if problem.contacts.is_empty() {
        return Err(FitError::TooFew { contacts: 0, least: 1 });
    }
    let fits = BACKGROUNDS.iter().filter_map(|background| problem.fitted(*background));
    let best =
        fits.max_by(|one, other| one.evidence.total_cmp(&other.evidence)).ok_or(FitError::Senseless)?;
    Ok(problem.calibration(&best))
}

/// What is fitted.
struct Problem<'f> {
    field: &'f PadField,
    sensitivities: Vec<&'f Sensitivity>,
    layout: Layout,
    contacts: Vec<Measured>,
    /// Root mean square of each map over the plate.
    scale: Maps,
    plate_mm: f64,
    reach_mm: f64,
}

/// The numbers for one size of the background.
struct Fit {
    background: f64,
    values: Vec<f64>,
    noise: Noise,
    factor: LargeFactor,
    evidence: f64,
}

impl<'f> Problem<'f> {
    fn of(rows: &[Row], device: &Device, field: &'f PadField) -> Self {
        let is_free = |it: &&Sensitivity| it.parameter.module().is_some();
        let sensitivities: Vec<&Sensitivity> = field.sensitivities.iter().filter(is_free).collect();
        let plate_mm = device.plate.diameter_mm / 2.0;
        let contacts =
            rows.iter().filter_map(|row| Measured::of(field, &sensitivities, plate_mm, row)).collect();
        let layout = Layout { physical: sensitivities.iter().map(|it| it.parameter).collect() };
        let reach_mm = f64::from(field.signals.radius_mm());
        Self { field, sensitivities, layout, contacts, scale: scale(&field.signals), plate_mm, reach_mm }
    }

    /// `None` where the numbers make no sense.
    fn fitted(&self, background: f64) -> Option<Fit> {
        let (before, precisions) = (self.layout.nominal(), self.layout.precisions(background));
        let (mut values, mut noise) = (before.clone(), noise::BEFORE);
        let mut found = None;
        for _ in 0..STEPS {
            let step = self.step(&values, &noise, &before, &precisions)?;
            values.iter_mut().zip(&step.change).for_each(|(value, change)| *value += change);
            let (rests, freedom) = (self.rests(&values), self.freedom(&precisions, &step.factor));
            let evidence = self.evidence(&values, &noise, &before, &precisions, &step.factor);
            let used = noise;
            noise = noise::of_rests(&rests, freedom);
            found =
                Some(Fit { background, values: values.clone(), noise: used, factor: step.factor, evidence });
        }
        found.filter(|fit| fit.values.iter().all(|value| value.is_finite()))
    }

    fn step(&self, values: &[f64], noise: &Noise, before: &[f64], precisions: &[f64]) -> Option<Step> {
        let mut normal = Symmetric::zeros(self.layout.size());
        let mut right: Vec<f64> =
            precisions.iter().zip(before.iter().zip(values)).map(|(p, (b, v))| p * (b - v)).collect();
        precisions.iter().enumerate().for_each(|(at, precision)| normal.add_diagonal(at, *precision));
        for contact in &self.contacts {
            self.layout.readings(values, &self.scale, contact, |channel, uv, slopes| {
                let weight = 1.0 / variance(noise, channel, contact.uv[channel]);
                let rest = contact.uv[channel] - uv;
                normal.add_product(weight, slopes);
                right.iter_mut().zip(slopes).for_each(|(right, slope)| *right += weight * slope * rest);
            });
        }
        let factor = normal.factorised()?;
        Some(Step { change: factor.solve(&right), factor })
    }

    /// Which part of the readings the fitted numbers did not take up.
    fn freedom(&self, precisions: &[f64], factor: &LargeFactor) -> f64 {
        let variances = factor.inverse_diagonal();
        let taken: f64 = precisions.iter().zip(variances).map(|(before, after)| 1.0 - before * after).sum();
        1.0 - taken / (CHANNELS * self.contacts.len()) as f64
    }

    /// What the channels leave over.
    fn rests(&self, values: &[f64]) -> [Vec<Rest>; CHANNELS] {
        let mut rests = [const { Vec::new() }; CHANNELS];
        for contact in &self.contacts {
            self.layout.readings(values, &self.scale, contact, |channel, uv, _| {
                rests[channel].push((contact.uv[channel], contact.uv[channel] - uv));
            });
        }
        rests
    }

    /// ln of the probability of the measured channels, but for a constant.
    fn evidence(
        &self,
        values: &[f64],
        noise: &Noise,
        before: &[f64],
        precisions: &[f64],
        factor: &LargeFactor,
    ) -> f64 {
        let mut sum = -factor.log_determinant();
        for (precision, (before, value)) in precisions.iter().zip(before.iter().zip(values)) {
            sum += precision.ln() - precision * (before - value).powi(2);
        }
        for contact in &self.contacts {
            self.layout.readings(values, &self.scale, contact, |channel, uv, _| {
                let variance = variance(noise, channel, contact.uv[channel]);
                sum -= (contact.uv[channel] - uv).powi(2) / variance + variance.ln();
            });
        }
        0.5 * sum
    }

    fn calibration(&self, fit: &Fit) -> Calibration {
        let Fit { background, values, noise, factor, .. } = fit;
        let first = values.len() - 3 * CHANNELS * super::model::TERMS - self.layout.physical.len();
        let deviation = |at: usize| {
            let mut unit = vec![0.0; values.len()];
            unit[at] = 1.0;
            factor.solve(&unit)[at].sqrt()
        };
        let physical = self.layout.physical.iter().enumerate();
        Calibration {
            field: self.corrected(values),
            noise: *noise,
            gain: std::array::from_fn(|channel| Layout::gain(values, channel)),
            physical: physical
                .map(|(index, it)| (*it, values[first + index], deviation(first + index)))
                .collect(),
            background: *background,
            contacts: self.contacts.len(),
        }
    }

    /// The pad's own field.
    fn corrected(&self, values: &[f64]) -> InfluenceField {
        let signals = &self.field.signals;
        InfluenceField::sampled(f64::from(signals.spacing_mm()), self.reach_mm, self.reach_mm, |place_mm| {
            let place = Place::of(self.field, &self.sensitivities, self.plate_mm, place_mm);
            let maps = self.layout.maps(values, &self.scale, &place);
            std::array::from_fn::<f64, MAPS, _>(|map| maps[map / 3][map % 3])
        })
    }
}

/// A step of the numbers, and the factor of their curvature.
struct Step {
    change: Vec<f64>,
    factor: LargeFactor,
}

fn variance(noise: &Noise, channel: usize, uv: f64) -> f64 {
    noise.additive_uv[channel].powi(2) + (noise.share[channel] * uv).powi(2)
}

/// Root mean square of each map over the plate; of a map that is small beside its channel's others, a fifth of theirs.
fn scale(signals: &InfluenceField) -> Maps {
    const RINGS: usize = 14;
    const PLACES: usize = 24;
    let mut squares = [[0.0; 3]; CHANNELS];
    let mut area = 0.0;
    for ring in 0..RINGS {
        let radius = f64::from(signals.radius_mm()) * (ring as f64 + 0.5) / RINGS as f64;
        for place in 0..PLACES {
            let angle = std::f64::consts::TAU * place as f64 / PLACES as f64;
            let gains = signals.gains((radius * angle.cos()) as f32, (radius * angle.sin()) as f32).value;
            for (square, gain) in squares.as_flattened_mut().iter_mut().zip(gains.as_flattened()) {
                *square += radius * gain * gain;
            }
            area += radius;
        }
    }
    squares.map(|axes| {
        let roots = axes.map(|square: f64| (square / area).sqrt());
        let largest = roots.iter().copied().fold(0.0, f64::max);
        roots.map(|root| root.max(0.2 * largest))
    })
}
