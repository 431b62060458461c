//! The least-squares problem of a calibration: residuals, normal equations and log evidence of all parameters.
//!
//! The parameters θ have a Gaussian prior with mean m and precisions P. What was measured is y = f(θ) + r, where each
//! contact's residual has the covariance V of [`NoiseModel`] and each jump of a zero the variance of its drift. The posterior's
//! maximum is found by Gauss and Newton's method with V, P and the drifts estimated anew at each step (iteratively
//! reweighted least squares). Its logarithm's curvature H then gives the posterior covariance H⁻¹ and the evidence.
//!
//! Source: D. J. C. MacKay, Bayesian interpolation, Neural Computation 4 (1992) 415 (evidence by the Laplace approximation,
//! effective number of parameters).

use std::collections::BTreeMap;

use super::contacts::{Lags, Maps, Measured, Place, TERMS};
use super::model::Layout;
use super::noise::{FieldCovariance, NoisePrior};
use super::noise_model::{NoiseModel, Residual};
use super::normal_equations::{NormalEquations, Step};
use super::plate::{places, scale};
use super::prior::Prior;
use super::prior_deviations::PriorDeviations;
use crate::numeric::linear::{LargeFactor, dot};
use crate::pad::device::Device;
use crate::pad::field::Sensitivity;
use crate::pad::influence::{InfluenceField, MAPS};
use crate::pipeline::compensation::creep::Creep;
use crate::pipeline::compensation::hysteresis::{Hysteresis, PLAYS};
use crate::pipeline::compensation::thermal::Thermal;
use crate::quantity::{CHANNELS, Strain};
use crate::tables::recording::{Recording, Untouched};

/// Most Gauss-Newton steps of a fit; the channels are nearly linear in the parameters.
const STEPS_MAX: usize = 12;
/// A step that changes the log evidence by less is the last.
const LOG_EVIDENCE_TOLERANCE: f64 = 0.3;
/// Normal force at which the field's posterior covariance is evaluated: half of full scale.
const REFERENCE_FORCE_N: f64 = 2.5;
/// Least part of the readings that counts as degrees of freedom, however many parameters are fitted.
const DEGREES_OF_FREEDOM_RATIO_MIN: f64 = 0.05;
/// Standard deviation of a zero's drift between two readings: its least value, and the one that the fit begins with.
const DRIFT_MIN_UV: f64 = 1.0;
const DRIFT_UV: f64 = 10.0;
/// A jump's standard deviation is at least this part of its residual, so that an outlier loses weight: temperature may have
/// changed.
const JUMP_PART: f64 = 1.0 / 3.0;

/// What is fitted, and to what.
#[derive(Clone)]
pub(super) struct Problem<'f> {
    prior: &'f Prior,
    recording: &'f Recording,
    reference_c: Option<f64>,
    sensitivities: Vec<&'f Sensitivity>,
    pub(super) layout: Layout,
    /// Rows of the recording, and what was measured in them.
    contacts: Vec<(usize, Measured)>,
    /// From one reading of the untouched pad to the next.
    jumps: Vec<Jump>,
    /// Root mean square of each map over the plate.
    scale: Maps,
    plate_mm: f64,
    reach_mm: f64,
}

/// The untouched pad at two times.
#[derive(Clone)]
struct Jump {
    rows: [usize; 2],
    change_uv: [f64; CHANNELS],
    /// Change of the play operators' states.
    lags: Lags,
    /// Change of the creep states.
    crept_uv: [f64; CHANNELS],
}

/// Hyperparameters that stay fixed while the parameters are fitted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Settings {
    /// Prior standard deviation of the background, as a share of each map's root mean square; zero: none.
    pub(super) background: f64,
    /// Thresholds of the play operators, in strains before gains; an operator with zero does nothing.
    pub(super) thresholds_uv: [f64; PLAYS],
    /// Relaxation time of creep; zero: no creep.
    pub(super) creep_time_s: f64,
}

/// Hyperparameters that are estimated anew at each step.
#[derive(Clone, Copy, Debug)]
pub(super) struct Estimates {
    pub(super) noise_model: NoiseModel,
    pub(super) prior_deviations: PriorDeviations,
    /// Standard deviation of each zero's drift from one reading to the next.
    pub(super) drift_uv: [f64; CHANNELS],
}

