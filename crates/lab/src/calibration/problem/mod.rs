//! The least-squares problem of a calibration: residuals, normal equations and log evidence of all parameters.
//!
//! The parameters θ have a Gaussian prior with mean m and precisions P. What was measured is y = f(θ) + r, where each
//! contact's residual has the covariance V of [`NoiseModel`] and each jump of a zero the variance of its drift. The posterior's
//! maximum is found by Gauss and Newton's method with V, P and the drifts estimated anew at each step (iteratively
//! reweighted least squares). Its logarithm's curvature H then gives the posterior covariance H⁻¹ and the evidence.
//!
//! Source: D. J. C. MacKay, Bayesian interpolation, Neural Computation 4 (1992) 415 (evidence by the Laplace approximation,
//! effective number of parameters).

pub(crate) mod effort;
pub(crate) mod evidence;
pub(crate) mod hyperparameters;
pub(crate) mod jumps;

use std::collections::BTreeMap;
use std::sync::Arc;

use self::effort::Effort;
use self::evidence::{log_likelihood_of_contacts, log_prior};
use self::hyperparameters::{Estimates, Settings};
use self::jumps::{Jump, Jumps};
use super::model::{ParameterLayout, ReadingSlopes};
use super::noise::NoisePrior;
use crate::ageing;
use crate::calibration::data::contacts::{FieldAtPlace, Fitted, Knowledge, Maps, Measured, TERMS};
use crate::calibration::data::plate::scale;
use crate::calibration::data::rig::RigPrior;
use crate::calibration::model::background_deviations::Coefficient;
use crate::calibration::model::physical::free;
use crate::calibration::model::prior::Prior;
use crate::calibration::model::prior_deviations::Deviating;
use crate::calibration::noise::lasting::Filter;
use crate::calibration::noise::model::NoiseModel;
use crate::calibration::noise::normal_equations::{GaussNewtonStep, NormalEquations};
use crate::calibration::noise::residual::{MarginalPrecision, Residual};
use tactpad_core::pad::device::Device;
use tactpad_core::pad::field::Sensitivity;
use tactpad_core::pipeline::compensation::hysteresis::PLAYS;
use tactpad_core::pipeline::contact::uncertainty::UNKNOWNS;
use tactpad_core::quantity::CHANNELS;
use tactpad_core::tables::recording::Recording;
use tactpad_numeric::linear::LargeFactor;
use tactpad_numeric::memory::Relaxation;
use tactpad_numeric::products::{combined, dot};

/// Most Gauss-Newton steps of a fit; the channels are nearly linear in the parameters.
const STEPS_MAX: usize = 12;
/// A contact is taken to be elsewhere only where that is farther off.
const RELOCATED_MM: f64 = 0.1;
/// Least part of the readings that counts as degrees of freedom, however many parameters are fitted.
const DEGREES_OF_FREEDOM_RATIO_MIN: f64 = 0.05;

/// Least-squares problem: measured contacts and the parameters that are fitted.
#[derive(Clone)]
pub(crate) struct Problem<'f> {
    pub(crate) prior: &'f Prior,
    pub(crate) recording: &'f Recording,
    pub(crate) reference_c: Option<f64>,
    pub(crate) sensitivities: Vec<&'f Sensitivity>,
    pub(crate) layout: ParameterLayout,
    /// Rows of the recording, and what was measured in them.
    pub(crate) contacts: Vec<(usize, Measured)>,
    /// From one reading of the untouched pad to the next.
    pub(crate) jumps: Jumps,
    /// Root mean square of each map over the plate.
    pub(crate) scale: Maps,
    pub(crate) plate_mm: f64,
    pub(crate) reach_mm: f64,
}

/// The posterior for some settings.
#[derive(Clone, Debug)]
pub(crate) struct PosteriorFit {
    pub(crate) settings: Settings,
    /// Its maximum, in the order of [`ParameterLayout`].
    pub(crate) values: Vec<f64>,
    pub(crate) estimates: Estimates,
    /// Of the curvature H.
    pub(crate) factor: LargeFactor,
    /// ln p(y | settings) by the Laplace approximation, but for a constant that the settings share.
    pub(crate) log_evidence: f64,
    /// The contacts as they are taken to be.
    located: Vec<Located>,
}