/// The posterior for some settings.
#[derive(Clone, Debug)]
pub(super) struct Fit {
    pub(super) settings: Settings,
    /// Its maximum, in the order of [`Layout`].
    pub(super) values: Vec<f64>,
    pub(super) estimates: Estimates,
    /// Of the curvature H.
    factor: LargeFactor,
    /// ln p(y | settings) by the Laplace approximation, but for a constant that the settings share.
    pub(super) log_evidence: f64,
}

impl Fit {
    /// Posterior standard deviation of a parameter.
    pub(super) fn deviation(&self, at: usize) -> f64 {
        // √(H⁻¹)ᵢᵢ = √(eᵢᵀ H⁻¹ eᵢ).
        let half = self.halved(&[(at, 1.0)]);
        dot(&half, &half).sqrt()
    }

    /// L⁻¹c of a linear combination cᵀθ of few parameters, where H = L Lᵀ: the posterior covariance of two combinations is
    /// cᵀ H⁻¹ d = (L⁻¹c)ᵀ (L⁻¹d).
    pub(super) fn halved(&self, combination: &[(usize, f64)]) -> Vec<f64> {
        let mut whole = vec![0.0; self.values.len()];
        combination.iter().for_each(|(at, factor)| whole[*at] = *factor);
        self.factor.solve_lower(&whole)
    }
}

impl<'f> Problem<'f> {
    /// `rows` are the contacts to fit to; all others only tell the load path. Without polynomials for a background.
    pub(super) fn of(
        recording: &'f Recording,
        reference_c: Option<f64>,
        rows: &[usize],
        device: &Device,
        prior: &'f Prior,
    ) -> Self {
        let field = &prior.field;
        let is_free = |it: &&Sensitivity| it.parameter.module().is_some();
        let sensitivities: Vec<&Sensitivity> = field.sensitivities.iter().filter(is_free).collect();
        let plate_mm = device.plate.radius_mm();
        let measured = |at: &usize| {
            let row = recording.tared().rows.get(*at)?;
            Some((*at, Measured::of(field, &sensitivities, plate_mm, row, reference_c)?))
        };
        let contacts = rows.iter().filter_map(measured).collect();
        let layout = Layout { physical: sensitivities.iter().map(|it| it.parameter).collect(), terms: 0 };
        Self {
            jumps: recording.zeros().flat_map(jumps).collect(),
            prior,
            recording,
            reference_c,
            sensitivities,
            layout,
            contacts,
            scale: scale(&field.signals),
            plate_mm,
            reach_mm: f64::from(field.signals.radius_mm()),
        }
    }

    /// How many contacts there are.
    pub(super) const fn contacts(&self) -> usize {
        self.contacts.len()
    }

    /// The prior of the channels' noise.
    pub(super) const fn noise_prior(&self) -> &NoisePrior {
        &self.prior.noise
    }

    /// The same with polynomials for a background.
    pub(super) fn with_background(mut self) -> Self {
        self.layout.terms = TERMS;
        self
    }

    /// The maximum of the posterior. The search begins at `start`, or at the prior's mean. `None` where the curvature is not
    /// positive definite or a parameter not finite.
    pub(super) fn fitted(mut self, settings: Settings, start: Option<&Fit>) -> Option<Fit> {
        let mean = self.layout.prior_mean(self.prior);
        let mut values = mean.clone();
        let mut estimates = self.first_estimates();
        if let Some(start) = start {
            values.iter_mut().zip(&start.values).for_each(|(value, start)| *value = *start);
            estimates = start.estimates;
        }
        let mut found: Option<Fit> = None;
        for _ in 0..STEPS_MAX {
            // One Gauss-Newton step with the present hyperparameters.
            let precisions = self.layout.precisions(settings.background, &estimates.prior_deviations);
            self.follow_load_path(&values, &settings);
            let Step { delta, factor } = self.step(&values, &estimates, &mean, &precisions)?;
            values.iter_mut().zip(&delta).for_each(|(value, delta)| *value += delta);
            let residuals = self.residuals(&values);
            let variances = factor.inverse_diagonal();
            // ln p(y | settings) ≈ ln p(y | θ) + ln p(θ) − ½ ln det H at the maximum.
            let mut log_evidence = Self::log_likelihood_of_contacts(&residuals, &estimates.noise_model)?;
            log_evidence +=
                self.log_likelihood_of_jumps(&values, &estimates.drift_uv) - 0.5 * factor.log_determinant();
            log_evidence += log_prior(&values, &mean, &precisions);
            let gain =
                found.as_ref().map_or(f64::INFINITY, |previous| (log_evidence - previous.log_evidence).abs());
            found = Some(Fit { settings, values: values.clone(), estimates, factor, log_evidence });
            // Then the hyperparameters at the new parameters.
            let differences =
                self.layout.kinds().map(|(kind, at)| (kind, values[at] - mean[at], variances[at]));
            let freedom_ratio = self.degrees_of_freedom_ratio(&precisions, &variances);
            estimates = Estimates {
                prior_deviations: estimates.prior_deviations.reestimated(differences),
                noise_model: estimates.noise_model.reestimated(&residuals, freedom_ratio),
                drift_uv: self.drift_uv(&values),
            };
            if gain < LOG_EVIDENCE_TOLERANCE {
                break;
            }
        }
        found.filter(|fit| fit.values.iter().all(|value| value.is_finite()))
    }