/// Where a contact is taken to be.
#[derive(Clone, Debug)]
struct Located {
    place_mm: [f64; 2],
    /// The field there, which takes long to find.
    place: Arc<FieldAtPlace>,
    force_n: [f64; 3],
}

/// A contact as a fit explains it.
#[derive(Clone, Debug)]
pub(crate) struct ExplainedContact {
    pub(crate) place_mm: [f64; 2],
    pub(crate) residual: Residual,
    /// Inverse covariance of the residual by the noise model.
    pub(crate) precision: MarginalPrecision,
    /// Posterior covariance of what the fit says of the channels, A H⁻¹ Aᵀ with A = ∂s/∂θ, µV².
    pub(crate) posterior_uv2: [[f64; CHANNELS]; CHANNELS],
}

impl<'f> Problem<'f> {
    /// `fitted` are the contacts to fit to; all other rows only tell the load path. Without polynomials for a background.
    pub(crate) fn of(
        recording: &'f Recording,
        reference_c: Option<f64>,
        fitted: &[Fitted],
        device: &Device,
        prior: &'f Prior,
    ) -> Self {
        let field = &prior.field;
        let (physical, sensitivities) = free(field, prior.solved.as_ref().unwrap_or(device), device);
        let plate_mm = device.plate.radius_mm();
        let rows = &recording.tared().rows;
        let to_come = ageing::to_come(rows);
        let measured = |Fitted { row, knowledge }: &Fitted| {
            let contact = Measured::of(field, &sensitivities, plate_mm, rows, *row, *knowledge, reference_c)?;
            Some((*row, Measured { to_come: to_come[*row], ..contact }))
        };
        let contacts = fitted.iter().filter_map(measured).collect();
        let is_play = fitted.iter().all(|it| it.knowledge != Knowledge::Written);
        let module_angles_deg = device.sites.angles_deg;
        let layout = ParameterLayout { physical, terms: 0, is_play, module_angles_deg };
        Self {
            jumps: Jumps::of(recording),
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
    pub(crate) const fn contacts(&self) -> usize {
        self.contacts.len()
    }

    /// The prior of the channels' noise.
    pub(crate) const fn noise_prior(&self) -> &NoisePrior {
        &self.prior.noise
    }

    /// The same with polynomials for a background.
    pub(crate) fn with_background(mut self) -> Self {
        self.layout.terms = TERMS;
        self
    }

    /// The maximum of the posterior. The search begins at `start`, or at the prior's mean. `None` where the curvature is not
    /// positive definite or a parameter not finite.
    pub(crate) fn fitted(
        mut self,
        settings: Settings,
        start: Option<&PosteriorFit>,
        effort: Effort,
    ) -> Option<PosteriorFit> {
        let mut estimates =
            Estimates::first(self.prior.noise, settings.noise_time_s, self.recording.is_tared());
        let mut values = self.layout.prior_mean(self.prior, &estimates.rig);
        if let Some(start) = start {
            values.iter_mut().zip(&start.values).for_each(|(value, start)| *value = *start);
            estimates = start.estimates;
            estimates.noise_model.lasting_s = settings.noise_time_s;
            self.relabel(&values);
            self.take_up(&start.located);
        }
        estimates.prior_deviations = estimates.prior_deviations.scaled(settings.elastic_scale);
        let mut found: Option<PosteriorFit> = None;
        for _ in 0..STEPS_MAX {
            // One Gauss-Newton step with the present hyperparameters.
            let mean = self.layout.prior_mean(self.prior, &estimates.rig);
            let precisions = self.layout.precisions(&estimates.prior_deviations, &estimates.rig);
            self.follow_load_path(&values, &settings);
            let GaussNewtonStep { delta, factor } = self.step(&values, &estimates, &mean, &precisions)?;
            values.iter_mut().zip(&delta).for_each(|(value, delta)| *value += delta);
            self.relabel(&values);
            self.relocate(&values, &estimates.noise_model);
            let residuals = self.residuals(&values);
            let variances = factor.inverse_diagonal();
            // ln p(y | settings) ≈ ln p(y | θ) + ln p(θ) − ½ ln det H at the maximum.
            let mut log_evidence = log_likelihood_of_contacts(&residuals, &estimates.noise_model)?;
            log_evidence += self.jumps.log_likelihood(&self.layout, &values, &estimates.drift_uv)
                - 0.5 * factor.log_determinant();
            log_evidence += log_prior(&values, &mean, &precisions) + estimates.rig.log_odds;
            let gain =
                found.as_ref().map_or(f64::INFINITY, |previous| (log_evidence - previous.log_evidence).abs());
            let located = self.located();
            found = Some(PosteriorFit {
                settings,
                values: values.clone(),
                estimates,
                factor,
                log_evidence,
                located,
            });
            // Then the hyperparameters at the new parameters.
            let mut differences: Vec<f64> =
                values.iter().zip(&mean).map(|(value, mean)| value - mean).collect();
            if !self.layout.is_play {
                // Modules that are off alike are a stage that is off, and say nothing of how carefully modules are put down.
                let common = self.layout.common_shift(&differences, &precisions);
                common.into_iter().for_each(|(at, common)| differences[at] -= common);
            }
            let deviating = self.layout.kinds().map(|(kind, module, at)| {
                let (difference, variance) = (differences[at], variances[at]);
                Deviating { kind, module, difference, variance }
            });
            let background = self.layout.background_degrees().map(|(degree, at)| Coefficient {
                degree,
                value: values[at],
                variance: variances[at],
            });
            let freedom_ratio = self.degrees_of_freedom_ratio(&precisions, &variances);
            estimates = Estimates {
                prior_deviations: estimates.prior_deviations.reestimated(deviating, background),
                noise_model: estimates.noise_model.reestimated(&residuals, freedom_ratio),
                drift_uv: self.jumps.drift_uv(&self.layout, &values),
                rig: self.rig_prior(&estimates.rig, &values, &variances),
            };
            if effort.is_enough(log_evidence, gain) {
                break;
            }
        }
        found.filter(|fit| fit.values.iter().all(|value| value.is_finite()))
    }

    /// The prior of the rig's errors, by the present posterior; play has no rig.
    fn rig_prior(&self, present: &RigPrior, values: &[f64], variances: &[f64]) -> RigPrior {
        if self.layout.is_play {
            *present
        } else {
            present.matched(&ParameterLayout::rig(values), &variances[ParameterLayout::first_of_rig()..])
        }
    }

    /// States of the play operators and of creep along the load path, by these parameters.
    pub(crate) fn follow_load_path(&mut self, values: &[f64], settings: &Settings) {
        if settings.thresholds_uv == [0.0; PLAYS] && settings.creep_time_s == 0.0 {
            return;
        }
        let strain = |(at, it): &(usize, Measured)| (*at, self.layout.load_uv(values, &self.scale, it));
        let strains: BTreeMap<usize, [f64; CHANNELS]> = self.contacts.iter().map(strain).collect();
        self.follow_creep(settings.creep_time_s, &strains);
        // Lags l = p − e of the play operators, relative to those of the untouched pad's readings.
        let hysteresis = ParameterLayout::hysteresis(values, &settings.thresholds_uv);
        for channel in 0..CHANNELS {
            let known = |at: usize| strains.get(&at).map(|uv| uv[channel]);
            let states = self.recording.states(channel, &hysteresis, known);
            for Jump { rows: [first, second], lags, .. } in &mut self.jumps.all {
                let changes = states[*second].iter().zip(states[*first]).map(|(to, from)| to - from);
                lags.iter_mut().zip(changes).for_each(|(lags, change_uv)| lags[channel] = change_uv);
            }
            let states = self.recording.relative(channel, states);
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
        // Only states are asked for, which are those of any share.
        let creep = Relaxation { time_s, share: 1.0 };
        for channel in 0..CHANNELS {
            let known = |at: usize| strains.get(&at).map(|uv| uv[channel]);
            let states = self.recording.crept(channel, &creep, known);
            for Jump { rows: [first, second], crept_uv, .. } in &mut self.jumps.all {
                crept_uv[channel] = states[*second][0] - states[*first][0];
            }
            let states = self.recording.relative(channel, states);
            for (at, contact) in &mut self.contacts {
                [contact.crept_uv[channel]] = states[*at];
            }
        }
    }

    /// The Gauss-Newton step from θ (`values`).
    fn step(
        &self,
        values: &[f64],
        estimates: &Estimates,
        mean: &[f64],
        precisions: &[f64],
    ) -> Option<GaussNewtonStep> {
        let mut prior = NormalEquations::of_prior(precisions, mean, values);
        if self.layout.is_play && self.layout.terms > 0 {
            self.pull_back(&mut prior, values, &estimates.noise_model, precisions)?;
        }
        self.equations(prior, values, estimates, |_, _, _| ())?.solved()
    }

    /// Takes back by how much the most probable background makes forces too large.
    ///
    /// Nobody knows the forces F of presses without labels. Where the field reads less of a force they are larger, and the background that
    /// says as much is smaller: its density p(β) is larger, as exp(−½ Σ β²/τ²), though there is no more of β that is probable. Integrated over β
    /// there is −½ ln det H as well, whose derivative by ln F is the opposite at the τ of the evidence. So the gradient gets Σᵢ wᵢ ∂Fᵢ/∂θ, with
    /// Σᵢ wᵢ Fᵢ = Σ β²/τ² for each axis of the force; a contact counts by the share of its force along that axis.
    fn pull_back(
        &self,
        equations: &mut NormalEquations,
        values: &[f64],
        noise_model: &NoiseModel,
        precisions: &[f64],
    ) -> Option<()> {
        let mut squares = [0.0; 3];
        self.layout
            .background_axes()
            .for_each(|(axis, at)| squares[axis] += values[at].powi(2) * precisions[at]);
        let shares = |contact: &Measured| {
            let square = dot(&contact.force_n, &contact.force_n).max(f64::MIN_POSITIVE);
            contact.force_n.map(|n| n * n / square)
        };
        let mut sums = [f64::MIN_POSITIVE; 3];
        for (_, contact) in &self.contacts {
            sums.iter_mut().zip(shares(contact)).for_each(|(sum, share)| *sum += share);
        }
        let first = self.layout.background(0, 0);
        for (_, contact) in &self.contacts {
            let residual = self.residual(values, contact);
            let square = dot(&contact.force_n, &contact.force_n).max(f64::MIN_POSITIVE);
            let by_force: [f64; 3] =
                std::array::from_fn(|axis| squares[axis] / sums[axis] * contact.force_n[axis] / square);
            let by_channel = noise_model.through_force(&residual, &by_force)?;
            let rows = self.slopes(values, contact, &residual).whole();
            by_channel.iter().zip(&rows).for_each(|(by, row)| equations.pull(*by, &row[..first]));
        }
        Some(())
    }

    /// Contribution of all contacts and jumps to the normal equations of a prior about θ. Where these have more unknowns than θ, `widen` adds the
    /// derivatives by them to those of each contact, which it is told by its place.
    pub(crate) fn equations(
        &self,
        mut equations: NormalEquations,
        values: &[f64],
        estimates: &Estimates,
        widen: impl Fn(usize, &(usize, Measured), &mut [Vec<f64>]),
    ) -> Option<NormalEquations> {
        let wander = estimates.noise_model.wander();
        let mut filter = wander.as_ref().map(|wander| Filter::new(wander, equations.size()));
        let mut previous_s = None;
        for (at, known) in self.contacts.iter().enumerate() {
            let (_, contact) = known;
            let residual = self.residual(values, contact);
            let slopes = self.slopes(values, contact, &residual);
            let mut rows = slopes.whole();
            widen(at, known, &mut rows);
            let precision = estimates.noise_model.marginal_precision(&residual)?.matrix();
            let weighted = combined(&precision, &rows);
            if let Some(filter) = &mut filter {
                if let Some(previous_s) = previous_s.replace(contact.at_s) {
                    filter.pass(contact.at_s - previous_s, Some(&mut equations))?;
                }
                filter.see(&precision, &residual, &weighted);
            }
            equations.add_contact(slopes.widened(&rows), weighted, &residual.residual_uv);
        }
        if let Some(filter) = filter {
            filter.end(Some(&mut equations))?;
        }
        self.jumps.each(
            &self.layout,
            values,
            &estimates.drift_uv,
            |_, residual_uv, variance, derivatives| {
                equations.add(residual_uv, variance, derivatives);
            },
        );
        Some(equations)
    }

    /// Mean and precisions of the prior at a fit's hyperparameters.
    pub(crate) fn prior_of(&self, fit: &PosteriorFit) -> (Vec<f64>, Vec<f64>) {
        let Estimates { prior_deviations, rig, .. } = &fit.estimates;
        let precisions = self.layout.precisions(prior_deviations, rig);
        (self.layout.prior_mean(self.prior, rig), precisions)
    }

    /// ∂f/∂θ at a contact.
    fn slopes(&self, values: &[f64], contact: &Measured, residual: &Residual) -> ReadingSlopes {
        let mut by_parameters = self.layout.slopes(values, &self.scale, contact);
        if contact.knowledge == Knowledge::Written {
            // ∂f/∂ρⱼ = J ∂T/∂ρⱼ, beside what f has of ρ itself.
            let slopes = contact.written.slopes(&ParameterLayout::rig(values));
            for (row, jacobian) in by_parameters.rest.iter_mut().zip(&residual.label_jacobian) {
                let of_rig = row[ParameterLayout::first_of_rig()..].iter_mut().zip(&slopes);
                of_rig.for_each(|(entry, slope)| *entry += dot(jacobian, slope));
            }
        }
        by_parameters
    }

    /// What a contact's readings have beyond the model, with the derivatives by the contact.
    fn residual(&self, values: &[f64], contact: &Measured) -> Residual {
        let fitted_uv = self.layout.readings(values, &self.scale, contact);
        let label_jacobian = self.layout.label_jacobian(values, &self.scale, contact);
        // r = y − f(θ) − J d, where the contact is taken to be off its label by d.
        let off = contact.off_label();
        let residual_uv =
            std::array::from_fn(|k| contact.uv[k] - fitted_uv[k] + dot(&label_jacobian[k], &off));
        let [fx_n, fy_n, fz_n] = contact.force_n;
        let force_n = libm::hypot(libm::hypot(fx_n, fy_n), fz_n);
        // Noise in proportion to a reading that has it would draw the fit to the small readings.
        let uv = if contact.knowledge == Knowledge::Written { contact.uv } else { fitted_uv };
        let Measured { knowledge, at_s, .. } = *contact;
        Residual { knowledge, at_s, uv, force_n, residual_uv, label_jacobian }
    }

    fn residuals(&self, values: &[f64]) -> Vec<Residual> {
        self.contacts.iter().map(|(_, contact)| self.residual(values, contact)).collect()
    }

    /// ln p(contacts | θ), but for a constant.
    pub(crate) fn log_likelihood(&self, values: &[f64], noise_model: &NoiseModel) -> Option<f64> {
        log_likelihood_of_contacts(&self.residuals(values), noise_model)
    }

    /// Corrected labels, by these errors of the rig.
    fn relabel(&mut self, values: &[f64]) {
        let rig = ParameterLayout::rig(values);
        let written = self.contacts.iter_mut().filter(|(_, contact)| contact.knowledge == Knowledge::Written);
        written.for_each(|(_, contact)| contact.label = contact.written.contact(&rig));
    }

    /// Takes each contact whose label the channels may correct to be where they say, by these parameters; the others are where
    /// their labels are.
    pub(crate) fn relocate(&mut self, values: &[f64], noise_model: &NoiseModel) {
        let here = |(_, contact): &(usize, Measured)| {
            let label = contact.label;
            if contact.knowledge == Knowledge::Written {
                return label;
            }
            let residual = self.residual(values, contact);
            let error = noise_model.label_error(&residual).unwrap_or_default();
            std::array::from_fn(|k| label[k] + error[k])
        };
        let contacts: Vec<[f64; UNKNOWNS]> = self.contacts.iter().map(here).collect();
        self.locate(&contacts);
    }

    /// Takes the contacts to be these.
    fn locate(&mut self, contacts: &[[f64; UNKNOWNS]]) {
        let (field, plate_mm) = (&self.prior.field, self.plate_mm);
        for ((_, contact), here) in self.contacts.iter_mut().zip(contacts) {
            let [x_mm, y_mm, fx_n, fy_n, fz_n] = *here;
            // No contact is beyond the plate that the field covers.
            let inward = (self.reach_mm / libm::hypot(x_mm, y_mm)).min(1.0);
            let place_mm = [inward * x_mm, inward * y_mm];
            contact.force_n = [fx_n, fy_n, fz_n];
            // So near the field is linear, and nothing is gained by being there.
            let [dx_mm, dy_mm] = [0, 1].map(|axis| place_mm[axis] - contact.place_mm[axis]);
            if libm::hypot(dx_mm, dy_mm) > RELOCATED_MM {
                let mut place = FieldAtPlace::of(field, &self.sensitivities, plate_mm, place_mm);
                // Of a written contact the background is at the place as written: a stage's errors must not move it, or the fit
                // finds those by which its polynomials suit best.
                if contact.knowledge == Knowledge::Written {
                    place.terms = contact.place.terms;
                }
                (contact.place, contact.place_mm) = (Arc::new(place), place_mm);
            }
        }
    }

    fn located(&self) -> Vec<Located> {
        let here = |(_, it): &(usize, Measured)| Located {
            place_mm: it.place_mm,
            place: Arc::clone(&it.place),
            force_n: it.force_n,
        };
        self.contacts.iter().map(here).collect()
    }

    /// Takes the contacts to be where another fit of them took them to be.
    fn take_up(&mut self, located: &[Located]) {
        for ((_, contact), Located { place_mm, place, force_n }) in self.contacts.iter_mut().zip(located) {
            (contact.place_mm, contact.force_n) = (*place_mm, *force_n);
            contact.place = Arc::clone(place);
        }
    }

    /// A fit's contacts, as it explains them.
    pub(crate) fn explained(mut self, fit: &PosteriorFit) -> Vec<ExplainedContact> {
        self.relabel(&fit.values);
        self.take_up(&fit.located);
        self.follow_load_path(&fit.values, &fit.settings);
        let contacts = self.contacts.iter().zip(self.residuals(&fit.values));
        let explained = contacts.filter_map(|((_, contact), residual)| {
            let precision = fit.estimates.noise_model.marginal_precision(&residual)?;
            let slopes = self.slopes(&fit.values, contact, &residual).whole();
            let halves: Vec<Vec<f64>> = slopes.iter().map(|row| fit.factor.solve_lower(row)).collect();
            let posterior_uv2 = std::array::from_fn(|k| std::array::from_fn(|l| dot(&halves[k], &halves[l])));
            Some(ExplainedContact { place_mm: contact.place_mm, residual, precision, posterior_uv2 })
        });
        explained.collect()
    }

    /// Residual degrees of freedom as a share of the readings, (N − γ)/N, with γ = Σᵢ (1 − Pᵢ (H⁻¹)ᵢᵢ) the effective number of
    /// parameters: those that the contacts tell, not the prior (MacKay 1992).
    ///
    /// `precisions` are P, `variances` the diagonal of H⁻¹.
    fn degrees_of_freedom_ratio(&self, precisions: &[f64], variances: &[f64]) -> f64 {
        let effective: f64 =
            precisions.iter().zip(variances).map(|(precision, variance)| 1.0 - precision * variance).sum();
        // A contact without a label takes five of its nine readings.
        let readings = |(_, contact): &(usize, Measured)| {
            if contact.knowledge == Knowledge::Unlabelled { CHANNELS - UNKNOWNS } else { CHANNELS }
        };
        let readings: usize = self.contacts.iter().map(readings).sum();
        (1.0 - effective / readings as f64).max(DEGREES_OF_FREEDOM_RATIO_MIN)
    }
}