    fn first_estimates(&self) -> Estimates {
        let is_tared = self.recording.is_tared();
        Estimates {
            noise_model: NoiseModel::prior(self.prior.noise),
            prior_deviations: if is_tared { PriorDeviations::TARED } else { PriorDeviations::RAW },
            drift_uv: [DRIFT_UV; CHANNELS],
        }
    }

    /// States of the play operators and of creep along the load path, by these parameters.
    fn follow_load_path(&mut self, values: &[f64], settings: &Settings) {
        if settings.thresholds_uv == [0.0; PLAYS] && settings.creep_time_s == 0.0 {
            return;
        }
        let strain = |(at, it): &(usize, Measured)| (*at, self.layout.load_uv(values, &self.scale, it));
        let strains: BTreeMap<usize, [f64; CHANNELS]> = self.contacts.iter().map(strain).collect();
        self.follow_creep(settings.creep_time_s, &strains);
        // Lags l = p − e of the play operators, relative to those of the untouched pad's readings.
        let hysteresis = Layout::hysteresis(values, &settings.thresholds_uv);
        for channel in 0..CHANNELS {
            let known = |at: usize| strains.get(&at).map(|uv| uv[channel]);
            let states = self.recording.states(channel, &hysteresis, known);
            for Jump { rows: [first, second], lags, .. } in &mut self.jumps {
                let changes = states[*second].iter().zip(states[*first]).map(|(to, from)| to - from);
                lags.iter_mut().zip(changes).for_each(|(lags, change_uv)| lags[channel] = change_uv);
            }
            let states = self.recording.relative(states);
            for (at, contact) in &mut self.contacts {
                contact.lags.iter_mut().zip(states[*at]).for_each(|(lags, lag_uv)| lags[channel] = lag_uv);
            }
        }
    }

    /// States of creep along the load path.
    fn follow_creep(&mut self, time_s: f64, strains: &BTreeMap<usize, [f64; CHANNELS]>) {
        if time_s == 0.0 {
            return;
        }
        for channel in 0..CHANNELS {
            let known = |at: usize| strains.get(&at).map(|uv| uv[channel]);
            let states = self.recording.crept(channel, time_s, known);
            for Jump { rows: [first, second], crept_uv, .. } in &mut self.jumps {
                crept_uv[channel] = states[*second][0] - states[*first][0];
            }
            let states = self.recording.relative(states);
            for (at, contact) in &mut self.contacts {
                [contact.crept_uv[channel]] = states[*at];
            }
        }
    }

    /// The Gauss-Newton step from θ (`values`).
    fn step(&self, values: &[f64], estimates: &Estimates, mean: &[f64], precisions: &[f64]) -> Option<Step> {
        let mut equations = NormalEquations::of_prior(precisions, mean, values);
        for (_, contact) in &self.contacts {
            let residual = self.residual(values, contact);
            let precision = estimates.noise_model.marginal_precision(&residual)?;
            equations.add_contact(&precision, &residual.residual_uv, |row| {
                self.layout.readings(values, &self.scale, contact, |channel, _, slopes| row(channel, slopes));
            });
        }
        self.each_jump(values, &estimates.drift_uv, |_, residual_uv, variance, derivatives| {
            equations.add(residual_uv, variance, derivatives);
        });
        equations.solved()
    }

    fn residual(&self, values: &[f64], contact: &Measured) -> Residual {
        // r = y − f(θ).
        let mut residual_uv = contact.uv;
        self.layout.readings(values, &self.scale, contact, |channel, uv, _| residual_uv[channel] -= uv);
        let label_jacobian = self.layout.label_jacobian(values, &self.scale, contact);
        let [fx_n, fy_n, fz_n] = contact.force_n;
        let force_n = libm::hypot(libm::hypot(fx_n, fy_n), fz_n);
        Residual { uv: contact.uv, force_n, residual_uv, label_jacobian }
    }

    fn residuals(&self, values: &[f64]) -> Vec<Residual> {
        self.contacts.iter().map(|(_, contact)| self.residual(values, contact)).collect()
    }

    /// Every jump of a zero: the channel, its residual beside hysteresis and creep, the variance of that, and its derivatives by
    /// the parameters.
    fn each_jump(
        &self,
        values: &[f64],
        drift_uv: &[f64; CHANNELS],
        mut then: impl FnMut(usize, f64, f64, &[f64]),
    ) {
        let mut derivatives = vec![0.0; self.layout.size()];
        for Jump { change_uv, lags, crept_uv, .. } in &self.jumps {
            for channel in 0..CHANNELS {
                derivatives.fill(0.0);
                let memory_uv = Layout::memory_uv(values, channel, lags, crept_uv, &mut derivatives);
                let residual_uv = change_uv[channel] - memory_uv;
                // σ = max(drift, |r|/3): beyond three standard deviations an outlier weighs 9/r².
                let deviation = drift_uv[channel].max(JUMP_PART * residual_uv.abs());
                then(channel, residual_uv, deviation * deviation, &derivatives);
            }
        }
    }

    /// Residual degrees of freedom as a share of the readings, (N − γ)/N, with γ = Σᵢ (1 − Pᵢ (H⁻¹)ᵢᵢ) the effective number of
    /// parameters: those that the contacts tell, not the prior (MacKay 1992).
    ///
    /// `precisions` are P, `variances` the diagonal of H⁻¹.
    fn degrees_of_freedom_ratio(&self, precisions: &[f64], variances: &[f64]) -> f64 {
        let effective: f64 =
            precisions.iter().zip(variances).map(|(precision, variance)| 1.0 - precision * variance).sum();
        (1.0 - effective / (CHANNELS * self.contacts.len()) as f64).max(DEGREES_OF_FREEDOM_RATIO_MIN)
    }

    /// Standard deviation of each channel's drift between readings of the zero, by the median magnitude of the jumps' residuals.
    fn drift_uv(&self, values: &[f64]) -> [f64; CHANNELS] {
        let mut magnitudes = [const { Vec::new() }; CHANNELS];
        self.each_jump(values, &[DRIFT_UV; CHANNELS], |channel, residual_uv, _, _| {
            magnitudes[channel].push(residual_uv.abs());
        });
        magnitudes.map(|mut magnitudes| {
            magnitudes.sort_by(f64::total_cmp);
            // Of a normal number the median magnitude is 0.6745 of its standard deviation.
            magnitudes
                .get(magnitudes.len() / 2)
                .map_or(DRIFT_UV, |median| (median / 0.6745).max(DRIFT_MIN_UV))
        })
    }

    /// ln p(contacts | θ) = −½ Σ (rᵀ V⁻¹ r + ln det V), but for a constant.
    fn log_likelihood_of_contacts(residuals: &[Residual], noise_model: &NoiseModel) -> Option<f64> {
        let cost = |residual| Some(noise_model.marginal_precision(residual)?.cost(&residual.residual_uv));
        let costs: Option<Vec<f64>> = residuals.iter().map(cost).collect();
        Some(-0.5 * costs?.iter().sum::<f64>())
    }

    /// ln p(jumps | θ) = −½ Σ (r²/σ² + ln σ²), but for a constant.
    fn log_likelihood_of_jumps(&self, values: &[f64], drift_uv: &[f64; CHANNELS]) -> f64 {
        let mut cost = 0.0;
        self.each_jump(values, drift_uv, |_, residual_uv, variance, _| {
            cost += residual_uv * residual_uv / variance + variance.ln();
        });
        -0.5 * cost
    }

    /// The contacts' channels at the reference temperature, without zeros, creep and hysteresis, and the written forces.
    pub(super) fn compensated(
        &self,
        values: &[f64],
        hysteresis: &Hysteresis,
        creep: &Creep,
    ) -> Vec<(Strain, [f64; 3])> {
        let mut recording = self.recording.clone().less(&Layout::zeros(values));
        if let Some(reference_c) = self.reference_c {
            let gain_per_c = std::array::from_fn(|channel| values[Layout::first_gain_slope() + channel]);
            let zero_uv_per_c = [0.0; CHANNELS];
            recording = recording.at_reference(&Thermal { reference_c, zero_uv_per_c, gain_per_c });
        }
        let compensated = recording.without_creep(creep).without_hysteresis(hysteresis);
        let contact = |(at, it): &(usize, Measured)| {
            let uv = compensated.rows.get(*at)?.uv?;
            Some((Strain { uv: uv.map(|uv| uv as f32) }, it.force_n))
        };
        self.contacts.iter().filter_map(contact).collect()
    }

    /// Posterior covariance of the channels, Σₖₗ = aₖᵀ H⁻¹ aₗ, at contacts all over the plate that are partly shear.
    pub(super) fn field_covariances(&self, fit: &Fit) -> Vec<FieldCovariance> {
        let shear_n = 0.4 * REFERENCE_FORCE_N;
        let forces_n = [
            [shear_n, 0.0, REFERENCE_FORCE_N],
            [0.0, shear_n, REFERENCE_FORCE_N],
            [-shear_n, -shear_n, REFERENCE_FORCE_N],
        ];
        let covariances = |place_mm: [f64; 2]| {
            let place = Place::of(&self.prior.field, &self.sensitivities, self.plate_mm, place_mm);
            forces_n.map(|force_n| {
                let contact = Measured::unmeasured(place.clone(), force_n);
                // H = L Lᵀ, so aₖᵀ H⁻¹ aₗ = (L⁻¹aₖ)ᵀ (L⁻¹aₗ).
                let mut halves = Vec::with_capacity(CHANNELS);
                self.layout.readings(&fit.values, &self.scale, &contact, |_, _, derivatives| {
                    halves.push(fit.factor.solve_lower(derivatives));
                });
                let product =
                    |one: &Vec<f64>, other: &Vec<f64>| one.iter().zip(other).map(|(a, b)| a * b).sum();
                FieldCovariance { place_mm, force_n, uv2: products(&halves, product) }
            })
        };
        places(self.reach_mm).flat_map(covariances).collect()
    }

    /// The pad's own field.
    pub(super) fn corrected(&self, values: &[f64]) -> InfluenceField {
        let signals = &self.prior.field.signals;
        InfluenceField::sampled(f64::from(signals.spacing_mm()), self.reach_mm, self.reach_mm, |place_mm| {
            let place = Place::of(&self.prior.field, &self.sensitivities, self.plate_mm, place_mm);
            let maps = self.layout.maps(values, &self.scale, &place);
            std::array::from_fn::<f64, MAPS, _>(|map| maps[map / 3][map % 3])
        })
    }
}

/// From each reading of the untouched pad to the next.
fn jumps(zeros: Vec<Untouched>) -> Vec<Jump> {
    let jump = |((first, earlier), (second, later)): (&Untouched, &Untouched)| Jump {
        rows: [*first, *second],
        change_uv: std::array::from_fn(|k| later[k] - earlier[k]),
        lags: [[0.0; CHANNELS]; PLAYS],
        crept_uv: [0.0; CHANNELS],
    };
    zeros.iter().zip(zeros.get(1..).unwrap_or_default()).map(jump).collect()
}

/// ln p(θ) = ½ Σᵢ (ln Pᵢ − Pᵢ (mᵢ − θᵢ)²), but for a constant.
fn log_prior(values: &[f64], mean: &[f64], precisions: &[f64]) -> f64 {
    let term = |(precision, (mean, value)): (&f64, (&f64, &f64))| {
        precision.ln() - precision * (mean - value).powi(2)
    };
    0.5 * precisions.iter().zip(mean.iter().zip(values)).map(term).sum::<f64>()
}

/// The matrix of all products.
fn products<T>(all: &[T], product: impl Fn(&T, &T) -> f64) -> [[f64; CHANNELS]; CHANNELS] {
    std::array::from_fn(|i| std::array::from_fn(|j| product(&all[i], &all[j])))
}
